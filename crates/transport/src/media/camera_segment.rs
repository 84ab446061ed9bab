//! Camera segment: a ray through media, up to the first surface: fog and smoke, and what they leave of the surface.

use crate::media::{Media, draws_along};
use bilux_math::Rgb;
use bilux_scene::media::mean;
use bilux_scene::{Ray, Surface, Tracer};

/// Segment of a camera ray through media; all of it expected values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraSegment {
    /// The first surface that separates two media, if there is one.
    pub(crate) surface: Option<Surface>,
    /// The fraction of light that comes from there, or from beyond all media.
    pub(crate) transmittance: Rgb,
    /// The fraction of light that media on the way scatter, and as much of what they emit, as the albedo of a surface.
    pub(crate) albedo: Rgb,
    /// The share of it all that media show, 0..=1: in air around things, and behind a surface, as in milk.
    pub(crate) shown: [f32; 2],
    /// The sum of the distances of what they show, in metres, weighted by these shares.
    distance: f32,
}

impl CameraSegment {
    /// The share of what is seen that media show, in air and behind a surface; the surface has the rest. What is absorbed is not seen.
    pub(crate) fn shares(&self) -> [f32; 2] {
        let [air, inside] = self.shown;
        let all = mean(self.transmittance) + air + inside;
        if air + inside > 0.0 { self.shown.map(|shown| shown / all) } else { [0.0; 2] }
    }

    /// Fraction of a pixel that it covers: 1 where there is a surface, otherwise what media stop.
    pub(crate) fn coverage(&self) -> f32 {
        if self.surface.is_some() { 1.0 } else { (1.0 - mean(self.transmittance)).max(0.0) }
    }

    /// The mean distance of what is seen, in metres, and the weight of that, 0..=1; 0 where there is nothing.
    pub(crate) fn depth(&self) -> [f32; 2] {
        let shown = self.shown[0] + self.shown[1];
        match self.surface {
            Some(surface) if shown > 0.0 => {
                let passed = mean(self.transmittance);
                [(passed * surface.t + self.distance) / (passed + shown), 1.0]
            }
            Some(surface) => [surface.t, 1.0],
            None if shown > 0.0 => [self.distance / shown, shown],
            None => [0.0; 2],
        }
    }
}

impl CameraSegment {
    /// Looks along a ray of unit direction that begins in these media, given the first surface along it. Afterwards they are those on the side
    /// that the ray comes from. `each` gets the objects whose media are on the way, with the share that each hides, 0..=1.
    ///
    /// Grids are looked at in points that the direction of the ray chooses: the same ray sees the same.
    pub(crate) fn along(
        tracer: &mut Tracer,
        media: &mut Media,
        ray: &Ray,
        first: Option<Surface>,
        mut each: impl FnMut(u32, f32),
    ) -> CameraSegment {
        let (scene, mut draws) = (tracer.scene, draws_along(ray, 0));
        let mut sight = CameraSegment {
            surface: None,
            transmittance: Rgb::WHITE,
            albedo: Rgb::BLACK,
            shown: [0.0; 2],
            distance: 0.0,
        };
        let surface = media.each_along(tracer, ray, first, |object, medium, line, [begin, end]| {
            let seen = medium.seen(line.as_ref(), end - begin, &mut draws);
            let is_inside = !scene.material_of(object).is_interface();
            each(object, mean(sight.transmittance * (Rgb::WHITE - seen.transmittance)));
            let albedo = match is_inside {
                true => medium.body_color() * (Rgb::WHITE - seen.transmittance),
                false => seen.scattered,
            };
            sight.albedo += sight.transmittance * (albedo + seen.emitted).clamp(0.0, 1.0);
            let passed = mean(sight.transmittance);
            sight.shown[usize::from(is_inside)] += passed * seen.shown;
            sight.distance += passed * (seen.distance + seen.shown * begin);
            sight.transmittance *= seen.transmittance;
        });
        CameraSegment { surface, ..sight }
    }
}
