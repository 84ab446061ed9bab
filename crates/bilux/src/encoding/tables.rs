//! Tables of what an encoded scene refers to by number: names of files, meshes, grids, images and textures, each once.

use super::blob::Blob;
use super::hash::ContentHash;
use bilux_scene::media::Grid;
use bilux_scene::texture::Image;
use bilux_scene::{Mesh, Texture};
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;
use std::sync::Arc;

/// Values in the order in which they first occurred.
pub(super) struct Numbered<T> {
    pub(super) values: Vec<T>,
    numbers: HashMap<T, usize>,
}

impl<T> Default for Numbered<T> {
    fn default() -> Numbered<T> {
        Numbered { values: Vec::new(), numbers: HashMap::new() }
    }
}

impl<T: Clone + Eq + Hash> Numbered<T> {
    pub(super) fn number(&mut self, value: T) -> usize {
        let next = self.values.len();
        *self.numbers.entry(value).or_insert_with_key(|value| {
            self.values.push(value.clone());
            next
        })
    }
}

/// The tables of a scene that is being encoded.
#[derive(Default)]
pub(super) struct WrittenTables {
    pub(super) files: Numbered<Arc<str>>,
    pub(super) meshes: Numbered<(String, ContentHash)>,
    pub(super) grids: Numbered<(String, ContentHash)>,
    pub(super) images: Numbered<ContentHash>,
    /// Encoded textures.
    pub(super) textures: Numbered<Vec<u8>>,
    pub(super) blobs: BTreeMap<ContentHash, Blob>,
    /// A texture that cannot be encoded.
    pub(super) computed_by_code: Option<String>,
}

impl WrittenTables {
    pub(super) fn blob(&mut self, blob: Blob) -> ContentHash {
        let hash = blob.hash();
        self.blobs.entry(hash).or_insert(blob);
        hash
    }
}

/// The tables of a scene that is being decoded.
#[derive(Default)]
pub(super) struct ReadTables {
    pub(super) files: Vec<Arc<str>>,
    pub(super) meshes: Vec<Arc<Mesh>>,
    pub(super) grids: Vec<Arc<Grid>>,
    pub(super) images: Vec<Arc<Image>>,
    pub(super) textures: Vec<Arc<Texture>>,
}
