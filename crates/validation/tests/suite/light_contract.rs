//! Every registered light and every kind of emissive mesh keeps its contract, and every check can fail.

use bilux_math::glam::DVec3;
use bilux_math::{Aabb, DMat4, Motion, MotionKey, Quat, Rgb, Transform, Vec2, Vec3};
use bilux_scene::mesh::shapes::{cuboid, icosphere, quad};
use bilux_scene::{
    AccelChoice, ClassicLight, ClassicLighting, EmissionSample, Goniometer, IntensityDistribution, LIGHTS,
    Light, LightSample, LightTracing, Mesh, Object, Primitive, SceneBuilder, Spec, Surface, Texture, Value,
};
use bilux_validation::chi_square::uniforms;
use bilux_validation::light_contract::{CHECKS, LightCase};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A block to be lit, and whatever `add` adds.
fn case(name: &str, time: f32, add: impl FnOnce(&mut SceneBuilder)) -> LightCase {
    let mut builder = SceneBuilder::default();
    let grey = builder.add_material(Spec::new("grey", "diffuse"));
    let block = Aabb { min: Vec3::new(-2.0, 0.0, -2.0), max: Vec3::new(2.0, 1.0, 2.0) };
    builder.objects.push(Object::new("block", Arc::new(cuboid(block)), grey));
    add(&mut builder);
    let scene = builder.build(&AccelChoice::default(), [0.0, 1.0], 1.0).unwrap();
    let light = scene.lights()[0].light.clone();
    LightCase { name: name.to_owned(), scene, light, time, power: None }
}

const RADIANCE: Rgb = Rgb { r: 3.0, g: 2.0, b: 1.0 };

/// A mesh with a motion that emits on both sides.
fn luminous(name: &str, mesh: Mesh, motion: &Motion, instanced: bool, time: f32) -> LightCase {
    luminous_on(2.0, name, mesh, motion, instanced, time)
}

/// A mesh with a motion that emits only in front.
fn in_front(name: &str, mesh: Mesh, motion: &Motion, instanced: bool, time: f32) -> LightCase {
    luminous_on(1.0, name, mesh, motion, instanced, time)
}

fn luminous_on(sides: f64, name: &str, mesh: Mesh, motion: &Motion, instanced: bool, time: f32) -> LightCase {
    let to_world = motion.at(time);
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| to_world.point(mesh.positions[i as usize]).as_dvec3()))
        .map(|[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length())
        .sum();
    let placed = case(name, time, |builder| {
        let glowing = Spec::new("glowing", "diffuse").with("reflectance", 0.0).with("emission", RADIANCE);
        let glowing = glowing.with("emission_sides", if sides == 1.0 { "front" } else { "both" });
        let material = builder.add_material(glowing);
        let object = Object::new("lamp", Arc::new(mesh), material);
        builder.objects.push(Object { motion: motion.clone(), instanced, ..object.clone() });
        // A copy that does not emit, so that the light is not the only instance of its mesh.
        let aside = Motion::still(shifted(DVec3::new(9.0, 3.0, 0.0)));
        builder.objects.insert(0, Object { motion: aside, material: 0, instanced, ..object });
    });
    LightCase { power: Some(f64::from(RADIANCE.luminance()) * area * 0.5 * TAU * sides), ..placed }
}

fn shifted(by: DVec3) -> Transform {
    Transform::from_matrix(DMat4::from_translation(by)).unwrap()
}

