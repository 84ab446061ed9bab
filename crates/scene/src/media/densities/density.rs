//! A density that is a formula, one of [`DENSITIES`], and the grid of its values.

use crate::grid::{BLOCK, BLOCK_VOXELS, Grid, GridError, MAX_SIDE, Origin};
use crate::messages::error::SceneError;
use crate::parameters::{Reader, Spec};
use bilux_math::parallel::for_each;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Transform, Vec3};

/// A density as a function of position.
pub trait Density: Send + Sync {
    /// The density at a point of the object, not negative.
    fn at(&self, p: Vec3) -> f32;
    /// Voxels per metre along each axis that show all of its detail; 0 where it does not vary.
    fn detail(&self) -> Vec3;
}

/// A row of [`DENSITIES`].
#[derive(Clone, Copy, Debug)]
pub struct DensityEntry {
    /// Name, summary, source, parameters; those of the box and the resolution come last.
    pub entry: Entry,
    /// Makes one from its parameters.
    pub build: fn(&Reader) -> Result<Box<dyn Density>, SceneError>,
}

/// All densities that are formulas.
pub static DENSITIES: &[DensityEntry] = &[super::cloud::ENTRY, super::noise::ENTRY, super::height::ENTRY];

/// Voxels that a formula takes unless a resolution is asked for: 16 MB.
pub const USUAL_MAX_VOXELS: usize = 1 << 23;

/// Voxels that a formula takes at most, since each costs a microsecond.
const MAX_VOXELS: usize = 1 << 27;

/// The minimum of voxels along an axis where a formula varies.
const MIN_VARYING: usize = 8;

/// A density that is a formula, before the grid of its values is made.
pub struct ComputedDensity {
    spec: Spec,
    density: Box<dyn Density>,
    size: [usize; 3],
    to_object: Transform,
}

impl ComputedDensity {
    /// The formula that a spec describes.
    ///
    /// # Errors
    /// When no row has its kind, a parameter is wrong, or its box has no volume.
    pub fn new(spec: Spec) -> Result<ComputedDensity, SceneError> {
        let names = DENSITIES.iter().map(|row| row.entry.name);
        let row = DENSITIES.iter().find(|row| row.entry.name == spec.kind);
        let row = row.ok_or_else(|| SceneError::unknown("density", &spec.kind, names, &spec.span))?;
        let reader = Reader::new(&spec, &row.entry)?;
        let density = (row.build)(&reader)?;
        let bounds = Aabb::of_points([FROM, TO].map(|corner| reader.vector(corner.name)));
        let size = size_of(bounds.extent(), density.detail(), reader.integer(RESOLUTION.name) as usize);
        if size.iter().product::<usize>() > MAX_VOXELS {
            let [x, y, z] = size;
            let message =
                format!("{x} x {y} x {z} voxels are more than {MAX_VOXELS}: choose a lower 'resolution'");
            return Err(SceneError::invalid(message, reader.span(RESOLUTION.name)));
        }
        let voxel = bounds.extent() / Vec3::from(size.map(|n| n as f32));
        let place = Transform::scale(voxel).zip(Transform::translate(bounds.min));
        let Some(to_object) = place.map(|(scale, shift)| scale.then(&shift)) else {
            let message = format!("the box from {} to {} has no volume", bounds.min, bounds.max);
            return Err(SceneError::invalid(message, reader.span(TO.name)));
        };
        Ok(ComputedDensity { spec, density, size, to_object })
    }

    /// Voxels along x, y and z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// From voxel coordinates to the object.
    pub fn to_object(&self) -> &Transform {
        &self.to_object
    }

    /// Bytes that [`Self::grid`] takes at most while it works.
    pub fn bytes(&self) -> u64 {
        // Blocks as floats in a list that grows by doubling, and as halves; a layer of blocks, and the places and bounds of all.
        let blocks = self.size.map(|n| n.div_ceil(BLOCK) as u64);
        let all: u64 = blocks.iter().product();
        all * (BLOCK_VOXELS as u64 * (8 + 2) + 8) + blocks[0] * blocks[1] * BLOCK_VOXELS as u64 * 4
    }

    /// The grid of its values at the centres of voxels.
    ///
    /// # Errors
    /// When there are too many voxels.
    pub fn grid(self) -> Result<Grid, SceneError> {
        let ComputedDensity { spec, density, size, to_object } = self;
        let row = [0, 1].map(|axis| size[axis].next_multiple_of(BLOCK));
        let mut layer = Vec::new();
        let fill = |at: [usize; 3], block: &mut [f32; BLOCK_VOXELS]| {
            if at[0] == 0 && at[1] == 0 {
                layer = layer_of(&*density, row, at[2], &to_object);
            }
            for (run, line) in block.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
                let [y, z] = [at[1] * BLOCK + run % BLOCK, run / BLOCK];
                let begin = (z * row[1] + y) * row[0] + at[0] * BLOCK;
                line.copy_from_slice(&layer[begin..begin + BLOCK]);
            }
            block.iter().any(|value| *value != 0.0)
        };
        let grid = Grid::new(&spec.kind, size, &to_object, fill);
        let grid = grid.map_err(|error: GridError| SceneError::invalid(error.to_string(), &spec.span))?;
        Ok(grid.with_origin(Origin::new(spec)))
    }
}

