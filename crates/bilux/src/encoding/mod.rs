//! Scenes as bytes, for other processes and other machines: a small document, and a blob for each mesh and each image.
//!
//! The encoding is canonical: the same scene has the same bytes on every machine, whatever it was read from and however its
//! meshes are shared. Blobs are known by the hash of their content, so that those that scenes have in common are sent
//! once. Film fingerprints come from the same bytes.
//!
//! ```
//! use bilux::prelude::*;
//!
//! let scene = bilux::generate(&Spec::new("", "cornell"))?;
//! let encoded = bilux::encoding::encode(&scene)?;
//! let blobs: std::collections::HashMap<_, _> =
//!     encoded.blobs.iter().map(|(hash, blob)| (*hash, blob.bytes())).collect();
//! let copy = bilux::encoding::decode(&encoded.document, &|hash| blobs.get(&hash).map(Vec::as_slice))?;
//! assert_eq!(bilux::encoding::encode(&copy)?.document, encoded.document);
//! # Ok::<(), bilux::Error>(())
//! ```

mod blob;
mod blob_reading;
mod code;
mod error;
mod hash;
mod scene;
mod table_code;
mod tables;
mod values;

pub use blob::Blob;
pub use error::EncodingError;
pub use hash::ContentHash;

use bilux_math::parallel::for_each;
use bilux_scene::texture::Texels;
use bilux_scene::{SceneBuilder, Spec};
use code::{Coded, Decoder, Encoder};
use std::collections::BTreeMap;
use std::sync::Arc;
use tables::ReadTables;

/// First bytes of a document.
const MAGIC: [u8; 12] = *b"bilux scene\n";

/// The version of the form of documents and blobs; others are refused.
pub const VERSION: u32 = 5;

/// The bytes of a hash.
const HASH: usize = 32;

/// A scene as bytes.
#[derive(Clone, Debug)]
pub struct EncodedScene {
    /// Everything but the blobs. It ends with the hash of what comes before.
    pub document: Vec<u8>,
    /// Meshes and images by their hashes, to which the document refers.
    pub blobs: BTreeMap<ContentHash, Blob>,
}

/// Encodes a scene. Names of the files that it was read from are left out.
///
/// # Errors
/// If a texture is computed by code of the calling program.
pub fn encode(scene: &SceneBuilder) -> Result<EncodedScene, EncodingError> {
    hash_images(scene);
    let mut body = Encoder::default();
    scene.write(&mut body);
    let tables = std::mem::take(&mut body.tables);
    if let Some(texture) = tables.computed_by_code {
        return Err(EncodingError::ComputedByCode(texture));
    }
    let mut whole = Encoder::default();
    MAGIC.write(&mut whole);
    VERSION.write(&mut whole);
    let blobs = tables.write(&mut whole);
    let mut document = whole.bytes;
    document.append(&mut body.bytes);
    let hash = ContentHash::of(&document);
    document.extend_from_slice(&hash.0);
    Ok(EncodedScene { document, blobs })
}

/// Decodes a scene. `blobs` gives the bytes of a blob by its hash, and is asked once for each.
///
/// # Errors
/// If the document comes from another version, if it or a blob is damaged, or if a blob is missing.
pub fn decode<'b>(
    document: &[u8],
    blobs: &(dyn Fn(ContentHash) -> Option<&'b [u8]> + 'b),
) -> Result<SceneBuilder, EncodingError> {
    let content = document.len().checked_sub(HASH).map(|end| document.split_at(end));
    let Some((content, hash)) = content.filter(|(content, _)| content.starts_with(&MAGIC)) else {
        return Err(EncodingError::NotAScene);
    };
    let mut from = Decoder::new(content);
    from.take(MAGIC.len())?;
    let found = u32::read(&mut from)?;
    if found != VERSION {
        return Err(EncodingError::OtherVersion { found, reads: VERSION });
    }
    if ContentHash::of(content).0 != hash {
        return Err(from.wrong("it has another hash than it says"));
    }
    decode_content(from, blobs)
}

/// Decodes what comes after the version.
fn decode_content<'b>(
    mut from: Decoder,
    blobs: &(dyn Fn(ContentHash) -> Option<&'b [u8]> + 'b),
) -> Result<SceneBuilder, EncodingError> {
    ReadTables::read(&mut from, blobs)?;
    let scene = SceneBuilder::read(&mut from)?;
    if from.left() > 0 {
        return Err(from.wrong(format!("{} bytes too many", from.left())));
    }
    Ok(scene)
}

/// The hash of what pictures of a scene show, without names, places in files and the like; and of more specs and a text.
pub(crate) fn hash_what_is_seen(scene: &SceneBuilder, more: &[&Spec], text: &str) -> ContentHash {
    hash_images(scene);
    let mut body = Encoder::default();
    scene::write_what_is_seen(scene, &mut body);
    more.iter().for_each(|spec| spec.write(&mut body));
    text.to_owned().write(&mut body);
    let mut whole = Encoder::default();
    VERSION.write(&mut whole);
    std::mem::take(&mut body.tables).write(&mut whole);
    whole.bytes.append(&mut body.bytes);
    ContentHash::of(&whole.bytes)
}

/// Computes the hashes of the textures' images side by side. They are known when the images are written one by one.
fn hash_images(scene: &SceneBuilder) {
    let mut images: Vec<_> = scene.textures.iter().map(|texture| &texture.image).collect();
    images.retain(|image| !matches!(image.texels, Texels::Formula(_)));
    images.sort_by_key(|image| Arc::as_ptr(image));
    images.dedup_by_key(|image| Arc::as_ptr(image));
    for_each(images, |image| {
        Blob::Image(image.clone()).hash();
    });
}

#[cfg(test)]
mod tests;
