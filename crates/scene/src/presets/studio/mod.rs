//! `studio`: any model, well framed and lit. [`complete`] gives it to scenes without a camera or a light.

mod cove;
mod drawings;
mod framing;
mod options;
mod standing;

use super::PresetEntry;
use crate::builder::{Object, SceneBuilder};
use crate::cameras::{self, CameraSample};
use crate::messages::error::SceneError;
use crate::orientation::Orientation;
use crate::parameters::{Spec, Value};
use bilux_math::registry::Entry;
use bilux_math::transcendental::{asin, atan2};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use framing::Framing;
use options::GROUND;
pub use options::{Ground, Studio};
use standing::is_around;
pub use standing::set_upright;
use std::sync::Arc;

pub(super) const ENTRY: PresetEntry = PresetEntry {
    entry: Entry {
        name: "studio",
        summary: "framed from the front, slightly from the right and above, softly lit, on a seamless backdrop",
        source: "",
        parameters: &[],
    },
    apply,
};

/// The light in front of the model.
const KEY: &str = "key";

/// The light behind the model.
const RIM: &str = "rim";

/// The environment around it.
const ROOM: &str = "room";

fn apply(scene: &mut SceneBuilder) -> Result<(), SceneError> {
    scene.cameras.clear();
    scene.lights.clear();
    let studio = Studio::default();
    standing::set_upright(scene, &studio);
    let framing = Framing::of(scene, &studio);
    scene.cameras.push(framing.camera());
    scene.lights.extend(lights(&framing, Ground::Shadow, 1.0));
    furnish(scene, &framing, Ground::Shadow, false);
    Ok(())
}

/// Adds what a scene lacks to be visible: a camera that frames everything, and studio lights.
///
/// A scene with neither gets the whole studio. If a scene has light sources but its format cannot describe an
/// environment, they get the studio's environment, or metal would have nothing to reflect. Anything that `studio` asks
/// for is added in any case, with its camera as the first one. A scene that has both stays as it is unless `studio`
/// asks for something. Returns the orientation of the model, if it was rotated.
pub fn complete(scene: &mut SceneBuilder, studio: &Studio) -> Option<Orientation> {
    let orientation = standing::set_upright(scene, studio);
    add_missing(scene, studio);
    orientation
}

/// Like [`complete`], for a scene that is upright already ([`set_upright`]).
pub fn add_missing(scene: &mut SceneBuilder, studio: &Studio) {
    let has_lights = scene.lights.iter().any(|light| !light.is_backdrop());
    let glows = scene.objects.iter().any(|o| is_bright(scene, o));
    let has_light = studio.lit.unwrap_or_else(|| seems_lit(scene));
    let has_lights_only =
        has_light && scene.environment_unspecified && has_lights && !glows && !has_surroundings(scene);
    let lit = has_light && !has_lights_only;
    let seen = !scene.cameras.is_empty();
    let behind = studio.cut_out || scene.lights.iter().any(Spec::is_backdrop);
    let bare = !lit && !seen && !behind;
    let asked = studio.has_camera();
    let ground = studio.ground.unwrap_or(if bare { Ground::Shadow } else { Ground::None });
    if lit && seen && !asked && ground == Ground::None {
        return;
    }
    // An existing camera sees the studio from the front.
    let own = || if studio.turn.is_none() { orbit_of(scene) } else { None };
    let looks = Studio { orbit: studio.orbit.or_else(own), ..*studio };
    let framing = Framing::of(scene, &looks);
    if !seen || asked {
        scene.cameras.insert(0, framing.camera());
    }
    if !lit {
        // An existing camera may be close, and show what is behind the model; so does a mirror.
        let is_in_view = |spec: &Spec| spec.name == RIM && (seen && !asked || ground == Ground::Mirror);
        let is_wanted = |spec: &Spec| if has_lights_only { spec.name == ROOM } else { !is_in_view(spec) };
        let brightness = studio.brightness.unwrap_or(1.0);
        scene.lights.extend(lights(&framing, ground, brightness).into_iter().filter(is_wanted));
    }
    if !lit && !seen {
        drawings::of_clay(scene);
    }
    furnish(scene, &framing, ground, studio.cut_out);
}

/// True when a scene has its own light, but its format cannot describe the environment.
///
/// Only measurement can show whether that light is meant to illuminate the scene.
pub fn may_be_lit(scene: &SceneBuilder) -> bool {
    scene.environment_unspecified && !has_surroundings(scene) && has_own_light(scene)
}

