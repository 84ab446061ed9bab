//! Opens layers, each once, and stacks them with their sublayers.

use super::packages::{in_package, root_of_package};
use crate::layers::layer::Layer;
use crate::layers::value::{TimeOffset, Value};
use crate::mtlx;
use crate::usda;
use crate::usdc;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_scene::Span;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// A layer with its sublayers, the strongest first, and what their time codes are in the first.
pub(crate) struct Stack {
    pub(super) layers: Vec<(u32, TimeOffset)>,
    pub(super) time_codes_per_second: f64,
}

/// All layers of a read.
pub(crate) struct Layers<'r, 'o, 'b> {
    pub(crate) reading: &'r mut Reading<'o>,
    pub(crate) diagnostics: Diagnostics,
    pub(crate) all: Vec<Layer<'b>>,
    pub(super) stacks: Vec<Stack>,
    /// By file: its layer, or that it could not be read.
    opened: HashMap<PathBuf, Option<u32>>,
    stack_of: HashMap<u32, u32>,
    /// The places that were brought in for the current prim, and for all.
    pub(super) places: [usize; 2],
    /// Number of places that all of them were brought through, beyond what is usual.
    pub(super) deep: usize,
    /// The times of the stage for which clips are opened.
    pub(crate) moments: Vec<f64>,
    /// Sets of clips so far.
    pub(super) clip_sets: u32,
}

/// Sublayers of sublayers.
const MAX_STACKED: usize = 32;
/// Layers in a stack: sublayers can be listed many times.
const MAX_LAYERS: usize = 4096;

