//! Textures on surfaces: images and procedural textures.
mod channel;
mod image;
mod levels;
pub(crate) mod mipmaps;
pub(crate) mod octaves;
mod procedural;
mod sampling;
mod together;
mod uv;

pub use channel::Channel;
pub use image::{ComputedTexels, Image, Texels};
pub use levels::Levels;
pub use procedural::{BuildPattern, Formula, Parts, Pattern, TEXTURES, TextureEntry};
pub use sampling::{Filter, UvTransform, Wrap};
pub(crate) use together::{AT_ONCE, LookUps, Seen};
pub use uv::{Patch, UvPair};

use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// An image placed on a surface, in linear light or plain numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The file that it came from, relative to the scene.
    pub name: String,
    /// Texels; textures may share them.
    pub image: Arc<Image>,
    /// Whether it holds numbers, such as roughness, rather than colours: files store numbers without a curve.
    pub is_data: bool,
    /// Values beyond the left and right edges, and beyond the upper and lower edges.
    pub wrap: [Wrap; 2],
    /// Values between texels.
    pub filter: Filter,
    /// Placement, if it is not from 0 to 1.
    pub transform: Option<UvTransform>,
    /// A factor on every texel; for a single channel, red.
    pub factor: Rgb,
    /// The channel that is used, as a grey, if only one is.
    pub channel: Option<Channel>,
    /// If given, filtered values below it become 0, and all others 1.
    pub threshold: Option<f32>,
    /// Whether it uses the second set of texture coordinates.
    pub second_uv: bool,
    /// The coarser levels of the image, once a render has asked for them.
    pub levels: Levels,
}

impl Texture {
    /// An image that is repeated, filtered linearly and otherwise unchanged.
    pub fn of(name: &str, image: Arc<Image>, is_data: bool) -> Texture {
        Texture {
            name: name.to_owned(),
            image,
            is_data,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
            transform: None,
            factor: Rgb::WHITE,
            channel: None,
            threshold: None,
            second_uv: false,
            levels: Levels::default(),
        }
    }

    /// [`Texture::of`] from `width * height` texels in rows, the top one first.
    pub fn new(name: &str, width: usize, height: usize, texels: Vec<Rgb>, is_data: bool) -> Texture {
        let texels = Texels::Floats { colours: texels, alpha: Vec::new() };
        Texture::of(name, Arc::new(Image { width, height, texels }), is_data)
    }

    /// A placeholder for a missing image: squares of magenta and black, which are hard to overlook.
    pub fn missing(name: &str) -> Texture {
        let square =
            |i: usize| if (i + i / 8).is_multiple_of(2) { [255, 0, 255, 255] } else { [0, 0, 0, 255] };
        let image = Image { width: 8, height: 8, texels: Texels::Bytes((0..64).map(square).collect()) };
        Texture { filter: Filter::Nearest, ..Texture::of(name, Arc::new(image), false) }
    }

    /// A placeholder for an unreadable image of a light: a uniform grey with a radiance of 0.5.
    pub fn missing_light(name: &str) -> Texture {
        let image = Image {
            width: 8,
            height: 8,
            texels: Texels::Floats { colours: vec![Rgb::grey(0.5); 64], alpha: Vec::new() },
        };
        Texture::of(name, Arc::new(image), true)
    }

    /// Texels per row.
    pub fn width(&self) -> usize {
        self.image.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.image.height
    }

