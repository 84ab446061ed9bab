//! Passages along a line through media, and how far a path comes along it.

use crate::media::interaction::MediumPoint;
use bilux_math::Rgb;
use bilux_math::hash::mix64;
use bilux_scene::media::{Draws, FreePath, mean};
use bilux_scene::{Medium, Ray, Surface};

/// A line through media on which nothing blocks light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// The fraction of light that passes.
    pub(crate) transmittance: Rgb,
    /// The probability that a walk along it, in either direction, has no event on the way.
    pub(crate) survival: f32,
    /// Survival probability of a walk in each channel.
    pub(crate) survivals: Rgb,
    /// The densities of an event at its start, by a walk from its end, and at its end, by a walk from its start; per metre,
    /// where the walk comes so far.
    pub(crate) hazards: [f32; 2],
    /// The panes on the way.
    pub(crate) panes: u32,
    is_first: bool,
}

/// End of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Arrival {
    /// At a surface.
    Surface(Surface),
    /// In a medium, which scatters there.
    Medium(MediumPoint),
    /// Nowhere: it leaves the scene.
    Escape,
}

/// Travel of a path along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Travelled {
    pub(crate) arrival: Arrival,
    /// The fraction of light that comes so far and is scattered there, over the density with which the path does.
    pub(crate) weight: Rgb,
    /// The densities of walks in each channel, over that of this one.
    pub(crate) odds: Rgb,
    pub(crate) passage: Passage,
    /// The light that media on the way emit.
    pub(crate) emitted: Rgb,
}

/// A part of a ray through a medium that scatters.
pub(crate) struct MediumPart<'t> {
    /// The object that it is in.
    pub(crate) object: u32,
    pub(crate) medium: Medium<'t>,
    /// Distances along the ray, in metres, to where it begins and to where it ends, at a surface or at an event.
    pub(crate) ends: [f32; 2],
    /// Travel of the path up to where the part begins.
    pub(crate) before: &'t Travelled,
}

impl Passage {
    /// Through nothing.
    pub(crate) const CLEAR: Passage = Passage {
        transmittance: Rgb::WHITE,
        survival: 1.0,
        survivals: Rgb::WHITE,
        hazards: [0.0; 2],
        panes: 0,
        is_first: true,
    };

    /// This line, continued by the next.
    #[inline]
    pub(crate) fn then(self, next: FreePath) -> Passage {
        Passage {
            transmittance: self.transmittance * next.transmittance,
            survival: self.survival * next.survival,
            survivals: self.survivals * next.survivals,
            hazards: [if self.is_first { next.hazards[0] } else { self.hazards[0] }, next.hazards[1]],
            is_first: false,
            ..self
        }
    }

    /// This line, beyond a pane that lets this fraction of light straight through; `None` where that is nothing.
    pub(super) fn beyond_pane(self, passed: Rgb) -> Option<Passage> {
        let transmittance = self.transmittance * passed;
        (!passed.is_black()).then_some(Passage { transmittance, panes: self.panes + 1, ..self })
    }

    /// The fraction of light that passes, as part of a path whose walks have these odds in each channel: over the mean density of
    /// all channels rather than that of its own.
    #[inline]
    pub(crate) fn share(&self, odds: Rgb) -> Rgb {
        // Where numbers run out nothing passes.
        if self.survival > 0.0 {
            self.transmittance * (self.survival / mean(odds * self.survivals))
        } else {
            Rgb::BLACK
        }
    }

    /// The density of arriving at its end by a walk from its start, over the density over solid angle over the squared
    /// distance: per area of a surface that the walk meets under this cosine, or per volume (`None`).
    #[inline]
    pub(crate) fn arriving(&self, cos: Option<f32>) -> f32 {
        self.survival * cos.unwrap_or(self.hazards[1])
    }

    /// Density of arriving at its start by a walk from its end, in the terms of [`Passage::arriving`], without the cosine at a surface.
    #[inline]
    pub(crate) fn returning(&self, is_in_medium: bool) -> f32 {
        if is_in_medium { self.survival * self.hazards[0] } else { self.survival }
    }
}

impl Travelled {
    /// At the start.
    pub(crate) const NOWHERE: Travelled = Travelled {
        arrival: Arrival::Escape,
        weight: Rgb::WHITE,
        odds: Rgb::WHITE,
        passage: Passage::CLEAR,
        emitted: Rgb::BLACK,
    };

    /// With light that the next medium emits.
    #[inline]
    pub(super) fn lit(self, emitted: Rgb) -> Travelled {
        Travelled { emitted: self.emitted + self.weight * emitted, ..self }
    }

    /// Past all of this.
    #[inline]
    pub(crate) fn passed(self, part: FreePath) -> Travelled {
        // Where numbers run out the path carries nothing.
        let (weight, odds) = match part.survival > 0.0 {
            true => (part.transmittance / part.survival, part.survivals / part.survival),
            false => (Rgb::BLACK, Rgb::WHITE),
        };
        Travelled {
            weight: self.weight * weight,
            odds: self.odds * odds,
            passage: self.passage.then(part),
            ..self
        }
    }

    /// To an event of a medium at the end of this, where its scattering coefficient and its extinction are these.
    #[inline]
    pub(super) fn scattered(
        self,
        part: FreePath,
        [sigma_s, sigma_t]: [Rgb; 2],
        point: MediumPoint,
    ) -> Travelled {
        let density = part.survival * part.hazards[1];
        let (weight, odds) = match density > 0.0 {
            true => (part.transmittance * sigma_s / density, part.survivals * sigma_t / density),
            false => (Rgb::BLACK, Rgb::WHITE),
        };
        Travelled {
            arrival: Arrival::Medium(point),
            weight: self.weight * weight,
            odds: self.odds * odds,
            passage: self.passage.then(part),
            ..self
        }
    }
}

/// This ray, from behind a surface that it has hit.
pub(crate) fn behind(ray: &Ray, surface: &Surface) -> Ray {
    Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..*ray }
}

/// Random numbers for what varies along a ray, of this line alone: others of the same sample have another direction.
#[inline]
pub(crate) fn draws_along(ray: &Ray, seed: u64) -> Draws {
    let [x, y, z] = ray.direction.map(|c| u64::from(c.to_bits()));
    Draws::new(mix64(seed ^ mix64(x ^ y << 32) ^ z << 16))
}
