//! A cloud with a flat bottom. [pbrt 2023]

use super::density::{FROM, RESOLUTION, TO};
use super::gradient_noise::{noise, rise};
use super::{Density, DensityEntry};
use bilux_math::Vec3;
use bilux_math::registry::{Entry, Parameter, ParameterKind};

pub(super) const ENTRY: DensityEntry = DensityEntry {
    entry: Entry {
        name: "cloud",
        summary: "a cloud as pbrt has it: full at y = 0, and wisps up to y = 1",
        source: "pbrt 2023",
        parameters: &[
            Parameter {
                name: "density",
                summary: "factor on the noise before it is cut off at 1",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1e6 },
                default: "1",
            },
            Parameter {
                name: "wispiness",
                summary: "how far its edges are drawn out; 0 for smooth ones",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1e3 },
                default: "1",
            },
            Parameter {
                name: "frequency",
                summary: "billows for each metre of the object",
                unit: "1/m",
                kind: ParameterKind::Number { min: 0.0, max: 1e4 },
                default: "5",
            },
            FROM,
            TO,
            RESOLUTION,
        ],
    },
    build: |reader| {
        let [density, wispiness, frequency] =
            ["density", "wispiness", "frequency"].map(|key| reader.number(key));
        Ok(Box::new(Cloud { density, wispiness, frequency }))
    },
};

struct Cloud {
    density: f32,
    wispiness: f32,
    frequency: f32,
}

const OCTAVES: u32 = 5;
/// The frequency of an octave over that of the one before.
const LACUNARITY: f32 = 1.99;

impl Density for Cloud {
    fn at(&self, p: Vec3) -> f32 {
        if p.y <= 0.0 {
            return 1.0;
        }
        let mut place = p * self.frequency;
        if self.wispiness > 0.0 {
            let (mut far, mut cells) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                place += rise(place * cells) * far;
                (far, cells) = (far * 0.5, cells * LACUNARITY);
            }
        }
        let (mut sum, mut weight, mut cells) = (0.0, 0.5, 1.0);
        for _ in 0..OCTAVES {
            sum += weight * noise(place * cells);
            (weight, cells) = (weight * 0.5, cells * LACUNARITY);
        }
        let wisps = ((1.0 - p.y) * 4.5 * self.density * sum).clamp(0.0, 1.0);
        (wisps + 2.0 * (0.5 - p.y).max(0.0)).min(1.0)
    }

    fn detail(&self) -> Vec3 {
        // Four voxels for each cell of the finest noise, and enough for the fall of the density with height.
        Vec3::splat((4.0 * 15.7 * self.frequency).max(8.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{mix64, unit_f32};

    fn cloud(density: f32, wispiness: f32, frequency: f32) -> Cloud {
        Cloud { density, wispiness, frequency }
    }

    /// Computed by another program, in double precision.
    #[test]
    fn it_is_the_cloud_of_pbrt() {
        for (p, wanted) in [
            ([0.703, 0.452, 0.725], [0.0960, 1.0000, 0.2538]),
            ([0.726, 0.422, 0.088], [0.7466, 0.1560, 0.1560]),
            ([0.497, 0.921, 0.42], [0.0250, 0.0023, 0.0902]),
            ([0.398, 0.639, 0.093], [0.4227, 0.2444, 0.0000]),
            ([0.995, 0.998, 0.121], [0.0013, 0.0052, 0.0020]),
            ([0.705, 0.951, 0.237], [0.0000, 0.0482, 0.0111]),
        ] {
            let clouds = [cloud(1.0, 1.0, 5.0), cloud(2.0, 0.0, 3.0), cloud(1.5, 0.5, 1.25)];
            for (cloud, wanted) in clouds.iter().zip(wanted) {
                let found = cloud.at(Vec3::from(p));
                assert!((found - wanted).abs() < 4e-3, "{found} for {wanted} at {p:?}");
            }
        }
    }

    #[test]
    fn its_mean_is_that_of_another_program() {
        let unit = |i: u64| unit_f32(mix64(i) as u32);
        let at = |i: u64| {
            f64::from(cloud(1.0, 1.0, 5.0).at(Vec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2))))
        };
        const COUNT: u64 = 40_000;
        let mean = (0..COUNT).map(at).sum::<f64>() / COUNT as f64;
        // Both know it to .0015, and .0018.
        assert!((mean - 0.3574).abs() < 4.0 * 0.0024, "{mean}");
    }
}
