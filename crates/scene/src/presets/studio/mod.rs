//! `studio`: any model, framed and lit well. What [`complete`] gives to scenes without a camera or a light.

mod cove;
mod framing;
mod standing;

use super::PresetEntry;
use crate::builder::{Object, SceneBuilder};
use crate::cameras::{self, CameraSample};
use crate::error::SceneError;
use crate::orientation::{Axis, Orientation};
use crate::parameters::{Spec, Value};
use bilux_math::registry::Entry;
use bilux_math::transcendental::{asin, atan2};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use framing::Framing;
pub use standing::set_upright;
use std::sync::Arc;

pub(super) const ENTRY: PresetEntry = PresetEntry {
    entry: Entry {
        name: "studio",
        summary: "framed from the front, a little from the right and above, softly lit, before a cove",
        source: "",
        parameters: &[],
    },
    apply,
};

/// What a model stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A matt cove, which takes the model's shadow; of a picture without surroundings, the shadow alone.
    Shadow,
    /// A level mirror.
    Mirror,
    /// Nothing.
    None,
}

impl Ground {
    /// As users name them.
    pub const NAMES: &'static [&'static str] = &["shadow", "mirror", "none"];

    /// By its name.
    pub fn named(name: &str) -> Option<Ground> {
        let all = [Ground::Shadow, Ground::Mirror, Ground::None];
        Ground::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }
}

/// How a model is photographed. What is `None` is made up for only where a scene says nothing of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Studio {
    /// What it stands on.
    pub ground: Option<Ground>,
    /// From where it is seen: degrees to the right of its front (+z), and above it.
    pub orbit: Option<[f32; 2]>,
    /// Which of the model's axes is up.
    pub up: Option<Axis>,
    /// Which of them is its front.
    pub front: Option<Axis>,
    /// Focal length in mm, for a picture 24 mm high.
    pub focal: Option<f32>,
    /// Width of the picture over its height, if it is not square.
    pub aspect: Option<f32>,
    /// It is cut out of its surroundings, so that nothing is put around it unasked.
    pub cut_out: bool,
    /// Whether the scene's own light lights what is seen, as measured; `None` to go by whether there is any.
    pub lit: Option<bool>,
}

impl Studio {
    /// A little from the right and above.
    pub const ORBIT: [f32; 2] = [26.5, 17.8];
    /// The lens of portraits, or a little more.
    pub const FOCAL: f32 = 45.0;

    /// True where the studio's own camera is asked for, whatever cameras the scene has.
    fn has_camera(&self) -> bool {
        self.orbit.is_some() || self.focal.is_some() || self.up.is_some() || self.front.is_some()
    }
}

/// The light behind the model.
const RIM: &str = "rim";

/// What is around it.
const ROOM: &str = "room";

/// What the ground's object and material are called.
const GROUND: &str = "studio floor";

fn apply(scene: &mut SceneBuilder) -> Result<(), SceneError> {
    scene.cameras.clear();
    scene.lights.clear();
    let studio = Studio::default();
    standing::set_upright(scene, &studio);
    let framing = Framing::of(scene, &studio);
    scene.cameras.push(framing.camera());
    scene.lights.extend(lights(&framing, Ground::Shadow));
    furnish(scene, &framing, Ground::Shadow, false);
    Ok(())
}

/// Gives a scene what it lacks to be seen: a camera that frames everything, the lights of a studio; and the whole
/// studio where it has neither. Lamps of a format that has no word for surroundings stand in those of the studio: metal would
/// mirror nothing. What is asked for in `studio` is there in any case: its camera is the first one then.
/// Does nothing to a scene that has both where nothing is asked for. Gives how the model was turned, if it was.
pub fn complete(scene: &mut SceneBuilder, studio: &Studio) -> Option<Orientation> {
    let orientation = standing::set_upright(scene, studio);
    add_missing(scene, studio);
    orientation
}

