//! Pictures that are textures: four bytes a pixel, without a detour by planes.

use super::guard::guarded;
use super::{jpeg, png};
use crate::{Limits, PictureError};

/// Bytes of an sRGB picture, alpha not multiplied in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgba8 {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// In rows, the top one first.
    pub texels: Vec<[u8; 4]>,
}

/// Decodes what is stored in sRGB bytes: PNG, JPEG and KTX2. `None` for all else, which [`super::read_bytes`] reads. Where both do,
/// they give the same, and this in a quarter of the memory.
///
/// # Errors
/// As [`super::read_bytes`].
pub fn read_rgba8(bytes: &[u8], limits: &Limits) -> Result<Option<Rgba8>, PictureError> {
    #[cfg(feature = "ktx2")]
    if (super::ktx2::ENTRY.sniff)(bytes) {
        return guarded("KTX2", || super::ktx2::read_rgba8(bytes, limits));
    }
    if (png::ENTRY.sniff)(bytes) {
        guarded("PNG", || png::read_rgba8(bytes, limits))
    } else if (jpeg::ENTRY.sniff)(bytes) {
        guarded("JPEG", || jpeg::read_rgba8(bytes, limits))
    } else {
        Ok(None)
    }
}

impl Rgba8 {
    /// From interleaved samples of one to four channels: grey, grey and alpha, colours, colours and alpha.
    pub(super) fn of(width: usize, height: usize, samples: &[u8]) -> Option<Rgba8> {
        let pixels = width.checked_mul(height).filter(|&pixels| pixels > 0)?;
        let texels = match samples.len() / pixels {
            1 => samples.iter().map(|&y| [y, y, y, 255]).collect(),
            2 => samples.as_chunks::<2>().0.iter().map(|&[y, a]| [y, y, y, a]).collect(),
            3 => samples.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
            4 => samples.as_chunks::<4>().0.to_vec(),
            _ => return None,
        };
        Some(Rgba8 { width, height, texels })
    }
}