    /// The texel of a column and a row, counted from the upper left, fully processed.
    ///
    /// # Panics
    /// When there is no such texel.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> Rgb {
        self.finished(self.raw(&self.image, x, y))
    }

    /// All texels in rows, the top one first.
    pub fn texels(&self) -> impl Iterator<Item = Rgb> + '_ {
        let count = if self.image.is_whole() { self.width() * self.height() } else { 0 };
        (0..count).map(|i| self.texel(i % self.width(), i / self.width()))
    }

    /// The maximum of each channel over all texels, at least 0.
    pub(crate) fn maximum(&self) -> Rgb {
        let greater = |a: Rgb, b: Rgb| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b));
        let rises = self.factor.to_array().iter().all(|c| *c >= 0.0);
        match &self.image.texels {
            // Larger bytes are larger numbers, so that only the largest need to be decoded.
            Texels::Bytes(bytes) if rises && self.image.is_whole() => {
                let image = Image { width: 1, height: 1, texels: Texels::Bytes(vec![largest(bytes)]) };
                self.finished(self.raw(&image, 0, 0))
            }
            _ => self.texels().fold(Rgb::BLACK, greater),
        }
    }

    /// The colour at texture coordinates, v upwards; white if there is no image.
    ///
    /// For a wide patch, if there are coarser levels, it comes from a level whose texels are at most half as wide:
    /// finer detail is averaged, so that fewer samples suffice.
    #[inline]
    pub fn at(&self, patch: impl Into<Patch>) -> Rgb {
        self.seen_in(&patch.into())
    }

    #[inline(never)]
    fn seen_in(&self, patch: &Patch) -> Rgb {
        let set = usize::from(self.second_uv);
        self.look_up(self.image_for(patch), patch.at.0[set])
    }

    /// The image, or a coarser level of it, that a patch is looked up in.
    #[inline(always)]
    fn image_for(&self, patch: &Patch) -> &Image {
        let set = usize::from(self.second_uv);
        let (uv, level) = (patch.at.0[set], self.level_for(patch.width[set]));
        let is_picture = std::ptr::eq(level, &*self.image);
        if is_picture || self.is_beyond_clamped_edge(uv) { &self.image } else { level }
    }

    /// True beyond an edge that is clamped: a coarser level would also contain what is inside the edge.
    fn is_beyond_clamped_edge(&self, uv: Vec2) -> bool {
        let at = self.placed(uv);
        let beyond = |wrap: Wrap, x: f32| wrap == Wrap::Clamp && !(0.0..=1.0).contains(&x);
        beyond(self.wrap[0], at.x) || beyond(self.wrap[1], at.y)
    }

    /// The position of coordinates in the image, downwards from its upper left corner.
    #[inline(always)]
    fn placed(&self, uv: Vec2) -> Vec2 {
        let uv = Vec2::new(uv.x, 1.0 - uv.y);
        self.transform.map_or(uv, |transform| transform.apply(uv))
    }

    /// The colour at coordinates of its own set.
    pub fn at_one(&self, uv: Vec2) -> Rgb {
        self.look_up(&self.image, uv)
    }

    /// The coarsest level of the image that suffices for a patch of this width.
    #[inline(always)]
    fn level_for(&self, width: Vec2) -> &Image {
        if width == Vec2::ZERO {
            return &self.image;
        }
        self.levels.with_texels_of(self.half_in_texels(width)).unwrap_or(&self.image)
    }

    /// Half of a patch's width, in texels, along the axis that has fewer.
    #[inline(always)]
    fn half_in_texels(&self, width: Vec2) -> f32 {
        let width = self.transform.map_or(width, |transform| transform.widen(width));
        (width.x * self.width() as f32).min(width.y * self.height() as f32) * 0.5
    }

    /// True if a patch may be wide enough for a coarser level.
    pub(crate) fn has_level_for(&self, widths: [Vec2; 2]) -> bool {
        self.half_in_texels(widths[usize::from(self.second_uv)]) >= 2.0
    }

    #[inline]
    fn look_up(&self, image: &Image, uv: Vec2) -> Rgb {
        if let Texels::Formula(formula) = &image.texels {
            return self.eval_procedural(&**formula, uv);
        }
        let Some((indices, at)) = self.four_around(image, uv) else { return Rgb::WHITE };
        self.finished(match self.filter {
            Filter::Nearest => image.texel(indices[0], self.channel, self.is_data),
            Filter::Linear => image.bilinear(indices, at, self.channel, self.is_data),
        })
    }

    /// The indices of the texels around a point, the upper two first, and its place between them; if the filter takes the
    /// nearest, that is the first. `None` where nothing can be looked up.
    #[inline(always)]
    fn four_around(&self, image: &Image, uv: Vec2) -> Option<([usize; 4], [f32; 2])> {
        if !image.is_whole() || !uv.is_finite() {
            return None;
        }
        let uv = self.placed(uv);
        let (width, height) = (image.width, image.height);
        let [wrap_x, wrap_y] = self.wrap;
        let (x, y) = (uv.x * width as f32, uv.y * height as f32);
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        let half = if self.filter == Filter::Nearest { 0.0 } else { 0.5 };
        let ([x0, x1], fx) = wrap_x.pair(x - half, width);
        let ([y0, y1], fy) = wrap_y.pair(y - half, height);
        let (above, below) = (y0 * width, y1 * width);
        Some(([above + x0, above + x1, below + x0, below + x1], [fx, fy]))
    }

    /// A procedural texture at texture coordinates; wrap and filter have no effect on it.
    #[inline(never)]
    fn eval_procedural(&self, formula: &dyn ComputedTexels, uv: Vec2) -> Rgb {
        let downwards = |uv: Vec2| Vec2::new(uv.x, 1.0 - uv.y);
        let uv = self.transform.map_or(uv, |transform| downwards(transform.apply(downwards(uv))));
        if !uv.is_finite() {
            return Rgb::WHITE;
        }
        self.finished(Channel::of(self.channel, formula.at(uv)))
    }

    /// A number at texture coordinates: the selected channel, otherwise the luminance.
    #[inline]
    pub fn number(&self, patch: impl Into<Patch>) -> f32 {
        self.number_of(self.at(patch))
    }

    /// The number that a colour of this texture stands for.
    #[inline(always)]
    fn number_of(&self, colour: Rgb) -> f32 {
        if self.channel.is_some() { colour.r } else { colour.luminance() }
    }

    #[inline]
    fn raw(&self, image: &Image, x: usize, y: usize) -> Rgb {
        image.texel(y * image.width + x, self.channel, self.is_data)
    }

    #[inline]
    fn finished(&self, texel: Rgb) -> Rgb {
        let factor = if self.channel.is_some() { Rgb::grey(self.factor.r) } else { self.factor };
        let texel = texel * factor;
        match self.threshold {
            Some(threshold) => texel.map(|c| if c < threshold { 0.0 } else { 1.0 }),
            None => texel,
        }
    }
}

