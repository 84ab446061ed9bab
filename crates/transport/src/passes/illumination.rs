//! Illumination of what a camera sees by a scene's own lights, if everything were clay: the studio uses this to decide
//! whether it is needed, and how a picture is exposed that nobody has exposed.
//!
//! A pure function of the scene and the camera: it returns the same numbers for any number of threads, and reads no
//! clock.

use crate::light::choice::LightChoice;
use crate::sampling::sampler::PixelSampler;
use bilux_math::frame::reflect;
use bilux_math::parallel::map;
use bilux_math::transcendental::cos;
use bilux_math::{Frame, Vec2, Vec3, warp};
use bilux_scene::{Camera, CameraSample, ClassicMaterial, Ray, Scene, Surface, Tracer};

/// Rows and columns of points on the film.
const GRID: u32 = 40;
/// Paths per point.
const SAMPLES: u32 = 12;
/// Maximum number of scattering events of a path.
const MAX_BOUNCES: u32 = 3;
/// Maximum number of glass surfaces that a ray passes straight through.
const MAX_PANES: usize = 32;
/// The albedo of clay.
const CLAY: f32 = 0.5;
/// A white surface with less outgoing radiance than this is dark.
const DARK: f32 = 0.05;
/// A surface that reflects specularly at least the first part of light, and diffusely at most the second fraction of
/// that, is metal.
const METAL: [f32; 2] = [0.1, 0.25];

/// Illumination of what a scene's camera sees by the scene's own lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Illumination {
    /// The fraction of the film that shows surfaces that are neither emissive nor glass.
    pub surfaces: f32,
    /// The fraction of these surfaces that light reaches.
    pub lit: f32,
    /// The median, over the surfaces that light reaches, of the outgoing radiance of a white surface there, as luminance; 0 if
    /// there are none.
    pub level: f32,
    /// The fraction of these surfaces that any light reaches, however little.
    pub touched: f32,
    /// The median of the same radiance over all that any light reaches; 0 if there are none.
    pub faint: f32,
    /// The median luminance of the emissive surfaces that the camera sees; 0 if there are none.
    pub glow: f32,
}

/// View from the camera through a point of the film.
enum Seen {
    /// Neither a surface nor an emitter.
    Nothing,
    /// A surface that emits light, with its luminance.
    Emitter(f32),
    /// Any other surface, with the outgoing radiance of a white one there, as luminance.
    Surface(f32),
}

/// Measures a scene through a camera. Metal counts as clay if it `gets_surroundings` to reflect, and otherwise as what
/// it reflects.
pub fn illumination(scene: &Scene, camera: &dyn Camera, gets_surroundings: bool) -> Illumination {
    let lights = LightChoice::new(scene);
    let of_row = |y: u32| {
        let mut tracer = Tracer::new(scene, false);
        (0..GRID).map(|x| at_point(&mut tracer, camera, &lights, gets_surroundings, [x, y])).collect()
    };
    let rows: Vec<Vec<Seen>> = map(0..GRID, of_row);
    let (mut surfaces, mut emitters) = (Vec::new(), Vec::new());
    for seen in rows.into_iter().flatten() {
        match seen {
            Seen::Nothing => {}
            Seen::Emitter(light) => emitters.push(light),
            Seen::Surface(light) => surfaces.push(light),
        }
    }
    let above = |least: f32| surfaces.iter().copied().filter(|light| *light >= least).collect::<Vec<f32>>();
    let (lit, touched) = (above(DARK), above(f32::MIN_POSITIVE));
    let share = |some: &[f32]| some.len() as f32 / surfaces.len().max(1) as f32;
    Illumination {
        surfaces: surfaces.len() as f32 / (GRID * GRID) as f32,
        lit: share(&lit),
        touched: share(&touched),
        level: median(lit),
        faint: median(touched),
        glow: median(emitters),
    }
}

