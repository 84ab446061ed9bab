//! The position of a model, and the camera position that frames it whole.

use super::Studio;
use crate::builder::SceneBuilder;
use crate::cameras::CameraSpec;
use crate::parameters::Spec;
use bilux_math::DVec3;
use bilux_math::transcendental::{atan, sin_cos_f64, tan};

/// The maximum fraction of the image's width and height that the model covers.
const FILL: f64 = 0.88;
/// Beyond this distance the squares of lengths overflow in f32.
const FARTHEST: f64 = 1e17;

/// The position of a model, and the viewpoint that frames it.
pub(super) struct Framing {
    pub(super) middle: DVec3,
    /// Never zero, and never too small for f32 relative to the distance from the origin.
    pub(super) radius: f64,
    pub(super) lowest: f64,
    /// Right, up, and into the image.
    pub(super) axes: [DVec3; 3],
    eye: DVec3,
    /// Vertical field of view, in degrees.
    fov: f32,
    /// Distance from the eye to the centre of its view.
    pub(super) distance: f64,
}

impl Framing {
    pub(super) fn of(scene: &SceneBuilder, studio: &Studio) -> Framing {
        // Frame an animated model by all of its movement.
        let scene = scene.inventory.movement.as_deref().unwrap_or(scene);
        let limit = |p: DVec3| p.clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST));
        let bounds = scene.bounds(0.0);
        let (low, high) = match bounds.is_empty() {
            true => (DVec3::splat(-1.0), DVec3::ONE),
            false => (limit(bounds.min.as_dvec3()), limit(bounds.max.as_dvec3())),
        };
        let middle = (low + high) * 0.5;
        let radius = match ((high - low).length() * 0.5).max(middle.length() * 1e-5) {
            r if r > 0.0 => r,
            _ => 1.0,
        };
        let axes = axes(studio.orbit.unwrap_or(Studio::ORBIT));
        let fov = field_of_view(studio.focal.unwrap_or(Studio::FOCAL));
        let mut framing = Framing { middle, radius, lowest: low.y, axes, eye: middle, fov, distance: radius };
        framing.stand_back(scene, f64::from(studio.aspect.unwrap_or(1.0)));
        framing
    }

    /// Finds the nearest eye that sees all vertices within the central `FILL` of an image, `aspect` times as wide as
    /// high.
    ///
    /// A point at (x, y, z) from the centre, along the axes, is visible from a shift of `s` and a distance of `d` when
    /// |x - s| ≤ (d + z) k. So `d` has to be at least the maximum of x/k - z, minus s/k, and the maximum of -x/k - z,
    /// plus s/k; it is smallest where both are equal. Vertically k belongs to the height, and horizontally to the
    /// width.
    fn stand_back(&mut self, scene: &SceneBuilder, aspect: f64) {
        let k = f64::from(tan(self.fov.to_radians() * 0.5)) * FILL;
        let across = k * aspect;
        let mut reach = [f64::NEG_INFINITY; 4];
        for object in &scene.objects {
            let to_world = object.motion.at(0.0);
            for &p in &object.mesh.positions {
                let p = to_world.point(p).as_dvec3();
                if p.is_finite() && p.abs().max_element() <= FARTHEST {
                    let [x, y, z] = self.axes.map(|axis| axis.dot(p - self.middle));
                    let needs = [x / across - z, -x / across - z, y / k - z, -y / k - z];
                    reach = std::array::from_fn(|i| reach[i].max(needs[i]));
                }
            }
        }
        if !reach.iter().all(|r| r.is_finite()) {
            reach = [self.radius / k.min(across); 4];
        }
        let [right, left, up, down] = reach;
        let shift = self.axes[0] * ((right - left) * 0.5 * across) + self.axes[1] * ((up - down) * 0.5 * k);
        let distance = ((right + left) * 0.5).max((up + down) * 0.5).max(self.radius * 0.5);
        self.distance = distance;
        self.eye = self.middle + shift - self.axes[2] * distance;
    }

    /// True when the eye is no higher than the lowest point of the model.
    pub(super) fn is_below(&self) -> bool {
        self.eye.y <= self.lowest
    }

    pub(super) fn camera(&self) -> CameraSpec {
        let spec = Spec::new("studio", "perspective")
            .with("position", self.eye.as_vec3())
            .with("look_at", (self.eye + self.axes[2] * self.distance).as_vec3())
            .with("fov", self.fov);
        CameraSpec { spec, keyframes: Vec::new() }
    }
}

/// Right, up, and into the image, for a view of the centre from this azimuth and elevation.
fn axes([azimuth, elevation]: [f32; 2]) -> [DVec3; 3] {
    let (sin_azimuth, cos_azimuth) = sin_cos_f64(f64::from(azimuth).to_radians());
    let (sin, cos) = sin_cos_f64(f64::from(elevation).to_radians());
    let forward = -DVec3::new(cos * sin_azimuth, sin, cos * cos_azimuth);
    let right = DVec3::new(cos_azimuth, 0.0, -sin_azimuth);
    [right, right.cross(forward), forward]
}

/// The vertical field of view, in degrees, of a lens for an image 24 mm high.
fn field_of_view(focal: f32) -> f32 {
    (2.0 * atan(12.0 / focal)).to_degrees()
}
