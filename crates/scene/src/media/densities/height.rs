//! Fog and haze that thin out with height, as air does.

use super::density::{FROM, RESOLUTION, TO};
use super::{Density, DensityEntry};
use crate::geometry::axis::Axis;
use bilux_math::Vec3;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::exp;

pub(super) const ENTRY: DensityEntry = DensityEntry {
    entry: Entry {
        name: "height",
        summary: "fog that thins out exponentially with height: 1 at its base and below",
        source: "",
        parameters: &[
            Parameter {
                name: "falloff",
                summary: "height over which the density falls to 1/e",
                unit: "m",
                kind: ParameterKind::Number { min: 1e-9, max: 1e9 },
                default: "1",
            },
            Parameter {
                name: "base",
                summary: "height up to which the density is 1",
                unit: "m",
                kind: ParameterKind::Number { min: -1e9, max: 1e9 },
                default: "0",
            },
            Parameter {
                name: "up",
                summary: "the axis of the object that points up",
                unit: "",
                kind: ParameterKind::Choice(&["x", "y", "z", "-x", "-y", "-z"]),
                default: "y",
            },
            FROM,
            TO,
            RESOLUTION,
        ],
    },
    build: |reader| {
        let up = Axis::from_name(&reader.text("up")).unwrap_or(Axis::Y);
        Ok(Box::new(Height { falloff: reader.number("falloff"), base: reader.number("base"), up }))
    },
};

/// Voxels for each [`Height::falloff`]: between them, values are linear, which adds a twelve-thousandth.
const FINENESS: f32 = 32.0;

struct Height {
    falloff: f32,
    base: f32,
    up: Axis,
}

impl Density for Height {
    fn at(&self, p: Vec3) -> f32 {
        let height = p[self.up.index()] * self.up.sign() as f32;
        exp(-((height - self.base) / self.falloff).max(0.0))
    }

    fn detail(&self) -> Vec3 {
        Vec3::AXES[self.up.index()] * (FINENESS / self.falloff)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fog_thins_out_upwards_wherever_up_is() {
        let p = Vec3::new(3.0, 5.0, -7.0);
        for (up, height) in [("x", 3.0), ("y", 5.0), ("z", -7.0), ("-x", -3.0), ("-y", -5.0), ("-z", 7.0)] {
            let fog = Height { falloff: 4.0, base: 1.0, up: Axis::from_name(up).unwrap() };
            let wanted = if height > 1.0 { exp(-(height - 1.0) / 4.0) } else { 1.0 };
            assert_eq!(fog.at(p), wanted, "{up}");
        }
    }
}