fn luminous_meshes() -> Vec<LightCase> {
    let rest = Motion::still(shifted(DVec3::new(0.5, 3.0, 0.0)));
    let askew = DMat4::from_translation(DVec3::new(-0.5, 3.0, 0.5))
        * DMat4::from_rotation_x(0.7)
        * DMat4::from_scale(DVec3::new(-1.5, 0.2, 0.9));
    let askew = Motion::still(Transform::from_matrix(askew).unwrap());
    let key = |time_seconds: f32, x: f32, turn: f32, scale: Vec3| MotionKey {
        time_seconds,
        translation: Vec3::new(x, 2.5, 0.3),
        rotation: Quat::from_rotation_x(turn),
        scale,
    };
    let first = key(0.0, -1.0, 0.0, Vec3::ONE);
    let moving = Motion::from_keys(vec![first, key(1.0, 1.5, 2.0, Vec3::new(0.5, 1.0, 2.0))]).unwrap();
    let ball = || icosphere(Vec3::ZERO, 0.4, 1);
    let panel = || quad(Vec3::ZERO, Vec3::X, Vec3::new(0.0, 0.3, 0.7));
    vec![
        luminous("ball", ball(), &rest, false, 0.0),
        luminous("ball of its own tree", ball(), &rest, true, 0.0),
        luminous("mirrored and flattened", ball(), &askew, false, 0.0),
        luminous("mirrored and flattened, of its own tree", ball(), &askew, true, 0.0),
        luminous("moving ball, at first", ball(), &moving, false, 0.0),
        luminous("moving ball, later", ball(), &moving, false, 0.6),
        luminous("moving panel, later", panel(), &moving, true, 0.9),
        in_front("panel in front", panel(), &rest, false, 0.0),
        in_front("front mirrored and flattened", ball(), &askew, false, 0.0),
        in_front("front mirrored and flattened, of its own tree", ball(), &askew, true, 0.0),
        in_front("front of a moving ball, later", ball(), &moving, false, 0.6),
    ]
}

/// A panel of 1 by 0.8 metres whose emission is a texture, most of which is black.
fn by_picture(sides: f64) -> LightCase {
    let texel = |i: usize| if i == 9 { RADIANCE * 7.0 } else { RADIANCE * (i % 4) as f32 * 0.2 };
    let picture = Texture::new("sign", 4, 4, (0..16).map(texel).collect(), false);
    let mean = (0..16).map(|i| f64::from((texel(i) * 0.5).luminance())).sum::<f64>() / 16.0;
    let name = format!("panel with a picture on {sides} sides");
    let placed = case(&name, 0.0, |builder| {
        builder.textures.push(Arc::new(picture));
        let glowing = Spec::new("sign", "diffuse").with("emission", Value::Texture(0));
        let glowing = glowing.with("emission_scale", 0.5f32);
        let sign =
            builder.add_material(glowing.with("emission_sides", if sides == 1.0 { "front" } else { "both" }));
        let panel = quad(Vec3::new(0.2, 2.5, 0.1), Vec3::X, Vec3::Z * 0.8);
        builder.objects.push(Object::new("sign", Arc::new(panel), sign));
    });
    LightCase { power: Some(mean * 0.8 * 0.5 * TAU * sides), ..placed }
}

/// A ball of so many levels whose emission is a picture, flattened and mirrored: its triangles are whole or cut. A quarter of it is black.
fn ball_with_a_picture(levels: u32) -> LightCase {
    let texel = |i: usize| RADIANCE * [0.0, 3.0, 0.3, 0.0, 0.2, 1.0][(i + i / 8) % 6];
    let picture = Texture::new("spots", 8, 8, (0..64).map(texel).collect(), false);
    let mut ball = icosphere(Vec3::ZERO, 0.4, levels);
    ball.uvs = ball.positions.iter().map(|p| Vec2::new(p.x, p.y) + Vec2::splat(0.5)).collect();
    let to_world = DMat4::from_translation(DVec3::new(-0.5, 3.0, 0.5))
        * DMat4::from_rotation_x(0.7)
        * DMat4::from_scale(DVec3::new(-1.5, 0.5, 0.9));
    let to_world = Transform::from_matrix(to_world).unwrap();
    let area_and_radiance = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| to_world.point(ball.positions[i as usize]).as_dvec3());
        let area = 0.5 * (b - a).cross(c - a).length();
        let cells = (0..64 * 64).filter(|i| i % 64 + i / 64 < 64);
        let uvs = t.map(|i| ball.uvs[i as usize]);
        // Two points of each cell but those at the far edge, which have one.
        let points = cells.flat_map(|i| {
            let (x, y) = ((i % 64) as f32, (i / 64) as f32);
            [1.0 / 3.0, 2.0 / 3.0].map(|third| ((x + third) / 64.0, (y + third) / 64.0))
        });
        let inside: Vec<_> = points.filter(|(v, w)| v + w < 1.0).collect();
        let at = |&(v, w): &(f32, f32)| {
            f64::from(picture.at_one(uvs[0] * (1.0 - v - w) + uvs[1] * v + uvs[2] * w).luminance())
        };
        area * inside.iter().map(at).sum::<f64>() / inside.len() as f64
    };
    let power = ball.triangles.iter().map(area_and_radiance).sum::<f64>() * 0.5 * TAU;
    let name = format!("ball of {levels} levels with a picture");
    let placed = case(&name, 0.0, |builder| {
        builder.textures.push(Arc::new(picture));
        let glowing = Spec::new("spots", "diffuse").with("emission", Value::Texture(0));
        let material = builder.add_material(glowing.with("emission_sides", "front"));
        let lamp = Object::new("lamp", Arc::new(ball), material);
        builder.objects.push(Object { motion: Motion::still(to_world), ..lamp });
    });
    LightCase { power: Some(power), ..placed }
}

