//! Options for writing pictures.

use crate::tonemap::{TONEMAPS, ToneMapEntry};
use crate::{Picture, PictureError};
use bilux_math::Rgb;

/// Options for writers. Each writer uses only those that it knows.
#[derive(Clone, Copy, Debug)]
pub struct WriteOptions {
    /// Bits per sample of PNG and PPM.
    pub bit_depth: BitDepth,
    /// Exposure in stops, for pictures for a display; other formats keep the light as it is.
    pub exposure: f32,
    /// The tone map for pictures for a display.
    pub tone_map: &'static ToneMapEntry,
    /// Background colour behind transparent pixels, in linear display light, in pictures for a display.
    pub behind: Option<Rgb>,
    /// Quality of a JPEG, from 1 to 100: higher is more faithful and larger.
    pub quality: u8,
}

/// Number of steps of a sample in a picture for a display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 256 steps.
    #[default]
    Eight,
    /// 65,536 steps.
    Sixteen,
}

/// The default JPEG quality: no visible artefacts, in a sixth of a PNG's bytes.
pub const DEFAULT_QUALITY: u8 = 92;

impl WriteOptions {
    /// True if bytes in sRGB come out as they are.
    pub(super) fn is_neutral(&self) -> bool {
        self.exposure == 0.0 && self.tone_map.entry.name == TONEMAPS[0].entry.name && self.behind.is_none()
    }
}

impl Default for WriteOptions {
    fn default() -> WriteOptions {
        WriteOptions {
            bit_depth: BitDepth::default(),
            exposure: 0.0,
            tone_map: &TONEMAPS[0],
            behind: None,
            quality: DEFAULT_QUALITY,
        }
    }
}

/// Refuses a picture without colours.
pub(super) fn require_colour(format: &'static str, picture: &Picture) -> Result<(), PictureError> {
    if picture.rgb_planes().is_some() {
        return Ok(());
    }
    let names: Vec<&str> = picture.channels().iter().map(|c| &c.name[..]).collect();
    let names =
        if names.is_empty() { "no channels".to_owned() } else { format!("only {}", names.join(", ")) };
    let what = format!(
        "it needs the channels R, G and B, or Y, but the picture has {names}; write .exr instead, or choose a layer"
    );
    Err(PictureError::Unwritable { format, what })
}
