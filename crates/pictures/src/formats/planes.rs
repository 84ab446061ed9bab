//! From samples in rows to planes.

use crate::PictureError;

/// Splits interleaved samples into planes of `f32`.
pub(super) fn planes_of<'a, T: Copy + 'a>(
    format: &'static str,
    samples: impl Iterator<Item = T> + Clone,
    channels: usize,
    pixels: usize,
    convert: impl Fn(T) -> f32,
) -> Result<Vec<Vec<f32>>, PictureError> {
    let mut planes = Vec::with_capacity(channels);
    for channel in 0..channels {
        let mut plane = crate::limits::reserved(format, pixels)?;
        plane.extend(samples.clone().skip(channel).step_by(channels).take(pixels).map(&convert));
        planes.push(plane);
    }
    Ok(planes)
}