/// A lamp that is turned, with angles at uneven distances, other intensities in all of them, and none in many directions.
fn luminaire(goniometer: Goniometer) -> LightCase {
    let azimuths = match goniometer {
        Goniometer::C => vec![0.0, 31.0, 90.0, 155.0, 250.0, 360.0],
        _ => vec![-80.0, -40.0, -10.0, 12.0, 55.0, 85.0],
    };
    let polar = vec![4.0, 20.0, 75.0, 80.0, 130.0, 171.0];
    let candela = (0..36).map(|i| [0.0, 900.0, 40.0, 350.0, 0.0, 2000.0, 610.0][i * 5 % 7]).collect();
    let made = IntensityDistribution::new("odd", goniometer, azimuths, polar, candela).unwrap();
    let spec = Spec::new("", "luminaire").with("distribution", Arc::new(made));
    let spec = spec.with("position", Vec3::new(0.7, 2.0, -0.4)).with("c0", Vec3::new(0.3, 0.2, -1.0));
    with_light(
        &format!("luminaire {goniometer:?}"),
        spec.with("direction", Vec3::new(-0.6, -1.0, 0.3)).with("scale", Rgb::new(700.0, 650.0, 400.0)),
    )
}

fn with_light(name: &str, spec: Spec) -> LightCase {
    case(name, 0.0, |builder| builder.lights.push(spec))
}

