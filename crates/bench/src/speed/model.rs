//! A textured model under a picture of a sky: `path` over `principled` on both sides, with the same textures.
//!
//! Both sides get the model with what both understand: base colour, metalness, roughness and normal map.

use super::measurement::{Context, Measurement};
use super::mitsuba::{Mitsuba, Scratch, bitmap, ply};
use super::row::{Goal, Row};
use super::shots::Plan;
use crate::median;
use crate::render::{block_relmse, mean};
use bilux::Error;
use bilux::math::transcendental::{cos, exp, sin};
use bilux::math::{Rgb, Vec3};
use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Mesh, Object, Parameters, SceneBuilder, SceneError, Spec, Texture, Value as Setting};
use serde_json::{Value, json};
use std::f32::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "model",
    summary: "path on a textured model under a sky, one thread, against Mitsuba's principled",
    run,
};

const SIDE: u32 = 256;
const SAMPLES: u32 = 64;
const MAX_DEPTH: u32 = 16;
const FOV: f32 = 35.0;
const FIRST_SEED: u32 = 40_001;
/// The least square of a mean that errors are relative to, as in `relmse`.
const DARK: f64 = 1e-2;

/// Parameters of a material that both sides have: our name, Mitsuba's, the number of channels, and the default.
const SHARED: [(&str, &str, usize, f32); 3] = [
    ("base_color", "base_color", 3, 0.8),
    ("base_metalness", "metallic", 1, 0.0),
    ("specular_roughness", "roughness", 1, 0.3),
];

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let goal = Goal::RatioAtLeast(1.2);
    let error_goal = Goal::RatioAtMost(0.6);
    let Some(file) = &context.options.model else {
        return Ok(vec![
            Row::skipped("path on a model under a sky, one thread: M samples/s", goal, NO_MODEL),
            Row::skipped("path on a model under a sky: error in the same time", error_goal, NO_MODEL),
        ]);
    };
    let what = format!("path on {} under a sky, one thread: M samples/s", name_of(file));
    let setting = Stage::new(bilux::load(file, &context.options.read)?)?;
    let plan = Plan {
        integrator: "path",
        side: SIDE,
        samples: context.options.part_of(SAMPLES),
        seed: FIRST_SEED,
        threads: 1,
        max_depth: MAX_DEPTH,
    };
    let scratch = Scratch::new("model")?;
    let mut mitsuba = Mitsuba::start(context.options, &scratch, &setting.for_mitsuba(&scratch)?);
    if let Ok(mitsuba) = &mut mitsuba {
        context.say("model: Mitsuba compiles its kernels");
        mitsuba.render(plan.samples, 1)?;
    }
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let mut pictures: [Vec<Vec<Rgb>>; 2] = Default::default();
    for round in context.rounds() {
        let plan = Plan { seed: FIRST_SEED + round, ..plan };
        context.say(&format!("model: path, round {}", round + 1));
        let shot = plan.shoot(&setting.scene)?;
        ours.push(shot.cpu_seconds);
        pictures[0].push(shot.pixels);
        if let Ok(mitsuba) = &mut mitsuba {
            context.say(&format!("model: Mitsuba's path, round {}", round + 1));
            let shot = mitsuba.render(plan.samples, plan.seed)?;
            theirs.push(shot.cpu_seconds);
            pictures[1].push(shot.pixels);
        }
    }
    let error_what = format!("path on {} under a sky: variance times CPU seconds", name_of(file));
    let error = match variance(&pictures[0]) {
        Some(variance) => Row::new(error_what, variance * median(ours.clone()), error_goal),
        None => Row::skipped(error_what, error_goal, "not measured: the variance needs two repeats"),
    };
    let row = Row::new(what, plan.millions() / median(ours), goal);
    let ([Some(a), Some(b)], Ok(mitsuba)) = (pictures.each_ref().map(|all| all.last()), &mitsuba) else {
        let why = mitsuba.err().unwrap_or_default();
        return Ok(vec![row.with_note(why.clone()), error.with_note(why)]);
    };
    let error = match variance(&pictures[1]) {
        Some(variance) => error
            .against(variance * median(theirs.clone()))
            .with_note("relative squared error of a pixel, between seeds: in the same time"),
        None => error,
    };
    Ok(vec![
        row.against(plan.millions() / median(theirs)).with_note(format!(
            "{}, principled; base colour, metalness, roughness and normal map only; the means of the pictures are {:.4} \
             and {:.4}, and the relMSE between their blocks of 8x8 pixels is {:.1e}",
            mitsuba.name(),
            mean(a),
            mean(b),
            block_relmse(a, b, SIDE as usize)
        )),
        error,
    ])
}