/// A number that may vary over a surface.
#[derive(Clone, Debug)]
pub struct NumberMap {
    /// The number, where there is no texture.
    pub number: f32,
    /// The minimum and maximum of the texture's values.
    pub range: [f32; 2],
    /// The texture, if there is one; for colours their luminance is used.
    pub texture: Option<Arc<Texture>>,
}

impl NumberMap {
    /// The number at texture coordinates.
    #[inline(always)]
    pub fn at(&self, patch: impl Into<Patch>) -> f32 {
        match &self.texture {
            // NaN becomes the minimum. Look up the point alone: few numbers of a material are proportional to the
            // light.
            Some(texture) => self.within(texture.number(patch.into().at)),
            None => self.number,
        }
    }

    #[inline(always)]
    fn within(&self, number: f32) -> f32 {
        number.max(self.range[0]).min(self.range[1])
    }
}

/// A colour that may vary over a surface.
#[derive(Clone, Debug)]
pub struct ColourMap {
    /// The colour, or the factor on the texture.
    pub colour: Rgb,
    /// The texture, if there is one.
    pub texture: Option<Arc<Texture>>,
}

impl ColourMap {
    /// The colour at texture coordinates.
    #[inline(always)]
    pub fn at(&self, patch: impl Into<Patch>) -> Rgb {
        match &self.texture {
            Some(texture) => self.colour * texture.at(patch),
            None => self.colour,
        }
    }
}

