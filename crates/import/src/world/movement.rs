//! Movement of the objects of an animated scene.

use crate::FormatError;
use crate::input::sink::Sink;
use bilux_scene::SceneBuilder;
use std::sync::Arc;

/// The number of intervals into which the animation is divided to find where objects move.
const MOMENTS: u32 = 8;

/// All objects at times from 0 to `end`, in seconds, as `place` adds them to a scene at one time.
pub fn whole_movement(
    end: f32,
    mut place: impl FnMut(f32, &mut Sink) -> Result<(), FormatError>,
) -> Result<Arc<SceneBuilder>, FormatError> {
    let mut all = SceneBuilder::default();
    for moment in 0..=MOMENTS {
        let mut sink = Sink::default();
        place(end * moment as f32 / MOMENTS as f32, &mut sink)?;
        all.objects.extend(sink.scene.objects);
    }
    Ok(Arc::new(all))
}
