//! Series of pictures, a turntable or an animation: what they have in common. If it changed from one to the next, they would
//! flicker.

use crate::Error;
use crate::job::own_light;
use crate::preparation::judged::Judged;
use crate::preparation::presets::{Studio, set_upright};
use crate::request::JobRequest;
use bilux_scene::{BuiltParts, SceneBuilder};

/// The maximum number of views in which a turntable's own light is measured.
const MAX_VIEWS: u32 = 8;

/// Properties that the pictures of a series have in common; a single picture has none.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// The part of a full turn by which the camera has moved around a model that is framed for the whole turn.
    pub(crate) turn: Option<f32>,
    /// The judgement of the scene's own light, in the first picture or in all views.
    pub(crate) own_light: Option<Judged>,
}

impl Series {
    /// `count` pictures from all around a model: all are framed for a full turn, and lit by the studio if one of them
    /// needs its light. This is the first.
    ///
    /// # Errors
    /// If a setting or anything in the scene is wrong, or if more memory is needed than the request allows.
    pub fn turntable(scene: &SceneBuilder, request: &JobRequest, count: u32) -> Result<Series, Error> {
        let settings = request.settings_for(scene)?;
        let aspect = settings.width as f32 / settings.height as f32;
        let views = count.clamp(1, MAX_VIEWS);
        let view = |i: u32| Studio {
            aspect: Some(aspect),
            turn: Some(of_turn(u64::from(i) * u64::from(count) / u64::from(views), count)),
            ..settings.studio
        };
        let views: Vec<Studio> = (0..views).map(view).collect();
        let mut upright = scene.clone();
        set_upright(&mut upright, &views[0]);
        let accel = settings.accel_for(scene.objects.iter().map(|object| object.mesh.triangles.len()).sum());
        let own = own_light::measure(&upright, &views, &settings, &accel, &mut BuiltParts::default())?;
        Ok(Series { turn: Some(0.0), own_light: own.map(|own| own.judged) })
    }

    /// Picture `index` of `count` of a turntable.
    #[must_use]
    pub fn turned(&self, index: u32, count: u32) -> Series {
        Series { turn: Some(of_turn(u64::from(index), count)), ..self.clone() }
    }
}

fn of_turn(index: u64, count: u32) -> f32 {
    index as f32 / count.max(1) as f32
}