/// Does what [`complete`] does, to a scene that stands upright already ([`set_upright`]).
pub fn add_missing(scene: &mut SceneBuilder, studio: &Studio) {
    let has_lights = scene.lights.iter().any(|light| !light.is_backdrop());
    let glows = scene.objects.iter().any(|o| gives_light(scene, o));
    let has_light = studio.lit.unwrap_or_else(|| seems_lit(scene));
    let has_lamps_alone =
        has_light && scene.surroundings_unsaid && has_lights && !glows && !has_surroundings(scene);
    let lit = has_light && !has_lamps_alone;
    let seen = !scene.cameras.is_empty();
    let behind = studio.cut_out || scene.lights.iter().any(Spec::is_backdrop);
    let bare = !lit && !seen && !behind;
    let asked = studio.has_camera();
    let ground = studio.ground.unwrap_or(if bare { Ground::Shadow } else { Ground::None });
    if lit && seen && !asked && ground == Ground::None {
        return;
    }
    // A camera that is there looks at the studio from in front.
    let looks = Studio { orbit: studio.orbit.or_else(|| orbit_of(scene)), ..*studio };
    let framing = Framing::of(scene, &looks);
    if !seen || asked {
        scene.cameras.insert(0, framing.camera());
    }
    if !lit {
        // It may be close, and have in view what stands behind the model; a mirror shows that.
        let is_in_view = |spec: &Spec| spec.name == RIM && (seen && !asked || ground == Ground::Mirror);
        let is_wanted = |spec: &Spec| if has_lamps_alone { spec.name == ROOM } else { !is_in_view(spec) };
        scene.lights.extend(lights(&framing, ground).into_iter().filter(is_wanted));
    }
    if !lit && !seen {
        of_clay(scene);
    }
    furnish(scene, &framing, ground, studio.cut_out);
}

/// True where a scene has light of its own, and its format no word for what else is around it: whether that light is meant
/// to light the scene is told by measure alone.
pub fn may_be_lit(scene: &SceneBuilder) -> bool {
    let has_lights = scene.lights.iter().any(|light| !light.is_backdrop());
    let emission = |o: &Object| scene.materials.get(o.material).and_then(|m| m.parameters.find("emission"));
    let glows = || scene.objects.iter().any(|o| emission(o).is_some());
    scene.surroundings_unsaid && !has_surroundings(scene) && (has_lights || glows())
}

/// True where a scene has lamps, or parts that are at least as bright as the white of a screen.
pub fn seems_lit(scene: &SceneBuilder) -> bool {
    scene.lights.iter().any(|light| !light.is_backdrop())
        || scene.objects.iter().any(|o| gives_light(scene, o))
}

/// Gives a scene the camera that [`complete`] would give it, and nothing else.
pub fn frame(scene: &mut SceneBuilder, studio: &Studio) {
    if scene.cameras.is_empty() || studio.has_camera() {
        let camera = Framing::of(scene, studio).camera();
        scene.cameras.insert(0, camera);
    }
}

/// From where a scene's own camera looks; `None` where it has none.
fn orbit_of(scene: &SceneBuilder) -> Option<[f32; 2]> {
    let camera = cameras::build(scene.cameras.first()?, 1.0).ok()?;
    let middle = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 };
    let towards = -Vec3::from(camera.ray(&middle).direction).try_normalize()?;
    Some([atan2(towards.x, towards.z).to_degrees(), asin(towards.y.clamp(-1.0, 1.0)).to_degrees()])
}

/// Makes of clay what nobody has said a word about; of ink, to be seen on pale ground, what is lines or a few points alone.
fn of_clay(scene: &mut SceneBuilder) {
    const FEW: usize = 5000;
    let is_drawing = |object: &Object| {
        let mesh = &object.mesh;
        mesh.triangles.is_empty() && mesh.points.len() < FEW && mesh.stroke_count() > 0
    };
    let drawings: Vec<usize> =
        scene.objects.iter().filter(|object| is_drawing(object)).map(|object| object.material).collect();
    let bare = |m: &Spec| m.kind == "phong" && m.parameters.0.is_empty();
    for (i, material) in scene.materials.iter_mut().enumerate().filter(|(_, m)| bare(m)) {
        let kd = if drawings.contains(&i) { Rgb::grey(0.06) } else { Rgb::new(0.62, 0.59, 0.55) };
        let clay = Spec::new(&material.name, "phong").with("kd", kd);
        *material = clay.with("ks", 0.05f32).with("exponent", 40.0f32).with("reflectivity", 0.0f32);
    }
}

