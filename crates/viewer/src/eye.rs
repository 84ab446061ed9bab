//! The camera that those who watch move: around a point, across, nearer, and through the scene.

use bilux::math::transcendental::{acos, cos_f64, sin_cos_f64};
use bilux::math::{Aabb, Vec2};
use bilux::math::{DVec3, Vec3};
use bilux::presets::Studio;
use bilux::scene::cameras::{self, CAMERAS};
use bilux::scene::{CameraSample, Parameters, Reader, SceneBuilder, Tracer};
use bilux::{Job, Settings};

/// The least angle in degrees between the line of sight and the up direction.
const STEEPEST: f64 = 2.0;

/// The bounds of the distance to the pivot, in radii of the scene.
const DISTANCES: [f64; 2] = [1e-4, 1e3];

/// A camera's position, and the point that it moves around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    /// The position of the camera.
    pub(crate) position: DVec3,
    /// The point that it looks at, and moves around.
    pub(crate) pivot: DVec3,
    /// The magnification of the picture.
    pub(crate) zoom: f64,
    /// Up, a unit vector.
    up: DVec3,
    /// Whether its rays are parallel: then coming nearer changes nothing, and it magnifies instead.
    is_parallel: bool,
    /// The radius of the scene, in metres.
    radius: f64,
}