impl<'r, 'o, 'b> Layers<'r, 'o, 'b> {
    /// Reads the first layer from bytes.
    pub(crate) fn new(
        reading: &'r mut Reading<'o>,
        bytes: &'b [u8],
        name: &Arc<str>,
        folder: Option<&Path>,
    ) -> Result<Layers<'r, 'o, 'b>, FormatError> {
        let mut layers = Layers {
            opened: reading.open.iter().map(|path| (path.clone(), Some(0))).collect(),
            reading,
            diagnostics: Diagnostics::default(),
            all: Vec::new(),
            stacks: Vec::new(),
            stack_of: HashMap::new(),
            places: [0; 2],
            deep: 0,
            moments: Vec::new(),
            clip_sets: 0,
        };
        let layer = layers.parsed(Cow::Borrowed(bytes), name, folder.map(Path::to_owned))?;
        layers.all.push(layer);
        layers.stack(0)?;
        Ok(layers)
    }

    /// A layer from bytes that count as held; those that it owns are released where the layer does not need them.
    fn parsed(
        &mut self,
        bytes: Cow<'b, [u8]>,
        name: &Arc<str>,
        folder: Option<PathBuf>,
    ) -> Result<Layer<'b>, FormatError> {
        let budget = &mut self.reading.budget;
        let owned = if let Cow::Owned(bytes) = &bytes { bytes.len() as u64 } else { 0 };
        if bytes.starts_with(usdc::MAGIC) {
            return usdc::read(bytes, name, folder, budget);
        }
        if mtlx::is_document(&bytes) {
            let layer = mtlx::read(&bytes, name, folder, budget)?;
            budget.release(owned);
            return Ok(layer);
        }
        if !usda::MAGIC.iter().any(|magic| bytes.starts_with(magic)) {
            let at = Span { file: name.clone(), line: 0, column: 0 };
            return Err(FormatError::malformed("this is not a layer of USD, in text or in a crate file", at));
        }
        let layer = usda::read(&bytes, name, folder, budget)?;
        budget.release(owned);
        Ok(layer)
    }

    /// The file that a layer names; `None`, with a warning, if it is not there or may not be opened.
    pub(super) fn locate(
        &mut self,
        layer: u32,
        asset: &str,
        at: &Span,
    ) -> Result<Option<PathBuf>, FormatError> {
        let folder = self.all[layer as usize].folder.clone();
        if let Some((package, inner)) = in_package(asset) {
            let Some(package) = self.locate(layer, package, at)? else { return Ok(None) };
            let name = package.display().to_string().into();
            return match root_of_package(self.reading, &package, &name) {
                Ok(_) => Ok(Some(package.join(inner))),
                Err(error) => {
                    self.left_out(&error, at);
                    Ok(None)
                }
            };
        }
        let found = self.reading.locator.locate(folder.as_deref(), asset, at).and_then(|path| {
            // A file of the same name elsewhere is another layer.
            let is_named = ends_with(&path, asset) || Path::new(asset).is_absolute();
            let missing = || FormatError::MissingFile {
                name: asset.to_owned(),
                folder: folder.clone().unwrap_or_default(),
                at: at.clone(),
            };
            if is_named { Ok(path) } else { Err(missing()) }
        });
        match found {
            Ok(path) => Ok(Some(path)),
            Err(error) => {
                self.left_out(&error, at);
                Ok(None)
            }
        }
    }

    /// A value that a layer may still hold packed.
    pub(super) fn unpacked(&mut self, layer: u32, value: Value) -> Result<Value, FormatError> {
        match (&value, &self.all[layer as usize].packed) {
            (Value::Packed(packed), Some(file)) => file.unpack(*packed, &mut self.reading.budget),
            _ => Ok(value),
        }
    }

    fn left_out(&mut self, error: &FormatError, at: &Span) {
        self.diagnostics.note(&format!("a layer is left out: {}", error.without_place()), || at.clone());
    }

    /// The layer in a file; `None`, with a warning, if it cannot be read.
    pub(super) fn open(&mut self, path: &Path, at: &Span) -> Result<Option<u32>, FormatError> {
        if let Some(known) = self.opened.get(path) {
            return Ok(*known);
        }
        let layer = self.loaded(path);
        let index = match layer {
            Ok(layer) => {
                self.all.push(layer);
                Some(self.all.len() as u32 - 1)
            }
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                self.diagnostics.note(&format!("a layer is left out: {error}"), || at.clone());
                None
            }
        };
        self.opened.insert(path.to_owned(), index);
        Ok(index)
    }

    fn loaded(&mut self, path: &Path) -> Result<Layer<'b>, FormatError> {
        let mut path = path.to_owned();
        let mut name: Arc<str> = path.display().to_string().into();
        if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("usdz")) {
            path = root_of_package(self.reading, &path, &name)?;
            name = path.display().to_string().into();
        }
        let bytes = self.reading.load(&path)?;
        self.parsed(Cow::Owned(bytes), &name, path.parent().map(Path::to_owned))
    }

    /// The stack of a layer and its sublayers.
    pub(super) fn stack(&mut self, layer: u32) -> Result<u32, FormatError> {
        if let Some(known) = self.stack_of.get(&layer) {
            return Ok(*known);
        }
        let mut stack = Stack {
            layers: Vec::new(),
            time_codes_per_second: self.all[layer as usize].time_codes_per_second(),
        };
        self.add(layer, TimeOffset::default(), &mut Vec::new(), &mut stack)?;
        self.stacks.push(stack);
        let index = self.stacks.len() as u32 - 1;
        self.stack_of.insert(layer, index);
        Ok(index)
    }

    fn add(
        &mut self,
        layer: u32,
        offset: TimeOffset,
        open: &mut Vec<u32>,
        stack: &mut Stack,
    ) -> Result<(), FormatError> {
        let at = self.all[layer as usize].at(0);
        if open.contains(&layer) {
            self.diagnostics.note("a layer is among its own sublayers: left out there", || at);
            return Ok(());
        }
        if open.len() >= MAX_STACKED || stack.layers.len() >= MAX_LAYERS {
            self.diagnostics.note("there are too many sublayers of sublayers: the rest is left out", || at);
            return Ok(());
        }
        stack.layers.push((layer, offset));
        let fields = &self.all[layer as usize].root().fields;
        if fields.find("relocates").or(fields.find("layerRelocates")).is_some() {
            let at = at.clone();
            self.diagnostics.not_shown("relocates of prims", || at);
        }
        let fields = &self.all[layer as usize].root().fields;
        let rate = self.all[layer as usize].time_codes_per_second();
        let names = fields.find("subLayers").and_then(Value::texts).unwrap_or_else(|| Arc::from([]));
        let offsets = match fields.find("subLayerOffsets") {
            Some(Value::Offsets(list)) => list.clone(),
            _ => Vec::new(),
        };
        open.push(layer);
        for (i, name) in names.iter().enumerate() {
            let Some(path) = self.locate(layer, name, &at)? else { continue };
            let Some(sublayer) = self.open(&path, &at)? else { continue };
            let own = offsets.get(i).copied().unwrap_or_default();
            let scale = rate / self.all[sublayer as usize].time_codes_per_second();
            let inner = own.after(TimeOffset { offset: 0.0, scale });
            self.add(sublayer, offset.after(inner), open, stack)?;
        }
        open.pop();
        Ok(())
    }
}

/// True if a path ends with the parts of a name, in upper or lower case, after those that go up.
fn ends_with(path: &Path, name: &str) -> bool {
    let name = name.replace('\\', "/");
    let parts = Path::new(&name).components().rev();
    let mut own = path.components().rev();
    parts
        .take_while(|part| matches!(part, Component::Normal(_)))
        .all(|part| own.next().is_some_and(|own| own.as_os_str().eq_ignore_ascii_case(part.as_os_str())))
}
