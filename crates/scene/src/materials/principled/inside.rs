//! The inside: the medium that light enters below the surface.

use super::maps::{Maps, is_there};
use super::point::{Point, Subsurface, weakened};
use crate::media::{HenyeyGreenstein, Medium, Phase, slab};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::texture::{ColourMap, NumberMap, Patch};
use bilux_math::Rgb;
use bilux_math::transcendental::ln;

/// Boundary that light enters through, and the medium below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inside {
    /// `None` where light does not enter: behind opaque surfaces and thin walls.
    pub(super) medium: Option<Medium<'static>>,
    /// Light is scattered below the surface, as `subsurface_weight` says, by a medium rather than at once.
    pub(super) is_body: bool,
    /// The colour of that medium, and where the surface has another: [`Inside::entering`].
    reference: Rgb,
    /// The index of the boundary.
    pub(super) ior: f32,
    /// Absorption coefficient of the clear part, per metre.
    pub(super) absorbed: Rgb,
}

impl Inside {
    pub(super) fn read(reader: &Reader, maps: &Maps) -> Result<Inside, SceneError> {
        let clear = Clear::read(reader, maps)?;
        let radius = reader.colour("subsurface_radius_scale") * reader.number("subsurface_radius");
        let is_body = !maps.thin && is_there(&maps.subsurface_weight) && !radius.is_black();
        let ior = match is_body {
            true => weakened(maps.specular_ior.number, number_of(&maps.specular_weight)),
            false => maps.specular_ior.number,
        };
        let reference = brightest(&maps.subsurface_color);
        let body = is_body.then(|| {
            let anisotropy = steady(maps.subsurface_anisotropy);
            body(reference, radius, anisotropy, ior)
        });
        let medium = match (clear.medium(maps), body) {
            (Some(clear), Some(body)) => {
                let clear_weight = number_of(&maps.transmission_weight);
                Some(mixed(
                    &clear,
                    &body,
                    (1.0 - clear_weight) * number_of(&maps.subsurface_weight),
                    clear_weight,
                ))
            }
            (clear, body) => clear.or(body),
        };
        Ok(Inside { medium, is_body, reference, ior, absorbed: clear.sigma[0] })
    }

    /// All parameters at a point.
    pub(super) fn point(&self, maps: &Maps, uv: impl Into<Patch>) -> Point {
        let uv = uv.into();
        let point = maps.at(uv);
        if !is_there(&maps.subsurface_weight) {
            return point;
        }
        let weight = maps.subsurface_weight.at(uv);
        let colour = maps.subsurface_color.at(uv).clamp(0.0, 1.0);
        if self.is_body {
            let subsurface = Subsurface::Body { weight, colour, entering: self.entering(colour) };
            return Point { subsurface, body_ior: self.ior, ..point };
        }
        // Without a mean free path it is a diffuse surface; a thin wall is one on both sides.
        let passed = if maps.thin { 0.5 * (1.0 + maps.subsurface_anisotropy) } else { 0.0 };
        let [reflected, passed] = [colour * (1.0 - passed), colour * passed];
        Point { subsurface: Subsurface::Sheet { weight, reflected, passed }, ..point }
    }

    /// The factor on light that enters or leaves where the colour is this. Light that does both at one place has the colour, and each
    /// of the two has it from either end. It is at most 1.
    fn entering(&self, colour: Rgb) -> Rgb {
        let ratio = |colour: f32, reference: f32| {
            if reference > 0.0 { (colour / reference).min(1.0).sqrt() } else { 1.0 }
        };
        let (c, r) = (colour, self.reference);
        Rgb::new(ratio(c.r, r.r), ratio(c.g, r.g), ratio(c.b, r.b))
    }
}

/// Inside of glass and of murky liquids, by `transmission_depth`.
struct Clear {
    /// Absorption and scattering, per metre.
    sigma: [Rgb; 2],
    anisotropy: f32,
}

impl Clear {
    /// The extinction gives transmitted light its colour; scattering is a part of it. [OpenPBR 1.1]
    fn read(reader: &Reader, maps: &Maps) -> Result<Clear, SceneError> {
        let is_deep = !maps.tints_surface;
        if is_deep && maps.transmission_color.texture.is_some() {
            let message = "with a transmission_depth, transmission_color belongs to the inside, which cannot have a texture: \
                 use a colour";
            return Err(SceneError::invalid(message, reader.span("transmission_color")));
        }
        let anisotropy = steady(reader.number("transmission_scatter_anisotropy"));
        if !is_deep {
            return Ok(Clear { sigma: [Rgb::BLACK; 2], anisotropy });
        }
        let depth = reader.number("transmission_depth");
        let sigma_t = maps.transmission_color.colour.map(|c| -ln(c.clamp(DARKEST, 1.0)) / depth);
        let sigma_s = reader.colour("transmission_scatter") * (1.0 / depth);
        if sigma_s.is_black() {
            return Ok(Clear { sigma: [sigma_t, sigma_s], anisotropy });
        }
        let absorbed = sigma_t - sigma_s;
        let least = absorbed.r.min(absorbed.g).min(absorbed.b).min(0.0);
        Ok(Clear { sigma: [absorbed - Rgb::grey(least), sigma_s], anisotropy })
    }

