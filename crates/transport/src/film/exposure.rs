//! When the points of the film are exposed: all at once, or one row after the other, as a rolling shutter does it.

use bilux_math::Vec2;

/// Every row is exposed for as long, the first one first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposure {
    opens: f32,
    /// For the first row.
    closes: f32,
    /// Delay of the last row after the first, in seconds.
    readout: f32,
    /// The half of a row's height, as a part of the film.
    half_row: f32,
}

impl Exposure {
    /// Exposure of so many rows while the shutter is open, which it is while any row is exposed. The middles of rows are exposed evenly
    /// one after the other, the last one `readout` seconds after the first.
    pub(crate) fn new([opens, last]: [f32; 2], readout: f32, rows: u32) -> Exposure {
        // A single row is the first and the last.
        let readout = if rows > 1 { readout } else { 0.0 };
        let closes = if readout == 0.0 { last } else { (last - readout).max(opens) };
        Exposure { opens, closes, readout, half_row: 0.5 / rows as f32 }
    }

    /// When the first row's exposure begins and ends.
    #[inline]
    pub(crate) fn of_first_row(&self) -> [f32; 2] {
        [self.opens, self.closes]
    }

    /// Delay after the first row with which a point of the film is exposed: not before it, and not after the last. Beyond the
    /// film's edges, time runs backwards: then rays are even over time, whichever filter spreads them over the film.
    #[inline]
    pub(crate) fn delay(&self, film: Vec2) -> f32 {
        if self.readout == 0.0 {
            return 0.0;
        }
        let inside = 1.0 - (1.0 - film.y.abs()).abs();
        self.readout * ((inside - self.half_row) / (1.0 - 2.0 * self.half_row)).clamp(0.0, 1.0)
    }

    /// Whether a point of the film is exposed at this time.
    #[inline]
    pub(crate) fn exposes(&self, film: Vec2, time: f32) -> bool {
        self.readout == 0.0 || self.is_open(time - self.delay(film))
    }

    /// Whether a row that is exposed like the first one is exposed at this time.
    fn is_open(&self, time: f32) -> bool {
        (self.opens..=self.closes).contains(&time)
    }

    /// By how much camera rays of this time are denser than those of all times together, since they begin at a part of the film only.
    #[inline]
    pub(crate) fn density(&self, time: f32) -> f32 {
        if self.readout == 0.0 {
            return 1.0;
        }
        let [first, last] =
            [self.closes, self.opens].map(|end| ((time - end) / self.readout).clamp(0.0, 1.0));
        // The upper half of the first row is exposed with its middle, and the lower half of the last.
        let ends = [time, time - self.readout].into_iter().filter(|time| self.is_open(*time)).count() as f32;
        1.0 / ((last - first) * (1.0 - 2.0 * self.half_row) + ends * self.half_row)
    }
}
