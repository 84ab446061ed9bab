//! Mipmaps: an image at half of its resolution, at a quarter, and so on, for pixels that cover more than one texel.
//! [Williams 1983]

use super::image::{Image, Texels};
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_math::parallel::for_each;
use std::sync::{Arc, LazyLock, OnceLock};

/// The coarser levels of a texture's image, finest first; empty until a render asks for them.
///
/// They derive from the image alone, and so compare as equal.
#[derive(Clone, Debug, Default)]
pub struct Levels(OnceLock<Arc<[Image]>>);

impl Levels {
    /// Stores levels, unless there are some.
    pub(super) fn fill(&self, levels: Arc<[Image]>) {
        // Another thread may have been faster, with the same result.
        let _ = self.0.set(levels);
    }

    /// True before they are stored.
    pub(super) fn is_unfilled(&self) -> bool {
        self.0.get().is_none()
    }
}

impl PartialEq for Levels {
    fn eq(&self, _: &Levels) -> bool {
        true
    }
}

impl Levels {
    /// The coarser levels, if they were built.
    #[inline]
    pub fn coarser(&self) -> &[Image] {
        self.0.get().map_or(&[], |levels| levels)
    }

    /// The coarsest level whose texels are at most `width` texels of the image wide; `None` for the image itself.
    #[inline]
    pub(super) fn with_texels_of(&self, width: f32) -> Option<&Image> {
        let coarser = self.coarser();
        // NaN is not at least 2 either.
        if width >= 2.0 && !coarser.is_empty() {
            let doubled =
                (width.to_bits() >> (f32::MANTISSA_DIGITS - 1)) as usize + 1 - f32::MAX_EXP as usize;
            return coarser.get(doubled.min(coarser.len()) - 1);
        }
        None
    }
}

/// Builds each level from the previous one, with half as many texels per row and column, rounded down.
///
/// Each texel is the mean of those that it covers. All levels together are at most a third of the image.
pub(super) fn of(image: &Image, is_data: bool) -> Arc<[Image]> {
    let size = [image.width, image.height];
    match &image.texels {
        Texels::Bytes(bytes) => of_bytes(size, bytes, if is_data { &PLAIN } else { &SRGB }),
        Texels::Floats { colours, alpha } => of_floats(size, colours, alpha),
        Texels::Formula(_) => Vec::new(),
    }
    .into()
}

pub(super) fn is_divisible([width, height]: [usize; 2]) -> bool {
    width.min(height) >= 2
}

/// Levels of at most this many texels keep sixteen bits per channel for the next level: rounding errors are then too
/// few to average out.
const FEW: usize = 1 << 18;

/// Averages light if bytes are colours.
fn of_bytes(mut size: [usize; 2], bytes: &[[u8; 4]], curve: &Curve) -> Vec<Image> {
    let (mut levels, mut wide) = (Vec::<Image>::new(), None::<Vec<[u16; 4]>>);
    while is_divisible(size) {
        let last = match levels.last().map(|level| &level.texels) {
            Some(Texels::Bytes(bytes)) => bytes,
            _ => bytes,
        };
        let widened = |texel: [u8; 4]| curve.widened(texel);
        let [width, height] = size.map(|side| side / 2);
        let texels = if width * height > FEW {
            each(size, last, |texels| curve.narrowed(mean_of_wide(texels, widened)))
        } else {
            let next = match &wide {
                Some(wide) => each(size, wide, |texels| mean_of_wide(texels, |texel| texel)),
                None => each(size, last, |texels| mean_of_wide(texels, widened)),
            };
            wide.insert(next).iter().map(|&texel| curve.narrowed(texel)).collect()
        };
        levels.push(Image { width, height, texels: Texels::Bytes(texels) });
        size = [width, height];
    }
    levels
}

