//! Files of numbers in space: the density of smoke and the like. The table is [`GRID_FORMATS`].

mod bytes;
mod file;
mod model;
mod npy;
mod numbers;
mod sparse;
mod surface;
mod vol;

pub use bytes::Bytes;
pub use file::file_of;
pub use model::{ENTRY, box_of};
pub use sparse::{LeafMask, Placed, ReadLeaf, Sparse};
pub use surface::LeafValues;

use crate::bytes::budget::Budget;
use crate::bytes::text::whole_file;
use crate::input::reading::{Reading, Source};
use crate::tables::vdb;
use crate::{FormatError, ReadOptions};
use bilux_math::{Aabb, Transform, Vec3};
use bilux_scene::media::{Faults, Grid, MAX_SIDE};
use bilux_scene::{Mesh, Span, UpHint};
use std::path::Path;
use std::sync::Arc;

/// All formats of grids.
pub static GRID_FORMATS: &[GridFormatEntry] = &[vdb::OPEN, vdb::NANO, npy::FORMAT, vol::FORMAT];

/// A row of [`GRID_FORMATS`].
#[derive(Clone, Copy, Debug)]
pub struct GridFormatEntry {
    /// True if the bytes look like this format.
    pub sniff: fn(&[u8]) -> bool,
    /// Lists the grids of a file.
    pub list: fn(&Source) -> Result<Catalogue, FormatError>,
    /// Reads a grid of the catalogue.
    pub read: fn(&Source, &Listed, &mut Budget) -> Result<Volume, FormatError>,
    /// Reads the surface of a level set; `None` for formats without them.
    pub surface: Option<ReadSurface>,
}

/// Reads the surface of a level set of the catalogue; `None` if it has none.
pub type ReadSurface = fn(&Source, &Listed, &mut Budget) -> Result<Option<Mesh>, FormatError>;

/// The grids of a file.
#[derive(Debug)]
pub struct Catalogue {
    pub grids: Vec<Listed>,
    /// The up axis, if the file tells what wrote it.
    pub up: Option<UpHint>,
}

/// A grid of a file that is not read yet.
#[derive(Clone, Debug)]
pub struct Listed {
    /// Name of the grid in the file; empty in formats without names.
    pub name: String,
    /// Which of the file's grids it is.
    pub index: usize,
    /// Why it cannot be a density, as the rest of a sentence about it.
    pub refused: Option<String>,
    /// True for distances from a surface.
    pub is_level_set: bool,
}

/// A grid that has been read.
#[derive(Debug)]
pub struct Volume {
    pub grid: Grid,
    /// Box of the values that may differ from 0, in voxels.
    pub bounds: Aabb,
    pub faults: Faults,
    /// The value of all that the file does not list.
    pub background: f32,
    /// True for the mean of the channels of a file of colours.
    pub is_mean: bool,
}

/// The names of the channels in files of colours.
pub const COLOURS: [&str; 3] = ["red", "green", "blue"];

impl Volume {
    /// Faults of the numbers, a sentence for each kind.
    pub fn complaints(&self) -> Vec<String> {
        let Faults { negative, not_finite } = self.faults;
        let mut all = Vec::new();
        if self.is_mean {
            all.push("it has a colour for each voxel, whose mean is taken".to_owned());
        }
        if negative > 0 {
            all.push(format!(
                "{negative} voxels are negative, which a density cannot be, and are taken as 0"
            ));
        }
        if not_finite > 0 {
            all.push(format!("{not_finite} voxels are not finite numbers, and are taken as 0"));
        }
        if self.background != 0.0 {
            all.push(format!("everything outside its voxels is {}, and is taken as 0", self.background));
        }
        all
    }
}

/// A grid of a file, as [`read_grids`] gives it.
#[derive(Debug)]
pub struct GridOfFile {
    /// Name of the grid in the file; that of the file in formats without names.
    pub name: String,
    /// The grid, or why it cannot be a density.
    pub grid: Result<Grid, String>,
    /// Box of the values that may differ from 0, in voxels of the grid.
    pub bounds: Aabb,
    /// Faults of the numbers, in sentences.
    pub warnings: Vec<String>,
}

