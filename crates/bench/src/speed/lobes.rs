//! Cost of a vertex of the material with everything, compared with a diffuse one.
//!
//! Two closed rooms, one inside the other, so that every path goes on to its full length: only the inner one lets light
//! through, and the camera and the light are in it. Time is divided by the rays that were traced.

use super::measurement::{Context, Measurement};
use super::row::{Goal, Row};
use super::shots::{Plan, Shot};
use crate::median;
use bilux::math::{Rgb, Vec3};
use bilux::scene::cameras::CameraSpec;
use bilux::scene::texture::{Image, Texels};
use bilux::scene::{Mesh, Object, SceneBuilder, Spec, Texture, Value};
use bilux::{Error, Job, JobRequest};
use bilux_math::hash::hash_words;
use std::sync::Arc;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "principled",
    summary: "a vertex of principled, all lobes textured, over a diffuse one",
    run,
};

const SIDE: u32 = 128;
const SAMPLES: u32 = 16;
/// The scattering events of every path.
const DEPTH: u32 = 8;
/// The width and the height of the textures.
const TEXELS: usize = 512;

/// The parameters of `principled` that get a texture of colours, or of numbers and a factor.
const COLOURS: [&str; 6] = [
    "base_color",
    "specular_color",
    "transmission_color",
    "coat_color",
    "fuzz_color",
    "diffuse_transmission_color",
];
const NUMBERS: [(&str, f32); 13] = [
    ("base_diffuse_roughness", 1.0),
    ("base_metalness", 0.5),
    ("specular_weight", 1.0),
    ("specular_roughness", 1.0),
    ("specular_roughness_anisotropy", 0.5),
    ("transmission_weight", 0.5),
    ("coat_weight", 0.5),
    ("coat_roughness", 0.5),
    ("fuzz_weight", 0.3),
    ("fuzz_roughness", 1.0),
    ("diffuse_transmission_weight", 0.3),
    ("thin_film_weight", 0.3),
    ("thin_film_thickness", 1.0),
];
/// Parameters that most models have, and nothing else of the above.
const USUAL: [&str; 4] = ["base_color", "base_metalness", "specular_roughness", "normal"];
/// Parameters that let light through.
const TRANSMISSIVE: [&str; 2] = ["transmission_weight", "diffuse_transmission_weight"];

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let diffuse = ["inner", "outer"].map(|name| Spec::new(name, "diffuse"));
    let scenes = [
        ("every lobe", principled(&|_| true)),
        ("the usual lobes", principled(&|key| USUAL.contains(&key))),
        ("diffuse", rooms(diffuse)),
    ];
    let plan = Plan {
        integrator: "path",
        side: SIDE,
        samples: context.options.part_of(SAMPLES),
        seed: 1,
        threads: 1,
        max_depth: DEPTH,
    };
    let mut settings = plan.settings();
    settings.set("roulette_depth", Value::Integer(1000));
    let mut rays_a_sample = [0.0; 3];
    for (rays, (_, scene)) in rays_a_sample.iter_mut().zip(&scenes) {
        let job = Job::new(scene, JobRequest::from(&settings).samples(0..1).counting_work())?;
        *rays = Shot::of(&job)?.rays as f64 / f64::from(SIDE * SIDE);
    }
    let mut seconds = [const { Vec::new() }; 3];
    for round in context.rounds() {
        for (seconds, (name, scene)) in seconds.iter_mut().zip(&scenes) {
            context.say(&format!("principled: {name}, round {}", round + 1));
            seconds.push(Shot::of(&Job::new(scene, &settings)?)?.cpu_seconds);
        }
    }
    let a_ray = |i: usize| median(seconds[i].clone()) / plan.millions() / rays_a_sample[i].max(1e-3) * 1e3;
    let row = |i: usize, what: &str, goal: Goal| {
        let note = format!(
            "the other side is ours, diffuse; time over rays traced, which are {:.1} and {:.1} a sample",
            rays_a_sample[i], rays_a_sample[2]
        );
        let what = format!("a principled vertex, {what}, over a diffuse one: ns a ray");
        Row::new(what, a_ray(i), goal).against(a_ray(2)).with_note(note)
    };
    Ok(vec![
        row(0, "all lobes textured", Goal::RatioAtMost(2.0)),
        row(1, "textured as usual in a glTF", Goal::Unset),
    ])
}

/// The rooms with a texture for each of these parameters; the others keep their defaults.
fn principled(has: &dyn Fn(&str) -> bool) -> SceneBuilder {
    let mut textures = Vec::new();
    let mut inner = Spec::new("inner", "principled").with("thin_walled", true);
    let mut add = |key: &str, texture: Texture| {
        if has(key) {
            textures.push(Arc::new(texture));
            inner.parameters.set(key, Value::Texture(textures.len() - 1));
        }
    };
    for key in COLOURS {
        add(key, bytes(key, false, |b| [128 | b[0] >> 1, 128 | b[1] >> 1, 128 | b[2] >> 1]));
    }
    for (key, factor) in NUMBERS {
        add(key, Texture { factor: Rgb::grey(factor), ..bytes(key, true, |b| [b[0]; 3]) });
    }
    // Bumps of up to a tenth.
    add("normal", bytes("normal", true, |b| [115 + b[0] / 10, 115 + b[1] / 10, 255]));
    let mut outer = inner.clone();
    outer.name = "outer".to_owned();
    TRANSMISSIVE.iter().for_each(|key| outer.parameters.set(key, 0.0f32));
    SceneBuilder { textures, ..rooms([inner, outer]) }
}

/// A texture of bytes that follow from its name.
fn bytes(name: &str, is_data: bool, texel: impl Fn([u8; 8]) -> [u8; 3]) -> Texture {
    let salt = name.bytes().fold(0u64, |salt, byte| salt.wrapping_mul(31).wrapping_add(u64::from(byte)));
    let texels = (0..TEXELS * TEXELS).map(|i| {
        let [r, g, b] = texel(hash_words([salt, i as u64]).to_le_bytes());
        [r, g, b, 255]
    });
    let image = Image { width: TEXELS, height: TEXELS, texels: Texels::Bytes(texels.collect()) };
    Texture::of(name, Arc::new(image), is_data)
}

/// The inner and the outer room, of these materials.
fn rooms(materials: [Spec; 2]) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    for (spec, half) in materials.into_iter().zip([1.0, 1.5]) {
        let name = spec.name.clone();
        let material = scene.add_material(spec);
        for axis in 0..3 {
            for side in [-half, half] {
                let [n, u, v] = [axis, (axis + 1) % 3, (axis + 2) % 3].map(|i| Vec3::AXES[i] * 2.0 * half);
                let corner = n * (0.5 * side / half) - (u + v) * 0.5;
                scene.objects.push(Object::new(&name, Arc::new(Mesh::quad(corner, u, v)), material));
            }
        }
    }
    let lamp = Spec::new("lamp", "rect").with("position", Vec3::new(0.0, 0.9, 0.0));
    let lamp = lamp.with("edge_u", Vec3::X * 0.3).with("edge_v", Vec3::Z * 0.3);
    scene.lights.push(lamp.with("radiance", Rgb::grey(10.0)));
    let camera = Spec::new("front", "perspective").with("position", Vec3::Z * 0.9);
    let camera = camera.with("look_at", Vec3::ZERO).with("fov", 60.0f32);
    scene.cameras.push(CameraSpec { spec: camera, keyframes: Vec::new() });
    scene
}