fn of_floats(mut size: [usize; 2], colours: &[Rgb], alpha: &[f32]) -> Vec<Image> {
    let mut levels: Vec<Image> = Vec::new();
    while is_divisible(size) {
        let (colours, alpha) = match levels.last().map(|level| &level.texels) {
            Some(Texels::Floats { colours, alpha }) => (&colours[..], &alpha[..]),
            _ => (colours, alpha),
        };
        let channel = |texels: Covered<Rgb>, channel: usize| mean(texels, |texel| texel[channel]);
        let texels = Texels::Floats {
            colours: each(size, colours, |texels| {
                Rgb::new(channel(texels, 0), channel(texels, 1), channel(texels, 2))
            }),
            alpha: if alpha.is_empty() {
                Vec::new()
            } else {
                each(size, alpha, |texels| mean(texels, |texel| texel))
            },
        };
        size = size.map(|side| side / 2);
        let [width, height] = size;
        levels.push(Image { width, height, texels });
    }
    levels
}

/// The texels that one texel of the next level covers.
#[derive(Clone, Copy)]
enum Covered<'a, T> {
    /// Four whole texels.
    Four([T; 4]),
    /// Parts of the texels of up to three columns and rows, as integer weights.
    Parts {
        /// Each row, from its first covered texel on.
        rows: [&'a [T]; 3],
        down: [u32; 3],
        across: [u32; 3],
    },
}

