//! What the pictures of a turntable or of an animation have in common. If it changed from one to the next, they would
//! flicker.

use crate::built::Built;
use crate::memory::Memory;
use crate::own_light::Judged;
use crate::presets::{Studio, set_upright};
use crate::settings::Settings;
use crate::{Error, Job, own_light};
use bilux_scene::{BuiltParts, Parameters, SceneBuilder};

/// The maximum number of views in which a turntable's own light is measured.
const MAX_VIEWS: u32 = 8;

/// What the pictures of a series have in common; for a single picture, nothing.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// The part of a full turn by which the camera has moved around a model that is framed for the whole turn.
    turn: Option<f32>,
    /// What was found of the scene's own light, in the first picture or in all views.
    own_light: Option<Judged>,
}

impl Series {
    /// `count` pictures from all around a model: all are framed for a full turn, and lit by the studio if one of them
    /// needs its light. This is the first.
    ///
    /// # Errors
    /// If a setting or anything in the scene is wrong, or if more than `most` bytes of memory are needed.
    pub fn turntable(
        scene: &SceneBuilder,
        user: &Parameters,
        most: u64,
        count: u32,
    ) -> Result<Series, Error> {
        let settings = checked(scene, user, most)?;
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

/// Checks settings, and that the picture fits into memory.
fn checked(scene: &SceneBuilder, user: &Parameters, most: u64) -> Result<Settings, Error> {
    let settings = Settings::of(scene, user)?;
    let needed = Memory::of(scene, &settings);
    if needed.total() > most {
        return Err(Error::TooLarge { needed, most });
    }
    Ok(settings)
}

impl Job {
    /// A picture of a series, as [`Job::within`].
    ///
    /// # Errors
    /// As for [`Job::within`].
    pub fn in_series(
        scene: &SceneBuilder,
        user: &Parameters,
        most: u64,
        series: &Series,
    ) -> Result<Job, Error> {
        Job::with_built(scene, user, most, series, &mut Built::default())
    }

    /// The same picture, made with what earlier jobs have built of this scene or another; what is new is kept there.
    ///
    /// # Errors
    /// As for [`Job::within`].
    pub fn with_built(
        scene: &SceneBuilder,
        user: &Parameters,
        most: u64,
        series: &Series,
        built: &mut Built,
    ) -> Result<Job, Error> {
        let mut settings = checked(scene, user, most)?;
        (settings.studio.turn, settings.own_light) = (series.turn, series.own_light);
        let mut job = Job::reusing(scene, settings, built)?;
        job.warnings.extend(job.settings.unused_settings(user));
        Ok(job)
    }

    /// The series of this picture and of those that are to be lit as it is.
    pub fn series(&self) -> Series {
        Series { turn: self.settings.studio.turn, own_light: self.settings.own_light }
    }
}