fn cases() -> Vec<LightCase> {
    let row = |kind: &'static str| {
        let spec = Spec::new("", kind);
        let has_surface = ["rect", "sphere"].contains(&kind);
        with_light(kind, if has_surface { spec.with("radiance", RADIANCE) } else { spec })
    };
    let spot = |outer: f32, inner: f32| {
        let at = Vec3::new(1.0, 4.0, -0.5);
        Spec::new("", "spot").with("position", at).with("angle", outer).with("inner_angle", inner)
    };
    let sky = Spec::new("", "environment")
        .with("zenith", Rgb::new(0.2, 0.4, 1.0))
        .with("horizon", Rgb::WHITE)
        .with("ground", Rgb::new(0.2, 0.1, 0.0));
    let clear = Spec::new("", "cie-sky").with("standard", 12).with("elevation", 25.0f32);
    let sphere = |position: Vec3, radius: f32| {
        let spec = Spec::new("", "sphere").with("radiance", RADIANCE);
        spec.with("position", position).with("radius", radius)
    };
    let beside = Spec::new("", "rect").with("radiance", RADIANCE).with("position", Vec3::new(1.0, 2.5, 0.5));
    let mut cases: Vec<LightCase> = LIGHTS.iter().map(|light| row(light.entry.name)).collect();
    cases.extend([
        with_light("gradient", sky.clone()),
        with_light("sun", Spec::new("", "directional").with("diameter", 0.533f32)),
        with_light("wide sun", Spec::new("", "directional").with("diameter", 70.0f32)),
        with_light("low sun", Spec::new("", "sky").with("elevation", 3.0f32).with("sun_diameter", 10.0f32)),
        with_light("clear sky with its sun", clear.with("sun", 9.0f32).with("sun_diameter", 4.0f32)),
        with_light("turbid sky", Spec::new("", "cie-sky").with("standard", 15).with("zenith", 2.0f32)),
        with_light(
            "weather",
            Spec::new("", "perez-sky").with("clearness", 3.0f32).with("brightness", 0.3f32),
        ),
        with_light("backdrop", sky.with("backdrop", true)),
        with_light("spot without an edge", spot(20.0, 20.0)),
        with_light("spot of half the sphere", spot(90.0, 0.0)),
        with_light("spot of all the sphere", spot(180.0, 120.0)),
        with_light("narrow spot", spot(2.0, 1.0)),
        with_light("near sphere", sphere(Vec3::new(0.0, 2.1, 0.0), 1.0)),
        with_light("small sphere", sphere(Vec3::new(0.5, 2.5, -0.4), 1e-2)),
        with_light("sphere in the block", sphere(Vec3::new(0.3, 1.1, 0.2), 0.7)),
        with_light("panel", beside.clone().with("edge_v", Vec3::new(0.3, 0.3, 0.8))),
        with_light("panel that shines away", beside.clone().with("sides", "front").with("edge_u", -Vec3::X)),
        with_light("panel that shines on the block", beside.with("sides", "front")),
    ]);
    cases.extend(Goniometer::ALL.map(luminaire));
    let sun = |x: usize, y: usize| if (x, y) == (41, 9) { 900.0 } else { 0.0 };
    let sky = |x: usize, y: usize| Rgb::new(0.2, 0.4, 0.7) * (1.0 - y as f32 / 32.0) + Rgb::WHITE * sun(x, y);
    let picture =
        Arc::new(Texture::new("", 64, 32, (0..64 * 32).map(|i| sky(i % 64, i / 64)).collect(), false));
    cases.extend([by_picture(1.0), by_picture(2.0), ball_with_a_picture(1), ball_with_a_picture(3)]);
    cases.push(case("picture", 0.0, |builder| {
        builder.textures.push(picture);
        let spec = Spec::new("", "environment").with("radiance", Value::Texture(0));
        builder.lights.push(spec.with("scale", Rgb::new(1.0, 0.5, 0.8)).with("rotation", 130.0f32));
    }));
    cases.extend(luminous_meshes());
    cases
}

#[test]
fn every_light_keeps_its_contract() {
    for case in cases() {
        for (check, run) in CHECKS {
            assert_eq!(run(&case), Ok(()), "{}: {check}", case.name);
        }
    }
}

/// A light with a bug.
struct BuggyLight {
    light: Arc<dyn Light>,
    defect: Defect,
}

/// Place of the bug.
#[derive(Clone, Copy)]
enum Defect {
    /// In the rays that it emits.
    Sent(fn(EmissionSample) -> EmissionSample),
    /// In the rays that are aimed.
    Aimed(fn(EmissionSample) -> EmissionSample),
    /// In light sampling.
    Picked(fn(LightSample) -> LightSample),
    /// In the density with which a start is sampled.
    Density(fn(f32, &EmissionSample) -> f32),
    /// In the density with which light subpaths begin where a point is hit that was sampled with another.
    Start(fn(f32, f32) -> f32),
}

impl Light for BuggyLight {
    fn sample_li(&self, from: Vec3, time: f32, u: Vec2) -> Option<LightSample> {
        let sample = self.light.sample_li(from, time, u);
        if let Defect::Picked(defect) = self.defect { sample.map(defect) } else { sample }
    }

    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        self.light.li_pdf_solid_angle(from, wi, hit)
    }

    fn pdf_area(&self, from: Vec3, hit: &Surface) -> f32 {
        self.light.pdf_area(from, hit)
    }

    fn samples_all_light(&self) -> bool {
        self.light.samples_all_light()
    }

    fn emits_towards(&self, hit: &Surface, wo: Vec3) -> bool {
        self.light.emits_towards(hit, wo)
    }

    fn le(&self, direction: Vec3) -> Rgb {
        self.light.le(direction)
    }

    fn is_delta(&self) -> bool {
        self.light.is_delta()
    }

    fn power(&self, bounds: &Aabb) -> f32 {
        self.light.power(bounds)
    }
}

