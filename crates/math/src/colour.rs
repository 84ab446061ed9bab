//! Linear Rec. 709 colour, and sRGB for input and output.

use crate::transcendental::powf;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// A linear Rec. 709 triple: a radiance, a reflectance or a weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Rgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

impl Rgb {
    /// No light.
    pub const BLACK: Rgb = Rgb::grey(0.0);
    /// One in every channel.
    pub const WHITE: Rgb = Rgb::grey(1.0);

    /// Creates a colour from three channels.
    pub const fn new(r: f32, g: f32, b: f32) -> Rgb {
        Rgb { r, g, b }
    }

    /// Grey, with this value in every channel.
    pub const fn grey(value: f32) -> Rgb {
        Rgb { r: value, g: value, b: value }
    }

    /// Creates a colour from an array in the order red, green, blue.
    pub const fn from_array(c: [f32; 3]) -> Rgb {
        Rgb { r: c[0], g: c[1], b: c[2] }
    }

    /// Converts to an array in the order red, green, blue.
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// Rec. 709 luminance.
    #[inline]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// The maximum channel.
    #[inline]
    pub fn max_channel(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// True when every channel is exactly zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self == Rgb::BLACK
    }

    /// True when no channel is infinite or NaN.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Applies a function to every channel.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Rgb {
        Rgb::new(f(self.r), f(self.g), f(self.b))
    }

    /// Clamps every channel to `low..=high`.
    #[inline]
    pub fn clamp(self, low: f32, high: f32) -> Rgb {
        self.map(|c| c.clamp(low, high))
    }

    /// Linear interpolation: `self` at 0, `other` at 1.
    #[inline]
    pub fn lerp(self, other: Rgb, t: f32) -> Rgb {
        self * (1.0 - t) + other * t
    }
}

macro_rules! channelwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Rgb {
            type Output = Rgb;
            #[inline]
            fn $method(self, o: Rgb) -> Rgb { Rgb::new(self.r $op o.r, self.g $op o.g, self.b $op o.b) }
        }
    };
}
channelwise!(Add, add, +);
channelwise!(Sub, sub, -);
channelwise!(Mul, mul, *);
channelwise!(Div, div, /);

impl Mul<f32> for Rgb {
    type Output = Rgb;
    #[inline]
    fn mul(self, s: f32) -> Rgb {
        self.map(|c| c * s)
    }
}
impl Div<f32> for Rgb {
    type Output = Rgb;
    #[inline]
    fn div(self, s: f32) -> Rgb {
        self.map(|c| c / s)
    }
}
impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Rgb) {
        *self = *self + o;
    }
}
impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Rgb) {
        *self = *self * o;
    }
}
impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}
impl std::iter::Sum for Rgb {
    fn sum<I: Iterator<Item = Rgb>>(iter: I) -> Rgb {
        iter.fold(Rgb::BLACK, Add::add)
    }
}
impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, channel: usize) -> &f32 {
        match channel {
            0 => &self.r,
            1 => &self.g,
            2 => &self.b,
            _ => panic!("a colour has three channels, not {channel}"),
        }
    }
}

/// Linear value to sRGB-encoded, both 0..=1. [IEC 61966-2-1]
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * powf(linear, 1.0 / 2.4) - 0.055 }
}

/// sRGB-encoded value to linear, both 0..=1. [IEC 61966-2-1]
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { powf((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values computed by hand from the standard: an error common to both directions would pass a round trip.
    #[test]
    fn srgb_is_the_curve_of_the_standard() {
        for (encoded, linear) in [(0.02, 0.001_548), (0.5, 0.214_041), (188.0 / 255.0, 0.502_886), (1.0, 1.0)]
        {
            assert!((srgb_decode(encoded) - linear).abs() < 2e-6, "{encoded}: {}", srgb_decode(encoded));
            assert!((srgb_encode(linear) - encoded).abs() < 1e-5, "{linear}: {}", srgb_encode(linear));
        }
    }

    #[test]
    fn luminance_is_that_of_rec_709() {
        let of = |r: f32, g: f32, b: f32| Rgb::new(r, g, b).luminance();
        assert_eq!([of(1.0, 0.0, 0.0), of(0.0, 1.0, 0.0), of(0.0, 0.0, 1.0)], [0.2126, 0.7152, 0.0722]);
    }

    #[test]
    fn arithmetic_is_by_channels() {
        let (a, b) = (Rgb::new(1.0, 2.0, 4.0), Rgb::new(8.0, 2.0, 0.5));
        assert_eq!((a + b, a - b), (Rgb::new(9.0, 4.0, 4.5), Rgb::new(-7.0, 0.0, 3.5)));
        assert_eq!((a * b, a / b), (Rgb::new(8.0, 4.0, 2.0), Rgb::new(0.125, 1.0, 8.0)));
        assert_eq!((a * 2.0, a / 2.0), (Rgb::new(2.0, 4.0, 8.0), Rgb::new(0.5, 1.0, 2.0)));
        let mut sum = a;
        sum += b;
        sum *= b;
        sum *= 0.5;
        assert_eq!(sum, Rgb::new(36.0, 4.0, 1.125));
        assert_eq!([a, b, a].into_iter().sum::<Rgb>(), Rgb::new(10.0, 6.0, 8.5));
        assert_eq!((a.lerp(b, 0.25), a.max_channel()), (Rgb::new(2.75, 2.0, 3.125), 4.0));
        assert_eq!(([a[0], a[1], a[2]], a.to_array()), ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0]));
        assert_eq!(a.clamp(1.5, 3.0), Rgb::new(1.5, 2.0, 3.0));
        assert!(Rgb::BLACK.is_black() && !Rgb::new(0.0, 0.0, 1e-30).is_black());
        for odd in [f32::NAN, f32::INFINITY] {
            let one_odd = [Rgb::new(odd, 0.0, 0.0), Rgb::new(0.0, odd, 0.0), Rgb::new(0.0, 0.0, odd)];
            assert!(a.is_finite() && one_odd.iter().all(|colour| !colour.is_finite()));
        }
    }

    #[test]
    fn srgb_round_trips_every_byte() {
        for byte in 0..=255u8 {
            let linear = srgb_decode(f32::from(byte) / 255.0);
            assert_eq!((srgb_encode(linear) * 255.0).round() as u8, byte);
        }
    }
}
