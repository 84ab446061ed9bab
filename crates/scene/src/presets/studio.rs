//! `studio`: any model, framed and lit well. What [`complete`] gives to scenes without a camera or a light.

use super::PresetEntry;
use crate::builder::{Object, SceneBuilder};
use crate::cameras::CameraSpec;
use crate::error::SceneError;
use crate::generators::shapes;
use crate::parameters::{Spec, Value};
use bilux_math::registry::Entry;
use bilux_math::transcendental::tan;
use bilux_math::{DVec3, Rgb, Vec3};
use std::sync::Arc;

pub(super) const ENTRY: PresetEntry = PresetEntry {
    entry: Entry {
        name: "studio",
        summary: "framed from the front, a little from the right and above, softly lit, on a floor",
        source: "",
        parameters: &[],
    },
    apply,
};

fn apply(scene: &mut SceneBuilder) -> Result<(), SceneError> {
    let framing = Framing::of(scene);
    scene.cameras.clear();
    scene.lights.clear();
    complete(scene);
    let floor = Spec::new("studio floor", "diffuse").with("reflectance", Rgb::new(0.52, 0.51, 0.50));
    let material = scene.add_material(floor);
    let middle = Vec3::new(framing.middle.x as f32, framing.lowest as f32, framing.middle.z as f32);
    let mesh = shapes::disc(middle, (framing.radius * 12.0) as f32, 96);
    scene.objects.push(Object::new("studio floor", Arc::new(mesh), material));
    Ok(())
}

/// Gives a scene without a camera one that frames everything in it, and a scene without any light that of a
/// studio. Does nothing to a scene that has both.
pub fn complete(scene: &mut SceneBuilder) {
    let lit = !scene.lights.is_empty() || scene.objects.iter().any(|o| gives_light(scene, o));
    if lit && !scene.cameras.is_empty() {
        return;
    }
    let framing = Framing::of(scene);
    if scene.cameras.is_empty() {
        scene.cameras.push(CameraSpec { spec: framing.camera(), keyframes: Vec::new() });
    }
    if !lit {
        scene.lights.extend(framing.lights());
    }
}

fn gives_light(scene: &SceneBuilder, object: &Object) -> bool {
    let black = |value: &Value| match value {
        Value::List(list) => list.iter().all(|v| matches!(v, Value::Integer(0) | Value::Number(0.0))),
        one => matches!(one, Value::Integer(0) | Value::Number(0.0)),
    };
    let emission = scene.materials.get(object.material).and_then(|m| m.parameters.find("emission"));
    emission.is_some_and(|(value, _)| !black(value))
}

/// Vertical field of view of the studio's camera, in degrees.
const FOV: f32 = 30.0;
/// Share of the picture's width and height that the model may take.
const FILL: f64 = 0.88;
/// Beyond this the squares of lengths overflow in f32.
const FARTHEST: f64 = 1e17;

/// Where a model is, and where it has to be seen from.
struct Framing {
    middle: DVec3,
    /// Never zero, and never so small beside the distance from the origin that f32 could not tell.
    radius: f64,
    lowest: f64,
    /// Right, up, and into the picture.
    axes: [DVec3; 3],
    eye: DVec3,
    /// From the eye to the middle of what it sees.
    distance: f64,
}

impl Framing {
    fn of(scene: &SceneBuilder) -> Framing {
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
        let forward = DVec3::new(-0.50, -0.36, -1.0).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let axes = [right, right.cross(forward), forward];
        let mut framing = Framing { middle, radius, lowest: low.y, axes, eye: middle, distance: radius };
        framing.stand_back(scene);
        framing
    }

    /// Finds the nearest eye that sees all vertices within the middle `FILL` of a square picture.
    ///
    /// A point at (x, y, z) from the middle, along the axes, is seen from a shift of `s` and a distance of `d`
    /// when |x - s| ≤ (d + z) k. So `d` has to be at least the greatest of x/k - z, less s/k, and the greatest
    /// of -x/k - z, plus s/k: least where both are equal.
    fn stand_back(&mut self, scene: &SceneBuilder) {
        let k = f64::from(tan(FOV.to_radians() * 0.5)) * FILL;
        let mut reach = [f64::NEG_INFINITY; 4];
        for object in &scene.objects {
            let to_world = object.motion.at(0.0);
            for &p in &object.mesh.positions {
                let p = to_world.point(p).as_dvec3();
                if p.is_finite() && p.abs().max_element() <= FARTHEST {
                    let [x, y, z] = self.axes.map(|axis| axis.dot(p - self.middle));
                    let needs = [x / k - z, -x / k - z, y / k - z, -y / k - z];
                    reach = std::array::from_fn(|i| reach[i].max(needs[i]));
                }
            }
        }
        if !reach.iter().all(|r| r.is_finite()) {
            reach = [self.radius / k; 4];
        }
        let [right, left, up, down] = reach;
        let shift = self.axes[0] * ((right - left) * 0.5 * k) + self.axes[1] * ((up - down) * 0.5 * k);
        let distance = ((right + left) * 0.5).max((up + down) * 0.5).max(self.radius * 0.5);
        self.distance = distance;
        self.eye = self.middle + shift - self.axes[2] * distance;
    }

    fn camera(&self) -> Spec {
        Spec::new("studio", "perspective")
            .with("position", self.eye.as_vec3())
            .with("look_at", (self.eye + self.axes[2] * self.distance).as_vec3())
            .with("fov", FOV)
    }

    /// A large panel from the left and above, a weaker one from behind on the right, and a pale room.
    fn lights(&self) -> [Spec; 3] {
        let [right, up, forward] = self.axes;
        let warm = Rgb::new(1.0, 0.96, 0.90);
        let cool = Rgb::new(0.86, 0.93, 1.0);
        let key = Lamp { name: "key", towards: right * -0.75 + up * 0.95 - forward * 0.75, size: [0.7, 0.7] };
        let rim = Lamp { name: "rim", towards: right * 0.9 + up * 0.75 + forward * 0.8, size: [0.6, 0.35] };
        [
            key.spec(self, warm * 4.2).with("classic", warm * 0.72),
            rim.spec(self, cool * 4.0).with("classic", cool * 0.28),
            Spec::new("room", "environment")
                .with("zenith", Rgb::new(0.52, 0.55, 0.60))
                .with("horizon", Rgb::new(0.36, 0.37, 0.39))
                .with("ground", Rgb::new(0.14, 0.135, 0.13)),
        ]
    }
}

/// A panel five radii away; its size is given for a distance of 1.
struct Lamp {
    name: &'static str,
    towards: DVec3,
    size: [f64; 2],
}

impl Lamp {
    fn spec(&self, framing: &Framing, radiance: Rgb) -> Spec {
        let towards = self.towards.normalize();
        // Light from a panel depends on the angles under which it is seen, so that a tiny model may have one
        // that is large beside it; its area has to be a number in f32. For huge models no panel does.
        let away = 5.0 * framing.radius.max(1e-6);
        if away > 1e8 {
            return Spec::new(self.name, "directional")
                .with("direction", (-towards).as_vec3())
                .with("irradiance", radiance * (self.size[0] * self.size[1]) as f32);
        }
        let across = towards.cross(DVec3::Y).normalize_or(DVec3::X) * away;
        Spec::new(self.name, "rect")
            .with("position", (framing.middle + towards * away).as_vec3())
            .with("edge_u", (across * self.size[0]).as_vec3())
            .with("edge_v", (across.cross(towards) * self.size[1]).as_vec3())
            .with("radiance", radiance)
    }
}
