//! A picture of photons: what the sensor of a camera makes of absolute radiance. [EMVA 1288]
//!
//! The mean number of photons on a pixel follows from the radiance, the lens and the exposure; each of them becomes an electron with the
//! quantum efficiency. What is counted is a Poisson variable of signal and dark current together, cut off at the full well; reading adds
//! normal noise; the converter multiplies, adds the black level, rounds and cuts off. Every random number is a hash of the seed and the
//! place of the pixel in the whole picture, so neither threads nor crops change any.

mod demosaic;
mod parameters;
mod pattern;

use crate::{Picture, PictureError};
use bilux_math::Rgb;
use bilux_math::parallel::for_each;
use bilux_math::photometry::LUMENS_PER_WATT;
use bilux_math::{Stream, poisson};
pub use parameters::SENSOR;
pub use pattern::Pattern;

/// Planck's constant, in J s. [SI 2019]
const PLANCK: f64 = 6.626_070_15e-34;
/// The speed of light in empty space, in m/s. [SI 2019]
const LIGHT_SPEED: f64 = 299_792_458.0;
/// Saturation-based speed times the exposure that saturates, in lx s. [ISO 12232]
const SATURATION_SPEED: f64 = 78.0;

/// A sensor, its lens and its exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// The radiance, in W/(m² sr), that a sample of 1 stands for.
    pub unit: f64,
    /// Exposure time, in seconds.
    pub exposure_time: f64,
    /// Focal length over the diameter of the aperture.
    pub f_number: f64,
    /// The fraction of light that the lens lets through.
    pub transmission: f64,
    /// Side of a pixel, in metres.
    pub pixel_pitch: f64,
    /// The wavelength, in metres, that each channel's light is taken to have.
    pub wavelength: [f64; 3],
    /// Electrons per photon of each channel.
    pub quantum_efficiency: [f64; 3],
    /// The most electrons that a pixel holds.
    pub full_well: f64,
    /// Electrons per second without light.
    pub dark_current: f64,
    /// Standard deviation of the noise of reading, in electrons.
    pub read_noise: f64,
    /// Standard deviation of the pixels' own dark signals (DSNU), in electrons: the same in every picture.
    pub dark_nonuniformity: f64,
    /// Standard deviation of the pixels' own responses (PRNU), as a fraction: the same in every picture.
    pub response_nonuniformity: f64,
    /// Digital numbers per electron; 0 for as many as let the full well reach the largest number.
    pub gain: f64,
    /// Saturation-based ISO speed, which sets the gain; 0 if `gain` does.
    pub iso: f64,
    /// The digital number without any electron.
    pub black_level: f64,
    /// Bits of a digital number.
    pub bit_depth: u32,
    /// The colour filters.
    pub pattern: Pattern,
    /// Chooses the noise.
    pub seed: u64,
}

/// Output of a sensor: digital numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Digital numbers: a plane `Y` if each pixel has one filter or none, otherwise `R`, `G` and `B`. Where the picture is a part of a larger
    /// one, so is this.
    pub raw: Picture,
    /// Number of pixels that have the largest number in any plane.
    pub saturated: u64,
}

impl Sensor {
    /// The digital numbers that the sensor reads of a picture's light.
    ///
    /// Light below zero and light that is not a number count as none; alpha has no effect, since colours are premultiplied.
    ///
    /// # Errors
    /// If the picture has no colours, or the numbers of the sensor leave no room between black and the largest number.
    pub fn read(&self, picture: &Picture) -> Result<Reading, PictureError> {
        let gain = self.checked_gain()?;
        let light = picture.main().into_linear();
        let colours = light.to_rgb().ok_or(PictureError::NoLayer { name: None, known: Vec::new() })?;
        let (width, [left, top]) = (picture.width(), corner(picture));
        let planes = self.pattern.planes();
        let mut raw = Picture::new(width, picture.height())?;
        (raw.crop, raw.metadata) = (picture.crop, picture.metadata.clone());
        let mut saturated = vec![false; picture.pixel_count()];
        for (plane, name) in planes.iter().enumerate() {
            let mut samples = vec![0.0; picture.pixel_count()];
            for_each(samples.chunks_mut(width).enumerate(), |(row, samples)| {
                for (column, sample) in samples.iter_mut().enumerate() {
                    let (x, y) = (left + column as u64, top + row as u64);
                    let light = self.seen(x, y, plane, colours[row * width + column]);
                    *sample = self.number([x, y], plane, light, gain) as f32;
                }
            });
            let most = self.largest_number() as f32;
            saturated.iter_mut().zip(&samples).for_each(|(is_full, &sample)| *is_full |= sample >= most);
            raw.push_channel(*name, samples)?;
        }
        Ok(Reading { raw, saturated: saturated.iter().filter(|is_full| **is_full).count() as u64 })
    }