/// The values of a layer of blocks, with what lies beyond the last voxels.
fn layer_of(density: &dyn Density, row: [usize; 2], block: usize, to_object: &Transform) -> Vec<f32> {
    let mut layer = vec![0.0; row[0] * row[1] * BLOCK];
    for_each(layer.chunks_mut(row[0]).enumerate(), |(run, line)| {
        let [y, z] = [run % row[1], block * BLOCK + run / row[1]];
        for (x, value) in line.iter_mut().enumerate() {
            *value = density.at(to_object.point(Vec3::new(x as f32, y as f32, z as f32) + 0.5));
        }
    });
    layer
}

/// Voxels along each axis of a box: of a resolution along its longest side, or as many as show all detail, but not too many.
fn size_of(extent: Vec3, detail: Vec3, resolution: usize) -> [usize; 3] {
    let wanted = match resolution {
        0 => extent * detail,
        side => {
            let varies = Vec3::from([0, 1, 2].map(|axis| if detail[axis] > 0.0 { 1.0 } else { 0.0 }));
            extent * (side as f32 / extent.max_element()) * varies
        }
    };
    // So that the sides of a box with any numbers become fewer.
    let wanted = wanted.min(Vec3::splat(MAX_SIDE as f32));
    let min = [0, 1, 2].map(|axis| if detail[axis] > 0.0 { MIN_VARYING } else { 1 });
    // A box that is not finite is refused later.
    let side =
        |axis: usize, factor: f32| ((wanted[axis] * factor).ceil() as usize).clamp(min[axis], MAX_SIDE);
    let sides = |factor: f32| [0, 1, 2].map(|axis| side(axis, factor));
    let mut factor = 1.0;
    let voxels = |size: [usize; 3]| size.iter().product::<usize>();
    while resolution == 0 && voxels(sides(factor)) > USUAL_MAX_VOXELS {
        factor *= 0.98;
    }
    sides(factor)
}

/// One corner of the box that the voxels fill.
pub(super) const FROM: Parameter = Parameter {
    name: "from",
    summary: "a corner of the box in the object, outside of which the density is 0",
    unit: "m",
    kind: ParameterKind::Vector,
    default: "0 0 0",
};

/// The opposite corner.
pub(super) const TO: Parameter = Parameter {
    name: "to",
    summary: "the opposite corner of that box",
    unit: "m",
    kind: ParameterKind::Vector,
    default: "1 1 1",
};

