//! The shared state of one read: the options, the memory used, and the files involved.

use crate::bytes::archive::OpenMember;
use crate::bytes::budget::Budget;
use crate::bytes::gzip;
use crate::bytes::opening::open;
use crate::bytes::text::{is_marked, plain, plain_size, whole_file};
use crate::geometry::displacement::{Displacement, Moved};
use crate::geometry::subdivision::PendingCage;
use crate::input::images::{Decoded, SampleMeaning, decoded, is_raw_unless_said, mend};
use crate::input::locating::Locator;
pub use crate::input::plain::{default_material, plain_material};
use crate::{FormatError, ReadOptions};
use bilux_math::DVec3;
use bilux_pictures::Limits;
use bilux_scene::media::{ComputedDensity, Grid};
use bilux_scene::texture::{Channel, Image};
use bilux_scene::{IntensityDistribution, Mesh, Object, SceneBuilder, Span, Spec, Texture, Warning};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The input of a reader.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The whole file, or only its beginning if the file is read in blocks.
    pub bytes: &'a [u8],
    /// Name of the file, for messages.
    pub name: &'a Arc<str>,
    /// The folder of the file, which relative names refer to; `None` if the bytes came from no file.
    pub folder: Option<&'a Path>,
}

impl Source<'_> {
    /// Name of the file without folder and extension.
    pub fn stem(&self) -> String {
        Path::new(&**self.name).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
    }
}

/// Interpretation of the texels of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Texels {
    /// Colours, converted to linear light.
    Colours,
    /// Colours, unless the picture is one that programs take as numbers if nobody says what it is.
    Unsaid,
    /// Raw numbers, of all channels or of one.
    Numbers(Option<Channel>),
}

/// The readers of other formats, for scenes that name files of them.
pub trait OtherFormats {
    /// Reads a source in the format of this name.
    fn read_named(
        &self,
        format: &str,
        reading: &mut Reading,
        source: &Source,
    ) -> Result<SceneBuilder, FormatError>;
}

/// The state that all readers of one read share.
pub struct Reading<'o> {
    pub options: &'o ReadOptions,
    /// Reads the files of other formats that a scene names, if it may name any.
    pub others: Option<&'o dyn OtherFormats>,
    pub budget: Budget,
    /// [`ReadOptions::crease_angle`], unless a scene has its own.
    pub crease_angle: f32,
    /// The origin of positions, if the file's coordinates are large compared with their differences.
    pub origin: DVec3,
    /// Finds what files refer to.
    pub locator: Locator,
    /// By file, layer and meaning.
    textures: HashMap<(PathBuf, Option<String>, Texels), Arc<Texture>>,
    /// By file and name.
    pub grids: HashMap<(PathBuf, String), Arc<Grid>>,
    /// By file.
    pub distributions: HashMap<PathBuf, Arc<IntensityDistribution>>,
    /// The bytes of textures and grids.
    texture_bytes: u64,
    /// The part of these bytes that is in [`Reading::textures`] or [`Reading::grids`].
    kept_bytes: u64,
    /// Faults in the texels of pictures and the voxels of grids.
    picture_faults: Vec<Warning>,
    /// Scenes inserted into other scenes, each read once.
    pub models: HashMap<PathBuf, Arc<SceneBuilder>>,
    /// Meshes that already count against the budget for good.
    counted: HashSet<*const Mesh>,
    /// The chain of nested scenes, from the first one to the current one.
    pub open: Vec<PathBuf>,
    /// Subdivision surfaces of the scene that is read now.
    pub cages: Vec<PendingCage>,
    /// Maps that move surfaces of the scene that is read now.
    pub displacements: Vec<(Moved, Displacement)>,
    /// Every file that was opened, by its full name.
    pub files: BTreeSet<PathBuf>,
    /// True once something has looked at [`ReadOptions::definitions`].
    pub has_variables: bool,
}

/// The memory that counts as held at some moment.
pub struct MemoryHeld {
    budget: Budget,
    /// The size of all textures read.
    textures: u64,
    /// Size of the textures that are found again by their names.
    kept: u64,
}

/// Longer chains of nested scenes are refused, since each level uses some of the stack.
const MAX_CHAIN: usize = 16;

