//! Blobs: the bytes of meshes, grids and images, by which scenes that share them send them once.

use super::hash::{ContentHash, KnownHashes};
use bilux_scene::Mesh;
use bilux_scene::media::{Grid, Stored};
use bilux_scene::texture::{Image, Texels};
use std::sync::Arc;

/// First byte of a blob, by its kind: a mesh, a grid, or an image of bytes or of floats.
pub(super) const MESH: u8 = b'M';
pub(super) const GRID: u8 = b'G';
pub(super) const BYTES: u8 = b'B';
pub(super) const FLOATS: u8 = b'F';

/// Number of items of a list that become bytes at a time.
const PIECE: usize = 4096;

pub(super) static MESHES: KnownHashes<Mesh> = KnownHashes::new();
pub(super) static GRIDS: KnownHashes<Grid> = KnownHashes::new();
pub(super) static IMAGES: KnownHashes<Image> = KnownHashes::new();

/// A mesh or a grid without its name, or the texels of an image. Equal ones have equal bytes.
#[derive(Clone, Debug)]
pub enum Blob {
    /// A mesh.
    Mesh(Arc<Mesh>),
    /// A grid.
    Grid(Arc<Grid>),
    /// An image.
    Image(Arc<Image>),
}

impl Blob {
    /// The hash of its bytes, which is computed once.
    pub fn hash(&self) -> ContentHash {
        let compute = || ContentHash::of_pieces(|write| self.write(write));
        match self {
            Blob::Mesh(mesh) => MESHES.of(mesh, compute),
            Blob::Grid(grid) => GRIDS.of(grid, compute),
            Blob::Image(image) => IMAGES.of(image, compute),
        }
    }

    /// Bytes of the blob.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.size_estimate());
        self.write(&mut |piece| bytes.extend_from_slice(piece));
        bytes
    }

    fn size_estimate(&self) -> usize {
        let content = match self {
            Blob::Mesh(mesh) => mesh.size(),
            Blob::Grid(grid) => grid.bytes(),
            Blob::Image(image) => image.size(),
        };
        content as usize + 128
    }

    /// Gives its bytes piece by piece.
    fn write(&self, write: &mut dyn FnMut(&[u8])) {
        match self {
            Blob::Mesh(mesh) => {
                write(&[MESH]);
                list(write, &mesh.positions, |p| p.to_array().map(f32::to_le_bytes));
                list(write, &mesh.normals, |n| n.to_array().map(f32::to_le_bytes));
                list(write, &mesh.uvs, |uv| uv.to_array().map(f32::to_le_bytes));
                list(write, &mesh.uvs2, |uv| uv.to_array().map(f32::to_le_bytes));
                list(write, &mesh.tangents, |t| t.to_array().map(f32::to_le_bytes));
                list(write, &mesh.vertex_kd, |c| c.to_array().map(f32::to_le_bytes));
                list(write, &mesh.vertex_ks, |c| c.to_array().map(f32::to_le_bytes));
                write(&[u8::from(mesh.emission_by_kd)]);
                list(write, &mesh.vertex_opacity, |x| [x.to_le_bytes()]);
                list(write, mesh.opacity_threshold.as_slice(), |x| [x.to_le_bytes()]);
                list(write, &mesh.point_widths, |x| [x.to_le_bytes()]);
                list(write, &mesh.triangles, |t| t.map(u32::to_le_bytes));
                list(write, &mesh.points, |p| [p.to_le_bytes()]);
                list(write, &mesh.lines, |l| l.map(u32::to_le_bytes));
            }
            Blob::Grid(grid) => write_grid(grid, write),
            Blob::Image(image) => {
                let size = |write: &mut dyn FnMut(&[u8])| {
                    write(&(image.width as u64).to_le_bytes());
                    write(&(image.height as u64).to_le_bytes());
                };
                match &image.texels {
                    Texels::Bytes(texels) => {
                        write(&[BYTES]);
                        size(write);
                        write(texels.as_flattened());
                    }
                    Texels::Floats { colours, alpha } => {
                        write(&[FLOATS]);
                        size(write);
                        list(write, colours, |c| c.to_array().map(f32::to_le_bytes));
                        list(write, alpha, |a| [a.to_le_bytes()]);
                    }
                    // Tables of textures hold these; they are no blobs.
                    Texels::Formula(_) => size(write),
                }
            }
        }
    }
}

/// Gives the length of a list, and then the bytes of its items.
fn list<T, const N: usize>(write: &mut dyn FnMut(&[u8]), items: &[T], bytes_of: impl Fn(&T) -> [[u8; 4]; N]) {
    write(&(items.len() as u64).to_le_bytes());
    let mut bytes = Vec::with_capacity(4 * N * items.len().min(PIECE));
    for piece in items.chunks(PIECE) {
        bytes.clear();
        piece.iter().for_each(|item| bytes.extend_from_slice(bytes_of(item).as_flattened()));
        write(&bytes);
    }
}

fn write_grid(grid: &Grid, write: &mut dyn FnMut(&[u8])) {
    write(&[GRID]);
    grid.size().iter().for_each(|n| write(&(*n as u64).to_le_bytes()));
    let to_object = grid.to_object();
    for matrix in [to_object.matrix(), to_object.inverse_matrix()] {
        matrix.to_cols_array().iter().for_each(|x| write(&x.to_le_bytes()));
    }
    let Stored { places, voxels, scale } = grid.stored();
    write(&scale.to_le_bytes());
    list(write, places, |place| [place.to_le_bytes()]);
    // Blocks have an even number of voxels.
    list(write, voxels.as_chunks::<2>().0, |[a, b]| [(u32::from(*b) << 16 | u32::from(*a)).to_le_bytes()]);
}