/// Resolution of the voxels.
pub(super) const RESOLUTION: Parameter = Parameter {
    name: "resolution",
    summary: "voxels along the longest side of the box; 0 for as many as its detail needs, but at most 2^23 in all",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: 2048 },
    default: "0",
};

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{mix64, unit_f32};
    use bilux_math::transcendental::exp_f64;

    fn computed(spec: Spec) -> ComputedDensity {
        ComputedDensity::new(spec).unwrap()
    }

    fn spec(kind: &str) -> Spec {
        Spec::new("", kind)
    }

    fn points(seed: u64) -> impl Iterator<Item = Vec3> {
        let unit = move |i: u64| unit_f32(mix64(seed << 32 | i) as u32);
        (0..2000).map(move |i| Vec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2)))
    }

    /// Between the centres of voxels a grid is what it is there, and no more than the bound of its block.
    #[test]
    fn grids_have_the_values_of_their_formulas_and_bounds_above_them() {
        let cases = [
            spec("cloud").with("frequency", 1.0).with("to", Vec3::new(1.0, 1.5, 1.0)),
            spec("noise").with("frequency", 3.0).with("octaves", 3),
            spec("height").with("falloff", 0.2).with("base", 0.1),
        ];
        for spec in cases {
            let formula = computed(spec.clone());
            let (size, bounds) = (formula.size(), formula.to_object);
            let row = DENSITIES.iter().find(|row| row.entry.name == spec.kind).unwrap();
            let density = (row.build)(&Reader::new(&spec, &row.entry).unwrap()).unwrap();
            let grid = formula.grid().unwrap();
            let (mut worst, mut sums) = (0.0f32, [0.0f64; 2]);
            for unit in points(1) {
                let p = bounds.point(unit * Vec3::from(size.map(|n| n as f32)));
                let [exact, found] = [density.at(p), grid.value(p)];
                worst = worst.max((exact - found).abs());
                sums = [sums[0] + f64::from(exact), sums[1] + f64::from(found)];
                let line = grid.line(p, Vec3::X);
                grid.for_each_block(&line, 1e-6, |_, _, majorant| {
                    assert!(found <= majorant, "{}: {found} above {majorant} at {p}", spec.kind);
                    false
                });
            }
            assert!((sums[0] / sums[1] - 1.0).abs() < 5e-3, "{}: {sums:?}", spec.kind);
            assert!(worst < 0.2, "{}: {worst}", spec.kind);
        }
    }

    /// The integral of exp(-h / H) along slanted lines.
    #[test]
    fn fog_that_thins_out_passes_what_the_closed_form_says() {
        use crate::media::{Draws, Medium};
        use bilux_math::Rgb;
        let fog =
            spec("height").with("falloff", 2.0).with("base", 1.0).with("from", Vec3::new(-50., 0., -50.));
        let grid = computed(fog.with("to", Vec3::new(50., 30., 50.))).grid().unwrap();
        assert_eq!([grid.size()[0], grid.size()[2]], [1, 1]);
        let medium = Medium { sigma_s: Rgb::grey(0.3), density: Some(&grid), ..Medium::VACUUM };
        for (low, direction, length) in [
            (1.0, Vec3::Y, 20.0),
            (3.0, Vec3::new(0.8, 0.6, 0.0), 9.0),
            (12.0, Vec3::new(0.6, -0.64, 0.48), 14.0),
            (5.0, Vec3::Z, 30.0),
        ] {
            let origin = Vec3::new(0.5, low, 0.25);
            let line = medium.line(|| Transform::IDENTITY, origin, direction);
            let [a, b] = [f64::from(low - 1.0) / 2.0, f64::from(low - 1.0 + direction.y * length) / 2.0];
            let integral = if direction.y == 0.0 {
                exp_f64(-a) * f64::from(length)
            } else {
                2.0 * (exp_f64(-a) - exp_f64(-b)) / f64::from(direction.y)
            };
            let wanted = exp_f64(-0.3 * integral);
            let seen = medium.seen(line.as_ref(), length, &mut Draws::new(3)).transmittance.g;
            assert!((f64::from(seen) - wanted).abs() < 1e-3 * wanted, "{seen} for {wanted}");
            let mut draws = Draws::new(7);
            let count = 20_000;
            let sum: f64 = (0..count)
                .map(|_| {
                    f64::from(medium.passed(line.as_ref(), length, 1, || draws.next_1d()).transmittance.g)
                })
                .sum();
            assert!(
                (sum / f64::from(count) - wanted).abs() < 0.01,
                "{} for {wanted}",
                sum / f64::from(count)
            );
        }
    }

    #[test]
    fn voxels_are_as_many_as_detail_needs_but_not_too_many() {
        let size = |spec: Spec| computed(spec).size();
        // Four voxels for each of the 15.7 / 2 cells of the finest noise.
        assert_eq!(size(spec("cloud").with("frequency", 0.5)), [32; 3]);
        let many = size(spec("cloud").with("frequency", 100.0).with("to", Vec3::new(4.0, 1.0, 2.0)));
        let voxels = many.iter().product::<usize>();
        assert!(voxels <= USUAL_MAX_VOXELS && voxels > USUAL_MAX_VOXELS / 10 * 9, "{many:?}");
        assert!(many[0].abs_diff(4 * many[1]) <= 4 && many[2].abs_diff(2 * many[1]) <= 2, "{many:?}");
        assert_eq!(
            size(spec("cloud").with("resolution", 30).with("to", Vec3::new(3., 1., 2.))),
            [30, 10, 20]
        );
        assert_eq!(size(spec("height").with("resolution", 30)), [1, 30, 1]);
        assert!(size(spec("height").with("falloff", 1e-8))[1] <= MAX_SIDE);
        assert_eq!(size(spec("height").with("falloff", 1e8)), [1, 8, 1]);
        assert!(
            size(spec("cloud").with("to", Vec3::splat(1e38))).iter().product::<usize>() <= USUAL_MAX_VOXELS
        );
    }

    #[test]
    fn what_is_wrong_is_refused() {
        for (spec, wanted) in [
            (spec("cluod"), "did you mean 'cloud'"),
            (spec("cloud").with("frequency", -1.0), "cloud.frequency"),
            (spec("cloud").with("frequency", f32::NAN), "cloud.frequency"),
            (spec("cloud").with("density", f32::INFINITY), "cloud.density"),
            (spec("noise").with("resolution", 1_000_000), "0 to 2048"),
            (spec("noise").with("resolution", 1024), "1024 x 1024 x 1024 voxels are more"),
            (spec("noise").with("low", 0.6).with("high", 0.5), "'low'"),
            (spec("height").with("falloff", 0.0), "height.falloff"),
            (spec("height").with("up", "w"), "one of"),
            (spec("height").with("to", Vec3::new(1.0, 0.0, 1.0)), "no volume"),
        ] {
            let message = ComputedDensity::new(spec).map(|_| ()).unwrap_err().to_string();
            assert!(message.contains(wanted), "{message}");
        }
    }
}
