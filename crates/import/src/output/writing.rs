//! The state of one write: files are built in memory, and reach the disk only when all are complete.

use crate::input::images::is_bright;
use crate::{FormatError, WriteOptions};
use bilux_pictures::{ColourSpace, Picture, write_atomically};
use bilux_scene::media::Grid;
use bilux_scene::{IntensityDistribution, SceneBuilder, Span, Texture, Warning};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The files of a scene under construction.
pub struct Writing<'o> {
    pub options: &'o WriteOptions,
    /// The path of the main file.
    path: &'o Path,
    /// The files that the scene was read from.
    read: BTreeSet<PathBuf>,
    /// The main file's name without folder and extension.
    pub stem: String,
    /// Extension of the main file, in lower case.
    pub extension: String,
    /// The main file.
    pub main: Vec<u8>,
    /// Accompanying files, by name.
    beside: Vec<(String, Vec<u8>)>,
    /// Textures written so far, and the files of each.
    textures: Vec<(Texture, String)>,
    /// Grids written so far, and the file of each.
    pub grids: Vec<(Arc<Grid>, String)>,
    /// Intensity distributions that are written already, each with its file.
    pub distributions: Vec<(Arc<IntensityDistribution>, String)>,
    /// Everything that the format could not hold.
    pub warnings: Vec<Warning>,
}

impl<'o> Writing<'o> {
    pub fn new(path: &'o Path, scene: &SceneBuilder, options: &'o WriteOptions) -> Writing<'o> {
        let stem = path.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned());
        let extension = path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_lowercase());
        Writing {
            options,
            path,
            read: scene.files.clone(),
            stem,
            extension,
            main: Vec::new(),
            beside: Vec::new(),
            textures: Vec::new(),
            grids: Vec::new(),
            distributions: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The file name of a texture next to the scene, written on first use.
    ///
    /// 8-bit samples are preserved exactly; a texture with texels brighter than white becomes an EXR.
    pub fn texture(&mut self, scene: &SceneBuilder, index: usize) -> Result<Option<String>, FormatError> {
        scene.textures.get(index).map(|texture| self.texture_file(texture)).transpose()
    }

    /// File name of a texture that may be nested in another, as [`Writing::texture`] gives it.
    pub fn texture_file(&mut self, texture: &Texture) -> Result<String, FormatError> {
        if let Some((_, name)) = self.textures.iter().find(|(known, _)| have_one_file(known, texture)) {
            return Ok(name.clone());
        }
        let bright = texture.texels().any(is_bright);
        let format = if bright { "exr" } else { "png" };
        let mut picture = Picture::from_rgb(texture.width(), texture.height(), texture.texels().collect())?;
        if texture.is_data && !bright {
            // Texels are written as stored, so that no transfer curve is applied to numbers.
            picture.colour_space = ColourSpace::Srgb;
        }
        let bytes = bilux_pictures::write_bytes(format, &picture, &bilux_pictures::WriteOptions::default())?;
        let name = self.add_numbered("texture", self.textures.len() + 1, format, bytes);
        self.textures.push((texture.clone(), name.clone()));
        Ok(name)
    }

    /// Adds an accompanying file and returns its name: `STEM.EXTENSION`, or with a number that makes it new.
    pub fn add(&mut self, extension: &str, bytes: Vec<u8>) -> String {
        let stem = self.stem.clone();
        let numbered = (2..).map(|i: usize| format!("{stem}-{i}.{extension}"));
        self.add_first_free(std::iter::once(format!("{stem}.{extension}")).chain(numbered), bytes)
    }

    /// Adds one of several files and returns its name: `STEM-KIND-NUMBER.EXTENSION`, with this number or the next that is free.
    pub fn add_numbered(&mut self, kind: &str, number: usize, extension: &str, bytes: Vec<u8>) -> String {
        let stem = self.stem.clone();
        self.add_first_free((number..).map(|i| format!("{stem}-{kind}-{i}.{extension}")), bytes)
    }

    /// The accompanying files so far, for formats that keep them within the main file.
    pub fn take_beside(&mut self) -> Vec<(String, Vec<u8>)> {
        std::mem::take(&mut self.beside)
    }

    /// The number of accompanying files so far.
    pub fn count(&self) -> usize {
        self.beside.len()
    }

    /// Adds an accompanying file under the first name that neither another one nor a file of the input has.
    fn add_first_free(&mut self, mut names: impl Iterator<Item = String>, bytes: Vec<u8>) -> String {
        let is_free = |name: &String| {
            let full = std::fs::canonicalize(self.path.with_file_name(name));
            !self.beside.iter().any(|(other, _)| other == name)
                && !full.is_ok_and(|full| self.read.contains(&full))
        };
        let name = names.find(is_free).unwrap_or_default();
        self.beside.push((name.clone(), bytes));
        name
    }

    /// Adds a warning unless it exists already.
    pub fn warn(&mut self, message: impl Into<String>) {
        let warning = Warning { message: message.into(), at: Span::default() };
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

/// True for textures with the same texels, whatever their placement.
fn have_one_file(a: &Texture, b: &Texture) -> bool {
    let of = |t: &Texture| (t.is_data, t.channel, t.factor, t.threshold);
    Arc::ptr_eq(&a.image, &b.image) && of(a) == of(b)
}

/// Writes the accompanying files first, so that the main file never refers to a missing one.
pub fn write_all(path: &Path, writing: Writing) -> Result<Vec<Warning>, FormatError> {
    for (name, bytes) in &writing.beside {
        let beside = path.with_file_name(name);
        write_atomically(&beside, bytes).map_err(|e| e.in_file(&beside))?;
    }
    write_atomically(path, &writing.main).map_err(|e| e.in_file(path))?;
    Ok(writing.warnings)
}

/// Generates unique names by appending a number.
#[derive(Debug, Default)]
pub struct UnusedNames {
    taken: HashSet<String>,
    /// The next number for each name.
    next: HashMap<String, u64>,
}

impl UnusedNames {
    pub fn unused(&mut self, name: &str) -> String {
        let mut free = name.to_owned();
        while !self.taken.insert(free.clone()) {
            let number = self.next.entry(name.to_owned()).or_insert(2);
            free = format!("{name} {number}");
            *number += 1;
        }
        free
    }
}
