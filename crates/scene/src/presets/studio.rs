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
    scene.cameras.clear();
    scene.lights.clear();
    let framing = Framing::of(scene);
    scene.cameras.push(framing.camera());
    scene.lights.extend(framing.lights());
    furnish(scene, &framing);
    Ok(())
}

/// Gives a scene what it lacks to be seen: a camera that frames everything, the lights of a studio; and the whole
/// studio where it has neither. Does nothing to a scene that has both.
pub fn complete(scene: &mut SceneBuilder) {
    let lit = !scene.lights.is_empty() || scene.objects.iter().any(|o| gives_light(scene, o));
    let seen = !scene.cameras.is_empty();
    if lit && seen {
        return;
    }
    let framing = Framing::of(scene);
    if !seen {
        scene.cameras.push(framing.camera());
    }
    if !lit {
        scene.lights.extend(framing.lights());
    }
    if !lit && !seen {
        furnish(scene, &framing);
    }
}

/// Puts a floor under the model, and makes of clay what nobody has said a word about.
fn furnish(scene: &mut SceneBuilder, framing: &Framing) {
    for material in scene.materials.iter_mut().filter(|m| m.kind == "phong" && m.parameters.0.is_empty()) {
        let clay = Spec::new(&material.name, "phong").with("kd", Rgb::new(0.62, 0.59, 0.55));
        *material = clay.with("ks", 0.05f32).with("exponent", 40.0f32).with("reflectivity", 0.0f32);
    }
    if scene.objects.is_empty() {
        return;
    }
    let floor = Spec::new("studio floor", "diffuse").with("reflectance", Rgb::new(0.45, 0.44, 0.43));
    let material = scene.add_material(floor);
    // A little below, so that a model with a floor of its own keeps that.
    let height = framing.lowest - framing.radius * 1e-3;
    let middle = Vec3::new(framing.middle.x as f32, height as f32, framing.middle.z as f32);
    let mesh = shapes::disc(middle, (framing.radius * 40.0) as f32, 96);
    scene.objects.push(Object::new("studio floor", Arc::new(mesh), material));
}

fn gives_light(scene: &SceneBuilder, object: &Object) -> bool {
    let black = |value: &Value| match value {
        Value::List(list) => list.iter().all(|v| matches!(v, Value::Integer(0) | Value::Number(0.0))),
        // What glows by a picture are signs and screens, no light to see the rest by.
        one => matches!(one, Value::Integer(0) | Value::Number(0.0) | Value::Texture(_)),
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

    fn camera(&self) -> CameraSpec {
        let spec = Spec::new("studio", "perspective")
            .with("position", self.eye.as_vec3())
            .with("look_at", (self.eye + self.axes[2] * self.distance).as_vec3())
            .with("fov", FOV);
        CameraSpec { spec, keyframes: Vec::new() }
    }

    /// A large panel from the left and above, a weaker one from behind on the right, and a pale room.
    fn lights(&self) -> [Spec; 3] {
        let [right, up, forward] = self.axes;
        let warm = Rgb::new(1.0, 0.96, 0.90);
        let cool = Rgb::new(0.86, 0.93, 1.0);
        let key = Lamp { name: "key", towards: right * -0.75 + up * 0.95 - forward * 0.75, size: [0.7, 0.7] };
        let rim = Lamp { name: "rim", towards: right * 0.9 + up * 0.75 + forward * 0.8, size: [0.6, 0.35] };
        [
            key.spec(self, warm * 4.4).with("classic", warm * 0.72),
            rim.spec(self, cool * 3.2).with("classic", cool * 0.28),
            Spec::new("room", "environment")
                .with("zenith", Rgb::new(0.40, 0.42, 0.46))
                .with("horizon", Rgb::new(0.26, 0.27, 0.29))
                .with("ground", Rgb::new(0.10, 0.096, 0.092)),
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
