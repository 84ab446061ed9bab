//! The textures of a material, looked up together: the texels are read before any of them is used, so that reads that miss
//! the caches overlap, and textures of one size and placement share the search for them.

use super::{ColourMap, Filter, Image, NumberMap, Patch, Texels, Texture, UvPair};
use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// The textures, in the order in which their colours are taken.
#[derive(Default)]
pub(crate) struct LookUps(Vec<LookUp>);

struct LookUp {
    texture: Arc<Texture>,
    /// Whether it is looked up in a patch, otherwise at a point.
    is_filtered: bool,
    /// Whether its texels are bytes, and it blends four of them.
    is_of_bytes: bool,
    /// Whether its placement is that of the one before.
    is_placed_alike: bool,
}

/// The colours of up to `N` textures at a point, which their maps take in order.
#[derive(Clone, Copy)]
pub(crate) struct Seen<const N: usize> {
    colours: [Rgb; N],
    next: usize,
}

/// Groups of four texels that are read before any is used: a core has no more reads under way.
pub(crate) const AT_ONCE: usize = 16;

const NO_PATCH: Patch = Patch { at: UvPair([Vec2::ZERO; 2]), width: [Vec2::ZERO; 2] };

/// Location of four texels.
#[derive(Clone, Copy)]
struct Place<'a> {
    bytes: &'a [[u8; 4]],
    indices: [usize; 4],
    /// The place between the four.
    at: [f32; 2],
    /// The size of the image.
    size: [usize; 2],
}

impl Place<'_> {
    const NOWHERE: Place<'static> = Place { bytes: &[], indices: [0; 4], at: [0.0; 2], size: [0; 2] };
}

/// Four texels, if there are any to be read.
type Four = Option<[[u8; 4]; 4]>;

/// Reads texels. There is nothing else in this loop, so that as many reads as possible are under way.
#[inline(always)]
fn read(places: &[Place], read: &mut [Four; AT_ONCE]) {
    for (Place { bytes, indices: [a, b, c, d], .. }, four) in places.iter().zip(read) {
        *four = match (bytes.get(*a), bytes.get(*b), bytes.get(*c), bytes.get(*d)) {
            (Some(a), Some(b), Some(c), Some(d)) => Some([*a, *b, *c, *d]),
            _ => None,
        };
    }
}

impl LookUps {
    /// Adds the texture of a map, if it has one.
    pub(crate) fn add_colour(&mut self, map: &ColourMap) {
        self.add(map.texture.as_ref(), true);
    }

    /// [`LookUps::add_colour`] for a number, looked up at points: few numbers of a material are proportional to the light.
    pub(crate) fn add_number(&mut self, map: &NumberMap) {
        self.add(map.texture.as_ref(), false);
    }

    /// Look-up of one texture at points.
    pub(crate) fn of_points(texture: &Arc<Texture>) -> LookUps {
        let mut one = LookUps::default();
        one.add(Some(texture), false);
        one
    }

    /// True if none of the maps has a texture.
    pub(crate) fn are_none(&self) -> bool {
        self.0.is_empty()
    }

    fn add(&mut self, texture: Option<&Arc<Texture>>, is_filtered: bool) {
        let Some(texture) = texture else { return };
        let place = |t: &Texture| (t.wrap, t.transform, t.second_uv);
        let image = &texture.image;
        self.0.push(LookUp {
            texture: texture.clone(),
            is_filtered,
            is_of_bytes: image.is_bytes() && image.is_whole() && texture.filter == Filter::Linear,
            is_placed_alike: self.0.last().is_some_and(|last| place(&last.texture) == place(texture)),
        });
    }

