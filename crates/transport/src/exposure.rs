//! When the points of the film are exposed: all at once, or one row after the other, as a rolling shutter does it.

use crate::settings::RenderSettings;
use bilux_math::Vec2;
use bilux_scene::Scene;

/// Every row is exposed for as long, the first one first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposure {
    opens: f32,
    /// For the first row.
    closes: f32,
    /// How much later the last row is exposed.
    readout: f32,
}

impl Exposure {
    /// The shutter of a scene is open while any row is exposed.
    pub(crate) fn new(scene: &Scene, settings: &RenderSettings) -> Exposure {
        let [opens, last] = scene.shutter();
        if settings.readout == 0.0 {
            return Exposure { opens, closes: last, readout: 0.0 };
        }
        Exposure { opens, closes: (last - settings.readout).max(opens), readout: settings.readout }
    }

    /// When the first row's exposure begins and ends.
    #[inline]
    pub(crate) fn of_first_row(&self) -> [f32; 2] {
        [self.opens, self.closes]
    }

    /// How much later than the first row a point of the film is exposed. Beyond its edges, time runs backwards: then rays are
    /// even over time, whichever filter spreads them over the film.
    #[inline]
    pub(crate) fn delay(&self, film: Vec2) -> f32 {
        if self.readout == 0.0 {
            return 0.0;
        }
        let inside = 1.0 - (1.0 - film.y.abs()).abs();
        self.readout * inside.clamp(0.0, 1.0)
    }

    /// Whether a point of the film is exposed at this time.
    #[inline]
    pub(crate) fn exposes(&self, film: Vec2, time: f32) -> bool {
        self.readout == 0.0 || (self.opens..=self.closes).contains(&(time - self.delay(film)))
    }

    /// By how much camera rays of this time are denser than those of all times together, since they begin at a part of the film only.
    #[inline]
    pub(crate) fn density(&self, time: f32) -> f32 {
        if self.readout == 0.0 {
            return 1.0;
        }
        let [first, last] =
            [self.closes, self.opens].map(|end| ((time - end) / self.readout).clamp(0.0, 1.0));
        1.0 / (last - first)
    }
}
