//! Pictures as sets of planes: the type that every reader returns and every writer takes.

use crate::PictureError;
use crate::crop::Crop;
use crate::limits::MAX_SIDE;
use bilux_math::Rgb;
use bilux_math::colour::{srgb_decode, srgb_encode};
use bilux_math::parallel::for_each;
use bilux_math::transcendental::powf;
use std::collections::BTreeMap;

/// A picture: named planes of `width * height` samples, with row 0 at the top.
///
/// The main picture's planes are `R`, `G`, `B` (or `Y` for grey) and `A`; those of a layer are prefixed with its
/// name, as in EXR: `albedo.R`, `normal.X`. Samples are kept exactly as the file has them; [`Picture::colour_space`]
/// and [`Picture::alpha`] say what they mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    pub(crate) channels: Vec<Channel>,
    integer_planes: Vec<IntegerPlane>,
    /// The meaning of the samples of colour channels.
    pub colour_space: ColourSpace,
    /// Whether `A` has been multiplied into the colours.
    pub alpha: Alpha,
    /// Texts that are stored with the picture, if its format can hold them.
    pub metadata: BTreeMap<String, String>,
    /// Which part of a larger picture this is, if it is one. Only EXR stores it.
    pub crop: Option<Crop>,
    /// Faults of the file that the picture was read from, though it could be read.
    pub warnings: Vec<String>,
}

/// One named plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Such as `R`, or `albedo.R`.
    pub name: String,
    /// `width * height` samples in rows from the top.
    pub samples: Vec<f32>,
}

/// One named plane of integers, preserved bit for bit (EXR's `uint`): object numbers, or one 32-bit limb of a film's
/// fixed-point sums.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IntegerPlane {
    /// Such as `id`, or `sum.R.0`.
    pub name: String,
    /// `width * height` samples in rows from the top.
    pub samples: Vec<u32>,
}

/// The meaning of a colour sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ColourSpace {
    /// Proportional to light, Rec. 709 primaries.
    #[default]
    LinearRec709,
    /// Encoded for a display, by the sRGB curve. [IEC 61966-2-1]
    Srgb,
    /// Light to this power (a PNG's `gAMA`); alpha and data are not affected.
    Gamma(f32),
}

/// Whether the colours of a picture have been multiplied by its alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alpha {
    /// Premultiplied, as in EXR: the light that the pixel emits.
    #[default]
    Premultiplied,
    /// Straight, as in PNG: the colour of what is there.
    Straight,
}

/// Samples that are infinite or NaN.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// Their number, over all channels.
    pub count: u64,
    /// The first one, channel by channel: channel, x, y.
    pub first: Option<(String, usize, usize)>,
}

impl Picture {
    /// Creates a picture without planes. Returns an error if a side is zero or too long.
    pub fn new(width: usize, height: usize) -> Result<Picture, PictureError> {
        let fits = |side: usize| side > 0 && side as u64 <= MAX_SIDE;
        if !fits(width) || !fits(height) || width.checked_mul(height).is_none() {
            let what = format!("a picture of {width} x {height} pixels: a side is 1 to {MAX_SIDE} pixels");
            return Err(PictureError::Malformed(what));
        }
        Ok(Picture {
            width,
            height,
            channels: Vec::new(),
            integer_planes: Vec::new(),
            colour_space: ColourSpace::default(),
            alpha: Alpha::default(),
            metadata: BTreeMap::new(),
            crop: None,
            warnings: Vec::new(),
        })
    }

    /// Creates a linear picture from `width * height` colours in rows from the top.
    pub fn from_rgb(width: usize, height: usize, pixels: Vec<Rgb>) -> Result<Picture, PictureError> {
        let mut picture = Picture::new(width, height)?;
        picture.push_rgb("", &pixels)?;
        Ok(picture)
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Total number of pixels: the length of every plane.
    pub fn pixel_count(&self) -> usize {
        self.width * self.height
    }

    /// Adds a plane. Returns an error if the name is taken or empty, or the length is not `width * height`.
    pub fn push_channel(&mut self, name: impl Into<String>, samples: Vec<f32>) -> Result<(), PictureError> {
        let name = name.into();
        self.check_plane(&name, samples.len())?;
        self.channels.push(Channel { name, samples });
        Ok(())
    }

    /// Adds a plane of integers, under the same conditions.
    pub fn push_integer_plane(
        &mut self,
        name: impl Into<String>,
        samples: Vec<u32>,
    ) -> Result<(), PictureError> {
        let name = name.into();
        self.check_plane(&name, samples.len())?;
        self.integer_planes.push(IntegerPlane { name, samples });
        Ok(())
    }

    /// Adds three planes, `R`, `G` and `B`, to the layer of this name ("" for the main picture).
    pub fn push_rgb(&mut self, layer: &str, pixels: &[Rgb]) -> Result<(), PictureError> {
        for (channel, component) in ["R", "G", "B"].into_iter().enumerate() {
            let samples = pixels.iter().map(|pixel| pixel[channel]).collect();
            self.push_channel(qualified(layer, component), samples)?;
        }
        Ok(())
    }

    fn check_plane(&self, name: &str, length: usize) -> Result<(), PictureError> {
        let taken = self.channels.iter().any(|c| c.name == name)
            || self.integer_planes.iter().any(|plane| plane.name == name);
        let what = if name.is_empty() || name.contains('\0') {
            format!("'{name}' is not a valid channel name: it must not be empty or contain zero bytes")
        } else if taken {
            format!("there is already a channel '{name}'")
        } else if length != self.pixel_count() {
            let (width, height) = (self.width, self.height);
            format!(
                "channel '{name}' has {length} samples; {width} x {height} pixels need {}",
                width * height
            )
        } else {
            return Ok(());
        };
        Err(PictureError::Malformed(what))
    }

    /// All planes, in the order in which they were added.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// All integer planes, in the order in which they were added.
    pub fn integer_planes(&self) -> &[IntegerPlane] {
        &self.integer_planes
    }

    /// The samples of one plane.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| &c.samples[..])
    }

