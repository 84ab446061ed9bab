//! The pictures of a file, wherever they are stored. Each is decoded once.

use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::document::uri::{self, Resource};
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::images::SampleMeaning;
use bilux_import::input::reading::Reading;
use bilux_math::parallel::map;
use bilux_pictures::{Limits, read_rgba8};
use bilux_scene::texture::{Image, Texels};
use std::borrow::Cow;
use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::sync::Arc;

/// A picture with its name.
pub(crate) type Named = (String, Arc<Image>);

/// Decoded pictures, by their index in the file and by whether they hold numbers; `None` for one that failed.
#[derive(Default)]
pub(crate) struct Pictures(HashMap<(usize, bool), Option<Named>>);

impl Pictures {
    /// Decodes the pictures that textures refer to, on all cores: that is most of the work of reading a textured model.
    ///
    /// A picture that fails is reported where it is used, and one without 8-bit texels is decoded there.
    ///
    /// # Errors
    /// If the decoded pictures exceed the remaining memory.
    pub(crate) fn decoded_ahead(
        document: &Document<'_>,
        reading: &mut Reading,
    ) -> Result<Pictures, FormatError> {
        let mut pictures = Pictures::default();
        let textures = document.root.list("textures").unwrap_or_default();
        let wanted: BTreeSet<usize> =
            textures.iter().filter_map(|texture| source(*texture)?.as_count().ok()).collect();
        if wanted.len() < 2 {
            return Ok(pictures);
        }
        let images =
            wanted.into_iter().filter_map(|number| Some((number, document.root.item("images", number)?)));
        let encoded: Vec<_> = images
            .filter_map(|(number, image)| Some((number, image, encoded(document, image, reading).ok()?)))
            .collect();
        // Each decoder holds its own buffers as well as the texels, and all decoders run at once.
        let share = Limits::new(reading.budget.left() / (2 * encoded.len().max(1) as u64));
        let decode = |bytes: &[u8]| read_rgba8(bytes, None, &share).ok().flatten();
        // The largest first, each to the next thread that is free, so that all threads end at about the same time.
        let mut largest_first: Vec<usize> = (0..encoded.len()).collect();
        largest_first.sort_by_key(|&i| Reverse(encoded[i].2.1.len()));
        let mut decoded = map(largest_first, |i| (i, decode(&encoded[i].2.1)));
        decoded.sort_unstable_by_key(|(i, _)| *i);
        for ((number, node, (name, bytes)), (_, picture)) in encoded.into_iter().zip(decoded) {
            release(bytes, reading);
            let Some(picture) = picture else { continue };
            reading.note_picture_faults(&name, &picture.warnings, &node.at());
            let (width, height) = (picture.width, picture.height);
            let image = Image { width, height, texels: Texels::Bytes(picture.texels) };
            reading.charge_image(&image, &name)?;
            pictures.0.insert((number, false), Some((name, Arc::new(image))));
        }
        Ok(pictures)
    }

    /// The picture of a texture; `None`, with a warning, if it cannot be read.
    pub(crate) fn of_texture<'d>(
        &mut self,
        texture: JsonNode<'d>,
        is_data: bool,
        document: &Document<'d>,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<Named>, FormatError> {
        let Some(index) = source(texture) else {
            let what = "a texture has no readable picture and is replaced by a magenta checker";
            diagnostics.note(what, || texture.at());
            return Ok(None);
        };
        let image = document.named("images", index)?;
        let number = index.as_count()?;
        let known = self.0.get(&(number, is_data)).or_else(|| {
            // 8-bit texels are the same whether they hold colours or numbers.
            let other = self.0.get(&(number, !is_data));
            other.filter(|other| other.as_ref().is_none_or(|(_, image)| image.is_bytes()))
        });
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let decoded = match decode(document, image, is_data, reading) {
            Ok(decoded) => Some(decoded),
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let reason = error.without_place();
                let what = format!("a texture is replaced by a magenta checker: {reason}");
                diagnostics.note(&what, || image.at());
                None
            }
        };
        self.0.insert((number, is_data), decoded.clone());
        Ok(decoded)
    }

    /// True if a picture has been read, as numbers or as colours.
    pub(crate) fn contain(&self, image: usize) -> bool {
        [true, false].iter().any(|&is_data| self.0.contains_key(&(image, is_data)))
    }
}

/// Decodes a picture.
pub(crate) fn decode<'d>(
    document: &Document<'d>,
    image: JsonNode<'d>,
    is_data: bool,
    reading: &mut Reading,
) -> Result<Named, FormatError> {
    let at = image.at();
    let (name, bytes) = encoded(document, image, reading)?;
    let kind = image.text("mimeType")?.unwrap_or_default();
    let extension = Path::new(&name).extension().and_then(|e| e.to_str());
    let hint = kind.strip_prefix("image/").or(extension);
    let means = if is_data { SampleMeaning::Numbers } else { SampleMeaning::SrgbColours };
    let decoded = reading.decode(&bytes, hint, None, means, &name, &at)?;
    release(bytes, reading);
    Ok((name, Arc::new(decoded)))
}

/// The name and the encoded bytes of a picture, wherever they are stored.
pub(crate) fn encoded<'s, 'd>(
    document: &'s Document<'d>,
    image: JsonNode<'d>,
    reading: &mut Reading,
) -> Result<(String, Cow<'s, [u8]>), FormatError> {
    if let Some(view) = image.get("bufferView") {
        let view = document.view(view)?;
        let name = if image.name().is_empty() { "a picture in the file" } else { image.name() };
        return Ok((name.to_owned(), Cow::Borrowed(view.bytes)));
    }
    let place = image.need("uri")?;
    Ok(match uri::resolve(reading, place)? {
        Resource::Data(bytes) => (image.name().to_owned(), Cow::Owned(bytes)),
        Resource::File(names) => {
            let path = reading.locator.locate_any(document.folder(), &names, &place.at())?;
            let bytes = reading.load(&path)?;
            (names.into_iter().next().unwrap_or_default(), Cow::Owned(bytes))
        }
    })
}

/// Releases bytes from [`encoded`].
pub(crate) fn release(bytes: Cow<[u8]>, reading: &mut Reading) {
    if let Cow::Owned(bytes) = bytes {
        reading.release(bytes);
    }
}

/// The index of a texture's image. The format that all programs can read comes first: compressed ones have lost
/// more.
fn source(texture: JsonNode) -> Option<JsonNode> {
    let of = |name| texture.extension(name).and_then(|extension| extension.get("source"));
    let packed = if cfg!(feature = "ktx2") { of("KHR_texture_basisu") } else { None };
    texture.get("source").or(of("EXT_texture_webp")).or(packed)
}