/// The maximum of each channel.
fn largest(texels: &[[u8; 4]]) -> [u8; 4] {
    const TEXELS: usize = 16;
    let (blocks, rest) = texels.as_chunks::<TEXELS>();
    let mut largest = [[0; 4]; TEXELS];
    for block in blocks {
        for (largest, byte) in largest.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
            *largest = (*largest).max(*byte);
        }
    }
    let greater = |a: [u8; 4], b: &[u8; 4]| std::array::from_fn(|i| a[i].max(b[i]));
    largest.iter().chain(rest).fold([0; 4], greater)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(wrap: Wrap, filter: Filter) -> Texture {
        let texels = (0..4).map(|i| Rgb::grey(i as f32)).collect();
        Texture { wrap: [wrap; 2], filter, ..Texture::new("", 4, 1, texels, true) }
    }

    fn reds(texture: &Texture, us: &[f32]) -> Vec<f32> {
        us.iter().map(|&u| texture.at(Vec2::new(u, 0.5)).r).collect()
    }

    #[test]
    fn edges_repeat_mirror_and_clamp() {
        let us = [-0.125, 0.125, 0.875, 1.125, 1.375];
        assert_eq!(reds(&row(Wrap::Repeat, Filter::Nearest), &us), [3., 0., 3., 0., 1.]);
        assert_eq!(reds(&row(Wrap::Mirror, Filter::Nearest), &us), [0., 0., 3., 3., 2.]);
        assert_eq!(reds(&row(Wrap::Clamp, Filter::Nearest), &us), [0., 0., 3., 3., 3.]);
        let between = [0.0, 0.25, 1.0];
        assert_eq!(reds(&row(Wrap::Repeat, Filter::Linear), &between), [1.5, 0.5, 1.5]);
        assert_eq!(reds(&row(Wrap::Mirror, Filter::Linear), &between), [0.0, 0.5, 3.0]);
        assert_eq!(reds(&row(Wrap::Clamp, Filter::Linear), &between), [0.0, 0.5, 3.0]);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f32::MAX, f32::MIN, f32::NAN, f32::INFINITY] {
                assert!(row(wrap, Filter::Linear).at(Vec2::splat(u)).is_finite());
            }
        }
    }

    #[test]
    fn bytes_are_the_same_picture_as_floats() {
        let bytes = [[0u8, 64, 255, 128], [10, 20, 30, 255]];
        let image = Arc::new(Image { width: 2, height: 1, texels: Texels::Bytes(bytes.to_vec()) });
        let colours = Texture::of("", image.clone(), false);
        assert_eq!(colours.texel(0, 0).g, bilux_math::colour::srgb_decode(64.0 / 255.0));
        let alpha = Texture { channel: Some(Channel::A), ..Texture::of("", image.clone(), false) };
        assert_eq!(alpha.texel(0, 0), Rgb::grey(128.0 / 255.0), "alpha has no curve");
        let cut = Texture { threshold: Some(0.75), ..alpha };
        assert_eq!((cut.texel(0, 0), cut.texel(1, 0)), (Rgb::BLACK, Rgb::WHITE));
        let green = Texture {
            channel: Some(Channel::G),
            factor: Rgb::new(0.5, 9.0, 9.0),
            ..Texture::of("", image, true)
        };
        assert_eq!(green.number(Vec2::new(0.25, 0.5)), 32.0 / 255.0);
    }

    #[test]
    fn the_maximum_is_that_of_all_texels() {
        let bytes = [[0u8, 64, 200, 128], [10, 20, 30, 255], [9, 65, 1, 7]];
        let image = Arc::new(Image { width: 3, height: 1, texels: Texels::Bytes(bytes.to_vec()) });
        for factor in [Rgb::WHITE, Rgb::new(0.5, 0.0, 3.0), Rgb::new(-1.0, 1.0, 1.0)] {
            for (is_data, channel) in [(false, None), (true, None), (true, Some(Channel::A))] {
                let texture = Texture { factor, channel, ..Texture::of("", image.clone(), is_data) };
                let greater = |a: Rgb, b: Rgb| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b));
                assert_eq!(texture.maximum(), texture.texels().fold(Rgb::BLACK, greater));
            }
        }
    }

    #[test]
    fn uv_transforms_use_downward_v() {
        // The second texel of the row fills the square; then half a turn about the upper left corner.
        let part = UvTransform::new([0.25, 0.0], 0.0, [0.25, 1.0]);
        let texture = Texture { transform: Some(part), ..row(Wrap::Repeat, Filter::Nearest) };
        assert_eq!(reds(&texture, &[0.1, 0.9]), [1.0, 1.0]);
        let quarter = UvTransform::new([0.0, 0.0], std::f32::consts::FRAC_PI_2, [1.0, 1.0]);
        let turned = quarter.apply(Vec2::new(0.0, 1.0));
        assert!((turned - Vec2::X).length() < 1e-6, "{turned}");
        // A patch that is turned is as wide along one coordinate as it was along the other, by its factor.
        let wide =
            UvTransform::new([0.1, 0.7], std::f32::consts::FRAC_PI_2, [3.0, 0.5]).widen(Vec2::new(0.4, 0.2));
        assert!((wide - Vec2::new(0.1, 1.2)).length() < 1e-6, "{wide}");
    }
}
