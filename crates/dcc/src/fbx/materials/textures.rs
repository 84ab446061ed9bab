//! Textures: a file beside the scene or in it, and how it lies on the surface.

use crate::fbx::document::{Index, Properties, display_name};
use crate::fbx::posed::Posed;
use crate::fbx::tree::{Node, Value};
use base64::Engine;
use bilux_import::FormatError;
use bilux_import::input::images::SampleMeaning;
use bilux_import::input::reading::{Reading, Texels};
use bilux_import::input::sink::Sink;
use bilux_math::transcendental::sin_cos;
use bilux_scene::Texture;
use bilux_scene::texture::{Image, UvTransform, Wrap};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// The pictures inside the file that have been decoded, by their object and whether they hold numbers.
#[derive(Default)]
pub(in crate::fbx) struct Textures {
    decoded: HashMap<(Index, bool), Arc<Image>>,
    /// The objects with pictures in them, by the names of their files with and without a folder.
    held: Option<HashMap<String, Index>>,
}

impl Textures {
    /// The texture of an object. One that cannot be read is a magenta checker, or `None` if it holds numbers, with a
    /// warning.
    pub(super) fn read(
        &mut self,
        index: Index,
        is_data: bool,
        second_set: Option<&[u8]>,
        posed: &Posed,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Option<Texture>, FormatError> {
        let document = posed.document;
        let node = document.object(index).node;
        if document.class(index) == b"LayeredTexture" {
            let mut layers = document.sources_of_class(index, "Texture");
            let first = layers.next();
            if layers.next().is_some() {
                sink.diagnostics.not_shown("textures above the first in layers", || node.at());
            }
            return match first {
                Some(first) => self.read(first, is_data, second_set, posed, reading, sink),
                None => Ok(None),
            };
        }
        let texture = match self.picture(index, is_data, posed, reading) {
            Ok(texture) => texture,
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let what = if is_data { "is left out" } else { "is replaced by a magenta checker" };
                sink.diagnostics.note(&format!("a texture {what}: {}", error.without_place()), || node.at());
                if is_data {
                    return Ok(None);
                }
                Texture::missing(&display_name(document.object(index).name))
            }
        };
        let properties = posed.properties(index);
        let wrap = |name: &str| if properties.integer(name) == Some(1) { Wrap::Clamp } else { Wrap::Repeat };
        let set = properties.text("UVSet");
        Ok(Some(Texture {
            is_data,
            wrap: [wrap("WrapModeU"), wrap("WrapModeV")],
            transform: placement(&properties),
            second_uv: set.is_some() && set == second_set,
            ..texture
        }))
    }

    /// The objects of the file that hold a picture of one of these names, the same name before the same file in another folder.
    fn embedded(&mut self, names: &[String], posed: &Posed) -> Vec<Index> {
        let document = posed.document;
        let held = self.held.get_or_insert_with(|| {
            let mut held: HashMap<String, Index> = HashMap::new();
            for index in document.indices().filter(|index| document.class(*index) == b"Video") {
                let node = document.object(index).node;
                if node.child("Content").is_some_and(|content| content.value(0).is_some()) {
                    for name in file_names(node).into_iter().flat_map(|name| [base_name(&name), name]) {
                        held.entry(name).or_insert(index);
                    }
                }
            }
            held
        });
        let wanted = names.iter().cloned().chain(names.iter().map(|name| base_name(name)));
        wanted.filter_map(|name| held.get(&name).copied()).collect()
    }

