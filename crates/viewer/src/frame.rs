//! A frame: a picture as bytes for a browser, with what is known of it.

use bilux::Error;
use bilux::pictures::{Picture, WriteOptions, write_bytes};
use serde_json::{Value, json};
use std::time::Duration;

/// The quality of JPEGs of pictures that soon give way to better ones.
const QUALITY: u8 = 82;

/// A picture as it is sent.
pub(crate) struct Frame {
    /// The number of the frame; later frames have higher numbers.
    pub(crate) number: u64,
    /// The length of the header in four bytes, the lowest first; the header, in JSON; and the bytes of the picture.
    pub(crate) message: axum::body::Bytes,
}

/// Facts about a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    /// Which of two pictures it is: `own`, or the `other` one that it is compared with.
    pub(crate) side: &'static str,
    /// Counts the pictures that were begun: frames of one picture refine each other.
    pub(crate) picture: u64,
    /// Samples of each pixel.
    pub(crate) samples: u32,
    /// Samples of each pixel that there will be.
    pub(crate) total: u32,
    /// Seconds that its samples took.
    pub(crate) seconds: f64,
    /// Samples a second, all pixels together.
    pub(crate) rate: f64,
    /// Rays a second.
    pub(crate) rays: f64,
    /// The noise, relative to the light; unknown at first.
    pub(crate) noise: Option<f32>,
    /// Whether it is one of the small, quick pictures that are shown while the camera moves.
    pub(crate) is_preview: bool,
    /// The name of what is shown: `picture`, or a layer of it.
    pub(crate) shown: &'static str,
    /// Whether the picture rests: it is stored without loss.
    pub(crate) rests: bool,
    /// The choice of the integrator, if it chooses.
    pub(crate) choice: Option<String>,
    /// The distance of two pictures that are compared, relative to their light.
    pub(crate) difference: Option<f64>,
    /// The camera: its position, then the point that it looks at.
    pub(crate) eye: [[f64; 3]; 2],
    /// The magnification of the camera, if it was moved; nothing where the scene has it.
    pub(crate) zoom: Option<f64>,
}

impl Facts {
    /// Adds the samples, the time and the rates of a picture of this size: so many samples and rays, which took this time.
    pub(crate) fn of(mut self, [width, height]: [u32; 2], samples: u32, rays: u64, time: Duration) -> Facts {
        let seconds = time.as_secs_f64();
        let pixels = f64::from(width) * f64::from(height);
        (self.samples, self.seconds) = (samples, seconds);
        self.rate = pixels * f64::from(samples) / seconds.max(1e-6);
        self.rays = rays as f64 / seconds.max(1e-6);
        self
    }
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
        "side": facts.side,
        "picture": facts.picture,
        "type": format!("image/{format}"),
        "size": [picture.width(), picture.height()],
        "full": full,
        "samples": facts.samples,
        "total": facts.total,
        "seconds": facts.seconds,
        "rate": facts.rate,
        "rays": facts.rays,
        "noise": facts.noise,
        "preview": facts.is_preview,
        "shown": facts.shown,
        "rests": facts.rests,
        "choice": facts.choice,
        "difference": facts.difference,
        "eye": facts.eye,
        "zoom": facts.zoom,
    })
}