impl Eye {
    /// Camera of a scene with these settings, in a picture of their shape; a job knows what lights the scene. Many files say only
    /// in which direction a camera looks: what it looks at is next to the middle of the scene.
    pub(crate) fn at_home(job: &Job, scene: &SceneBuilder, asked: &Parameters) -> Option<Eye> {
        let settings = Settings::of(scene, asked).ok()?;
        let aspect = settings.width as f32 / settings.height as f32;
        let studio = Studio { aspect: Some(aspect), lit: job.settings().studio.lit, ..settings.studio };
        let mut completed = bilux::presets::completed(scene, &studio);
        settings.view.place(&mut completed, &settings.camera);
        let by_name = completed.cameras.iter().find(|camera| camera.spec.name == settings.camera);
        let camera = by_name.or_else(|| completed.cameras.get(settings.camera.parse::<usize>().ok()?))?;
        let row = CAMERAS.iter().find(|row| row.entry.name == camera.spec.kind)?;
        let reader = Reader::new(&camera.spec, &row.entry).ok()?;
        // Where it is at this time, if it moves.
        let built = cameras::build(camera, aspect).ok()?;
        let middle_of_film = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: settings.time };
        let position = Vec3::from_array(built.ray(&middle_of_film).origin).as_dvec3();
        let ahead = built.forward(settings.time).as_dvec3().try_normalize()?;
        let bounds = own_bounds(&completed, scene.objects.len(), settings.time);
        let middle = ((bounds.min + bounds.max) * 0.5).as_dvec3();
        let radius = f64::from(bounds.radius()).max(f64::MIN_POSITIVE);
        let depth = (middle - position).dot(ahead);
        let has_focus = camera.spec.number("aperture").unwrap_or(0.0) > 0.0;
        let target = reader.vector("look_at").as_dvec3();
        let far = if depth > 0.0 && !has_focus { depth } else { target.distance(position) };
        Some(Eye {
            position,
            pivot: position + ahead * far,
            zoom: f64::from(settings.view.zoom),
            up: nearest_axis(reader.vector("up").as_dvec3()),
            is_parallel: camera.spec.kind == "orthographic",
            radius,
        })
    }

    /// Stands back as far as the scene's own camera does where the shape of the window changes: from where it was at home
    /// before to where it is now.
    pub(crate) fn keep_in_view(&mut self, before: &Eye, home: &Eye) {
        let factor = home.position.distance(home.pivot) / before.position.distance(before.pivot);
        if factor.is_finite() && factor > 0.0 && !self.is_parallel {
            self.position = self.pivot + (self.position - self.pivot) * factor;
        }
    }

    /// Moves around the pivot, by degrees to the right and up.
    pub(crate) fn orbit(&mut self, right: f64, up: f64) {
        self.position = self.pivot + self.turned(self.position - self.pivot, right, up);
    }

    /// Turns to the right and up, by degrees, without moving.
    pub(crate) fn look(&mut self, right: f64, up: f64) {
        self.pivot = self.position - self.turned(self.position - self.pivot, -right, -up);
    }

    /// Moves to the right and up, in metres.
    pub(crate) fn pan(&mut self, right: f64, up: f64) {
        let [across, above, _] = self.axes();
        self.shift(across * right + above * up);
    }

    /// Flies to the right, up and forward, in distances of the pivot.
    pub(crate) fn fly(&mut self, right: f64, up: f64, forward: f64) {
        let [across, _, ahead] = self.axes();
        let by = (across * right + self.up * up + ahead * forward) * self.pivot.distance(self.position);
        self.shift(by);
    }

    /// Comes nearer to the pivot by a factor, or magnifies by it.
    pub(crate) fn approach(&mut self, factor: f64) {
        if self.is_parallel {
            self.zoom = (self.zoom * factor).clamp(1e-2, 1e3);
            return;
        }
        let offset = self.position - self.pivot;
        let [least, most] = DISTANCES.map(|radii| radii * self.radius);
        let far = (offset.length() / factor).clamp(least, most);
        self.position = self.pivot + offset.normalize_or_zero() * far;
    }

    /// Moves around another point from now on, and looks at it.
    pub(crate) fn focus(&mut self, point: Vec3) {
        let point = point.as_dvec3();
        if point.is_finite() && point.distance(self.position) > DISTANCES[0] * self.radius {
            self.pivot = point;
        }
    }

    /// Goes to a position, and looks at a point, unless that makes no sense in this scene.
    pub(crate) fn put(&mut self, position: DVec3, pivot: DVec3, zoom: f64) {
        let far = position.distance(pivot) / self.radius;
        let leaning = (pivot - position).normalize_or_zero().dot(self.up).abs();
        let is_steep = leaning > cos_f64(0.5 * STEEPEST.to_radians());
        if (0.1 * DISTANCES[0]..=10.0 * DISTANCES[1]).contains(&far) && !is_steep {
            (self.position, self.pivot) = (position, pivot);
            if self.is_parallel {
                self.zoom = zoom;
            }
        }
    }

    /// Position, pivot and magnification as settings have them.
    pub(crate) fn settings(&self) -> [(&'static str, String); 3] {
        let point = |p: DVec3| {
            let p = p.as_vec3();
            format!("{},{},{}", p.x, p.y, p.z)
        };
        let zoom = (self.zoom as f32).to_string();
        [("eye", point(self.position)), ("look_at", point(self.pivot)), ("zoom", zoom)]
    }

    fn shift(&mut self, by: DVec3) {
        let limit = DISTANCES[1] * self.radius;
        if (self.position + by - self.pivot).length() < f64::INFINITY && by.length() < limit {
            self.position += by;
            self.pivot += by;
        }
    }

    /// Right, up and forward in the picture.
    fn axes(&self) -> [DVec3; 3] {
        let ahead = (self.pivot - self.position).normalize_or(DVec3::NEG_Z);
        let right = ahead.cross(self.up).normalize_or(self.up.any_orthonormal_vector());
        [right, right.cross(ahead), ahead]
    }

    /// An offset turned by degrees around the up direction, and towards it, but never onto it.
    fn turned(&self, offset: DVec3, right: f64, up: f64) -> DVec3 {
        let [across, ..] = self.axes();
        let flat = rotated(offset, self.up, right.to_radians());
        let across = rotated(across, self.up, right.to_radians());
        let cos = (flat.normalize_or(DVec3::Z).dot(self.up) as f32).clamp(-1.0, 1.0);
        let from_up = f64::from(acos(cos).to_degrees());
        let wanted = (from_up - up).clamp(STEEPEST, 180.0 - STEEPEST);
        rotated(flat, across, (wanted - from_up).to_radians())
    }
}

