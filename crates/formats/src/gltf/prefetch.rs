//! Decodes a file's images in advance, on all cores: decoding them is most of the work of reading a textured
//! model.

use super::json::JsonNode;
use super::reader::Gltf;
use super::textures::source;
use crate::FormatError;
use bilux_pictures::{Limits, read_rgba8};
use bilux_scene::texture::{Image, Texels};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

impl<'d> Gltf<'d, '_, '_> {
    /// Decodes the images that textures refer to.
    ///
    /// An image that fails is reported where it is used, and one without 8-bit texels is decoded there.
    ///
    /// # Errors
    /// If the decoded images exceed the remaining memory.
    pub(super) fn decode_ahead(&mut self) -> Result<(), FormatError> {
        let document = self.document;
        let textures = document.root.list("textures").unwrap_or_default();
        let wanted: BTreeSet<usize> =
            textures.iter().filter_map(|texture| source(*texture)?.as_count().ok()).collect();
        if wanted.len() < 2 {
            return Ok(());
        }
        let images =
            wanted.into_iter().filter_map(|number| Some((number, document.root.item("images", number)?)));
        let images: Vec<(usize, JsonNode<'d>)> = images.collect();
        let encoded: Vec<_> = images
            .into_iter()
            .filter_map(|(number, image)| Some((number, image, self.encoded(image).ok()?)))
            .collect();
        // Each decoder holds its own buffers as well as the texels, and all decoders run at once.
        let share = Limits::new(self.reading.budget.left() / (2 * encoded.len().max(1) as u64));
        let decode = |bytes: &[u8]| read_rgba8(bytes, None, &share).ok().flatten();
        let decoded: Vec<_> = encoded.par_iter().map(|(_, _, (_, bytes))| decode(bytes)).collect();
        for ((number, node, (name, bytes)), picture) in encoded.into_iter().zip(decoded) {
            self.release_encoded(bytes);
            let Some(picture) = picture else { continue };
            self.reading.note_picture_faults(&name, &picture.warnings, &node.at());
            let (width, height) = (picture.width, picture.height);
            let image = Image { width, height, texels: Texels::Bytes(picture.texels) };
            self.reading.charge_image(&image, &name)?;
            self.images.insert((number, false), Some((name, Arc::new(image))));
        }
        Ok(())
    }
}
