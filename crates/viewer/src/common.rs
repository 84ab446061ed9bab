//! State that all views share: the scene, the turns, the room, and what the viewer was started with.

use crate::open_scene::OpenScene;
use crate::options::Options;
use crate::turns::Turns;
use bilux::scene::{Parameters, SceneBuilder};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An upper estimate of the bytes that each pixel of a view takes: the picture, its copy while it is denoised, and what
/// denoising takes.
const PIXEL: u64 = 400;
/// Bytes per triangle that a view takes for itself: the studio's ground depends on the shape of the window, and is joined
/// with what else stands still.
const TRIANGLE: u64 = 40;

/// State that all views share.
pub(crate) struct Common {
    /// The settings that the viewer was started with.
    pub(crate) settings: Parameters,
    pub(crate) max_memory: u64,
    pub(crate) may_edit: bool,
    pub(crate) may_drop: bool,
    pub(crate) sandboxed: bool,
    pub(crate) environments: Vec<String>,
    pub(crate) open: Arc<OpenScene>,
    pub(crate) turns: Turns,
    pub(crate) room: Room,
    /// Accelerators are measured for one view at a time: each is built, and may take all the memory that there is.
    pub(crate) measuring: Mutex<()>,
}

impl Common {
    /// State of the views that are started with these options.
    pub(crate) fn new(options: &Options, open: Arc<OpenScene>) -> Common {
        Common {
            settings: options.settings.clone(),
            max_memory: options.max_memory,
            may_edit: options.may_edit,
            may_drop: options.may_edit && options.may_drop,
            sandboxed: options.sandboxed,
            environments: options.environments.clone(),
            open,
            turns: Turns::default(),
            room: Room::default(),
            measuring: Mutex::default(),
        }
    }
}

/// The memory that is left for views, and who takes how much of it.
#[derive(Default)]
pub(crate) struct Room {
    /// The bytes that each view has taken, by its number.
    taken: Mutex<Vec<(u64, u64)>>,
    views: AtomicU64,
}

impl Room {
    /// The number of another view.
    pub(crate) fn number(&self) -> u64 {
        self.views.fetch_add(1, Ordering::Relaxed)
    }

    /// Gives a view room for so many pictures of a scene, if `most` bytes are there for all views together. Returns the
    /// number of pixels that each picture may have, at most as many as it asks for.
    pub(crate) fn take(
        &self,
        view: u64,
        [pictures, pixels]: [u64; 2],
        scene: &SceneBuilder,
        most: u64,
    ) -> u64 {
        let (scene_itself, of_view) = sizes(scene);
        let mut taken = self.lock();
        taken.retain(|(other, _)| *other != view);
        let others: u64 = taken.iter().map(|(_, bytes)| bytes).sum();
        let left = most.saturating_sub(scene_itself).saturating_sub(others) / pictures;
        let granted = pixels.min(left.saturating_sub(of_view) / PIXEL);
        let each = of_view.saturating_add(granted.saturating_mul(PIXEL));
        taken.push((view, each.saturating_mul(pictures)));
        granted
    }

    /// True if another view of so many pixels finds room.
    pub(crate) fn is_left(&self, pixels: u64, scene: &SceneBuilder, most: u64) -> bool {
        let (scene, of_view) = sizes(scene);
        let others: u64 = self.lock().iter().map(|(_, bytes)| bytes).sum();
        let wanted = [scene, of_view, others, pixels.saturating_mul(PIXEL)];
        wanted.into_iter().fold(0, u64::saturating_add) <= most
    }

    /// A view is closed.
    pub(crate) fn leave(&self, view: u64) {
        self.lock().retain(|(other, _)| *other != view);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(u64, u64)>> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The bytes that a scene takes, and those that each of its views takes besides its picture.
fn sizes(scene: &SceneBuilder) -> (u64, u64) {
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    (bilux::memory::Memory::of_scene(scene).total(), triangles as u64 * TRIANGLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_get_what_is_left_of_the_memory_and_give_it_back() {
        let (room, scene) = (Room::default(), SceneBuilder::default());
        let own = sizes(&scene).0;
        let most = own + 1000 * PIXEL;
        assert_eq!(room.take(0, [1, 600], &scene, most), 600);
        assert_eq!(room.take(1, [1, 600], &scene, most), 400);
        assert!(!room.is_left(1, &scene, most));
        // A view that changes its size gives its own room back first.
        assert_eq!(room.take(0, [1, 500], &scene, most), 500);
        assert!(room.is_left(100, &scene, most) && !room.is_left(101, &scene, most));
        room.leave(1);
        assert_eq!(room.take(2, [1, 600], &scene, most), 500);
        // Two pictures that are compared take twice as much.
        room.leave(2);
        assert_eq!(room.take(3, [2, 600], &scene, most), 250);
        assert!(!room.is_left(1, &scene, most));
    }
}