/// True when a scene has light sources, or surfaces or media that emit light, however little.
pub fn has_own_light(scene: &SceneBuilder) -> bool {
    let is_black = |value: &Value| match value {
        Value::Integer(i) => *i == 0,
        Value::Number(x) => *x == 0.0,
        Value::List(list) => list.iter().all(|c| matches!(c, Value::Integer(0)) || *c == Value::Number(0.0)),
        _ => false,
    };
    scene.lights.iter().any(|light| !light.is_backdrop())
        || scene.objects.iter().flat_map(|o| emissions_of(scene, o)).any(|value| !is_black(value))
}

/// True when a scene says something of its light, if only that some surface emits none.
pub fn mentions_light(scene: &SceneBuilder) -> bool {
    scene.lights.iter().any(|light| !light.is_backdrop())
        || scene.objects.iter().any(|o| emission_of(scene, o).is_some())
}

/// True when a scene has light of its own.
///
/// Any light counts, textures and dim surfaces too, and so does a scene whose format describes all of its light. If the format
/// cannot describe an environment, surfaces count that are at least as bright as the white of a screen.
pub fn seems_lit(scene: &SceneBuilder) -> bool {
    match scene.environment_unspecified {
        true => {
            scene.lights.iter().any(|light| !light.is_backdrop())
                || scene.objects.iter().any(|o| is_bright(scene, o))
        }
        false => scene.describes_all_light || has_own_light(scene),
    }
}

/// True when every surface emits its colour and reflects nothing, as in models with baked light.
pub fn is_unlit(scene: &SceneBuilder) -> bool {
    let is_zero = |value: &Value| matches!(value, Value::Integer(0)) || *value == Value::Number(0.0);
    let of = |object: &Object| {
        let Some(material) = scene.materials.get(object.material) else { return false };
        let value = |key: &str| material.parameters.find(key).map(|(value, _)| value);
        let is_black = |key: &str| value(key).is_some_and(is_zero);
        material.kind == "principled"
            && value("emission").is_some()
            && value("emission_scale").is_none()
            && is_black("base_color")
            && is_black("specular_weight")
    };
    !scene.objects.is_empty() && scene.objects.iter().all(of)
}

/// Lights that the studio has added to a scene, as a list in words; `None` if it has added no light. `count` is the number of
/// lights that the scene had before.
pub fn added_lights(completed: &SceneBuilder, count: usize) -> Option<String> {
    let words = |light: &Spec| match light.name.as_str() {
        KEY => "a key light",
        RIM => "a rim light",
        _ => "surroundings",
    };
    let added = completed.lights.get(count..)?.iter().filter(|light| !light.is_backdrop());
    let added: Vec<&str> = added.map(words).collect();
    let (last, others) = added.split_last()?;
    Some(if others.is_empty() { (*last).to_owned() } else { format!("{} and {last}", others.join(", ")) })
}

/// Adds only the camera that [`complete`] would add.
pub fn frame(scene: &mut SceneBuilder, studio: &Studio) {
    if scene.cameras.is_empty() || studio.has_camera() {
        let camera = Framing::of(scene, studio).camera();
        scene.cameras.insert(0, camera);
    }
}

/// The view direction of a scene's own camera; `None` if it has none.
fn orbit_of(scene: &SceneBuilder) -> Option<[f32; 2]> {
    let camera = cameras::build(scene.cameras.first()?, 1.0).ok()?;
    let middle = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 };
    let towards = -Vec3::from(camera.ray(&middle).direction).try_normalize()?;
    Some([atan2(towards.x, towards.z).to_degrees(), asin(towards.y.clamp(-1.0, 1.0)).to_degrees()])
}

/// Puts the ground under the model.
fn furnish(scene: &mut SceneBuilder, framing: &Framing, ground: Ground, cut_out: bool) {
    // A camera below the ground would see nothing else.
    if ground == Ground::None || scene.objects.is_empty() || framing.is_below() {
        return;
    }
    let is_pale = drawings::is_pale(scene) || is_white_smoke(scene);
    let colour = if is_pale { Rgb::grey(0.05) } else { Rgb::new(0.72, 0.71, 0.70) };
    let paper = Spec::new(GROUND, "diffuse").with("reflectance", colour);
    let (material, mesh) = match ground {
        Ground::Mirror => {
            (Spec::new(GROUND, "mirror").with("reflectance", 0.85f32), cove::level(framing, false))
        }
        // It only receives light: the camera sees through its back, and the image keeps the shadow on it.
        _ if cut_out => (paper.with("visible_sides", "front"), cove::level(framing, true)),
        _ => (paper, cove::cove(framing)),
    };
    let material = scene.add_material(material);
    scene.objects.push(Object::new(GROUND, Arc::new(mesh), material));
}

