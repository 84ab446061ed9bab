//! Optical flow: where the labelled points are at another moment, and whether they are visible there.

use super::surface::{LabelRays, Labelled};
use bilux_math::{DVec2, DVec3, Vec2, Vec3};
use bilux_scene::{Camera, CameraSample, Scene, Tracer};

/// Minimum gap between a point and something that hides it, as a part of the point's distance. A ray to a point hits the
/// triangles beside it just as well.
const NEARER: f64 = 1e-4;

/// Number of look-ups of the row in which a rolling shutter sees a point: each comes nearer, where the point moves over the picture
/// more slowly than rows are read.
const ROUNDS: usize = 6;

/// The scene at another time.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The scene, of the same objects, whose meshes may be in another pose; built for this time.
    pub scene: &'a Scene,
    /// Camera at that time.
    pub camera: &'a dyn Camera,
    /// The time, in seconds.
    pub time: f32,
}

/// From a picture to another moment.
pub(super) struct Flow<'a> {
    pub(super) moment: Moment<'a>,
    /// Neither the camera nor any object moves.
    is_still: bool,
}

/// A point at the other moment.
struct Seen {
    p: DVec3,
    film: DVec2,
    time: f32,
}

/// Motion of a point to the other moment, and whether it is visible there.
pub(super) struct Followed {
    /// Displacement over the picture, in pixels: to the right, and upwards.
    pub(super) motion: Vec2,
    /// Whether something hides it there, or it is outside of the picture.
    pub(super) is_hidden: bool,
}

impl<'a> Flow<'a> {
    pub(super) fn new(here: &LabelRays, moment: Moment<'a>) -> Flow<'a> {
        let times = [here.opens(), moment.time];
        let (ours, theirs) = (here.scene.geometry(), moment.scene.geometry());
        // A camera that turns or zooms has other rays.
        let probes = [DVec2::new(0.5, 0.5), DVec2::new(0.2, 0.3), DVec2::new(0.9, 0.4)];
        let has_same_ray =
            |film: &DVec2| here.camera.ray_f64(*film, times[0]) == moment.camera.ray_f64(*film, times[1]);
        let is_same_camera = std::ptr::addr_eq(here.camera, moment.camera) && probes.iter().all(has_same_ray);
        let is_still = is_same_camera
            && std::ptr::eq(ours, theirs)
            && ours.objects().iter().all(|object| object.motion.is_still());
        Flow { moment, is_still }
    }

    /// Follows a labelled point, seen at a point of the film, to the other moment; `follows` tells whether it is asked what hides it.
    pub(super) fn followed(
        &self,
        here: &LabelRays,
        (labelled, at): (&Labelled, DVec2),
        tracer: &mut Tracer,
        follows: bool,
    ) -> Followed {
        if self.is_still {
            return Followed { motion: Vec2::ZERO, is_hidden: false };
        }
        let now = labelled.surface.time;
        let exposure = here.settings.exposure(here.scene);
        let moved = |film: DVec2| {
            let time = self.moment.time + exposure.delay(film.as_vec2());
            let places = [now, time];
            let theirs = self.moment.scene.geometry();
            let [from, to] = here.scene.geometry().moved(&labelled.hit, labelled.surface.p, theirs, places);
            let ends = here.camera.project_beside(from, now, at);
            let [from, film] = [ends?, self.moment.camera.project_beside(to, time, at)?];
            Some((from, film, Seen { p: to, film, time }))
        };
        // Where a row is exposed later, the point has moved on, to another row.
        let rounds = if here.settings.readout == 0.0 { 1 } else { ROUNDS };
        let end = (0..rounds).try_fold((at, at, None), |(_, film, _), _| {
            moved(film).map(|(from, film, seen)| (from, film, Some(seen)))
        });
        let Some((from, film, Some(seen))) = end else {
            return Followed { motion: Vec2::ZERO, is_hidden: true };
        };
        let size = DVec2::new(f64::from(here.settings.width), -f64::from(here.settings.height));
        let motion = ((film - from) * size).as_vec2();
        let is_hidden = follows && self.is_hidden(here, labelled, &seen, tracer);
        Followed { motion, is_hidden }
    }

    /// Whether something is in front of a point at the other moment; or the film ends there.
    fn is_hidden(
        &self,
        here: &LabelRays,
        labelled: &Labelled,
        &Seen { p, film, time }: &Seen,
        tracer: &mut Tracer,
    ) -> bool {
        let Moment { scene, camera, .. } = self.moment;
        if film.cmplt(DVec2::ZERO).any() || film.cmpge(DVec2::ONE).any() {
            return true;
        }
        let ray = camera.ray(&CameraSample { film: film.as_vec2(), lens: Vec2::ZERO, time });
        if ray.is_nowhere() {
            return true;
        }
        let there = LabelRays { scene, camera, settings: here.settings };
        let Some(seen) = there.first(&scene.for_labels(ray), tracer) else { return false };
        let own = here.scene.geometry().triangle_of(&labelled.hit);
        if own.is_some() && own == scene.geometry().triangle_of(&seen.hit) {
            return false;
        }
        let towards = Vec3::from(ray.direction).as_dvec3();
        let distance = (p - Vec3::from(ray.origin).as_dvec3()).dot(towards);
        f64::from(seen.surface.t) < distance * (1.0 - NEARER)
    }
}
