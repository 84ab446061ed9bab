//! Conversion of tables to bytes and back, and references to what is in them.

use super::blob::Blob;
use super::code::{Coded, Decoder, Encoder};
use super::error::EncodingError;
use super::hash::ContentHash;
use super::tables::{ReadTables, WrittenTables};
use bilux_scene::media::Grid;
use bilux_scene::texture::Image;
use bilux_scene::{Mesh, Texture};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

impl WrittenTables {
    /// Appends the bytes of all tables.
    pub(super) fn write(self, to: &mut Encoder) -> BTreeMap<ContentHash, Blob> {
        self.files.values.iter().map(|file| file.to_string()).collect::<Vec<_>>().write(to);
        self.meshes.values.write(to);
        self.grids.values.write(to);
        self.images.values.write(to);
        self.textures.values.len().write(to);
        self.textures.values.iter().for_each(|texture| to.bytes.extend_from_slice(texture));
        self.blobs
    }
}

impl Encoder {
    /// Puts what `write` writes into the table of textures, and writes its number.
    pub(super) fn texture(&mut self, write: impl FnOnce(&mut Encoder)) {
        let outside = std::mem::take(&mut self.bytes);
        write(self);
        let texture = std::mem::replace(&mut self.bytes, outside);
        self.tables.textures.number(texture).write(self);
    }
}

/// Gives the bytes of a blob.
pub(super) type Blobs<'b> = dyn Fn(ContentHash) -> Option<&'b [u8]> + 'b;

impl ReadTables {
    /// Reads the tables at the beginning of a scene.
    pub(super) fn read(from: &mut Decoder, blobs: &Blobs) -> Result<(), EncodingError> {
        let mut known: HashMap<ContentHash, Blob> = HashMap::new();
        let mut blob_of = |hash: ContentHash| {
            if let Some(blob) = known.get(&hash) {
                return Ok(blob.clone());
            }
            let bytes = blobs(hash).ok_or(EncodingError::MissingBlob(hash))?;
            let blob = Blob::read(bytes, hash)?;
            known.insert(hash, blob.clone());
            Ok(blob)
        };
        from.tables.files = Vec::<String>::read(from)?.into_iter().map(Into::into).collect();
        for (name, hash) in Vec::<(String, ContentHash)>::read(from)? {
            let Blob::Mesh(mesh) = blob_of(hash)? else { return Err(from.wrong("no mesh for a mesh")) };
            let mesh = if name.is_empty() { mesh } else { Arc::new(Mesh { name, ..(*mesh).clone() }) };
            from.tables.meshes.push(mesh);
        }
        for (name, hash) in Vec::<(String, ContentHash)>::read(from)? {
            let Blob::Grid(grid) = blob_of(hash)? else { return Err(from.wrong("no grid for a grid")) };
            from.tables.grids.push(Arc::new((*grid).clone().named(&name)));
        }
        for hash in Vec::<ContentHash>::read(from)? {
            let Blob::Image(image) = blob_of(hash)? else { return Err(from.wrong("no image for an image")) };
            from.tables.images.push(image);
        }
        for _ in 0..from.count(1)? {
            let texture = Arc::new(Texture::read(from)?);
            from.tables.textures.push(texture);
        }
        Ok(())
    }
}

impl Coded for ContentHash {
    fn write(&self, to: &mut Encoder) {
        self.0.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(ContentHash(Coded::read(from)?))
    }
}

/// The name of a file.
impl Coded for Arc<str> {
    fn write(&self, to: &mut Encoder) {
        to.tables.files.number(self.clone()).write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let index = from.index("the name of file", from.tables.files.len())?;
        Ok(from.tables.files[index].clone())
    }
}

impl Coded for Arc<Mesh> {
    fn write(&self, to: &mut Encoder) {
        let hash = to.tables.blob(Blob::Mesh(self.clone()));
        let name = if to.only_what_is_seen { String::new() } else { self.name.clone() };
        to.tables.meshes.number((name, hash)).write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let index = from.index("mesh", from.tables.meshes.len())?;
        Ok(from.tables.meshes[index].clone())
    }
}

impl Coded for Arc<Grid> {
    fn write(&self, to: &mut Encoder) {
        let hash = to.tables.blob(Blob::Grid(self.clone()));
        let name = if to.only_what_is_seen { String::new() } else { self.name().to_owned() };
        to.tables.grids.number((name, hash)).write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let index = from.index("grid", from.tables.grids.len())?;
        Ok(from.tables.grids[index].clone())
    }
}

impl Coded for Arc<Image> {
    fn write(&self, to: &mut Encoder) {
        let hash = to.tables.blob(Blob::Image(self.clone()));
        to.tables.images.number(hash).write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let index = from.index("image", from.tables.images.len())?;
        Ok(from.tables.images[index].clone())
    }
}

impl Coded for Arc<Texture> {
    fn write(&self, to: &mut Encoder) {
        to.texture(|to| Texture::write(self, to));
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let index = from.index("texture", from.tables.textures.len())?;
        Ok(from.tables.textures[index].clone())
    }
}