    /// Light enters by transmission; where it is scattered, also by diffuse transmission.
    fn medium(&self, maps: &Maps) -> Option<Medium<'static>> {
        let [sigma_a, sigma_s] = self.sigma;
        let enters = is_there(&maps.transmission_weight) || (is_there(&maps.passing) && !sigma_s.is_black());
        let phase = henyey_greenstein(self.anisotropy);
        (enters && !maps.thin).then_some(Medium { sigma_a, sigma_s, phase, ..Medium::VACUUM })
    }
}

/// The minimum transmission colour: a smaller one would need an absorption beyond the range of numbers.
const DARKEST: f32 = 1e-6;

/// The shortest mean free path, in metres: positions are no more exact than that in scenes of a few metres.
const SHORTEST: f32 = 1e-6;

/// A medium of this mean free path that has this colour below a boundary, at normal incidence. [OpenPBR 1.1]
fn body(colour: Rgb, radius: Rgb, anisotropy: f32, ior: f32) -> Medium<'static> {
    let mut found: [Option<(f32, f32)>; 3] = [None; 3];
    let mut absorbed = [0.0; 3];
    for (i, colour) in colour.to_array().into_iter().enumerate() {
        let known = found.iter().flatten().find(|(known, _)| *known == colour);
        absorbed[i] = known.map_or_else(
            || slab::absorbed_fraction(f64::from(colour), f64::from(anisotropy), f64::from(ior)) as f32,
            |(_, absorbed)| *absorbed,
        );
        found[i] = Some((colour, absorbed[i]));
    }
    let absorbed = Rgb::from_array(absorbed);
    let sigma_t = radius.map(|radius| 1.0 / radius.max(SHORTEST));
    Medium {
        sigma_a: sigma_t * absorbed,
        sigma_s: sigma_t * absorbed.map(|a| 1.0 - a),
        phase: henyey_greenstein(anisotropy),
        ..Medium::VACUUM
    }
}

/// Both media in these parts of the surface are one inside.
fn mixed(clear: &Medium, body: &Medium, body_weight: f32, clear_weight: f32) -> Medium<'static> {
    let share = body_weight / (body_weight + clear_weight).max(f32::MIN_POSITIVE);
    Medium {
        sigma_a: clear.sigma_a.lerp(body.sigma_a, share),
        sigma_s: clear.sigma_s.lerp(body.sigma_s, share),
        phase: if share > 0.0 || !clear.scatters() { body.phase } else { clear.phase },
        ..Medium::VACUUM
    }
}

fn henyey_greenstein(anisotropy: f32) -> Phase {
    Phase::HenyeyGreenstein(HenyeyGreenstein { g: anisotropy })
}

/// A mean cosine that is not all straight on, nor back.
fn steady(anisotropy: f32) -> f32 {
    anisotropy.clamp(-0.99, 0.99)
}

/// A number, or what a texture scales.
fn number_of(map: &NumberMap) -> f32 {
    map.number
}

/// The colour of a body: of a texture, in each channel, what one texel in a hundred is brighter than. Then nothing that the surface
/// does can make light, and a single white texel does not turn all the body white.
fn brightest(map: &ColourMap) -> Rgb {
    let Some(texture) = &map.texture else { return map.colour.clamp(0.0, 1.0) };
    let texels: Vec<Rgb> = match texture.formula() {
        Some(_) => texture.spread(SPREAD).collect(),
        None => texture.texels().collect(),
    };
    let channel = |i: usize| {
        let mut values: Vec<f32> = texels.iter().map(|texel| texel[i]).collect();
        let place = (values.len() * 99 / 100).min(values.len().saturating_sub(1));
        values.select_nth_unstable_by(place, f32::total_cmp).1.to_owned()
    };
    let of_texture =
        if texels.is_empty() { Rgb::WHITE } else { Rgb::new(channel(0), channel(1), channel(2)) };
    (map.colour * of_texture).clamp(0.0, 1.0)
}

/// Points along each side of a procedural texture that stand for all.
const SPREAD: usize = 64;
