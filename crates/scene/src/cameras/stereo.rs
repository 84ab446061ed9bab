//! Two eyes: a pair of pictures beside or above each other, or one of them.

use super::{Camera, CameraConnection, CameraKeys, CameraMatrices, CameraSample};
use crate::messages::error::SceneError;
use bilux_accel::Ray;
use bilux_math::registry::{Parameter, ParameterKind, choice};
use bilux_math::{DVec2, DVec3, Vec2, Vec3};
use std::sync::Arc;

pub(super) const STEREO: Parameter = choice(
    "stereo",
    "the picture of one eye, or of both: the left one left of the right one, or above it",
    &["none", "left", "right", "side-by-side", "over-under"],
    "none",
);

pub(super) const EYE_DISTANCE: Parameter = Parameter {
    name: "eye_distance",
    summary: "distance between the two eyes of stereo",
    unit: "m",
    kind: ParameterKind::Number { min: 0.0, max: 1e6 },
    default: "0.064",
};

/// Makes the camera that `stereo` asks for: `eye` makes one that is so many metres to the right of the middle, for a film of
/// this width over height.
pub(super) fn build(
    keys: CameraKeys,
    aspect: f32,
    eye: impl Fn(CameraKeys, f32, f64) -> Result<Arc<dyn Camera>, SceneError>,
) -> Result<Arc<dyn Camera>, SceneError> {
    let Some((_, reader)) = keys.first() else { return eye(keys, aspect, 0.0) };
    let half = 0.5 * reader.number_f64("eye_distance");
    let pair = |layout: Layout| -> Result<Arc<dyn Camera>, SceneError> {
        let aspect = layout.aspect(aspect);
        Ok(Arc::new(Pair { eyes: [eye(keys, aspect, -half)?, eye(keys, aspect, half)?], layout }))
    };
    match reader.text("stereo").as_str() {
        "left" => eye(keys, aspect, -half),
        "right" => eye(keys, aspect, half),
        "side-by-side" => pair(Layout::SideBySide),
        "over-under" => pair(Layout::OverUnder),
        _ => eye(keys, aspect, 0.0),
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Layout {
    SideBySide,
    OverUnder,
}

const LEFT: usize = 0;
const RIGHT: usize = 1;

impl Layout {
    /// The width over height of each of the two pictures.
    fn aspect(self, both: f32) -> f32 {
        if self == Layout::SideBySide { both * 0.5 } else { both * 2.0 }
    }

    /// The eye that a point of the film belongs to, and the point of that eye's film.
    fn part(self, film: DVec2) -> (usize, DVec2) {
        let across = if self == Layout::SideBySide { DVec2::X } else { DVec2::Y };
        let eye = if film.dot(across) < 0.5 { LEFT } else { RIGHT };
        (eye, film + across * (film - eye as f64))
    }

    /// The inverse; `None` where the other eye's part is.
    fn whole(self, eye: usize, own: DVec2) -> Option<DVec2> {
        let across = if self == Layout::SideBySide { DVec2::X } else { DVec2::Y };
        let film = own - across * (own - eye as f64) * 0.5;
        (self.part(film).0 == eye).then_some(film)
    }
}

/// Both eyes. For connections they are the two halves of one lens, whose left half stands for the left eye: a random point of the lens
/// then chooses an eye, and a point on the lens of that eye.
struct Pair {
    eyes: [Arc<dyn Camera>; 2],
    layout: Layout,
}

impl Pair {
    fn part(&self, film: Vec2) -> (usize, Vec2) {
        let (eye, own) = self.layout.part(film.as_dvec2());
        (eye, own.as_vec2())
    }

    fn whole(&self, eye: usize, own: Vec2) -> Option<Vec2> {
        Some(self.layout.whole(eye, own.as_dvec2())?.as_vec2())
    }

    /// The eye that a ray comes from: the nearer one.
    fn eye_of(&self, ray: &Ray) -> &dyn Camera {
        let origin = Vec3::from(ray.origin);
        let away = |eye: &Arc<dyn Camera>| {
            let seen = eye.connect(Vec3::from(ray.at(1.0)), Vec2::ZERO, ray.time);
            seen.map_or(f32::INFINITY, |seen| seen.p.distance_squared(origin))
        };
        &*self.eyes[if away(&self.eyes[RIGHT]) < away(&self.eyes[LEFT]) { RIGHT } else { LEFT }]
    }
}

/// Each half of the unit disc becomes the whole, evenly: angles are doubled.
fn unfolded(half: Vec2) -> Vec2 {
    let length = half.length();
    if length == 0.0 {
        return Vec2::ZERO;
    }
    Vec2::new(half.x * half.x - half.y * half.y, 2.0 * half.x * half.y) / length
}

/// The inverse, on the half of an eye.
fn folded(whole: Vec2, eye: usize) -> Vec2 {
    let length = whole.length();
    // cos and sin of half the angle, of the root that lies to the right.
    let x = (0.5 * length * (length + whole.x)).max(0.0).sqrt();
    let y = (0.5 * length * (length - whole.x)).max(0.0).sqrt();
    // Of the middle too, one half has to be chosen.
    let half = Vec2::new(x.max(f32::MIN_POSITIVE), if whole.y < 0.0 { -y } else { y });
    if eye == RIGHT { half } else { -half }
}

impl Camera for Pair {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let (eye, film) = self.part(sample.film);
        self.eyes[eye].ray(&CameraSample { film, ..*sample })
    }

    fn connect(&self, from: Vec3, lens: Vec2, time: f32) -> Option<CameraConnection> {
        let eye = if lens.x > 0.0 { RIGHT } else { LEFT };
        let seen = self.eyes[eye].connect(from, unfolded(lens), time)?;
        Some(CameraConnection { film: self.whole(eye, seen.film)?, ..seen })
    }

    fn lens_of(&self, film: Vec2, lens: Vec2) -> Vec2 {
        folded(lens, self.part(film).0)
    }

    fn repeats(&self, film: Vec2) -> [Option<Vec2>; 3] {
        let (eye, own) = self.part(film);
        self.eyes[eye].repeats(own).map(|own| self.whole(eye, own?))
    }

    fn density(&self, ray: &Ray, t: f32) -> f32 {
        self.eye_of(ray).density(ray, t)
    }

    fn project(&self, p: Vec3, time: f32) -> Option<Vec2> {
        self.whole(LEFT, self.eyes[LEFT].project(p, time)?)
    }

    fn project_beside(&self, p: DVec3, time: f32, film: DVec2) -> Option<DVec2> {
        let (eye, own) = self.layout.part(film);
        self.layout.whole(eye, self.eyes[eye].project_beside(p, time, own)?)
    }

    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2> {
        self.layout.whole(LEFT, self.eyes[LEFT].project_f64(p, time)?)
    }

    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]> {
        let (eye, own) = self.layout.part(film);
        self.eyes[eye].ray_f64(own, time)
    }

    fn matrices(&self, time: f32) -> CameraMatrices {
        // There is one for each eye, but pictures have one.
        CameraMatrices { to_film: None, ..self.eyes[LEFT].matrices(time) }
    }

    fn height_at(&self, p: Vec3, time: f32) -> f32 {
        let rows = if self.layout == Layout::OverUnder { 2.0 } else { 1.0 };
        self.eyes[LEFT].height_at(p, time) * rows
    }

    fn shape(&self) -> Option<f64> {
        let of_both = |shape: f64| if self.layout == Layout::SideBySide { shape * 2.0 } else { shape * 0.5 };
        self.eyes[LEFT].shape().map(of_both)
    }

    fn warnings(&self) -> Vec<String> {
        self.eyes[LEFT].warnings()
    }

    fn has_lens(&self) -> bool {
        true
    }

    fn forward(&self, time: f32) -> Vec3 {
        self.eyes[LEFT].forward(time)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CameraSpec, build};
    use super::*;
    use crate::parameters::Spec;
    use bilux_math::transcendental::{asin_f64, sin_cos_f64, tan_f64};

    fn eye(kind: &str, stereo: &str, aspect: f32) -> Arc<dyn Camera> {
        let spec = Spec::new("", kind).with("stereo", stereo).with("eye_distance", 0.1f32);
        build(&CameraSpec::new(spec.with("position", Vec3::ZERO).with("look_at", -Vec3::Z)), aspect).unwrap()
    }

    /// Disparity is focal length times base over depth.
    #[test]
    fn disparity_of_parallel_eyes() {
        let [left, right] = ["left", "right"].map(|stereo| eye("perspective", stereo, 1.0));
        let focal = 0.5 / tan_f64(20f64.to_radians());
        for p in [DVec3::new(0.2, 0.1, -2.0), DVec3::new(-0.4, 0.3, -5.0)] {
            let disparity = left.project_f64(p, 0.0).unwrap() - right.project_f64(p, 0.0).unwrap();
            assert!((disparity.x + focal * 0.1 / p.z).abs() < 1e-6 && disparity.y.abs() < 1e-9);
            // And in the pair, where each has half of the width.
            let pair = eye("perspective", "side-by-side", 2.0);
            let [a, b] = [0.2, 0.7].map(|x| pair.project_beside(p, 0.0, DVec2::new(x, 0.5)).unwrap());
            assert!(((a.x + 0.5 - b.x) * 2.0 - disparity.x).abs() < 1e-9);
        }
    }

    #[test]
    fn eyes_that_converge_agree_where_they_meet() {
        let spec = Spec::new("", "perspective").with("eye_distance", 0.2f32).with("convergence", 3.0f32);
        for mirrored in [false, true] {
            let [left, right] = ["left", "right"].map(|stereo| {
                let spec = spec.clone().with("stereo", stereo).with("mirrored", mirrored);
                build(&CameraSpec::new(spec), 1.3).unwrap()
            });
            // From z = 5 towards -z.
            for (z, sign) in [(2.0, 0.0), (1.0, -1.0), (3.0, 1.0)] {
                let p = Vec3::new(0.3, 0.2, z);
                let apart = left.project(p, 0.0).unwrap().x - right.project(p, 0.0).unwrap().x;
                assert!(if sign == 0.0 { apart.abs() < 1e-6 } else { apart * sign > 1e-4 }, "{z}: {apart}");
            }
        }
    }

    /// All around, both eyes see a point at the angle of their circle: twice asin(radius / distance).
    #[test]
    fn turning_eyes_see_depth_all_around() {
        let [left, right] = ["left", "right"].map(|stereo| eye("panorama", stereo, 2.0));
        for i in 0..12 {
            let turn = f64::from(i) * 0.5 + 0.1;
            let p = {
                let (sin, cos) = sin_cos_f64(turn);
                DVec3::new(sin, 0.3, cos) * 1.5
            };
            let level = DVec2::new(p.x, p.z).length();
            let apart = left.project_f64(p, 0.0).unwrap().x - right.project_f64(p, 0.0).unwrap().x;
            let angle = apart.rem_euclid(1.0) * std::f64::consts::TAU;
            assert!((angle - 2.0 * asin_f64(0.05 / level)).abs() < 1e-9, "{turn}: {angle}");
        }
    }

    #[test]
    fn halves_of_a_lens_are_whole_lenses() {
        for whole in [Vec2::new(0.3, -0.4), Vec2::new(-0.9, 0.1), Vec2::new(-0.5, 0.0), Vec2::ZERO] {
            for eye in [LEFT, RIGHT] {
                let half = folded(whole, eye);
                assert!(unfolded(half).distance(whole) < 1e-6 && (half.x > 0.0) == (eye == RIGHT));
            }
        }
    }
}