impl<'o> Reading<'o> {
    pub fn new(options: &'o ReadOptions, folder: Option<&Path>) -> Reading<'o> {
        Reading {
            options,
            others: None,
            budget: Budget::new(options.max_memory),
            crease_angle: options.crease_angle,
            origin: DVec3::ZERO,
            locator: Locator::new(folder, options),
            textures: HashMap::new(),
            grids: HashMap::new(),
            distributions: HashMap::new(),
            texture_bytes: 0,
            kept_bytes: 0,
            picture_faults: Vec::new(),
            models: HashMap::new(),
            counted: HashSet::new(),
            open: Vec::new(),
            cages: Vec::new(),
            displacements: Vec::new(),
            files: BTreeSet::new(),
            has_variables: false,
        }
    }

    /// Reads a file that the scene names, in the format of this name.
    pub fn read_named(&mut self, format: &str, source: &Source) -> Result<SceneBuilder, FormatError> {
        match self.others {
            Some(others) => others.read_named(format, self, source),
            None => Err(FormatError::malformed("no other format is read here", whole_file(source.name))),
        }
    }

    /// Replaces the memory charged for reading a file by that of its result; textures are charged separately.
    pub fn settle(&mut self, spent_before: u64, textures_before: u64, scene: &SceneBuilder) {
        let mut held = self.texture_bytes - textures_before;
        for object in &scene.objects {
            held += (size_of::<Object>() + object.name.len() + object.motion.heap_bytes()) as u64;
            if self.counted.insert(Arc::as_ptr(&object.mesh)) {
                held += object.mesh.size();
            }
        }
        held += (scene.materials.len() * size_of::<[Spec; 4]>()) as u64;
        let now = spent_before.saturating_add(held);
        self.budget.release(self.budget.spent().saturating_sub(now));
    }

    /// Memory that counts as held.
    pub fn memory_held(&self) -> MemoryHeld {
        MemoryHeld { budget: self.budget.clone(), textures: self.texture_bytes, kept: self.kept_bytes }
    }

    /// Releases a scene that has been read since then, except for textures that the next read finds again.
    pub fn go_back_to(&mut self, before: MemoryHeld, scene: SceneBuilder) {
        for object in scene.objects {
            self.counted.remove(&Arc::as_ptr(&object.mesh));
        }
        let kept = self.kept_bytes - before.kept;
        self.budget = before.budget;
        self.budget.take_again(kept);
        self.texture_bytes = before.textures + kept;
    }

    /// Adds to the scene what is known of all files that it refers to.
    pub fn complete(self, mut scene: SceneBuilder) -> Result<SceneBuilder, FormatError> {
        if let (false, Some((name, _))) = (self.has_variables, self.options.definitions.first()) {
            let message = format!("the scene has no variable '{name}', nor any other: leave it out");
            return Err(FormatError::malformed(message, Span::default()));
        }
        scene.files = self.files;
        scene.warnings.extend(self.picture_faults);
        self.locator.into_notes(&mut scene);
        match scene.warnings.first() {
            Some(first) if self.options.strict => Err(FormatError::Strict(first.clone())),
            _ => Ok(scene),
        }
    }

    /// Charges memory for texels, for good.
    pub fn charge_image(&mut self, image: &Image, file: &str) -> Result<(), FormatError> {
        self.budget.take_bytes(image.size(), file)?;
        self.texture_bytes += image.size();
        Ok(())
    }

    /// Decodes a picture within the remaining memory, and charges it for good.
    pub fn decode(
        &mut self,
        bytes: &[u8],
        hint: Option<&str>,
        layer: Option<&str>,
        means: SampleMeaning,
        name: &str,
        at: &Span,
    ) -> Result<Image, FormatError> {
        // The decoder's planes and the texels exist at the same time for a moment.
        let limits = Limits::new(self.budget.left() / 2);
        let decoded = decoded(bytes, hint, layer, means, &limits).map_err(|e| {
            FormatError::malformed(format!("the texture '{name}' cannot be read: {e}"), at.clone())
        })?;
        let Decoded { mut image, mut warnings } = decoded.ok_or_else(|| {
            FormatError::malformed(
                format!("the texture '{name}' has no colour channels: use another picture"),
                at.clone(),
            )
        })?;
        warnings.extend(mend(&mut image, means == SampleMeaning::Numbers));
        self.note_picture_faults(name, &warnings, at);
        self.charge_image(&image, name)?;
        Ok(image)
    }

    /// Charges memory for a grid, for good.
    pub fn charge_grid(&mut self, grid: &Grid, file: &str) -> Result<(), FormatError> {
        self.budget.take_bytes(grid.bytes(), file)?;
        self.texture_bytes += grid.bytes();
        Ok(())
    }

    /// The grid of a density that is a formula, charged for good.
    pub fn computed_grid(&mut self, spec: Spec, file: &str) -> Result<Arc<Grid>, FormatError> {
        let density = ComputedDensity::new(spec)?;
        let bytes = density.bytes();
        self.budget.take_bytes(bytes, file)?;
        let grid = density.grid()?;
        self.budget.release(bytes);
        self.charge_grid(&grid, file)?;
        Ok(Arc::new(grid))
    }

    /// Counts a grid as one that the next read finds again.
    pub fn keep(&mut self, grid: &Grid) {
        self.kept_bytes += grid.bytes();
    }

    /// Charges memory for an intensity distribution that the next read finds again, for good.
    pub fn keep_distribution(&mut self, bytes: u64, file: &str) -> Result<(), FormatError> {
        self.budget.take_bytes(bytes, file)?;
        self.texture_bytes += bytes;
        self.kept_bytes += bytes;
        Ok(())
    }

    /// Notes what is wrong with a picture that could be read.
    pub fn note_picture_faults(&mut self, name: &str, warnings: &[String], at: &Span) {
        self.note_faults(&format!("the texture '{name}'"), warnings, at);
    }

    /// Notes what is wrong with something that could be read.
    pub fn note_faults(&mut self, what_it_is: &str, warnings: &[String], at: &Span) {
        for what in warnings {
            let message = format!("{what_it_is}: {what}");
            let fault = Warning { message, at: at.clone() };
            // A file that is read twice, for its digits, may have its pictures decoded twice.
            if !self.picture_faults.contains(&fault) {
                self.picture_faults.push(fault);
            }
        }
    }

    /// The size in bytes of all textures read.
    pub fn texture_bytes(&self) -> u64 {
        self.texture_bytes
    }

    /// Enters a nested scene.
    pub fn enter(&mut self, path: &Path, at: &Span) -> Result<(), FormatError> {
        if self.open.len() >= MAX_CHAIN {
            let message = format!("scenes are nested more than {MAX_CHAIN} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        self.open.push(path.to_owned());
        Ok(())
    }

    /// Leaves the scene that [`Reading::enter`] entered.
    pub fn leave(&mut self) {
        self.open.pop();
    }

    /// The bytes of a file. They count as held until [`Reading::release`].
    pub fn load(&mut self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let (file, length) = self.open_file(path)?;
        self.take(file, length, path)
    }

    /// All of a stream, which is expected to have this length. It counts as held until [`Reading::release`].
    pub fn take(&mut self, stream: impl Read, length: u64, path: &Path) -> Result<Vec<u8>, FormatError> {
        let limit = self.budget.left();
        // Reserves the memory at once if the system reports a length.
        let mut bytes = Vec::new();
        let stated = length.min(limit).saturating_add(1);
        let _ = usize::try_from(stated).map(|stated| bytes.try_reserve_exact(stated));
        let failed = |source| FormatError::Io { path: path.to_owned(), action: "read it", source };
        stream.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
        self.budget.take_bytes(bytes.len() as u64, &path.display().to_string())?;
        Ok(bytes)
    }

    /// The bytes of a text file without its byte order mark, as UTF-8. They count as held until [`Reading::release`].
    pub fn load_text(&mut self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let bytes = self.load(path)?;
        if !is_marked(&bytes) {
            return Ok(bytes);
        }
        self.budget.take_bytes(plain_size(&bytes), &path.display().to_string())?;
        let text = plain(&bytes).into_owned();
        self.budget.release((bytes.len() as u64 + plain_size(&bytes)).saturating_sub(text.len() as u64));
        Ok(text)
    }

    /// Opens a file for reading, or a member of an archive; one that is compressed by gzip gives what it holds. Also returns
    /// the length that the system or the archive states.
    pub fn open_file(&mut self, path: &Path) -> Result<OpenMember, FormatError> {
        let failed = |source| FormatError::Io { path: path.to_owned(), action: "open it", source };
        let (stream, length): OpenMember = if let Some((archive, opened)) = self.locator.archives.open(path) {
            self.files.extend(fs::canonicalize(archive));
            opened.map_err(failed)?
        } else {
            let (file, length) = open(path)?;
            self.files.extend(fs::canonicalize(path));
            (Box::new(file), length)
        };
        Ok((gzip::plain(stream).map_err(failed)?, length))
    }

    /// Releases the bytes of a loaded file.
    pub fn release(&mut self, bytes: Vec<u8>) {
        self.budget.release(bytes.len() as u64);
    }

    /// A picture as a texture, decoded only once.
    pub fn texture(
        &mut self,
        folder: Option<&Path>,
        name: &str,
        holds: Texels,
        at: &Span,
    ) -> Result<Arc<Texture>, FormatError> {
        self.texture_of_layer(folder, name, None, holds, at)
    }

    /// One layer of a picture as a texture, decoded only once.
    pub fn texture_of_layer(
        &mut self,
        folder: Option<&Path>,
        name: &str,
        layer: Option<&str>,
        holds: Texels,
        at: &Span,
    ) -> Result<Arc<Texture>, FormatError> {
        let path = self.locator.locate(folder, name, at)?;
        let key = (path.clone(), layer.map(str::to_owned), holds);
        if let Some(texture) = self.textures.get(&key) {
            return Ok(texture.clone());
        }
        let bytes = self.load(&path)?;
        let hint = path.extension().and_then(|e| e.to_str());
        let is_data = match holds {
            Texels::Colours => false,
            Texels::Unsaid => is_raw_unless_said(&bytes, hint, &Limits::new(self.budget.left() / 2)),
            Texels::Numbers(_) => true,
        };
        let means = if is_data { SampleMeaning::Numbers } else { SampleMeaning::Colours };
        let image = self.decode(&bytes, hint, layer, means, name, at)?;
        self.release(bytes);
        self.kept_bytes += image.size();
        let channel = if let Texels::Numbers(channel) = holds { channel } else { None };
        let texture = Arc::new(Texture { channel, ..Texture::of(name, Arc::new(image), is_data) });
        self.textures.insert(key, texture.clone());
        Ok(texture)
    }
}
