//! A thin lens: what is out of focus, and what it looks like.

use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::Vec2;
use bilux_math::registry::{Parameter, ParameterKind, integer};
use bilux_math::transcendental::{atan2, sin_cos, tan};
use std::f32::consts::TAU;

pub(super) const APERTURE: Parameter = Parameter {
    name: "aperture",
    summary: "radius of the aperture; 0 for a pinhole",
    unit: "m",
    kind: ParameterKind::Number { min: 0.0, max: 1e6 },
    default: "0",
};

pub(super) const FOCUS: Parameter = Parameter {
    name: "focus",
    summary: "focus distance; 0 for the distance of look_at",
    unit: "m",
    kind: ParameterKind::Number { min: 0.0, max: 1e9 },
    default: "0",
};

pub(super) const BLADES: Parameter = integer(
    "blades",
    "blades of the aperture: highlights out of focus have as many corners; 0 for a round one",
    0,
    64,
    "0",
);

pub(super) const BLADES_ROTATION: Parameter =
    degrees("blades_rotation", "by how much the blades are turned counterclockwise", 360.0);

pub(super) const FOCUS_TILT_X: Parameter = degrees(
    "focus_tilt_x",
    "by how much the plane of focus leans back on the right side of the picture, as behind a tilted lens",
    89.0,
);

pub(super) const FOCUS_TILT_Y: Parameter =
    degrees("focus_tilt_y", "by how much it leans back at the top; near 90 it is like a floor", 89.0);

const fn degrees(name: &'static str, summary: &'static str, most: f64) -> Parameter {
    Parameter {
        name,
        summary,
        unit: "degrees",
        kind: ParameterKind::Number { min: -most, max: most },
        default: "0",
    }
}

/// A thin lens in the plane through the eye and perpendicular to the axis.
#[derive(Clone, Copy)]
pub(super) struct ThinLens {
    /// The radius.
    pub(super) aperture: f32,
    /// Distance of the plane of focus along the axis; 0 for that of what the camera looks at.
    pub(super) focus: f32,
    /// The plane of focus is where x · tilt.x + y · tilt.y + z = focus, with x to the right, y upwards and z forwards.
    tilt: Vec2,
    blades: u32,
    /// Radians, counterclockwise.
    rotation: f32,
}

impl ThinLens {
    /// Reads the lens of a camera at this distance from what it looks at.
    pub(super) fn read(reader: &Reader, distance: f32) -> Result<ThinLens, SceneError> {
        let [x, y] = ["focus_tilt_x", "focus_tilt_y"].map(|key| -tan(reader.number(key).to_radians()));
        let lens = ThinLens {
            aperture: reader.number("aperture"),
            focus: reader.number("focus"),
            tilt: Vec2::new(if reader.bool("mirrored") { -x } else { x }, y),
            blades: reader.integer("blades") as u32,
            rotation: reader.number("blades_rotation").to_radians(),
        };
        if lens.aperture * lens.tilt.length() >= lens.focused(distance).focus {
            let message = "the plane of focus goes through the lens: tilt it less, make the aperture smaller, or focus \
                           farther away";
            let key = if reader.is_given("focus_tilt_x") { "focus_tilt_x" } else { "focus_tilt_y" };
            return Err(SceneError::invalid(message, reader.span(key)));
        }
        Ok(lens)
    }

    /// The lens of a camera at this distance from what it looks at.
    pub(super) fn focused(self, distance: f32) -> ThinLens {
        ThinLens { focus: if self.focus > 0.0 { self.focus } else { distance }, ..self }
    }

    /// The lens on the way to another one.
    pub(super) fn lerp(&self, other: &ThinLens, t: f32) -> ThinLens {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        ThinLens {
            aperture: mix(self.aperture, other.aperture),
            focus: mix(self.focus, other.focus),
            tilt: self.tilt.lerp(other.tilt, t),
            rotation: mix(self.rotation, other.rotation),
            ..*self
        }
    }

    /// The point of the aperture, in its radii to the right and upwards, by a point of the unit disc, evenly over both.
    pub(super) fn point(&self, disc: Vec2) -> Vec2 {
        if self.blades < 3 || disc == Vec2::ZERO {
            return disc;
        }
        // The disc's sectors become the triangles of a polygon: along a radius as it was, across it by the fraction of the
        // angle.
        let sector = TAU / self.blades as f32;
        let angle = atan2(disc.y, disc.x) / sector;
        let corner = |index: f32| {
            let (sin, cos) = sin_cos(index * sector + self.rotation);
            Vec2::new(cos, sin)
        };
        let edge = corner(angle.floor()).lerp(corner(angle.floor() + 1.0), angle - angle.floor());
        edge * disc.length()
    }

