//! The pictures of a file ahead of whoever asks for them, on all cores: to decode them is most of what a textured model takes.

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
    /// Decodes what textures name. What goes wrong is told where it is asked for, and what is not in bytes is decoded there.
    ///
    /// # Errors
    /// When the decoded pictures take more memory than there may be.
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
            .filter_map(|(number, image)| Some((number, self.encoded(image).ok()?)))
            .collect();
        // Decoders' buffers and texels are held side by side for a moment, all at once.
        let share = Limits::new(self.reading.budget.left() / (2 * encoded.len().max(1) as u64));
        let decode = |bytes: &[u8]| read_rgba8(bytes, None, &share).ok().flatten();
        let decoded: Vec<_> = encoded.par_iter().map(|(_, (_, bytes))| decode(bytes)).collect();
        for ((number, (name, bytes)), picture) in encoded.into_iter().zip(decoded) {
            self.let_go(bytes);
            let Some(picture) = picture else { continue };
            let (width, height) = (picture.width, picture.height);
            let image = Image { width, height, texels: Texels::Bytes(picture.texels) };
            self.reading.hold_image(&image, &name)?;
            self.images.insert((number, false), Some((name, Arc::new(image))));
        }
        Ok(())
    }
}