    /// The colours at a point.
    #[inline]
    pub(crate) fn at<const N: usize>(&self, patch: &Patch) -> Seen<N> {
        let mut seen = Seen::NOTHING;
        let (mut last, mut begin) = (Place::NOWHERE, 0);
        for look_ups in self.0.chunks(AT_ONCE) {
            let (mut places, mut four) = ([Place::NOWHERE; AT_ONCE], [None; AT_ONCE]);
            for (place, look_up) in places.iter_mut().zip(look_ups) {
                *place = look_up.place(patch, &last);
                last = *place;
            }
            read(&places[..look_ups.len()], &mut four);
            for (i, look_up) in look_ups.iter().enumerate() {
                seen.put(begin + i, look_up.colour(four[i], places[i].at, patch));
            }
            begin += AT_ONCE;
        }
        seen
    }

    /// [`LookUps::at`] for up to [`AT_ONCE`] points.
    #[inline]
    pub(crate) fn at_each<const N: usize>(
        &self,
        points: impl ExactSizeIterator<Item = Patch>,
    ) -> [Seen<N>; AT_ONCE] {
        let (mut patches, count) = ([NO_PATCH; AT_ONCE], points.len().min(AT_ONCE));
        patches.iter_mut().zip(points).for_each(|(patch, point)| *patch = point);
        let mut seen = [Seen::NOTHING; AT_ONCE];
        let (mut places, mut four) = ([Place::NOWHERE; AT_ONCE], [None; AT_ONCE]);
        for (i, look_up) in self.0.iter().enumerate() {
            for (place, patch) in places.iter_mut().zip(&patches[..count]) {
                *place = look_up.place(patch, place);
            }
            read(&places[..count], &mut four);
            for (k, patch) in patches[..count].iter().enumerate() {
                seen[k].put(i, look_up.colour(four[k], places[k].at, patch));
            }
        }
        seen
    }
}

impl LookUp {
    /// Location of its texels; `last` is the place in the texture before.
    #[inline(always)]
    fn place<'a>(&'a self, patch: &Patch, last: &Place) -> Place<'a> {
        let texture = &*self.texture;
        let image = if self.is_filtered { texture.image_for(patch) } else { &texture.image };
        let Texels::Bytes(bytes) = &image.texels else { return Place::NOWHERE };
        let size = [image.width, image.height];
        if !self.is_of_bytes {
            return Place::NOWHERE;
        }
        if self.is_placed_alike && last.size == size {
            return Place { bytes, size, ..*last };
        }
        match texture.four_around(image, patch.at.0[usize::from(texture.second_uv)]) {
            Some((indices, at)) => Place { bytes, indices, at, size },
            None => Place::NOWHERE,
        }
    }

    #[inline(always)]
    fn colour(&self, four: Four, at: [f32; 2], patch: &Patch) -> Rgb {
        let texture = &*self.texture;
        match four {
            Some(four) => texture.finished(Image::blended(four, at, texture.channel, texture.is_data)),
            None if self.is_filtered => texture.at(*patch),
            None => texture.at(patch.at),
        }
    }
}

impl<const N: usize> Seen<N> {
    const NOTHING: Seen<N> = Seen { colours: [Rgb::BLACK; N], next: 0 };

    #[inline(always)]
    fn put(&mut self, i: usize, colour: Rgb) {
        if let Some(seen) = self.colours.get_mut(i) {
            *seen = colour;
        }
    }

    /// The next colour.
    #[inline(always)]
    pub(crate) fn take(&mut self) -> Rgb {
        let colour = self.colours.get(self.next).copied().unwrap_or(Rgb::BLACK);
        self.next += 1;
        colour
    }

    /// The colour of the next map.
    #[inline(always)]
    pub(crate) fn colour(&mut self, map: &ColourMap) -> Rgb {
        if map.texture.is_some() { map.colour * self.take() } else { map.colour }
    }

