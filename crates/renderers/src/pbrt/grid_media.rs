//! Media whose density a grid gives: in the file itself, or in a file of NanoVDB.

use super::loader::Loader;
use super::parameters::ParameterList;
use bilux_import::FormatError;
use bilux_import::appearance::filling::{Density, Temperature};
use bilux_math::{DMat4, DVec3, Rgb, Transform, Vec3};
use bilux_scene::media::{BLOCK_VOXELS, Faults, Grid};
use bilux_scene::{Spec, Value};
use std::sync::Arc;

/// Makes the grids that the parameters of a medium describe.
pub(super) struct GridMaker<'m, 'o, 'r> {
    /// The name of the medium.
    pub(super) name: &'m str,
    pub(super) list: &'m ParameterList,
    /// The place of the medium.
    pub(super) to_world: DMat4,
    pub(super) loader: &'m mut Loader<'o, 'r>,
}

impl GridMaker<'_, '_, '_> {
    /// A grid of numbers in the list.
    pub(super) fn uniform(&mut self, key: &'static str) -> Result<Density, FormatError> {
        let numbers = self.list.numbers(key)?;
        self.in_box(key, numbers.len(), |i| numbers[i])
    }

    /// A grid of the colours of absorption and scattering: the luminance of both is the density, and their means are its colours.
    pub(super) fn coloured(&mut self) -> Result<([Rgb; 2], Density), FormatError> {
        let list = self.list;
        let [absorption, scattering] = [list.triples("sigma_a")?, list.triples("sigma_s")?];
        let count = absorption.len().max(scattering.len());
        let of = |all: &[Vec3], i: usize| {
            if all.is_empty() { Vec3::ONE } else { all.get(i).copied().unwrap_or(Vec3::ZERO) }
        };
        let luminance =
            |i: usize| Rgb::from_array((of(&absorption, i) + of(&scattering, i)).to_array()).luminance();
        if [&absorption, &scattering].iter().any(|all| !all.is_empty() && all.len() != count) {
            let message = "'sigma_a' and 'sigma_s' have different numbers of colours";
            return Err(FormatError::malformed(message, list.place("sigma_s")));
        }
        let sum = |all: &[Vec3]| (0..count).map(|i| of(all, i).as_dvec3()).sum::<DVec3>();
        let total: f64 = (0..count).map(|i| f64::from(luminance(i))).sum();
        let mean = |all: &[Vec3]| {
            let mean = if total > 0.0 { sum(all) / total } else { DVec3::ZERO };
            Rgb::from_array(mean.as_vec3().to_array())
        };
        let what = "the colours of a medium of type 'rgbgrid' are the same everywhere here, and only its density varies";
        self.loader.note(what, || list.at.clone());
        let density = self.in_box("sigma_s", count, luminance)?;
        Ok(([mean(&absorption), mean(&scattering)], density))
    }

    /// A grid of numbers that fills the box of a medium. Towards the border they fade to 0 within a voxel, as in pbrt.
    fn in_box(
        &mut self,
        key: &str,
        count: usize,
        value: impl Fn(usize) -> f32 + Sync,
    ) -> Result<Density, FormatError> {
        let list = self.list;
        let mut size = [0usize; 3];
        for (side, key) in size.iter_mut().zip(["nx", "ny", "nz"]) {
            *side = usize::try_from(list.integer(key)?.unwrap_or(1)).unwrap_or(0);
        }
        let [nx, ny, nz] = size;
        let fail = |message: String| FormatError::malformed(message, list.place(key));
        if nx.checked_mul(ny).and_then(|n| n.checked_mul(nz)) != Some(count) || count == 0 {
            return Err(fail(format!(
                "'{key}' has {count} values, but 'nx', 'ny' and 'nz' are {nx}, {ny} and {nz}"
            )));
        }
        let (from, to) = (list.triple("p0", Vec3::ZERO)?, list.triple("p1", Vec3::ONE)?);
        let voxel = (to - from) / Vec3::from(size.map(|side| side as f32));
        let place = Transform::scale(voxel).zip(Transform::translate(from - voxel));
        let Some(to_medium) = place.map(|(scale, shift)| scale.then(&shift)) else {
            return Err(fail(format!("the box of a medium from {from} to {to} has no volume")));
        };
        let padded = size.map(|side| side + 2);
        let file = &*list.at.file;
        let bytes = Grid::bytes_to_make(padded);
        self.loader.reading.budget.take_bytes(bytes, file)?;
        let row = |y: usize, z: usize, row: &mut [f32]| {
            row.fill(0.0);
            if (1..=ny).contains(&y) && (1..=nz).contains(&z) {
                let first = ((z - 1) * ny + y - 1) * nx;
                row[1..=nx].iter_mut().enumerate().for_each(|(x, density)| *density = value(first + x));
            }
        };
        let made = Grid::of_rows(self.name, padded, &to_medium, row);
        let (grid, faults) = made.map_err(|error| fail(error.to_string()))?;
        if faults != Faults::default() {
            let what = "numbers of a grid that are negative or not finite are taken as 0";
            self.loader.note(what, || list.place(key));
        }
        self.loader.reading.budget.release(bytes);
        self.loader.reading.charge_grid(&grid, file)?;
        Ok(Density { grid: Arc::new(grid), to_world: self.to_world })
    }

    /// A cloud that is a formula, in the box of its medium.
    pub(super) fn cloud(&mut self) -> Result<Density, FormatError> {
        let list = self.list;
        let mut spec = Spec { span: list.at.clone(), ..Spec::new("", "cloud") };
        for (key, default) in [("density", 1.0), ("wispiness", 1.0), ("frequency", 5.0)] {
            let number = list.number(key)?.unwrap_or(default);
            spec.parameters.set_at(key, Value::from(number), list.place(key));
        }
        for (key, corner, default) in [("from", "p0", Vec3::ZERO), ("to", "p1", Vec3::ONE)] {
            spec.parameters.set_at(key, Value::from(list.triple(corner, default)?), list.place(corner));
        }
        let grid = self.loader.reading.computed_grid(spec, &list.at.file)?;
        Ok(Density { grid, to_world: self.to_world })
    }

    /// The temperatures of a medium, if it has any: in the list, or beside the density in its file.
    pub(super) fn temperature(&mut self, kind: &str) -> Result<Option<Temperature>, FormatError> {
        let list = self.list;
        let cutoff = list.finite("temperaturecutoff", 0.0)?;
        let offset = list.finite("temperatureoffset", cutoff)?;
        let scale = list.finite("temperaturescale", 1.0)?;
        let found = match kind {
            "uniformgrid" if list.has("temperature") => Some(self.uniform("temperature")?),
            "nanovdb" => {
                let key = list.text("temperaturename")?.unwrap_or("temperature");
                let file = list.text("filename")?.unwrap_or_default();
                let at = list.place("filename");
                let folder = self.loader.folder.as_deref();
                let grid = self.loader.reading.grid_if_there(folder, (file, key), &at)?;
                grid.ok().map(|grid| Density { grid, to_world: self.to_world })
            }
            _ => None,
        };
        let Some(mut grid) = found.filter(|_| scale > 0.0) else { return Ok(None) };
        if offset != 0.0 {
            grid.grid = self.lowered(&grid.grid, offset)?;
        }
        Ok((grid.grid.maximum() > 0.0).then_some(Temperature { grid, scale }))
    }

    /// A grid of numbers that are less by this much, and 0 where they would be negative.
    fn lowered(&mut self, grid: &Grid, by: f32) -> Result<Arc<Grid>, FormatError> {
        let (size, at) = (grid.size(), &self.list.at);
        // A warm background makes all blocks count, as floats in a list that grows by doubling.
        let bytes =
            size.iter().fold(8, |bytes: u64, side| bytes.saturating_mul(side.next_multiple_of(8) as u64));
        self.loader.reading.budget.take_bytes(bytes, &at.file)?;
        let lowered = Grid::new(grid.name(), size, &grid.to_object(), |at, block| {
            let values = grid.block(at).unwrap_or([0.0; BLOCK_VOXELS]);
            *block = values.map(|value| (value - by).max(0.0));
            block.iter().any(|value| *value > 0.0)
        });
        let lowered = lowered.map_err(|error| FormatError::malformed(error.to_string(), at.clone()))?;
        self.loader.reading.budget.release(bytes);
        self.loader.reading.charge_grid(&lowered, &at.file)?;
        Ok(Arc::new(lowered))
    }

    /// A grid of a file.
    pub(super) fn nanovdb(&mut self) -> Result<Density, FormatError> {
        let list = self.list;
        let Some(file) = list.text("filename")? else {
            return Err(FormatError::malformed(
                "a medium of type 'nanovdb' needs a 'filename'",
                list.at.clone(),
            ));
        };
        let (name, at) = (list.text("gridname")?.unwrap_or("density"), list.place("filename"));
        let grid = self.loader.reading.grid(self.loader.folder.as_deref(), (file, name), &at)?;
        Ok(Density { grid, to_world: self.to_world })
    }
}
