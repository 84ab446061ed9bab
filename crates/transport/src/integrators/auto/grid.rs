//! The pixels of a film that a pilot samples.

use crate::film::window::Window;
use crate::schedule::settings::RenderSettings;
use bilux_math::Vec2;

/// Side of a block of pixels that is evaluated as a whole.
const BLOCK: u32 = 4;

/// Maximum number of pixels of a pilot; and minimum, unless the film has fewer. More make a better choice, but not in proportion
/// to their time: docs/adr/0013-auto.md has figures.
const MAX_PIXELS: u64 = 256;
const MIN_PIXELS: u64 = 128;
/// Between the two, the pilot has one pixel for this many of the film's.
const PART: u64 = 96;

/// The pixels of the film that a pilot samples: a regular grid of them, each at its true size. Differences between them
/// are not noise, as they would be within larger pixels.
pub(super) struct Grid {
    film: [u32; 2],
    /// Columns and rows.
    pub(super) size: [u32; 2],
}

impl Grid {
    pub(super) fn of(film: &RenderSettings) -> Grid {
        let pixels = u64::from(film.width) * u64::from(film.height);
        let wanted = (pixels / PART).clamp(MIN_PIXELS, MAX_PIXELS).min(pixels);
        let scale = (wanted as f64 / pixels as f64).sqrt();
        let size =
            [film.width, film.height].map(|side| ((f64::from(side) * scale).round() as u32).clamp(1, side));
        Grid { film: [film.width, film.height], size }
    }

    pub(super) fn tiles(&self) -> Vec<Window> {
        Window::whole(self.size[0], self.size[1]).tiles(BLOCK)
    }

    /// The film's pixel at a position in the grid.
    pub(super) fn pixel(&self, (x, y): (u32, u32)) -> (u32, u32) {
        let along = |at: u32, axis: usize| {
            let middle = (2 * u64::from(at) + 1) * u64::from(self.film[axis]);
            (middle / (2 * u64::from(self.size[axis]))) as u32
        };
        (along(x, 0), along(y, 1))
    }

    /// The tile at a point of the film's plane; `None` beyond the film's edge, from where little light comes into the picture.
    pub(super) fn tile_at(&self, film: Vec2) -> Option<usize> {
        let [width, height] = self.size;
        let is_on_film = film.cmpge(Vec2::ZERO).all() && film.cmplt(Vec2::ONE).all();
        let place = (film * Vec2::new(width as f32, height as f32)).as_uvec2();
        let place = [place.x.min(width - 1), place.y.min(height - 1)].map(|at| at / BLOCK);
        is_on_film.then_some((place[1] * width.div_ceil(BLOCK) + place[0]) as usize)
    }
}
