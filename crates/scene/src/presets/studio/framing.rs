//! The position of a model, and the camera position that frames it whole.

use super::Studio;
use crate::builder::SceneBuilder;
use crate::cameras::CameraSpec;
use crate::parameters::Spec;
use bilux_math::transcendental::{atan, sin_cos_f64, tan};
use bilux_math::{DVec2, DVec3};

/// The maximum fraction of the image's width and height that the model covers.
const FILL: f64 = 0.88;
/// Beyond this distance the squares of lengths overflow in f32.
const FARTHEST: f64 = 1e17;

/// A box is flat if its height is less than the first fraction of its narrower side, and entirely flat from the second
/// on.
const FLAT: [f64; 2] = [0.2, 0.1];
/// The elevation from which an entirely flat model is seen, in degrees.
const ABOVE_FLAT: f32 = 40.0;

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
        let scene = scene.movement.as_deref().unwrap_or(scene);
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
        let flat = flatness(high - low);
        let [azimuth, elevation] = studio.orbit.unwrap_or(default_orbit(flat));
        let axes = axes([azimuth + 360.0 * studio.turn.unwrap_or(0.0), elevation]);
        let fov = field_of_view(studio.focal.unwrap_or(Studio::FOCAL));
        let mut framing = Framing { middle, radius, lowest: low.y, axes, eye: middle, fov, distance: radius };
        let view = View { scene, turns: studio.turn.is_some(), flat };
        framing.stand_back(&view, f64::from(studio.aspect.unwrap_or(1.0)));
        framing
    }

    /// Finds the nearest eye that sees all vertices within the central `FILL` of an image, `aspect` times as wide as
    /// high.
    ///
    /// A point at (x, y, z) from the centre, along the axes, is visible from a shift of `s` and a distance of `d` when
    /// |x - s| ≤ (d + z) k. So `d` has to be at least the maximum of x/k - z, minus s/k, and the maximum of -x/k - z,
    /// plus s/k; it is smallest where both are equal. Vertically k belongs to the height, and horizontally to the
    /// width.
    fn stand_back(&mut self, view: &View, aspect: f64) {
        let k = f64::from(tan(self.fov.to_radians() * 0.5)) * FILL;
        let across = k * aspect;
        let mut reach = [f64::NEG_INFINITY; 4];
        view.each(self, |p| {
            let [right, left] = self.needs_across(view, p, across);
            for [y, z] in self.heights(view, p) {
                let needs = [right, left, y / k - z, -y / k - z];
                reach = std::array::from_fn(|i| reach[i].max(needs[i]));
            }
        });
        if !reach.iter().all(|r| r.is_finite()) {
            reach = [self.radius / k.min(across); 4];
        }
        let [right, left, up, down] = reach;
        let distance = ((right + left) * 0.5).max((up + down) * 0.5).max(self.radius * 0.5);
        let mut shift = DVec2::new((right - left) * 0.5 * across, (up - down) * 0.5 * k);
        let centring = if view.turns { 1.0 } else { view.flat };
        if centring > 0.0 {
            shift.y += (self.centred(view, distance, shift.y) - shift.y) * centring;
        }
        self.distance = distance;
        self.eye = self.middle + self.axes[0] * shift.x + self.axes[1] * shift.y - self.axes[2] * distance;
    }

    /// The distances that a point, relative to the centre, needs on the right and on the left.
    ///
    /// On a turntable, at radius r and height h, x/k - z is r sin φ/k + r cos φ cos ε + h sin ε.
    fn needs_across(&self, view: &View, p: DVec3, k: f64) -> [f64; 2] {
        if !view.turns {
            let [x, z] = [self.axes[0].dot(p), self.axes[2].dot(p)];
            return [x / k - z, -x / k - z];
        }
        let (cos, sin) = (self.axes[1].y, -self.axes[2].y);
        [DVec2::new(p.x, p.z).length() * DVec2::new(1.0 / k, cos).length() + p.y * sin; 2]
    }

    /// The heights and depths in the image at which a point, relative to the centre, is seen; on a turntable, where it
    /// is nearest and where it is farthest.
    fn heights(&self, view: &View, p: DVec3) -> [[f64; 2]; 2] {
        let [_, up, forward] = self.axes;
        if !view.turns {
            return [[up.dot(p), forward.dot(p)]; 2];
        }
        let (cos, sin, r) = (up.y, -forward.y, DVec2::new(p.x, p.z).length());
        [r, -r].map(|near| [p.y * cos - near * sin, -p.y * sin - near * cos])
    }

    /// The vertical shift at which the model reaches as far above the centre of the image as below it.
    fn centred(&self, view: &View, distance: f64, mut shift: f64) -> f64 {
        // Where the highest and the lowest point of one shift are also those of the next, one step is exact.
        for _ in 0..4 {
            let (mut highest, mut lowest) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
            view.each(self, |p| {
                for [y, z] in self.heights(view, p) {
                    let seen = (y - shift) / (distance + z);
                    if seen > highest[0] {
                        highest = [seen, y, distance + z];
                    }
                    if seen < lowest[0] {
                        lowest = [seen, y, distance + z];
                    }
                }
            });
            let ([_, top, top_depth], [_, bottom, bottom_depth]) = (highest, lowest);
            let next = (top * bottom_depth + bottom * top_depth) / (top_depth + bottom_depth);
            if !next.is_finite() {
                break;
            }
            shift = next;
        }
        shift
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

/// Scene that a framing has to show.
struct View<'a> {
    scene: &'a SceneBuilder,
    /// Whether it turns, and has to be seen whole from all around.
    turns: bool,
    /// Flatness of the model, from 0 to 1.
    flat: f64,
}

impl View<'_> {
    /// Calls `f` with every vertex, relative to the centre.
    fn each(&self, framing: &Framing, mut f: impl FnMut(DVec3)) {
        for object in &self.scene.objects {
            let to_world = object.motion.at(0.0);
            for &p in &object.mesh.positions {
                let p = to_world.point(p).as_dvec3();
                if p.is_finite() && p.abs().max_element() <= FARTHEST {
                    f(p - framing.middle);
                }
            }
        }
    }
}

/// Flatness of a box, from 0 to 1.
fn flatness(extent: DVec3) -> f64 {
    let [from, to] = FLAT;
    let height = extent.y / extent.x.min(extent.z);
    if height.is_nan() { 0.0 } else { ((from - height) / (from - to)).clamp(0.0, 1.0) }
}

/// Slightly from the right and from above; from farther above for a flat model, of which little more than an edge would
/// be visible.
fn default_orbit(flat: f64) -> [f32; 2] {
    let [azimuth, elevation] = Studio::ORBIT;
    [azimuth, elevation + (ABOVE_FLAT - elevation) * flat as f32]
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