/// The median; 0 of nothing.
fn median(mut values: Vec<f32>) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Looks from the camera through a point of the film.
fn at_point(
    tracer: &mut Tracer,
    camera: &dyn Camera,
    lights: &LightChoice,
    gets_surroundings: bool,
    [x, y]: [u32; 2],
) -> Seen {
    let scene = tracer.scene;
    let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / GRID as f32;
    let sample = CameraSample { film, lens: Vec2::splat(0.5), time: scene.shutter()[0] };
    let ray = scene.from_camera(camera.ray(&sample));
    let Some(surface) = beyond_glass(tracer, ray) else { return Seen::Nothing };
    let wo = -Vec3::from(ray.direction);
    let emission = scene.emission(&surface, wo);
    if !emission.is_black() {
        return Seen::Emitter(emission.luminance());
    }
    let metal =
        Some(scene.material(&surface).classic(&surface)).filter(|it| !gets_surroundings && is_metal(it));
    let sum: f32 = (0..SAMPLES)
        .map(|i| {
            let mut sampler = PixelSampler::new(0, x, y, i);
            match &metal {
                Some(metal) => reflected(tracer, lights, &mut sampler, surface, wo, *metal),
                None => path(tracer, lights, &mut sampler, surface, wo),
            }
        })
        .sum();
    Seen::Surface(sum / SAMPLES as f32)
}

fn is_metal(material: &ClassicMaterial) -> bool {
    let [specular, diffuse] = METAL;
    let ks = material.ks.luminance() * material.reflectivity;
    ks >= specular && material.kd.luminance() <= ks * diffuse
}

/// The light that metal reflects: from an emitter, or from the first surface that is not metal, as clay.
fn reflected(
    tracer: &mut Tracer,
    lights: &LightChoice,
    sampler: &mut PixelSampler,
    mut surface: Surface,
    mut wo: Vec3,
    mut metal: ClassicMaterial,
) -> f32 {
    for _ in 0..=MAX_BOUNCES {
        let mirror = Frame::from_normal(reflect(wo, surface.n_shade));
        let wi = mirror.to_world(warp::sample_cone(sampler.next_2d(), cos(metal.gloss)));
        let Some(next) = beyond_glass(tracer, surface.spawn(wi)) else { return 0.0 };
        (surface, wo) = (next, -wi);
        let emission = tracer.scene.emission(&surface, wo);
        if !emission.is_black() {
            return emission.luminance();
        }
        metal = tracer.scene.material(&surface).classic(&surface);
        if !is_metal(&metal) {
            return path(tracer, lights, sampler, surface, wo);
        }
    }
    0.0
}

/// The light that one path of scattering events brings to a white surface.
fn path(
    tracer: &mut Tracer,
    lights: &LightChoice,
    sampler: &mut PixelSampler,
    mut surface: Surface,
    mut wo: Vec3,
) -> f32 {
    let (mut light, mut beta) = (0.0, 1.0);
    for bounce in 0..=MAX_BOUNCES {
        let n = if surface.n_geom.dot(wo) < 0.0 { -surface.n_geom } else { surface.n_geom };
        light += beta * direct(tracer, lights, sampler, &surface, n);
        let wi = Frame::from_normal(n).to_world(warp::sample_cosine_hemisphere(sampler.next_2d()));
        if bounce == MAX_BOUNCES {
            break;
        }
        let Some(next) = beyond_glass(tracer, surface.spawn(wi)) else { break };
        (surface, wo, beta) = (next, -wi, beta * CLAY);
    }
    if light.is_finite() { light } else { 0.0 }
}

/// The outgoing radiance of a white surface from direct light.
fn direct(
    tracer: &mut Tracer,
    lights: &LightChoice,
    sampler: &mut PixelSampler,
    surface: &Surface,
    n: Vec3,
) -> f32 {
    let scene = tracer.scene;
    let mut sum = 0.0;
    for (index, probability) in lights.sample(sampler.next_1d(), Some(surface.p)) {
        let (u, light) = (sampler.next_2d(), &scene.lights()[index].light);
        if probability == 0.0 {
            continue;
        }
        let Some(sample) = light.sample_li(surface.p, surface.time, u) else { continue };
        let cos = n.dot(sample.wi);
        if cos > 0.0 && is_seen(tracer, surface.spawn_to_light(&sample), sample.n_light) {
            let density = std::f32::consts::PI * sample.pdf_solid_angle * probability;
            sum += sample.li.luminance() * cos / density;
        }
    }
    sum
}

/// True when nothing but glass lies between the ends of a ray.
fn is_seen(tracer: &mut Tracer, ray: Ray, n: Vec3) -> bool {
    tracer.ending_on(&ray, n, |tracer| beyond_glass(tracer, ray).is_none())
}

/// The first surface along a ray that is not glass.
fn beyond_glass(tracer: &mut Tracer, mut ray: Ray) -> Option<Surface> {
    for _ in 0..MAX_PANES {
        let surface = tracer.closest(&ray)?;
        if tracer.scene.material(&surface).classic(&surface).kt.is_black() {
            return Some(surface);
        }
        ray = Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..ray };
    }
    None
}