/// The bounding box of the first objects of a scene: those that come after them are the studio's, whose ground reaches far.
pub(crate) fn own_bounds(completed: &SceneBuilder, count: usize, time: f32) -> Aabb {
    let moved = |object: &bilux::scene::Object| object.motion.at(time).bounds(&object.mesh.bounds());
    completed.objects.iter().take(count).map(moved).fold(Aabb::EMPTY, Aabb::union)
}

/// The point of a scene at a place of the picture, as fractions of its width and height; `None` where there is nothing.
pub(crate) fn point_at(job: &Job, at: [f32; 2]) -> Option<Vec3> {
    let time = job.settings().time;
    let sample = CameraSample { film: Vec2::from(at), lens: Vec2::ZERO, time };
    let ray = job.scene().from_camera(job.camera().ray(&sample));
    Some(Tracer::new(job.scene(), false).closest(&ray)?.p)
}

/// The axis that is nearest to a direction.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let nearer = |a: DVec3, b: DVec3| if direction.dot(b).abs() > direction.dot(a).abs() { b } else { a };
    let axis = nearer(nearer(DVec3::Y, DVec3::Z), DVec3::X);
    axis * direction.dot(axis).signum()
}

/// A vector turned by an angle in radians around a unit axis, by Rodrigues' formula.
fn rotated(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = sin_cos_f64(angle);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eye() -> Eye {
        let position = DVec3::new(0.0, 1.0, 5.0);
        Eye { position, pivot: DVec3::Y, zoom: 1.0, up: DVec3::Y, is_parallel: false, radius: 2.0 }
    }

    /// The eye is at home where a moving camera is at the moment of the picture.
    #[test]
    fn at_home_a_moving_camera_is_where_it_is_then() {
        let at = |x: f32| bilux::scene::Spec::new("", "perspective").with("position", Vec3::new(x, 1.0, 5.0));
        let mut scene = bilux::generate(&bilux::scene::Spec::new("", "teapot")).unwrap();
        let keyframes = [0.0, 2.0].map(|time| (time, at(3.0 * time).parameters)).into();
        let spec = at(0.0).with("look_at", Vec3::new(0.0, 1.0, 0.0));
        scene.cameras = vec![bilux::scene::cameras::CameraSpec { spec, keyframes }];
        for (time, x) in [(0.0, 0.0), (1.0, 3.0), (2.0, 6.0)] {
            let job = Job::new(&scene, bilux::JobRequest::new().set("time", time).spp(1)).unwrap();
            let mut asked = Parameters::default();
            asked.set("time", time);
            let home = Eye::at_home(&job, &scene, &asked).unwrap();
            assert!(home.position.distance(DVec3::new(x, 1.0, 5.0)) < 1e-6, "{time}: {home:?}");
            // And it looks where it looks then.
            let ahead = (home.pivot - home.position).normalize();
            assert!(ahead.distance(DVec3::new(-x, 0.0, -5.0).normalize()) < 1e-6, "{time}: {home:?}");
        }
    }

    #[test]
    fn an_orbit_keeps_the_distance_and_never_reaches_the_pole() {
        let mut moved = eye();
        moved.orbit(90.0, 0.0);
        assert!(moved.position.distance(DVec3::new(5.0, 1.0, 0.0)) < 1e-6, "{moved:?}");
        for _ in 0..50 {
            moved.orbit(7.0, 13.0);
            assert!((moved.position.distance(moved.pivot) - 5.0).abs() < 1e-6);
            let ahead = (moved.pivot - moved.position).normalize();
            assert!(ahead.dot(DVec3::Y).abs() < 0.9995, "{moved:?}");
        }
        assert!(moved.position.y > 5.9, "it is nearly above");
        moved.orbit(-360.0 * 2.0, -400.0);
        assert!(moved.position.y < -3.9, "it is nearly below");
    }

    /// Degrees to the right add to the azimuth, degrees up to the elevation, whichever of the two come together.
    #[test]
    fn an_orbit_about_both_axes_adds_up_azimuth_and_elevation() {
        let at = |azimuth: f64, elevation: f64| {
            let [(sin_a, cos_a), (sin_e, cos_e)] =
                [azimuth, elevation].map(|x: f64| sin_cos_f64(x.to_radians()));
            DVec3::Y + 5.0 * DVec3::new(cos_e * sin_a, sin_e, cos_e * cos_a)
        };
        let (mut azimuth, mut elevation, mut moved) = (0.0, 0.0, eye());
        for [right, up] in [[30.0, 20.0], [-75.0, 25.0], [140.0, -80.0], [10.0, 0.0], [0.0, 12.0]] {
            (azimuth, elevation) = (azimuth + right, elevation + up);
            moved.orbit(right, up);
            assert!(
                moved.position.distance(at(azimuth, elevation)) < 1e-5,
                "{moved:?} {azimuth} {elevation}"
            );
            assert_eq!(moved.pivot, DVec3::Y);
        }
        // Looking around is the same around the eye itself: to the right it turns the other way.
        let mut looks = eye();
        looks.look(30.0, 20.0);
        let ahead = (looks.pivot - looks.position).normalize();
        let [(sin_a, cos_a), (sin_e, cos_e)] = [30f64, 20.0].map(|x| sin_cos_f64(x.to_radians()));
        assert!(ahead.distance(DVec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a)) < 1e-5, "{ahead}");
    }

    #[test]
    fn looking_around_keeps_the_position_and_panning_the_direction() {
        let mut moved = eye();
        moved.look(90.0, 0.0);
        assert_eq!(moved.position, eye().position);
        assert!((moved.pivot - moved.position).distance(DVec3::new(5.0, 0.0, 0.0)) < 1e-6, "{moved:?}");
        let mut moved = eye();
        moved.pan(1.0, 2.0);
        assert_eq!(moved.position - eye().position, DVec3::new(1.0, 2.0, 0.0));
        assert_eq!(moved.pivot - eye().pivot, DVec3::new(1.0, 2.0, 0.0));
        moved.fly(0.0, 0.0, 0.5);
        assert!((moved.position - eye().position).distance(DVec3::new(1.0, 2.0, -2.5)) < 1e-6);
    }

    #[test]
    fn a_view_that_was_kept_comes_back() {
        let (mut moved, mut again) = (eye(), eye());
        moved.orbit(40.0, 25.0);
        moved.approach(1.5);
        again.put(moved.position, moved.pivot, moved.zoom);
        assert_eq!(again, moved);
        // From straight above there is no up, and what is at itself or not a number is no place.
        for (position, pivot) in [
            (DVec3::Y * 9.0, DVec3::Y),
            (DVec3::Y, DVec3::Y),
            (DVec3::NAN, DVec3::Y),
            (DVec3::X * 1e9, DVec3::Y),
        ] {
            again.put(position, pivot, 1.0);
            assert_eq!(again, moved, "{position}");
        }
        let mut parallel = Eye { is_parallel: true, ..eye() };
        parallel.put(moved.position, moved.pivot, 3.0);
        assert_eq!((parallel.zoom, again.zoom), (3.0, 1.0));
    }

    #[test]
    fn coming_nearer_never_passes_the_pivot() {
        let mut moved = eye();
        moved.approach(2.0);
        assert!((moved.position.z - 2.5).abs() < 1e-9);
        (0..200).for_each(|_| moved.approach(10.0));
        assert!(moved.position.z > 0.0 && moved.position.z < 1e-3);
        (0..200).for_each(|_| moved.approach(0.1));
        assert!(moved.position.is_finite() && moved.position.z > 100.0);
        let mut parallel = Eye { is_parallel: true, ..eye() };
        parallel.approach(2.0);
        assert_eq!((parallel.zoom, parallel.position), (2.0, eye().position));
    }
}