impl<T: Copy> Covered<'_, T> {
    /// Calls `take` with each texel and its weight.
    #[inline(always)]
    fn for_each(self, mut take: impl FnMut(T, u64)) {
        match self {
            Covered::Four(four) => four.into_iter().for_each(|texel| take(texel, 1)),
            Covered::Parts { rows, down, across } => {
                for (row, down) in rows.into_iter().zip(down).filter(|(_, part)| *part > 0) {
                    for (texel, across) in row.iter().zip(across).filter(|(_, part)| *part > 0) {
                        take(*texel, u64::from(down) * u64::from(across));
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn total(self) -> u64 {
        match self {
            Covered::Four(_) => 4,
            Covered::Parts { down, across, .. } => {
                u64::from(down.iter().sum::<u32>()) * u64::from(across.iter().sum::<u32>())
            }
        }
    }
}

/// Parts of texels `2 * i` and the next two that texel `i` of the next level covers, in a row of `n`.
///
/// If `n` is odd, it covers slightly more than two.
fn parts(i: usize, n: usize) -> [u32; 3] {
    if n.is_multiple_of(2) { [1, 1, 0] } else { [n / 2 - i, n / 2, i + 1].map(|part| part as u32) }
}

/// All texels of the next level.
fn each<S: Copy + Sync, T: Default + Copy + Send>(
    size: [usize; 2],
    fine: &[S],
    mean: impl Fn(Covered<S>) -> T + Sync,
) -> Vec<T> {
    /// The number of texels worth a thread.
    const PIECE: usize = 1 << 14;
    let [width, height] = size.map(|side| side / 2);
    let is_even = size.iter().all(|side| side.is_multiple_of(2));
    let mut texels = vec![T::default(); width * height];
    let of_row = |(y, texels): (usize, &mut [T])| {
        let row = |y: usize| fine.get(y * size[0]..(y + 1) * size[0]).unwrap_or(&[]);
        let rows = [row(2 * y), row(2 * y + 1), row(2 * y + 2)];
        if is_even {
            let pairs = rows[0].chunks_exact(2).zip(rows[1].chunks_exact(2));
            for (texel, (above, below)) in texels.iter_mut().zip(pairs) {
                *texel = mean(Covered::Four([above[0], above[1], below[0], below[1]]));
            }
            return;
        }
        let down = parts(y, size[1]);
        for (x, texel) in texels.iter_mut().enumerate() {
            let rows = rows.map(|row| row.get(2 * x..).unwrap_or(&[]));
            *texel = mean(Covered::Parts { rows, down, across: parts(x, size[0]) });
        }
    };
    let together = PIECE.div_ceil(width);
    for_each(texels.chunks_mut(width * together).enumerate(), |(piece, texels)| {
        (piece * together..).zip(texels.chunks_mut(width)).for_each(of_row);
    });
    texels
}

/// Tables for averaging bytes: the value of each byte in 65,535ths, and the nearest byte of each such value.
struct Curve {
    light: [u16; 256],
    bytes: Vec<u8>,
}

/// Colours, averaged as light.
static SRGB: LazyLock<Curve> = LazyLock::new(|| Curve::new(srgb_decode));

/// Numbers, averaged as they are.
static PLAIN: LazyLock<Curve> = LazyLock::new(|| Curve::new(|number| number));

impl Curve {
    fn new(decode: impl Fn(f32) -> f32) -> Curve {
        let light: [u16; 256] =
            std::array::from_fn(|byte| (decode(byte as f32 / 255.0) * 65535.0).round() as u16);
        let mut bytes = vec![u8::MAX; 1 << 16];
        for byte in (0..u8::MAX).rev() {
            let [this, next] = [byte, byte + 1].map(|b| usize::from(light[usize::from(b)]));
            bytes[..=(this + next) / 2].fill(byte);
        }
        Curve { light, bytes }
    }

    /// A texel in 65,535ths; alpha is linear.
    #[inline(always)]
    fn widened(&self, [r, g, b, a]: [u8; 4]) -> [u16; 4] {
        let light = |byte: u8| self.light[usize::from(byte)];
        [light(r), light(g), light(b), 257 * u16::from(a)]
    }

    #[inline(always)]
    fn narrowed(&self, [r, g, b, a]: [u16; 4]) -> [u8; 4] {
        let byte = |light: u16| self.bytes[usize::from(light)];
        [byte(r), byte(g), byte(b), ((u32::from(a) + 128) / 257) as u8]
    }
}

#[inline(always)]
fn mean_of_wide<T: Copy>(texels: Covered<T>, widened: impl Fn(T) -> [u16; 4]) -> [u16; 4] {
    if let Covered::Four(four) = texels {
        let [a, b, c, d] = four.map(widened);
        let mean = |i: usize| (u32::from(a[i]) + u32::from(b[i]) + u32::from(c[i]) + u32::from(d[i]) + 2) / 4;
        return [0, 1, 2, 3].map(|i| mean(i) as u16);
    }
    let (mut sums, total) = ([0u64; 4], texels.total());
    texels.for_each(|texel, part| {
        sums.iter_mut().zip(widened(texel)).for_each(|(sum, channel)| *sum += u64::from(channel) * part);
    });
    sums.map(|sum| ((sum + total / 2) / total) as u16)
}

fn mean<T: Copy>(texels: Covered<T>, number: impl Fn(T) -> f32) -> f32 {
    let mut sum = 0.0;
    texels.for_each(|texel, part| sum += f64::from(number(texel)) * part as f64);
    (sum / texels.total() as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::super::mipmaps::build;
    use super::super::{Patch, Texture, UvPair, Wrap};
    use super::*;
    use bilux_math::Vec2;

    /// Numbers from 0 to 1 that resemble noise.
    fn noise(i: usize) -> f32 {
        (bilux_math::hash::hash_words([i as u64]) >> 40) as f32 / (1u64 << 24) as f32
    }

    fn means(image: &Image, is_data: bool) -> [f64; 4] {
        let mean = |channel| {
            let texture =
                Texture { channel: Some(channel), ..Texture::of("", Arc::new(image.clone()), is_data) };
            let sum: f64 = texture.texels().map(|texel| f64::from(texel.r)).sum();
            sum / (image.width * image.height) as f64
        };
        use super::super::Channel::{A, B, G, R};
        [R, G, B, A].map(mean)
    }

    fn noisy_bytes(width: usize, height: usize) -> Image {
        let byte = |i: usize| (noise(i) * 255.99) as u8;
        let texel =
            |i: usize| [byte(i), byte(3 * i + 1) / 8, if i.is_multiple_of(3) { 255 } else { 0 }, byte(5 * i)];
        Image { width, height, texels: Texels::Bytes((0..width * height).map(texel).collect()) }
    }

    #[test]
    fn every_level_keeps_the_mean_of_the_image() {
        for (width, height) in [(64, 64), (61, 64), (37, 29), (2, 2), (3, 3), (2, 50), (127, 255)] {
            let floats = Image {
                width,
                height,
                texels: Texels::Floats {
                    colours: (0..width * height)
                        .map(|i| Rgb::new(noise(i), 40.0 * noise(i * 7), 0.5))
                        .collect(),
                    alpha: (0..width * height).map(|i| noise(i * 3)).collect(),
                },
            };
            let bytes = noisy_bytes(width, height);
            // Half of a byte, and half of the step in light from one byte to the next, at most 0.9% for the brightest.
            let kinds = [(floats, false, 1e-6), (bytes.clone(), true, 0.502 / 255.0), (bytes, false, 0.0045)];
            for (image, is_data, tolerance) in kinds {
                let (levels, wanted) = (of(&image, is_data), means(&image, is_data));
                assert_eq!(levels.len(), width.min(height).ilog2() as usize, "{width}x{height}");
                let texels: usize = levels.iter().map(|level| level.width * level.height).sum();
                assert!(3 * texels <= width * height);
                for level in levels.iter() {
                    let found = means(level, is_data);
                    for (a, b) in found.into_iter().zip(wanted) {
                        let size = (level.width, level.height);
                        assert!(
                            (a - b).abs() <= tolerance * b.max(1.0),
                            "{size:?}: {found:?}, not {wanted:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn uniform_levels_stay_uniform_and_light_is_averaged() {
        let texel = [3, 130, 254, 77];
        let even = Image { width: 11, height: 6, texels: Texels::Bytes(vec![texel; 66]) };
        for is_data in [false, true] {
            for level in of(&even, is_data).iter() {
                assert_eq!(level.texels, Texels::Bytes(vec![texel; level.width * level.height]));
            }
        }
        let board = |i: usize| if (i + i / 4).is_multiple_of(2) { [0; 4] } else { [255; 4] };
        let board = Image { width: 4, height: 4, texels: Texels::Bytes((0..16).map(board).collect()) };
        assert_eq!(of(&board, false)[0].texels, Texels::Bytes(vec![[188, 188, 188, 128]; 4]));
        assert_eq!(of(&board, true)[1].texels, Texels::Bytes(vec![[128; 4]; 1]));
    }

    #[test]
    fn textures_of_one_picture_share_its_levels() {
        let image = Arc::new(noisy_bytes(16, 8));
        let textures = [false, false, true].map(|is_data| Arc::new(Texture::of("", image.clone(), is_data)));
        build(&textures.each_ref());
        let [a, b, c] = &textures;
        let shared = |a: &Texture, b: &Texture| std::ptr::eq(a.levels.coarser(), b.levels.coarser());
        assert!(shared(a, b) && !shared(a, c));
        assert_eq!(a.levels.coarser().len(), 3);
    }

    #[test]
    fn a_level_is_chosen_by_its_texels() {
        let texture = Arc::new(Texture::of("", Arc::new(noisy_bytes(16, 16)), true));
        build(&[&texture]);
        let side = |width: f32| texture.levels.with_texels_of(width).map_or(16, |level| level.width);
        let widths = [0.0, 1.9, 2.0, 3.9, 4.0, 8.0, 15.0, 16.0, 1e9, f32::INFINITY];
        assert_eq!(widths.map(side), [16, 16, 8, 8, 4, 2, 2, 1, 1, 1]);
        assert_eq!([f32::NAN, -1.0].map(side), [16, 16]);
    }

    #[test]
    fn beyond_a_clamped_edge_is_that_edge_alone() {
        // White except for a black column on the left.
        let texels = (0..32 * 32).map(|i| Rgb::grey(if i % 32 == 0 { 0.0 } else { 1.0 })).collect();
        let edge = Texture { wrap: [Wrap::Clamp, Wrap::Repeat], ..Texture::new("", 32, 32, texels, false) };
        let edge = Arc::new(edge);
        build(&[&edge]);
        let seen = |u: f32| {
            let at = UvPair::from(Vec2::new(u, 0.3));
            edge.at(Patch { at, width: [Vec2::splat(0.5); 2] }).r
        };
        assert_eq!([-3.0, -0.01, 1.01, 2.0].map(seen), [0.0, 0.0, 1.0, 1.0]);
        assert!((0.5..1.0).contains(&seen(0.1)), "{}", seen(0.1));
    }
}
