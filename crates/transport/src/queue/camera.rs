//! The camera rays of [`LANES`] samples at a time, where the camera is a pinhole.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, run_at, vec3};
use crate::film::failures::SamplePlace;
use crate::sampling::camera_rays::PinholeRays;
use crate::sampling::sampler::{self, PixelSampler};
use bilux_math::{Vec2, Vec3};
use bilux_scene::cameras::Pinhole;
use bilux_scene::{Ray, Scene};

/// Calls `each` with every sample, its random numbers and its ray.
pub(crate) fn camera_rays(
    rays: &PinholeRays,
    scene: &Scene,
    places: &[SamplePlace],
    mut each: impl FnMut(SamplePlace, PixelSampler, Ray),
) {
    let level = scene.cpu_level();
    let (mut film, mut directions) = ([Column::ZERO; 2], ZERO3);
    let mut samplers = Vec::with_capacity(LANES);
    for places in places.chunks(LANES) {
        let (mut streams, mut reversed_indices) = ([0; LANES], [0; LANES]);
        samplers.clear();
        samplers.extend(places.iter().map(|&place| rays.sampler(place)));
        for (i, sampler) in samplers.iter().enumerate() {
            (streams[i], reversed_indices[i]) = sampler.state();
        }
        run_at(level, Places { streams: &streams, reversed_indices: &reversed_indices, u: &mut film });
        for (i, &SamplePlace { x, y, .. }) in places.iter().enumerate() {
            let point = rays.film(x, y, Vec2::new(film[0].0[i], film[1].0[i]));
            (film[0].0[i], film[1].0[i]) = (point.x, point.y);
        }
        run_at(level, Directions { pinhole: &rays.pinhole, film: &film, directions: &mut directions });
        for (i, (place, sampler)) in places.iter().zip(samplers.drain(..)).enumerate() {
            let direction: Vec3 = vec3(&directions, i);
            let ray = Ray::new(rays.pinhole.position.to_array(), direction.to_array());
            each(*place, sampler, scene.from_camera(Ray { time: rays.time, ..ray }));
        }
    }
}

/// Random points, each of which chooses a place in a pixel.
struct Places<'a> {
    streams: &'a [u64; LANES],
    reversed_indices: &'a [u32; LANES],
    u: &'a mut [Column; 2],
}

impl Stage for Places<'_> {
    #[inline(always)]
    fn run(self) {
        let Places { streams, reversed_indices, u: [x, y] } = self;
        for i in 0..LANES {
            let key = sampler::key(streams[i], PinholeRays::DIMENSION);
            let u = sampler::point(key, reversed_indices[i]);
            (x.0[i], y.0[i]) = (u.x, u.y);
        }
    }
}

/// The directions through points of the film.
struct Directions<'a> {
    pinhole: &'a Pinhole,
    film: &'a [Column; 2],
    directions: &'a mut Columns3,
}

impl Stage for Directions<'_> {
    #[inline(always)]
    fn run(self) {
        let Directions { pinhole, film: [x, y], directions } = self;
        for i in 0..LANES {
            put(directions, i, pinhole.direction(Vec2::new(x.0[i], y.0[i])).to_array());
        }
    }
}