/// True for a scene of nothing but smoke that scatters more light than it absorbs, which nobody would see on paper.
fn is_white_smoke(scene: &SceneBuilder) -> bool {
    let is_smoke = |object: &Object| {
        let material = scene.materials.get(object.material).filter(|material| material.kind == "interface");
        material.is_some_and(|material| {
            let of = |key: &str| material.colour(key).map_or(0.0, |colour| colour.luminance());
            of("scattering") > of("absorption")
        })
    };
    !scene.objects.is_empty() && scene.objects.iter().all(is_smoke)
}

/// The index of the object that catches the shadow in a scene completed for an image without surroundings.
pub fn shadow_catcher(scene: &SceneBuilder, studio: &Studio) -> Option<usize> {
    let is_wanted = studio.cut_out && studio.ground == Some(Ground::Shadow);
    let last = scene.objects.len().checked_sub(1).filter(|_| is_wanted)?;
    (scene.objects[last].name == GROUND).then_some(last)
}

/// True when a light illuminates the scene from all around.
fn has_surroundings(scene: &SceneBuilder) -> bool {
    scene.lights.iter().any(|light| is_around(light) && !light.is_backdrop())
}

/// Emissions of an object's material, from its surface and from its inside, as far as the scene states them.
fn emissions_of<'a>(scene: &'a SceneBuilder, object: &Object) -> impl Iterator<Item = &'a Value> {
    let inside = || scene.materials.get(object.material)?.parameters.find("medium_emission");
    emission_of(scene, object).into_iter().chain(inside().map(|(value, _)| value))
}

/// The emission of an object's material, if the scene states it.
fn emission_of<'a>(scene: &'a SceneBuilder, object: &Object) -> Option<&'a Value> {
    let material = scene.materials.get(object.material)?;
    material.parameters.find("emission").map(|(value, _)| value)
}

/// True for an object that is at least as bright as the white of a screen: a less bright one is a sign, not a light.
fn is_bright(scene: &SceneBuilder, object: &Object) -> bool {
    let bright = |value: &Value| match value {
        Value::Integer(i) => *i >= 1,
        Value::Number(x) => *x >= 1.0,
        // Textures count as signs too.
        _ => false,
    };
    emission_of(scene, object).is_some_and(|value| match value {
        Value::List(list) => list.iter().any(bright),
        one => bright(one),
    })
}

/// A large key light from the upper left, a weaker rim light from behind on the right, and a pale environment.
///
/// Without a cove, which reflects light, the environment is brighter.
fn lights(framing: &Framing, ground: Ground, brightness: f32) -> [Spec; 3] {
    let bright = brightness * if ground == Ground::None { 1.7 } else { 1.0 };
    let [right, up, forward] = framing.axes;
    let warm = Rgb::new(1.0, 0.96, 0.90);
    let cool = Rgb::new(0.86, 0.93, 1.0);
    let key = Panel { name: KEY, towards: right * -0.75 + up * 0.95 - forward * 0.75, size: [0.7, 0.7] };
    let rim = Panel { name: RIM, towards: right * 0.9 + up * 0.75 + forward * 0.8, size: [0.6, 0.35] };
    [
        key.spec(framing, warm * (4.4 * brightness)).with("classic", warm * 0.72),
        rim.spec(framing, cool * (3.2 * brightness)).with("classic", cool * 0.28),
        Spec::new(ROOM, "environment")
            .with("zenith", Rgb::new(0.40, 0.42, 0.46) * bright)
            .with("horizon", Rgb::new(0.26, 0.27, 0.29) * bright)
            .with("ground", Rgb::new(0.10, 0.096, 0.092) * bright),
    ]
}

/// A panel at a distance of five radii; its size is given for a distance of 1.
struct Panel {
    name: &'static str,
    towards: DVec3,
    size: [f64; 2],
}

impl Panel {
    fn spec(&self, framing: &Framing, radiance: Rgb) -> Spec {
        let towards = self.towards.normalize();
        // The light of a panel depends only on its solid angle, so a tiny model may have a relatively large panel,
        // whose area has to be representable in f32. For huge models no panel's area is.
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