    /// Point at which the ray from the middle of the lens crosses the plane at distance 1. `at` is that point for the ray from this
    /// point of the lens, in metres, moved to the middle. Unmoved, both rays go through the same point of the plane of focus.
    pub(super) fn seen(&self, lens: Vec2, at: Vec2) -> Vec2 {
        let aside = if lens == Vec2::ZERO { lens } else { lens / self.focus };
        at + aside * (self.depth(at) / self.stretch(lens))
    }

    /// By how much the rays of a point of the lens cover more of the plane at distance 1 than those of its middle: other
    /// than 1 only where the plane of focus is tilted.
    pub(super) fn stretch(&self, lens: Vec2) -> f32 {
        if self.tilt == Vec2::ZERO { 1.0 } else { 1.0 - self.tilt.dot(lens) / self.focus }
    }

    /// True if [`ThinLens::stretch`] depends on the point of the lens.
    pub(super) fn is_tilted(&self) -> bool {
        self.tilt != Vec2::ZERO
    }

    /// The focus distance over the distance along the axis at which the ray from the middle through this point of the plane at distance 1
    /// reaches the plane of focus.
    pub(super) fn depth(&self, at: Vec2) -> f32 {
        if self.tilt == Vec2::ZERO { 1.0 } else { 1.0 + self.tilt.dot(at) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CameraSample, CameraSpec, build};
    use crate::parameters::Spec;
    use bilux_math::transcendental::{sin_cos_f64, tan};
    use bilux_math::{Vec2, Vec3, warp};

    /// The mean of the squared distance from the centre, over that of the corners, of a regular polygon is (2 + cos(2π/n)) / 6, of a
    /// disc 1/2; and no point is beyond its edges.
    #[test]
    fn apertures_are_evenly_covered_polygons() {
        for (blades, expected) in [(0, 0.5), (3, 0.25), (4, 1.0 / 3.0), (6, 2.5 / 6.0)] {
            let spec = Spec::new("", "perspective").with("aperture", 0.5f32).with("blades", blades);
            let camera = build(&CameraSpec::new(spec.with("blades_rotation", 20.0f32)), 1.0).unwrap();
            let (mut sum, mut farthest, mut count) = (0.0, 0.0f64, 0.0);
            for i in 0..200 * 200 {
                let u = Vec2::new((i % 200) as f32 + 0.5, (i / 200) as f32 + 0.5) / 200.0;
                let sample = CameraSample { film: Vec2::splat(0.5), lens: warp::sample_disc(u), time: 0.0 };
                let p = (Vec3::from(camera.ray(&sample).origin) - Vec3::Z * 5.0).as_dvec3() / 0.5;
                // Along the middles of the edges.
                let edge = |k: i32| {
                    let angle = (20.0 + (f64::from(k) + 0.5) * 360.0 / f64::from(blades)).to_radians();
                    {
                        let (sin, cos) = sin_cos_f64(angle);
                        p.x * cos + p.y * sin
                    }
                };
                farthest = (0..blades).map(edge).fold(farthest, f64::max);
                sum += p.length_squared();
                count += 1.0;
            }
            assert!((sum / count - expected).abs() < 1e-3, "{blades}: {}", sum / count);
            if blades > 0 {
                let apothem = sin_cos_f64(std::f64::consts::PI / f64::from(blades)).1;
                assert!((farthest / apothem - 1.0).abs() < 0.02, "{blades}: {farthest}");
            }
        }
    }

    #[test]
    fn what_is_in_the_tilted_plane_of_focus_is_sharp() {
        let spec = Spec::new("", "perspective").with("aperture", 0.5f32).with("focus", 4.0f32);
        let spec = spec.with("focus_tilt_x", 25.0f32).with("focus_tilt_y", -40.0f32);
        let camera = build(&CameraSpec::new(spec), 1.5).unwrap();
        let [right, up] = [25.0f32, -40.0].map(|degrees| tan(degrees.to_radians()));
        let lens = Vec2::new(0.3, -0.7);
        // The camera is at z = 5 and looks along -z.
        for (x, y) in [(0.0, 0.0), (1.0, 0.5), (-0.7, 0.9)] {
            let p = Vec3::new(x, y, 5.0 - (4.0 + right * x + up * y));
            let [sharp, through_lens] =
                [Vec2::ZERO, lens].map(|lens| camera.connect(p, lens, 0.0).unwrap().film);
            assert!(sharp.distance(through_lens) < 1e-5, "{p}: {sharp} and {through_lens}");
            let behind = p - Vec3::Z;
            let [a, b] = [Vec2::ZERO, lens].map(|lens| camera.connect(behind, lens, 0.0).unwrap().film);
            assert!(a.distance(b) > 1e-3);
        }
    }
}