    /// The number of the next map.
    #[inline(always)]
    pub(crate) fn number(&mut self, map: &NumberMap) -> f32 {
        match &map.texture {
            // NaN becomes the minimum.
            Some(texture) => map.within(texture.number_of(self.take())),
            None => map.number,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, Image, Texels, UvTransform, Wrap, mipmaps};
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    fn bytes(width: usize, height: usize, salt: u64) -> Texture {
        let texel = |i: usize| hash_words([salt, i as u64]).to_le_bytes();
        let texels = (0..width * height).map(|i| *texel(i).first_chunk::<4>().unwrap()).collect();
        Texture::of("", Arc::new(Image { width, height, texels: Texels::Bytes(texels) }), salt % 2 == 1)
    }

    /// Textures of every kind, next to others of the same placement and of another.
    fn textures() -> Vec<Arc<Texture>> {
        let floats = (0..64).map(|i| Rgb::new(i as f32, 2.0, -0.5)).collect();
        let turned = Some(UvTransform::new([0.25, 0.5], 0.7, [3.0, -2.0]));
        let all = vec![
            bytes(16, 8, 2),
            bytes(16, 8, 3),
            Texture { channel: Some(Channel::G), ..bytes(16, 8, 5) },
            Texture { transform: turned, ..Texture::new("", 8, 8, floats, true) },
            // Placed as the one before, of which no place is known, and not as those before that.
            Texture { transform: turned, ..bytes(16, 8, 7) },
            Texture { filter: Filter::Nearest, ..bytes(16, 8, 9) },
            bytes(16, 8, 11),
            Texture { wrap: [Wrap::Clamp, Wrap::Mirror], ..bytes(16, 8, 12) },
            Texture { second_uv: true, factor: Rgb::new(2.0, 0.5, 1.0), ..bytes(16, 8, 13) },
            bytes(8, 16, 14),
            Texture { threshold: Some(0.5), ..bytes(16, 8, 15) },
            bytes(64, 64, 16),
            Texture { channel: Some(Channel::A), ..bytes(64, 64, 18) },
        ];
        let all: Vec<Arc<Texture>> = all.into_iter().map(Arc::new).collect();
        mipmaps::build(&all.iter().filter(|texture| mipmaps::has_use(texture)).collect::<Vec<_>>());
        all
    }

    #[test]
    fn many_together_are_what_each_is_alone() {
        const N: usize = 26;
        let textures = textures();
        let mut look_ups = LookUps::default();
        for texture in &textures {
            look_ups.add_colour(&ColourMap { colour: Rgb::WHITE, texture: Some(texture.clone()) });
            look_ups.add(Some(texture), false);
        }
        assert_eq!(look_ups.0.len(), N);
        let number = |i: u64| 4.0 * unit_f32(hash_words([i]) as u32) - 1.5;
        let patch = |i: u64| {
            let uv = |k| match i {
                3 => Vec2::new(f32::NAN, 0.5),
                5 => Vec2::splat(f32::INFINITY),
                _ => Vec2::new(number(8 * i + k), number(8 * i + k + 1)),
            };
            let width = if i.is_multiple_of(3) { Vec2::ZERO } else { Vec2::splat(number(8 * i + 6).abs()) };
            Patch { at: UvPair([uv(0), uv(2)]), width: [width, width * 0.25] }
        };
        let mut is_coarse = false;
        for begin in (0..400).step_by(AT_ONCE - 1) {
            let patches: Vec<Patch> = (begin..begin + AT_ONCE as u64 - 1).map(patch).collect();
            let each = look_ups.at_each::<N>(patches.iter().copied());
            for (patch, each) in patches.iter().zip(each) {
                let (mut one, mut each) = (look_ups.at::<N>(patch), each);
                for texture in &textures {
                    for wanted in [texture.at(*patch), texture.at(patch.at)] {
                        let bits = |colour: Rgb| colour.to_array().map(f32::to_bits);
                        assert_eq!([one.take(), each.take()].map(bits), [bits(wanted); 2]);
                    }
                    is_coarse |= texture.at(*patch) != texture.at(patch.at);
                }
            }
        }
        assert!(is_coarse, "no patch is wide enough for a coarser level");
    }
}
