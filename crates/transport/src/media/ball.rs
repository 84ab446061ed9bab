//! Balls around points of dense media, in which photons are merged.

use std::f32::consts::PI;

/// A ball around a point of a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    /// In metres.
    pub(crate) radius: f32,
    /// Volume of the part of it that is in the medium, in cubic metres.
    pub(crate) volume: f32,
}

/// Near a surface balls shrink, to this fraction of their radius.
const SHRUNK: f32 = 0.5;

impl Ball {
    /// A whole one.
    pub(crate) fn whole(radius: f32) -> Ball {
        Ball { radius, volume: 4.0 / 3.0 * PI * radius * radius * radius }
    }

    /// This ball where the nearest surface is at this distance from its middle: smaller, and without the part beyond the plane there.
    pub(crate) fn near(self, clearance: f32) -> Ball {
        let radius = clearance.clamp(SHRUNK * self.radius, self.radius);
        let height = (clearance / radius).min(1.0);
        let inside = 0.25 * (2.0 + height * (3.0 - height * height));
        Ball { volume: Ball::whole(radius).volume * inside, radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Vec3;

    #[test]
    fn the_part_of_a_ball_on_one_side_of_a_plane_is_counted() {
        const STEPS: i32 = 60;
        for clearance in [0.0, 0.2, 0.5, 0.7, 1.0, 3.0] {
            let part = Ball::whole(1.0).near(clearance);
            assert!((0.5..=1.0).contains(&part.radius) && part.radius >= clearance.min(1.0));
            let at = |i: i32| (i as f32 + 0.5) / STEPS as f32 * part.radius;
            let along = || (-STEPS..STEPS).map(at);
            let is_in = |x: f32, y: f32, z: f32| {
                z < clearance && Vec3::new(x, y, z).length_squared() < part.radius * part.radius
            };
            let count = along()
                .flat_map(|x| along().flat_map(move |y| along().map(move |z| [x, y, z])))
                .filter(|&[x, y, z]| is_in(x, y, z))
                .count();
            let step = part.radius / STEPS as f32;
            let volume = count as f32 * step * step * step;
            assert!((part.volume / volume - 1.0).abs() < 0.01, "{clearance}: {part:?}, counted {volume}");
        }
    }
}