    /// The samples of one plane, mutable.
    pub fn channel_mut(&mut self, name: &str) -> Option<&mut [f32]> {
        self.channels.iter_mut().find(|c| c.name == name).map(|c| &mut c.samples[..])
    }

    /// The samples of one integer plane.
    pub fn integer_plane(&self, name: &str) -> Option<&[u32]> {
        self.integer_planes.iter().find(|plane| plane.name == name).map(|plane| &plane.samples[..])
    }

    /// The three planes of the main picture's colour, all the same one if it is grey; `None` if it has no colour.
    pub fn rgb_planes(&self) -> Option<[&[f32]; 3]> {
        match (self.channel("R"), self.channel("G"), self.channel("B"), self.channel("Y")) {
            (Some(r), Some(g), Some(b), _) => Some([r, g, b]),
            (None, None, None, Some(y)) => Some([y; 3]),
            _ => None,
        }
    }

    /// The main picture's colours in rows, as stored; `None` if it has none.
    pub fn to_rgb(&self) -> Option<Vec<Rgb>> {
        let [r, g, b] = self.rgb_planes()?;
        Some((0..self.pixel_count()).map(|i| Rgb::new(r[i], g[i], b[i])).collect())
    }

    /// The main picture as bytes for a display, four per pixel in rows from the top: red, green, blue and alpha,
    /// sRGB-encoded, with straight alpha, which is 255 if the picture has none. `None` if it has no colour. Light
    /// above 1 becomes 255: see [`crate::to_display`] for exposure and tone curves.
    pub fn to_rgba8(&self) -> Option<Vec<u8>> {
        let shown = self.main().into_srgb();
        let [r, g, b] = shown.rgb_planes()?;
        let alpha = shown.channel("A");
        let byte = |sample: f32| quantise(sample, 255.0) as u8;
        let pixel = |i: usize| [byte(r[i]), byte(g[i]), byte(b[i]), alpha.map_or(255, |a| byte(a[i]))];
        Some((0..self.pixel_count()).flat_map(pixel).collect())
    }

    /// The colour of one pixel as stored, black if the picture has no colour. Panics outside the picture, as indexing
    /// a slice does; for whole pictures [`Picture::to_rgb`] is faster.
    pub fn rgb(&self, x: usize, y: usize) -> Rgb {
        let i = self.index(x, y);
        self.rgb_planes().map_or(Rgb::BLACK, |[r, g, b]| Rgb::new(r[i], g[i], b[i]))
    }

    /// The alpha of one pixel, 1 if the picture has none. Panics outside the picture, as indexing a slice does.
    pub fn alpha_at(&self, x: usize, y: usize) -> f32 {
        let i = self.index(x, y);
        self.channel("A").map_or(1.0, |a| a[i])
    }

    fn index(&self, x: usize, y: usize) -> usize {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of {} x {}", self.width, self.height);
        y * self.width + x
    }

    /// A picture of the same size and meaning, without planes and metadata.
    pub(crate) fn like(&self) -> Picture {
        self.like_rows(self.height)
    }

    /// A picture of the same width and meaning and a number of rows, without planes and metadata.
    pub(crate) fn like_rows(&self, height: usize) -> Picture {
        Picture {
            width: self.width,
            height,
            channels: Vec::new(),
            integer_planes: Vec::new(),
            colour_space: self.colour_space,
            alpha: self.alpha,
            metadata: BTreeMap::new(),
            crop: self.crop,
            warnings: self.warnings.clone(),
        }
    }