impl LightTracing for BuggyLight {
    fn direct_pdf(&self, sample: &EmissionSample, from: Vec3) -> f32 {
        let pdf = self.light.direct_pdf(sample, from);
        if let Defect::Density(defect) = self.defect { defect(pdf, sample) } else { pdf }
    }

    fn pdf_start(&self, pdf_direct: f32, hit: &Surface) -> f32 {
        let pdf = self.light.pdf_start(pdf_direct, hit);
        if let Defect::Start(defect) = self.defect { defect(pdf, pdf_direct) } else { pdf }
    }

    fn sample_le(&self, bounds: &Aabb, time: f32, u_point: Vec2, u: Vec2) -> Option<EmissionSample> {
        let sample = self.light.sample_le(bounds, time, u_point, u);
        if let Defect::Sent(defect) = self.defect { sample.map(defect) } else { sample }
    }

    fn sample_le_aimed(&self, bounds: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let sample = self.light.sample_le_aimed(bounds, time, u, aim);
        if let Defect::Aimed(defect) = self.defect { sample.map(defect) } else { sample }
    }

    fn unaimed_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32 {
        self.light.unaimed_pdf(bounds, pdf_direct, direction, cos)
    }

    fn emission_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32 {
        self.light.emission_pdf(bounds, pdf_direct, direction, cos)
    }

    fn is_infinite(&self) -> bool {
        self.light.is_infinite()
    }
}

impl ClassicLighting for BuggyLight {
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight> {
        self.light.classic(from, time, u, extent)
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        self.light.classic_colour(bounds)
    }
}