    /// The picture of a texture: in the file, or else beside it.
    fn picture(
        &mut self,
        index: Index,
        is_data: bool,
        posed: &Posed,
        reading: &mut Reading,
    ) -> Result<Texture, FormatError> {
        let document = posed.document;
        let node = document.object(index).node;
        let video = document.sources_of_class(index, "Video").next();
        let nodes = [Some(node), video.map(|video| document.object(video).node)];
        let names: Vec<String> = nodes.into_iter().flatten().flat_map(file_names).collect();
        let name = names.first().cloned().unwrap_or_default();
        // Another object may hold the picture for all that name its file.
        let holders = video.into_iter().chain(self.embedded(&names, posed));
        for video in holders {
            if let Some(image) = self.decoded.get(&(video, is_data)) {
                return Ok(Texture::of(&name, image.clone(), is_data));
            }
            let content = document.object(video).node.child("Content");
            let bytes = content.map_or(Ok(Cow::Borrowed(&[][..])), |content| content_of(content, reading))?;
            if !bytes.is_empty() {
                let extension = Path::new(&name).extension().and_then(|e| e.to_str());
                let means = if is_data { SampleMeaning::Numbers } else { SampleMeaning::Colours };
                let image = Arc::new(reading.decode(&bytes, extension, None, means, &name, &node.at())?);
                if let Cow::Owned(bytes) = bytes {
                    reading.release(bytes);
                }
                self.decoded.insert((video, is_data), image.clone());
                return Ok(Texture::of(&name, image, is_data));
            }
        }
        if names.is_empty() {
            return Err(node.error("this texture has no file"));
        }
        let holds = if is_data { Texels::Numbers(None) } else { Texels::Colours };
        let folder = document.folder;
        let mut first = None;
        for name in candidates(&names, &document.stem) {
            match reading.texture(folder, &name, holds, &node.at()) {
                Ok(texture) => return Ok((*texture).clone()),
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                // A file that is there but cannot be read says more than one that is not there.
                Err(error @ FormatError::MissingFile { .. }) => _ = first.get_or_insert(error),
                Err(error) => return Err(error),
            }
        }
        Err(first.unwrap_or_else(|| node.error("this texture has no file")))
    }
}

/// The names of the file that a texture or its picture states.
fn file_names(node: Node<'_>) -> Vec<String> {
    let names = ["RelativeFilename", "FileName", "Filename"].into_iter();
    let stated = names.filter_map(|name| node.child_value(name)?.text()).map(display_name);
    stated.filter(|name| !name.is_empty()).collect()
}

/// The name of a file without its folder.
fn base_name(name: &str) -> String {
    name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned()
}

/// Paths at which the file may be: as stated, or in the folders where programs put textures beside their scenes.
fn candidates(names: &[String], stem: &str) -> Vec<String> {
    let mut all: Vec<String> = names.to_vec();
    for name in names {
        let base = base_name(name);
        for folder in [&format!("{stem}.fbm"), "textures", "Textures", "../textures", "../Textures"] {
            all.push(format!("{folder}/{base}"));
        }
    }
    all
}

/// The bytes of a picture in the file; in text they are in base 64, and perhaps in several pieces.
fn content_of<'d>(node: Node<'d>, reading: &mut Reading) -> Result<Cow<'d, [u8]>, FormatError> {
    if node.is_binary() {
        let bytes = node.value(0).and_then(Value::text).unwrap_or_default();
        return Ok(Cow::Borrowed(bytes));
    }
    let mut bytes = Vec::new();
    for piece in node.values().filter_map(Value::text) {
        reading.budget.take_bytes(piece.len() as u64, node.file())?;
        let engine = base64::engine::general_purpose::STANDARD;
        let compact: Vec<u8> = piece.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
        engine.decode_vec(compact, &mut bytes).map_err(|_| node.error("this picture is not in base 64"))?;
    }
    Ok(Cow::Owned(bytes))
}

/// Placement of the picture: texture coordinates are scaled and rotated about pivots, and moved.
fn placement(properties: &Properties) -> Option<UvTransform> {
    let pair = |name: &str, default: f32| {
        properties.vector(name).map_or([default; 2], |vector| [vector.x as f32, vector.y as f32])
    };
    let [tx, ty] = pair("Translation", 0.0);
    let [sx, sy] = pair("Scaling", 1.0);
    let degrees = properties.vector("Rotation").map_or(0.0, |rotation| rotation.z as f32);
    if ([tx, ty], [sx, sy], degrees) == ([0.0; 2], [1.0; 2], 0.0) {
        return None;
    }
    let (sin, cos) = sin_cos(degrees.to_radians());
    let [about_x, about_y] = pair("TextureRotationPivot", 0.0);
    let [from_x, from_y] = pair("TextureScalingPivot", 0.0);
    let (a, b, c, d) = (cos * sx, -sin * sy, sin * sx, cos * sy);
    // Where the origin goes: scaled about one pivot, and then rotated about the other.
    let (x, y) = (from_x - sx * from_x - about_x, from_y - sy * from_y - about_y);
    let (x, y) = (cos * x - sin * y + about_x + tx, sin * x + cos * y + about_y + ty);
    // Here v runs downwards.
    Some(UvTransform::from_array([a, -c, -b, d, b + x, 1.0 - d - y]))
}
