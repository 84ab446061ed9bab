//! A frame: a picture as bytes for a browser, with what is known of it.

use bilux::Error;
use bilux::pictures::{Picture, WriteOptions, write_bytes};
use serde_json::{Value, json};

/// The quality of JPEGs of pictures that soon give way to better ones.
const QUALITY: u8 = 82;

/// A picture as it is sent.
pub(crate) struct Frame {
    /// Its number; later frames have higher numbers.
    pub(crate) number: u64,
    /// The length of the header in four bytes, the lowest first; the header, in JSON; and the bytes of the picture.
    pub(crate) message: axum::body::Bytes,
}

/// What is known of a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    /// Counts the pictures that were begun: frames of one picture refine each other.
    pub(crate) picture: u64,
    /// Samples of each pixel.
    pub(crate) samples: u32,
    /// Samples of each pixel that there will be.
    pub(crate) total: u32,
    /// Samples a second, all pixels together.
    pub(crate) rate: f64,
    /// Rays a second.
    pub(crate) rays: f64,
    /// The noise, relative to the light; unknown at first.
    pub(crate) noise: Option<f32>,
    /// Whether it is one of the small, quick pictures that are shown while the camera moves.
    pub(crate) is_preview: bool,
    /// What is shown: `picture`, or a layer of it.
    pub(crate) shown: &'static str,
    /// Whether the picture rests: it is stored without loss.
    pub(crate) rests: bool,
    /// What the integrator has chosen, if it chooses.
    pub(crate) choice: Option<String>,
    /// Where the camera is: position, then the point that it looks at.
    pub(crate) eye: [[f64; 3]; 2],
}

impl Frame {
    /// A frame of a picture; `full` is the size of the picture that it refines into.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn new(
        number: u64,
        picture: &Picture,
        options: &WriteOptions,
        full: [u32; 2],
        facts: &Facts,
    ) -> Result<Frame, Error> {
        let format = if facts.rests { "png" } else { "jpeg" };
        let options = WriteOptions { quality: QUALITY, ..*options };
        let bytes = write_bytes(format, picture, &options)?;
        let header = header(number, picture, format, full, facts).to_string();
        let length = u32::try_from(header.len()).unwrap_or(u32::MAX).to_le_bytes();
        let message = [&length[..], header.as_bytes(), &bytes].concat().into();
        Ok(Frame { number, message })
    }
}

fn header(number: u64, picture: &Picture, format: &str, full: [u32; 2], facts: &Facts) -> Value {
    json!({
        "frame": number,
        "picture": facts.picture,
        "type": format!("image/{format}"),
        "size": [picture.width(), picture.height()],
        "full": full,
        "samples": facts.samples,
        "total": facts.total,
        "rate": facts.rate,
        "rays": facts.rays,
        "noise": facts.noise,
        "preview": facts.is_preview,
        "shown": facts.shown,
        "rests": facts.rests,
        "choice": facts.choice,
        "eye": facts.eye,
    })
}