    /// Counts the samples that are infinite or NaN, and locates the first one.
    pub fn non_finite(&self) -> NonFinite {
        let mut found = NonFinite::default();
        for channel in &self.channels {
            for (i, _) in channel.samples.iter().enumerate().filter(|(_, s)| !s.is_finite()) {
                found.count += 1;
                found.first.get_or_insert_with(|| (channel.name.clone(), i % self.width, i / self.width));
            }
        }
        found
    }

    /// The picture in linear Rec. 709 with premultiplied alpha: the form that light transport uses.
    pub fn into_linear(mut self) -> Picture {
        let space = self.colour_space;
        self.map_colours(|encoded| space.decode(encoded));
        self.colour_space = ColourSpace::LinearRec709;
        if self.alpha == Alpha::Straight {
            self.scale_by_alpha(|colour, alpha| colour * alpha);
            self.alpha = Alpha::Premultiplied;
        }
        self
    }

    /// The picture encoded by the sRGB curve, with straight alpha. Linear values are first clamped to 0..=1: apply a
    /// tone map before if they exceed that.
    pub fn into_srgb(mut self) -> Picture {
        if self.alpha == Alpha::Premultiplied && self.channel("A").is_some() {
            self = self.into_linear();
            self.scale_by_alpha(|colour, alpha| if alpha > 0.0 { colour / alpha } else { colour });
        }
        let space = self.colour_space;
        if space != ColourSpace::Srgb {
            self.map_colours(|sample| srgb_encode(clamp_sample(space.decode(sample), 1.0)));
        }
        self.colour_space = ColourSpace::Srgb;
        self.alpha = Alpha::Straight;
        self
    }

    /// Composites a picture for a display over a background colour of linear light, and removes alpha.
    pub(crate) fn before(self, colour: Rgb) -> Picture {
        let mut picture = self.into_linear();
        let Some(at) = picture.channels.iter().position(|c| c.name == "A") else {
            return picture.into_srgb();
        };
        let alpha = picture.channels.remove(at).samples;
        for (name, behind) in [("R", colour.r), ("G", colour.g), ("B", colour.b), ("Y", colour.luminance())] {
            let samples = picture.channel_mut(name).unwrap_or_default();
            samples.iter_mut().zip(&alpha).for_each(|(sample, alpha)| *sample += (1.0 - alpha) * behind);
        }
        picture.into_srgb()
    }

    /// Applies a function to every sample of the main picture's colour and of every layer's.
    fn map_colours(&mut self, f: impl Fn(f32) -> f32 + Sync) {
        let colours: Vec<bool> = self.channels.iter().map(|c| self.is_colour(&c.name)).collect();
        for (channel, _) in self.channels.iter_mut().zip(colours).filter(|&(_, colour)| colour) {
            let pieces = channel.samples.chunks_mut(PIECE);
            for_each(pieces, |piece| piece.iter_mut().for_each(|sample| *sample = f(*sample)));
        }
    }

    fn scale_by_alpha(&mut self, f: impl Fn(f32, f32) -> f32) {
        let Some(alpha) = self.channel("A").map(<[f32]>::to_vec) else { return };
        for name in ["R", "G", "B", "Y"] {
            let samples = self.channel_mut(name).unwrap_or_default();
            samples.iter_mut().zip(&alpha).for_each(|(colour, &alpha)| *colour = f(*colour, alpha));
        }
    }

    /// True for the channels that hold colour: not alpha, depth or the Y of a vector X, Y, Z.
    fn is_colour(&self, name: &str) -> bool {
        let (layer, component) = name.rsplit_once('.').unwrap_or(("", name));
        match component {
            "R" | "G" | "B" => true,
            "Y" => self.channel(&qualified(layer, "X")).is_none(),
            _ => false,
        }
    }
}

impl ColourSpace {
    /// Decodes a stored sample to a value proportional to light.
    pub fn decode(self, sample: f32) -> f32 {
        match self {
            ColourSpace::LinearRec709 => sample,
            ColourSpace::Srgb => srgb_decode(sample),
            ColourSpace::Gamma(gamma) => powf(sample.max(0.0), 1.0 / gamma),
        }
    }
}

/// Number of samples that one thread processes at a time.
const PIECE: usize = 1 << 14;

/// Clamps a sample to 0..=`most`; NaN becomes 0, whereas `clamp` would keep it.
pub(crate) fn clamp_sample(sample: f32, most: f32) -> f32 {
    if sample > 0.0 { sample.min(most) } else { 0.0 }
}

/// Quantises a sample of 0..=1 to `steps`, rounded half up. In f64, so that every step survives a round trip.
pub(crate) fn quantise(sample: f32, steps: f64) -> u32 {
    (f64::from(clamp_sample(sample, 1.0)) * steps + 0.5).floor() as u32
}

/// A layer's channel: "albedo" and "R" make "albedo.R", "" and "R" make "R".
pub(crate) fn qualified(layer: &str, component: &str) -> String {
    if layer.is_empty() { component.to_owned() } else { format!("{layer}.{component}") }
}