/// The variance between pictures of different seeds, relative to the square of their mean, as a mean over pixels; `None` for
/// fewer than two.
fn variance(pictures: &[Vec<Rgb>]) -> Option<f64> {
    let (count, pixels) = (pictures.len() as f64, pictures.first()?.len());
    if pictures.len() < 2 {
        return None;
    }
    let of_pixel = |i: usize| {
        let channels = [0, 1, 2].map(|channel| {
            let values = || pictures.iter().map(|picture| f64::from(picture[i].to_array()[channel]));
            let mean = values().sum::<f64>() / count;
            values().map(|value| (value - mean) * (value - mean)).sum::<f64>()
                / (count - 1.0)
                / (mean * mean + DARK)
        });
        channels.iter().sum::<f64>() / 3.0
    };
    Some((0..pixels).map(of_pixel).sum::<f64>() / pixels.max(1) as f64)
}

/// Why rows about models are empty.
pub(super) const NO_MODEL: &str = "not measured: --model FILE names a model";

pub(super) fn name_of(file: &Path) -> String {
    file.file_stem().map_or_else(|| "a model".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The model, its light and its camera.
struct Stage {
    scene: SceneBuilder,
    eye: Vec3,
    target: Vec3,
}

impl Stage {
    fn new(mut scene: SceneBuilder) -> Result<Stage, Error> {
        let bounds = scene.bounds(0.0);
        let size = (bounds.max - bounds.min).length();
        if !(size > 0.0 && size.is_finite()) {
            return Err(SceneError::invalid("the model has no triangles", &Default::default()).into());
        }
        let target = (bounds.min + bounds.max) * 0.5;
        let eye = target + Vec3::new(0.4, 0.3, 0.9).normalize() * (1.3 * size);
        scene.materials.iter_mut().for_each(|spec| *spec = shared_part(spec));
        scene.textures.push(Arc::new(sky()));
        let radiance = Setting::Texture(scene.textures.len() - 1);
        scene.lights = vec![Spec::new("sky", "environment").with("radiance", radiance)];
        let camera = Spec::new("front", "perspective");
        let camera = camera.with("position", eye).with("look_at", target).with("fov", FOV);
        scene.cameras = vec![CameraSpec { spec: camera, keyframes: Vec::new() }];
        scene.settings = Parameters::default();
        Ok(Stage { scene, eye, target })
    }

    fn for_mitsuba(&self, scratch: &Scratch) -> Result<Value, Error> {
        let mut scene = super::mitsuba::scene(self.eye, self.target, FOV, [SIDE; 2], MAX_DEPTH);
        for (i, object) in self.scene.objects.iter().enumerate() {
            let name = format!("object{i}");
            let mut shape = json!({
                "type": "ply", "filename": ply(scratch, &name, in_world(object))?, "flip_tex_coords": true,
            });
            if let Some(spec) = self.scene.materials.get(object.material) {
                shape["bsdf"] = self.bsdf(scratch, object.material, spec)?;
            }
            scene[&name] = shape;
        }
        if let Some(sky) = self.scene.textures.last() {
            // The middle of our maps lies towards -z, that of Mitsuba's towards +z.
            let bitmap = bitmap(scratch, "sky", sky, 3)?;
            scene["sky"] = json!({ "type": "envmap", "bitmap": bitmap, "to_world": { "rotate_y": 180.0 } });
        }
        Ok(scene)
    }

    fn bsdf(&self, scratch: &Scratch, material: usize, spec: &Spec) -> Result<Value, Error> {
        let mut bsdf = json!({ "type": "principled" });
        for (ours, theirs, channels, default) in SHARED {
            let value = spec.parameters.find(ours).map(|(value, _)| value);
            bsdf[theirs] = match (self.texture(spec, ours), value) {
                (Some(texture), _) => texture_for(scratch, &format!("{ours}{material}"), texture, channels)?,
                (None, Some(Setting::List(list))) => {
                    let numbers: Vec<f64> = list.iter().filter_map(number).collect();
                    json!({ "type": "rgb", "value": numbers })
                }
                (None, value) => json!(value.and_then(number).unwrap_or(f64::from(default))),
            };
        }
        // A single number is no colour for Mitsuba.
        if bsdf["base_color"].is_number() {
            bsdf["base_color"] = json!({ "type": "rgb", "value": bsdf["base_color"].take() });
        }
        let Some(normals) = self.texture(spec, "normal") else { return Ok(bsdf) };
        let normals = texture_for(scratch, &format!("normal{material}"), normals, 3)?;
        Ok(json!({ "type": "normalmap", "normalmap": normals, "bsdf": bsdf }))
    }

    fn texture(&self, spec: &Spec, key: &str) -> Option<&Texture> {
        match spec.parameters.find(key) {
            Some((Setting::Texture(index), _)) => self.scene.textures.get(*index).map(|texture| &**texture),
            _ => None,
        }
    }
}

fn number(value: &Setting) -> Option<f64> {
    match *value {
        Setting::Integer(i) => Some(i as f64),
        Setting::Number(x) => Some(x),
        _ => None,
    }
}

fn texture_for(scratch: &Scratch, name: &str, texture: &Texture, channels: usize) -> Result<Value, Error> {
    Ok(json!({ "type": "bitmap", "raw": true, "bitmap": bitmap(scratch, name, texture, channels)? }))
}

/// A material with nothing but what both sides understand.
fn shared_part(spec: &Spec) -> Spec {
    let keys = SHARED.iter().map(|row| row.0).chain(["normal"]);
    let mut shared = Spec::new(&spec.name, "principled");
    for key in keys {
        if let Some((value, span)) = spec.parameters.find(key) {
            shared.parameters.set_at(key, value.clone(), span.clone());
        }
    }
    shared
}

/// The triangles of an object in world space.
fn in_world(object: &Object) -> Mesh {
    let (to_world, mesh) = (object.motion.at(0.0), &*object.mesh);
    Mesh {
        positions: mesh.positions.iter().map(|&p| to_world.point(p)).collect(),
        normals: mesh.normals.iter().map(|&n| to_world.normal(n).normalize_or_zero()).collect(),
        uvs: mesh.uvs.clone(),
        triangles: mesh.triangles.clone(),
        ..Mesh::default()
    }
}

/// A sky in longitude and latitude: brighter at the horizon, with a hazy sun, over dark ground.
fn sky() -> Texture {
    let (width, height) = (512usize, 256usize);
    let sun = Vec3::new(0.5, 0.6, 0.62).normalize();
    let texel = |i: usize| {
        let longitude = ((i % width) as f32 + 0.5) / width as f32 * TAU;
        let theta = ((i / width) as f32 + 0.5) / height as f32 * PI;
        let (up, side) = (cos(theta), sin(theta));
        let towards = Vec3::new(-sin(longitude) * side, up, cos(longitude) * side);
        let light = if up < 0.0 {
            Rgb::new(0.12, 0.1, 0.08)
        } else {
            Rgb::new(0.25, 0.45, 0.9) + Rgb::grey(0.6 * exp(-up * 5.0))
        };
        light + Rgb::new(30.0, 26.0, 20.0) * exp((towards.dot(sun) - 1.0) * 300.0)
    };
    Texture::new("sky", width, height, (0..width * height).map(texel).collect(), false)
}
