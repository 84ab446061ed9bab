//! Points of the unit square: Sobol' sequences with hash-based scrambling. [Burley 2020]
//!
//! A point is a pure function of seed, pixel, sample index and dimension; no state is carried from one sample to the
//! next. Each pair of dimensions is the (0, 2)-sequence of Sobol' with a shuffling and a scrambling of its own, so any
//! first 2ⁿ samples of a pixel are evenly distributed over the square.

use bilux_math::Vec2;
use bilux_math::hash::{hash_words, mix64, unit_f32};

/// The random numbers of one sample of one pixel, in order.
///
/// They come in streams: [`PixelSampler::enter`] begins one for each vertex of a path (or node of a ray tree), so the
/// numbers used at one vertex never shift those used at the next.
#[derive(Clone, Debug)]
pub struct PixelSampler {
    pixel: u64,
    /// The sample's index with its bits reversed.
    reversed_index: u32,
    stream: u64,
    dimension: u32,
}

impl PixelSampler {
    /// The random numbers of one sample.
    pub fn new(seed: u64, x: u32, y: u32, index: u32) -> PixelSampler {
        let pixel = hash_words([seed, u64::from(x) << 32 | u64::from(y)]);
        PixelSampler { pixel, reversed_index: index.reverse_bits(), stream: pixel, dimension: 0 }
    }

    /// The numbers of the pixel's first sample.
    pub(crate) fn first(&self) -> PixelSampler {
        PixelSampler { reversed_index: 0, ..self.clone() }
    }

    /// Skips this many numbers or points that are not needed: what follows is the same as if they had been generated.
    #[inline]
    pub fn skip(&mut self, draws: u32) {
        self.dimension += draws;
    }

    /// Begins the stream with this number; a new sampler begins with a different one.
    #[inline]
    pub fn enter(&mut self, stream: u64) {
        self.stream = mix64(self.pixel ^ mix64(stream.wrapping_add(0x9e37_79b9_7f4a_7c15)));
        self.dimension = 0;
    }

    /// The next number in `[0, 1)`.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        self.dimension += 1;
        number(key(self.stream, self.dimension), self.reversed_index)
    }

    /// The next point in `[0, 1)²`.
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        self.dimension += 1;
        point(key(self.stream, self.dimension), self.reversed_index)
    }

    /// A seed for further random numbers, another one after each draw.
    #[inline]
    pub(crate) fn seed(&self) -> u64 {
        self.stream ^ (u64::from(self.reversed_index) << 32 | u64::from(self.dimension))
    }

    /// The state from which [`number`] and [`point`] draw for many paths at once: the stream, and the sample's index
    /// with its bits reversed.
    #[inline]
    pub(crate) fn state(&self) -> (u64, u32) {
        (self.stream, self.reversed_index)
    }
}