/// Puts something under the model.
fn furnish(scene: &mut SceneBuilder, framing: &Framing, ground: Ground, cut_out: bool) {
    // Who looks up from below would see nothing else.
    if ground == Ground::None || scene.objects.is_empty() || framing.is_below() {
        return;
    }
    let paper = Spec::new(GROUND, "diffuse").with("reflectance", Rgb::new(0.72, 0.71, 0.70));
    let (material, mesh) = match ground {
        Ground::Mirror => {
            (Spec::new(GROUND, "mirror").with("reflectance", 0.85f32), cove::level(framing, false))
        }
        // It is there for light alone: the camera looks through its back, and the picture is given the shadow on it.
        _ if cut_out => (paper.with("visible_sides", "front"), cove::level(framing, true)),
        _ => (paper, cove::cove(framing)),
    };
    let material = scene.add_material(material);
    scene.objects.push(Object::new(GROUND, Arc::new(mesh), material));
}

/// The number of the object that catches the shadow in a scene that was completed for a picture without surroundings.
pub fn shadow_catcher(scene: &SceneBuilder, studio: &Studio) -> Option<usize> {
    let is_wanted = studio.cut_out && studio.ground == Some(Ground::Shadow);
    let last = scene.objects.len().checked_sub(1).filter(|_| is_wanted)?;
    (scene.objects[last].name == GROUND).then_some(last)
}

/// True where something lights a scene from all around.
fn has_surroundings(scene: &SceneBuilder) -> bool {
    let is_around = |light: &Spec| matches!(light.kind.as_str(), "environment" | "sky" | "ambient");
    scene.lights.iter().any(|light| is_around(light) && !light.is_backdrop())
}

/// True for what lights a scene: what is less bright than the white of a screen is a sign, no lamp.
fn gives_light(scene: &SceneBuilder, object: &Object) -> bool {
    let bright = |value: &Value| match value {
        Value::Integer(i) => *i >= 1,
        Value::Number(x) => *x >= 1.0,
        // So are pictures.
        _ => false,
    };
    let emission = scene.materials.get(object.material).and_then(|m| m.parameters.find("emission"));
    emission.is_some_and(|(value, _)| match value {
        Value::List(list) => list.iter().any(bright),
        one => bright(one),
    })
}

/// A large panel from the left and above, a weaker one from behind on the right, and a pale room.
/// Without a cove, which sends on what it gets, the room is brighter.
fn lights(framing: &Framing, ground: Ground) -> [Spec; 3] {
    let bright = if ground == Ground::None { 1.7 } else { 1.0 };
    let [right, up, forward] = framing.axes;
    let warm = Rgb::new(1.0, 0.96, 0.90);
    let cool = Rgb::new(0.86, 0.93, 1.0);
    let key = Lamp { name: "key", towards: right * -0.75 + up * 0.95 - forward * 0.75, size: [0.7, 0.7] };
    let rim = Lamp { name: RIM, towards: right * 0.9 + up * 0.75 + forward * 0.8, size: [0.6, 0.35] };
    [
        key.spec(framing, warm * 4.4).with("classic", warm * 0.72),
        rim.spec(framing, cool * 3.2).with("classic", cool * 0.28),
        Spec::new(ROOM, "environment")
            .with("zenith", Rgb::new(0.40, 0.42, 0.46) * bright)
            .with("horizon", Rgb::new(0.26, 0.27, 0.29) * bright)
            .with("ground", Rgb::new(0.10, 0.096, 0.092) * bright),
    ]
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