type Bug = (&'static str, &'static str, &'static str, Defect);

/// A bug, the light that has it, and the check that must detect it.
const PLANTED: &[Bug] = &[
    (
        "a scene seen from within",
        "sky",
        "samples are sound",
        Defect::Sent(|s| EmissionSample { p: s.p + s.direction * 3.0, ..s }),
    ),
    (
        "a normal on the other side",
        "ball",
        "samples are sound",
        Defect::Sent(|s| EmissionSample { n_light: -s.n_light, ..s }),
    ),
    (
        "one side's density",
        "panel",
        "densities match the samples",
        Defect::Sent(|s| EmissionSample { pdf_emission: 2.0 * s.pdf_emission, ..s }),
    ),
    (
        "1% too dense",
        "moving ball, later",
        "emitted samples add up to the power",
        Defect::Sent(|s| EmissionSample { pdf_emission: 1.01 * s.pdf_emission, ..s }),
    ),
    (
        "an edge forgotten",
        "spot",
        "emitted samples add up to the power",
        Defect::Sent(|s| EmissionSample { le: Rgb::WHITE * 100.0, ..s }),
    ),
    (
        "the mean intensity in all directions",
        "luminaire C",
        "emitted samples add up to the power",
        Defect::Sent(|s| EmissionSample { le: Rgb::grey(1000.0), ..s }),
    ),
    (
        "an angle in the wrong half plane",
        "luminaire C",
        "direct sampling finds the emitted light",
        Defect::Sent(|s| EmissionSample {
            direction: Vec3::new(s.direction.x, s.direction.y, -s.direction.z),
            ..s
        }),
    ),
    (
        "a cosine counted twice",
        "panel",
        "emitted samples add up to the power",
        Defect::Sent(|s| EmissionSample { le: s.le * s.cos(), ..s }),
    ),
    (
        "an aim turned about",
        "panel",
        "aimed rays hit their target",
        Defect::Aimed(|s| EmissionSample {
            direction: Vec3::new(s.direction.z, s.direction.y, -s.direction.x),
            ..s
        }),
    ),
    (
        "an aim past the scene",
        "sky",
        "aimed rays hit their target",
        Defect::Aimed(|s| EmissionSample { p: s.p + Vec3::X * 0.1, ..s }),
    ),
    (
        "2% too dense",
        "near sphere",
        "rays aimed everywhere add up to the power",
        Defect::Aimed(|s| EmissionSample { pdf_emission: 1.02 * s.pdf_emission, ..s }),
    ),
    (
        "a cosine that the aim has no part in",
        "panel",
        "rays aimed everywhere add up to the power",
        Defect::Aimed(|s| EmissionSample { pdf_emission: s.pdf_emission * s.cos(), ..s }),
    ),
    (
        "the wrong instance",
        "ball of its own tree",
        "direct sampling finds the emitted light",
        Defect::Sent(|s| EmissionSample { primitive: Primitive { instance: 0, ..s.primitive }, ..s }),
    ),
    (
        "a density of its own space",
        "moving ball, later",
        "direct sampling finds the emitted light",
        Defect::Sent(|s| EmissionSample { pdf_direct: s.pdf_direct * 0.9, ..s }),
    ),
    (
        "the sky upside down",
        "sky",
        "direct sampling finds the emitted light",
        Defect::Sent(|s| EmissionSample { direction: -s.direction, ..s }),
    ),
    (
        "a picture's density of another place",
        "picture",
        "direct sampling finds the emitted light",
        Defect::Sent(|s| EmissionSample { pdf_direct: s.pdf_direct * 1.01, ..s }),
    ),
    (
        "one side only",
        "panel",
        "flux through a plane agrees in both directions",
        Defect::Sent(|s| {
            let up = s.n_light * if s.n_light.y < 0.0 { 1.0 } else { -1.0 };
            EmissionSample { direction: s.direction - s.n_light * s.cos() + up * s.cos(), n_light: up, ..s }
        }),
    ),
    (
        "a narrow disc",
        "sky",
        "flux through a plane agrees in both directions",
        Defect::Sent(|s| EmissionSample { p: s.p * 0.9, ..s }),
    ),
    (
        "1% too dense",
        "near sphere",
        "emitted samples add up to the power",
        Defect::Sent(|s| EmissionSample { pdf_emission: 1.01 * s.pdf_emission, ..s }),
    ),
    (
        "a density that forgets who asks",
        "near sphere",
        "direct sampling finds the emitted light",
        Defect::Density(|_, s| s.pdf_direct),
    ),
    (
        "a start as often as the receiver asks",
        "panel with a picture on 1 sides",
        "direct sampling finds the emitted light",
        Defect::Start(|_, pdf_direct| pdf_direct),
    ),
    (
        "a connection that knows only how often it was made",
        "ball of 3 levels with a picture",
        "sampled points are hit with the same density",
        Defect::Picked(|s| LightSample { pdf_start: None, ..s }),
    ),
    (
        "the density of a start for all who ask",
        "ball of 1 levels with a picture",
        "direct sampling finds the emitted light",
        Defect::Density(|_, s| s.pdf_direct),
    ),
    (
        "a density of half a cone",
        "near sphere",
        "sampled points are hit with the same density",
        Defect::Picked(|s| LightSample { pdf_solid_angle: 1.05 * s.pdf_solid_angle, ..s }),
    ),
    (
        "a point of the far side",
        "sphere",
        "sampled points are hit with the same density",
        Defect::Picked(|s| LightSample { point: s.point.map(|p| p + s.wi), ..s }),
    ),
    (
        "a cone of the wrong width",
        "near sphere",
        "flux through a plane agrees in both directions",
        Defect::Picked(|s| LightSample { pdf_solid_angle: 1.1 * s.pdf_solid_angle, ..s }),
    ),
];

#[test]
fn every_check_catches_its_planted_bugs() {
    let cases = cases();
    for (bug, name, check, defect) in PLANTED {
        let sound = cases.iter().find(|case| case.name == *name).unwrap();
        let defective = LightCase {
            name: name.to_string(),
            scene: sound.scene.at(&AccelChoice::default(), sound.scene.shutter()),
            light: Arc::new(BuggyLight { light: sound.light.clone(), defect: *defect }),
            ..*sound
        };
        let (_, run) = CHECKS.iter().find(|(name, _)| name == check).unwrap();
        assert!(run(&defective).is_err(), "{check} does not see {bug}");
    }
    for (check, _) in CHECKS {
        assert!(PLANTED.iter().any(|(_, _, name, _)| *name == check), "{check}");
    }
}

#[test]
fn infinite_lights_cannot_aim_at_empty_bounds() {
    let point = Aabb::of_points([Vec3::ONE]);
    for kind in ["directional", "environment"] {
        let case = with_light(kind, Spec::new("", kind));
        for bounds in [Aabb::EMPTY, point, Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }] {
            assert_eq!(
                case.light.sample_le(&bounds, 0.0, Vec2::splat(0.3), Vec2::splat(0.6)),
                None,
                "{kind}"
            );
            assert_eq!(case.light.emission_pdf(&bounds, 1.0, Vec3::Y, 1.0), 0.0, "{kind}");
        }
    }
}