/// Reads all grids of a file in memory: OpenVDB, NanoVDB, `.npy` or Mitsuba's `.vol`; `file` is what messages call it.
///
/// # Errors
/// When the file is in no such format or broken, or takes more memory than allowed.
pub fn read_grids(bytes: &[u8], file: &str, options: &ReadOptions) -> Result<Vec<GridOfFile>, FormatError> {
    let mut reading = Reading::new(options, None);
    let source = Source { bytes, name: &Arc::from(file), folder: None };
    let format = format_of(&source)?;
    let grids = (format.list)(&source)?.grids.into_iter();
    grids.map(|listed| reading.grid_of_file(format, &source, listed)).collect()
}

/// Reads the grid with a name from a file in memory; if the name is empty, `density` or else the first that can be one.
///
/// # Errors
/// As [`read_grids`], and when there is no such grid.
pub fn read_grid(
    bytes: &[u8],
    file: &str,
    name: &str,
    options: &ReadOptions,
) -> Result<GridOfFile, FormatError> {
    let source = Source { bytes, name: &Arc::from(file), folder: None };
    let format = format_of(&source)?;
    let catalogue = (format.list)(&source)?;
    let listed = catalogue.named(name, file);
    let listed = listed.map_err(|message| FormatError::malformed(message, whole_file(source.name)))?;
    Reading::new(options, None).grid_of_file(format, &source, listed.clone())
}

impl Catalogue {
    /// The grid with this name, or if that is empty `density`, or else the only or first one that can be a density.
    pub fn named(&self, name: &str, file: &str) -> Result<&Listed, String> {
        let usable = || self.grids.iter().filter(|grid| grid.refused.is_none());
        let found = if name.is_empty() {
            usable().find(|grid| grid.name == "density").or_else(|| usable().next()).or(self.grids.first())
        } else {
            self.grids.iter().find(|grid| grid.name == name || grid.name.is_empty())
        };
        match found {
            Some(Listed { name, refused: Some(why), .. }) => {
                Err(format!("the grid '{name}' of '{file}' {why}"))
            }
            Some(grid) => Ok(grid),
            None if self.grids.is_empty() => Err(format!("the file '{file}' has no grids")),
            None => {
                let names: Vec<&str> = usable().map(|grid| &*grid.name).collect();
                Err(format!("the file '{file}' has no grid '{name}', but {}", names.join(", ")))
            }
        }
    }
}

/// The format of a file of grids.
pub fn format_of(source: &Source) -> Result<&'static GridFormatEntry, FormatError> {
    GRID_FORMATS.iter().find(|row| (row.sniff)(source.bytes)).ok_or_else(|| {
        let message = "this is no file of grids: known are OpenVDB (.vdb), NanoVDB (.nvdb), numpy's .npy and Mitsuba's .vol";
        FormatError::malformed(message, whole_file(source.name))
    })
}

/// Makes a grid that fills a box and has a number for each voxel; `fill` writes the row along x at y and z.
pub fn dense(
    source: &Source,
    size: [usize; 3],
    bounds: &Aabb,
    budget: &mut Budget,
    fill: impl Fn(usize, usize, &mut [f32]) + Sync,
) -> Result<Volume, FormatError> {
    let fail = |message: String| FormatError::malformed(message, whole_file(source.name));
    let [x, y, z] = size;
    if size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
        return Err(fail(format!("{x} x {y} x {z} voxels: each side has 1 to {MAX_SIDE}")));
    }
    budget.take_bytes(Grid::bytes_to_make(size), source.name)?;
    let extent = bounds.extent() / Vec3::from(size.map(|side| side as f32));
    let to_file = Transform::scale(extent).zip(Transform::translate(bounds.min));
    let to_file = to_file.map(|(scale, shift)| scale.then(&shift));
    let to_file =
        to_file.ok_or_else(|| fail("the box of its voxels has no volume, or is not finite".to_owned()))?;
    let grid = Grid::of_rows(&source.stem(), size, &to_file, fill);
    let (grid, faults) = grid.map_err(|error| fail(error.to_string()))?;
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::from(size.map(|side| side as f32)) };
    Ok(Volume { grid, bounds, faults, background: 0.0, is_mean: false })
}