    /// The light that a reading stands for, in the unit of the picture that was read: the inverse of the sensor's mean response, pixel by pixel
    /// after bilinear interpolation of the colours that the filters hide.
    ///
    /// # Errors
    /// As [`Sensor::read`].
    pub fn developed(&self, raw: &Picture) -> Result<Picture, PictureError> {
        let gain = self.checked_gain()?;
        let electrons = |number: f32| (f64::from(number) - self.black_level) / gain - self.mean_dark();
        let inverse = |channel: usize| 1.0 / (self.electrons_per_radiance(channel) * self.unit);
        let mut picture = Picture::new(raw.width(), raw.height())?;
        (picture.crop, picture.metadata) = (raw.crop, raw.metadata.clone());
        let mosaic = raw.channel("Y").filter(|_| self.pattern.has_filters());
        if let Some(mosaic) = mosaic {
            let pixels = demosaic::bilinear(mosaic, raw.width(), corner(raw), &self.pattern);
            for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
                let light = pixels.iter().map(|pixel| (electrons(pixel[channel]) * inverse(channel)) as f32);
                picture.push_channel(name, light.collect())?;
            }
        } else {
            for plane in raw.channels() {
                // Without filters the light is all of the wavelength of green.
                let channel = "RGB".find(&plane.name).unwrap_or(GREEN);
                let light = plane.samples.iter().map(|&number| (electrons(number) * inverse(channel)) as f32);
                picture.push_channel(plane.name.clone(), light.collect())?;
            }
        }
        Ok(picture)
    }

    /// The mean number of photons that light of this radiance, in W/(m² sr), brings to a pixel in one channel.
    ///
    /// The irradiance behind an aplanatic lens is π sin²θ times the radiance, where sin θ is 1/(2 f-number); a photon has the energy h c/λ.
    /// [EMVA 1288, section 2]
    pub fn photons(&self, radiance: f64, channel: usize) -> f64 {
        let lens = std::f64::consts::PI * self.transmission / (4.0 * self.f_number * self.f_number);
        let energy = radiance * lens * self.pixel_pitch * self.pixel_pitch * self.exposure_time;
        energy * self.wavelength[channel] / (PLANCK * LIGHT_SPEED)
    }

    /// Mean electrons of the dark current.
    pub fn mean_dark(&self) -> f64 {
        self.dark_current * self.exposure_time
    }

    /// The system gain, in digital numbers per electron.
    pub fn system_gain(&self) -> f64 {
        let range = self.largest_number() - self.black_level;
        if self.iso > 0.0 {
            return range / self.electrons_at_saturation();
        }
        if self.gain > 0.0 { self.gain } else { range / self.full_well }
    }

    /// Saturation-based ISO speed, for light of the wavelength of green. [ISO 12232]
    pub fn iso_speed(&self) -> f64 {
        let electrons = ((self.largest_number() - self.black_level) / self.system_gain()).min(self.full_well);
        SATURATION_SPEED * self.electrons_per_lux_second() / electrons
    }

    /// The luminance, in cd/m², of a grey that reaches the largest number or the full well.
    pub fn saturating_luminance(&self) -> f64 {
        let electrons = ((self.largest_number() - self.black_level) / self.system_gain()).min(self.full_well);
        (electrons - self.mean_dark()).max(0.0) / self.electrons_per_radiance(GREEN)
            * f64::from(LUMENS_PER_WATT)
    }

    /// The largest digital number.
    pub fn largest_number(&self) -> f64 {
        ((1u64 << self.bit_depth) - 1) as f64
    }

    fn electrons_per_radiance(&self, channel: usize) -> f64 {
        self.photons(1.0, channel) * self.quantum_efficiency[channel]
    }

    /// Electrons in a pixel that 1 lx s of the light of green makes.
    fn electrons_per_lux_second(&self) -> f64 {
        let energy = self.pixel_pitch * self.pixel_pitch / f64::from(LUMENS_PER_WATT);
        energy * self.wavelength[GREEN] / (PLANCK * LIGHT_SPEED) * self.quantum_efficiency[GREEN]
    }

    fn electrons_at_saturation(&self) -> f64 {
        SATURATION_SPEED * self.electrons_per_lux_second() / self.iso
    }

    fn checked_gain(&self) -> Result<f64, PictureError> {
        let gain = self.system_gain();
        let what = if self.black_level >= self.largest_number() {
            format!(
                "the black level, {}, leaves no room below the largest number of {} bits, {}: lower it, or take more bits",
                self.black_level,
                self.bit_depth,
                self.largest_number()
            )
        } else if !(gain.is_finite() && gain > 0.0) {
            "the sensor answers no light: give its green a quantum efficiency above 0, or leave 'iso' out"
                .to_owned()
        } else {
            return Ok(gain);
        };
        Err(PictureError::Malformed(what))
    }

    /// The mean electrons of light in a pixel, and in which channel.
    fn seen(&self, x: u64, y: u64, plane: usize, light: Rgb) -> f64 {
        let channel = self.pattern.channel(x, y, plane);
        let radiance = match channel {
            Some(channel) => light[channel],
            None => light.luminance(),
        };
        let radiance = f64::from(if radiance > 0.0 { radiance } else { 0.0 });
        (self.electrons_per_radiance(channel.unwrap_or(GREEN)) * radiance * self.unit).min(BRIGHTEST)
    }

    /// The digital number of a pixel with so many mean electrons of light.
    fn number(&self, [x, y]: [u64; 2], plane: usize, light: f64, gain: f64) -> f64 {
        // What is the pixel's own does not depend on the seed.
        let mut own = Stream::new([FIXED, x, y, plane as u64]);
        let (response, dark) = (own.normal(), own.normal());
        let light = light * (1.0 + self.response_nonuniformity * response).max(0.0);
        let dark = (self.mean_dark() + self.dark_nonuniformity * dark).max(0.0);
        let mut stream = Stream::new([self.seed, x, y, plane as u64]);
        let electrons = poisson(light + dark, &mut stream).min(self.full_well);
        let read = electrons + self.read_noise * stream.normal();
        (self.black_level + gain * read + 0.5).floor().clamp(0.0, self.largest_number())
    }
}

/// The channel whose wavelength light without colour has.
const GREEN: usize = 1;

/// Light beyond this fills any well.
const BRIGHTEST: f64 = 1e12;

/// The first word of what is a pixel's own.
const FIXED: u64 = 0x5e45_0001;

/// The pixel at which a picture begins in the one that it is a part of.
fn corner(picture: &Picture) -> [u64; 2] {
    picture.crop.map_or([0; 2], |crop| [crop.x as u64, crop.y as u64])
}
