//! Tone mapping: from the light of a scene to what a display can show. To add a curve, add a file with its `ENTRY`,
//! and a line in the table.

mod aces;
mod agx;
mod exposure;
mod neutral;
mod none;
mod reinhard;

pub use exposure::auto_exposure;

use crate::PictureError;
use crate::error::nearest;
use crate::picture::{Picture, clamp_sample};
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// Every available curve; the first does nothing.
pub static TONEMAPS: &[ToneMapEntry] =
    &[none::ENTRY, agx::ENTRY, neutral::ENTRY, aces::ENTRY, reinhard::ENTRY];

/// One curve.
#[derive(Clone, Copy, Debug)]
pub struct ToneMapEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// From linear Rec. 709 light to linear Rec. 709 for the display: the input is finite and not negative, the
    /// output 0..=1.
    pub map: fn(Rgb) -> Rgb,
}

/// The curve of this name.
pub fn tone_map(name: &str) -> Result<&'static ToneMapEntry, PictureError> {
    TONEMAPS.iter().find(|row| row.entry.name == name).ok_or_else(|| PictureError::UnknownName {
        kind: "tone-mapping curve",
        name: name.to_owned(),
        suggestion: nearest(name, TONEMAPS.iter().map(|row| row.entry.name)),
        known: TONEMAPS.iter().map(|row| row.entry.name).collect::<Vec<_>>().join(", "),
    })
}

/// The main picture prepared for a display: exposed by `exposure` stops, tone mapped, sRGB-encoded, with straight
/// alpha. Layers are dropped. A picture that is already encoded, and needs neither exposure nor a tone map, stays as
/// it is. Returns an error if the picture has no colour.
pub fn to_display(picture: &Picture, exposure: f32, curve: &ToneMapEntry) -> Result<Picture, PictureError> {
    if picture.rgb_planes().is_none() {
        let what =
            "a picture for a display needs the channels R, G and B, or Y; choose a layer that has them";
        return Err(PictureError::Malformed(what.to_owned()));
    }
    let shown = picture.main();
    if exposure == 0.0 && curve.entry.name == TONEMAPS[0].entry.name {
        return Ok(shown.into_srgb());
    }
    let mut shown = shown.into_linear();
    let gain = bilux_math::transcendental::powf(2.0, exposure);
    apply(&mut shown, |colour| (curve.map)(colour.map(|c| clamp_sample(c * gain, f32::MAX))));
    Ok(shown.into_srgb())
}

/// Maps the main picture's colours; alpha is divided out before and multiplied in afterwards.
fn apply(picture: &mut Picture, map: impl Fn(Rgb) -> Rgb) {
    let Some(colours) = picture.to_rgb() else { return };
    let alpha = picture.channel("A").map(<[f32]>::to_vec);
    let mapped: Vec<Rgb> = colours
        .into_iter()
        .enumerate()
        .map(|(i, colour)| match alpha.as_ref().map(|alpha| alpha[i]) {
            Some(alpha) if alpha > 0.0 => map(colour / alpha) * alpha,
            _ => map(colour),
        })
        .collect();
    for (component, index) in [("R", 0), ("G", 1), ("B", 2), ("Y", 0)] {
        let samples = picture.channel_mut(component).unwrap_or_default();
        samples
            .iter_mut()
            .zip(&mapped)
            .for_each(|(sample, colour)| *sample = clamp_sample(colour[index], 1.0));
    }
}