#[test]
fn rays_of_a_light_far_from_the_origin_do_not_hit_it() {
    let at = Vec3::new(900.0, -700.0, 800.0);
    let panel = Spec::new("", "rect")
        .with("edge_u", Vec3::new(1.0, 0.3, 0.1))
        .with("edge_v", Vec3::new(-0.2, 0.4, 0.9));
    let sphere = |radius: f32| Spec::new("", "sphere").with("radius", radius);
    for spec in [panel, sphere(0.7), sphere(0.003), sphere(1e4)] {
        let far = with_light("far", spec.with("radiance", RADIANCE).with("position", at));
        let mut tracer = bilux_scene::Tracer::new(&far.scene, false);
        for i in 0..20_000u32 {
            let u = Vec2::new((i % 141) as f32 / 141.0, (i / 141) as f32 / 142.0);
            let u_direction = Vec2::new(u.y, u.x);
            let Some(sample) = far.light.sample_le(&far.scene.bounds(), 0.0, u, u_direction) else {
                continue;
            };
            let hit = tracer.closest(&sample.spawn(0.0));
            assert!(hit.is_none_or(|hit| far.scene.light_of(hit.object).is_none()), "{sample:?}");
        }
    }
}

/// A light that is alone never blocks the points sampled on it, from anywhere that is farther from it than f32 is
/// coarse there.
#[test]
fn a_sphere_is_not_in_its_own_light() {
    for (at, radius) in [(Vec3::Y * 3.0, 0.5), (Vec3::new(900.0, -700.0, 800.0), 0.5), (Vec3::X * 40.0, 0.01)]
    {
        let spec = Spec::new("", "sphere").with("radius", radius).with("radiance", RADIANCE);
        let alone = with_light("alone", spec.with("position", at));
        let mut tracer = bilux_scene::Tracer::new(&alone.scene, false);
        for i in 0..20_000 {
            let ((up, place), u) = (uniforms(0, i), uniforms(1, i).1);
            let away =
                Vec3::new(place.x - 0.5, up, place.y - 0.5).normalize() * (radius * (1.01 + 9.0 * up * up));
            let Some(sample) = alone.light.sample_li(at + away, 0.0, u) else { continue };
            let (p, point) = (at + away, sample.point.unwrap());
            let t_max = 1.0 - sample.clearance;
            let ray =
                bilux_scene::Ray { t_max, ..bilux_scene::Ray::new(p.to_array(), (point - p).to_array()) };
            assert!(!tracer.occluded(&ray), "{sample:?} from {p}");
            // And yet the ray ends close to it, where f32 can distinguish its sides.
            let is_coarse = radius < 0.1 || up < 0.2 || sample.cos() < 0.1;
            assert!(is_coarse || sample.clearance < 0.02, "{sample:?}");
        }
    }
}