/// The key of a dimension of a stream; the first dimension is 1.
#[inline(always)]
pub(crate) fn key(stream: u64, dimension: u32) -> u64 {
    mix64(stream.wrapping_add(u64::from(dimension).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}

/// The number of a dimension in `[0, 1)`.
#[inline(always)]
pub(crate) fn number(key: u64, reversed_index: u32) -> f32 {
    let index = scramble_reversed(reversed_index, key as u32).reverse_bits();
    unit_f32(scramble_reversed(reversed_sobol_0(index), (key >> 32) as u32).reverse_bits())
}

/// The point of a dimension in `[0, 1)²`.
#[inline(always)]
pub(crate) fn point(key: u64, reversed_index: u32) -> Vec2 {
    let index = scramble_reversed(reversed_index, key as u32).reverse_bits();
    let scramble = mix64(key);
    Vec2::new(
        unit_f32(scramble_reversed(reversed_sobol_0(index), scramble as u32).reverse_bits()),
        unit_f32(scramble_reversed(reversed_sobol_1(index), (scramble >> 32) as u32).reverse_bits()),
    )
}

/// A regular pattern over the pixel, for integrators that use no random numbers: multiples of the inverse powers of the
/// plastic number. The first point is the pixel's centre. [Roberts 2018]
pub(crate) fn regular_pattern(index: u32) -> Vec2 {
    const STEP: [u32; 2] = [3_242_174_889, 2_447_445_414];
    let at = |step: u32| unit_f32(0x8000_0000u32.wrapping_add(index.wrapping_mul(step)));
    Vec2::new(at(STEP[0]), at(STEP[1]))
}

/// First dimension of the sequence, bit-reversed: the index itself. [Sobol 1967]
#[inline(always)]
fn reversed_sobol_0(index: u32) -> u32 {
    index
}

/// Second dimension, bit-reversed: the index times Pascal's triangle modulo 2, here in five steps rather than 32.
#[inline(always)]
fn reversed_sobol_1(index: u32) -> u32 {
    let mut x = index;
    x ^= x >> 16;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^= (x & 0xaaaa_aaaa) >> 1;
    x
}

/// A nested uniform scrambling of bit-reversed numbers: each bit is flipped by a hash of the bits below it.
/// [Burley 2020, listing 3; constants of Vegdahl 2021]
#[inline(always)]
fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second dimension from its direction numbers, one for each bit.
    fn sobol_1_by_definition(mut index: u32) -> u32 {
        let (mut direction, mut x) = (1u32 << 31, 0);
        while index != 0 {
            if index & 1 == 1 {
                x ^= direction;
            }
            index >>= 1;
            direction ^= direction >> 1;
        }
        x
    }

    #[test]
    fn the_second_dimension_is_that_of_sobol() {
        for i in 0..10_000u32 {
            let index = i.wrapping_mul(2_654_435_769);
            let reversed = sobol_1_by_definition(index).reverse_bits();
            assert_eq!(reversed_sobol_1(index), reversed, "index {index}");
        }
    }

    /// True when each cell of every 2^a × 2^b grid with a + b = m holds one of 2^m points.
    fn fills_elementary_intervals(points: &[Vec2], m: u32) -> bool {
        (0..=m).all(|a| {
            let mut cells = vec![0; points.len()];
            for p in points {
                let column = (p.x * (1u32 << a) as f32) as usize;
                let row = (p.y * (1u32 << (m - a)) as f32) as usize;
                cells[(row << a) + column] += 1;
            }
            cells.iter().all(|&n| n == 1)
        })
    }

    fn points(m: u32, enter: u64, draw: impl Fn(&mut PixelSampler) -> Vec2) -> Vec<Vec2> {
        let point = |i| {
            let mut sampler = PixelSampler::new(1, 17, 4, i);
            sampler.enter(enter);
            sampler.next_2d();
            draw(&mut sampler)
        };
        (0..1 << m).map(point).collect()
    }

    #[test]
    fn every_pair_is_a_net() {
        for stream in 0..20 {
            for m in [0, 3, 8] {
                assert!(fills_elementary_intervals(&points(m, stream, PixelSampler::next_2d), m));
            }
        }
    }

    #[test]
    fn two_single_dimensions_are_no_net() {
        // Negative control of the test above: the check must reject points that are not a net.
        let singles = |s: &mut PixelSampler| Vec2::new(s.next_1d(), s.next_1d());
        assert!(!fills_elementary_intervals(&points(8, 3, singles), 8));
    }

    #[test]
    fn skipped_dimensions_change_nothing() {
        let mut drawn = PixelSampler::new(5, 3, 9, 77);
        let mut skipped = drawn.clone();
        drawn.next_1d();
        drawn.next_2d();
        skipped.skip(2);
        assert_eq!((drawn.next_1d(), drawn.next_2d()), (skipped.next_1d(), skipped.next_2d()));
    }

    #[test]
    fn the_regular_pattern_begins_in_the_middle_and_fills_the_pixel() {
        assert_eq!(regular_pattern(0), Vec2::splat(0.5));
        let mut cells = [0; 16];
        for i in 0..256 {
            let p = regular_pattern(i);
            cells[(p.y * 4.0) as usize * 4 + (p.x * 4.0) as usize] += 1;
        }
        assert!(cells.iter().all(|n| (13..=19).contains(n)), "{cells:?}");
    }
}