impl Reading<'_> {
    /// A grid of a file that a scene refers to, read only once; an empty name asks for the density.
    pub fn grid(
        &mut self,
        folder: Option<&Path>,
        (file, name): (&str, &str),
        at: &Span,
    ) -> Result<Arc<Grid>, FormatError> {
        let found = self.grid_if_there(folder, (file, name), at)?;
        found.map_err(|message| FormatError::malformed(message, at.clone()))
    }

    /// True if a file has a colour for each voxel: then it has the grids [`COLOURS`].
    pub fn has_colours(&mut self, folder: Option<&Path>, file: &str, at: &Span) -> Result<bool, FormatError> {
        let path = self.locator.locate(folder, file, at)?;
        let bytes = self.load(&path)?;
        let shown: Arc<str> = path.display().to_string().into();
        let source = Source { bytes: &bytes, name: &shown, folder: None };
        let catalogue = (format_of(&source)?.list)(&source)?;
        let has = COLOURS.iter().all(|colour| catalogue.grids.iter().any(|grid| grid.name == *colour));
        self.release(bytes);
        Ok(has)
    }

    /// Grid of a file as in [`Reading::grid`], or why there is no such grid in the file.
    pub fn grid_if_there(
        &mut self,
        folder: Option<&Path>,
        (file, name): (&str, &str),
        at: &Span,
    ) -> Result<Result<Arc<Grid>, String>, FormatError> {
        let path = self.locator.locate(folder, file, at)?;
        let key = (path.clone(), name.to_owned());
        if let Some(grid) = self.grids.get(&key) {
            return Ok(Ok(grid.clone()));
        }
        let bytes = self.load(&path)?;
        let shown: Arc<str> = path.display().to_string().into();
        let source = Source { bytes: &bytes, name: &shown, folder: None };
        let format = format_of(&source)?;
        let catalogue = (format.list)(&source)?;
        let listed = match catalogue.named(name, file) {
            Ok(listed) => listed,
            Err(message) => {
                self.release(bytes);
                return Ok(Err(message));
            }
        };
        let volume = self.volume(format, &source, listed)?;
        self.note_faults(&format!("the grid '{}' of '{file}'", listed.name), &volume.complaints(), at);
        self.release(bytes);
        let grid = Arc::new(volume.grid);
        self.keep(&grid);
        self.grids.insert(key, grid.clone());
        Ok(Ok(grid))
    }

    /// Reads one of the grids of a file, unless it cannot be a density.
    fn grid_of_file(
        &mut self,
        format: &GridFormatEntry,
        source: &Source,
        listed: Listed,
    ) -> Result<GridOfFile, FormatError> {
        let name = if listed.name.is_empty() { source.stem() } else { listed.name.clone() };
        if let Some(why) = listed.refused {
            return Ok(GridOfFile { name, grid: Err(why), bounds: Aabb::EMPTY, warnings: Vec::new() });
        }
        let volume = self.volume(format, source, &listed)?;
        let warnings = volume.complaints();
        Ok(GridOfFile { name, grid: Ok(volume.grid), bounds: volume.bounds, warnings })
    }

    /// Reads one of the grids of a file, and charges it for good.
    pub fn volume(
        &mut self,
        format: &GridFormatEntry,
        source: &Source,
        listed: &Listed,
    ) -> Result<Volume, FormatError> {
        let before = self.budget.spent();
        let volume = (format.read)(source, listed, &mut self.budget)?;
        self.budget.release(self.budget.spent() - before);
        self.charge_grid(&volume.grid, source.name)?;
        Ok(volume)
    }
}
