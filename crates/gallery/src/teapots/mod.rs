//! The paper's scene: teapots on a green floor, two to five of them, or any number.

mod coverage;

use crate::teapot::{NEWELL_HEIGHT, TESSELLATION, Teapot};
use crate::{GeneratorEntry, choice, integer, switch, vector};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, Quat, Rgb, Transform, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, Object, Parameters, Reader, SceneBuilder, Spec};
use coverage::Pinhole;
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "teapots",
        summary: "the paper's scene: teapots on a green floor, each at a fixed offset from the one before",
        source: "Newell 1975",
        parameters: &[
            integer("count", "number of teapots", 1, 10_000, "3"),
            vector("offset", "offset from each teapot to the next, in the layout 'paper'", "1.6 0 -4.6"),
            choice(
                "layout",
                "paper: in a row, seen from a fixed position; equal-coverage: in a block, seen from a distance at \
                 which the teapots always cover a fifth of a square picture",
                &["paper", "equal-coverage"],
                "paper",
            ),
            TESSELLATION,
            switch(
                "instanced",
                "one tree that all teapots share, instead of one tree over all triangles",
                "false",
            ),
            switch("per_vertex", "diffuse and specular reflectance that vary from vertex to vertex", "false"),
            switch("moving", "the last teapot circles around the one before", "false"),
            switch("walk", "the camera moves around the teapots and closer", "false"),
            Parameter {
                name: "seconds",
                summary: "duration of the movement",
                unit: "s",
                kind: ParameterKind::Number { min: 1e-3, max: 1e6 },
                default: "4",
            },
        ],
    },
    triangles: |reader| 64 * (reader.integer("tessellation") as u64).pow(2),
    generate: |reader| {
        let mut scene = SceneBuilder::default();
        let places = places(reader);
        add_teapots(&mut scene, reader, &places);
        let bounds = scene.bounds(0.0);
        add_floor(&mut scene, &bounds);
        add_lights(&mut scene);
        add_camera(&mut scene, reader, &places, &bounds);
        Ok(scene)
    },
};

/// Spacing in the block of teapots.
const ACROSS: f32 = 7.5;
const BACK: f32 = 4.5;

/// The fraction of a square image that the teapots of `equal-coverage` cover.
const COVERAGE: f64 = 0.2;

/// The positions of the teapots.
fn places(reader: &Reader) -> Vec<Vec3> {
    let count = reader.integer("count") as u32;
    if reader.text("layout") == "paper" {
        let offset = reader.vector("offset").as_dvec3();
        return (0..count).map(|i| (offset * f64::from(i)).as_vec3()).collect();
    }
    let columns = ((count as f32 * BACK / ACROSS).sqrt().round() as u32).max(1);
    (0..count)
        .map(|i| Vec3::new((i % columns) as f32 * ACROSS, 0.0, -((i / columns) as f32) * BACK))
        .collect()
}

/// Names and colours that the teapots cycle through.
const GLAZES: [(&str, Rgb); 5] = [
    ("copper", Rgb::new(0.75, 0.33, 0.16)),
    ("cream", Rgb::new(0.78, 0.70, 0.52)),
    ("blue", Rgb::new(0.14, 0.28, 0.62)),
    ("plum", Rgb::new(0.48, 0.16, 0.36)),
    ("slate", Rgb::new(0.30, 0.36, 0.40)),
];

fn add_teapots(scene: &mut SceneBuilder, reader: &Reader, places: &[Vec3]) {
    let tessellation = reader.integer("tessellation") as u32;
    let mut mesh = Teapot { tessellation, ..Teapot::default() }.mesh();
    if reader.bool("per_vertex") {
        vary(&mut mesh);
    }
    let mesh = Arc::new(mesh);
    for (name, kd) in GLAZES.iter().take(places.len()) {
        let glaze = Spec::new(name, "phong").with("kd", *kd).with("ks", 0.25f32).with("exponent", 60.0f32);
        scene.add_material(glaze);
    }
    for (i, &place) in places.iter().enumerate() {
        let object = Object::new(&format!("teapot {}", i + 1), mesh.clone(), i % GLAZES.len());
        scene.objects.push(Object { motion: standing(place), instanced: reader.bool("instanced"), ..object });
    }
    if let (true, Some(last)) = (reader.bool("moving"), scene.objects.last_mut()) {
        let around = places.iter().rev().nth(1).map_or(Vec3::ZERO, |p| *p);
        let circle = circling(around, places[places.len() - 1] - around, reader.number("seconds"));
        last.motion = circle.unwrap_or_else(|| last.motion.clone());
    }
}

fn standing(place: Vec3) -> Motion {
    let matrix = bilux_math::DMat4::from_translation(place.as_dvec3());
    Motion::still(Transform::from_matrix(matrix).unwrap_or_default())
}

/// One revolution around a point, facing the direction of travel.
fn circling(around: Vec3, from: Vec3, seconds: f32) -> Option<Motion> {
    const STEPS: u32 = 12;
    let radius = if from.length() > 0.0 { from } else { Vec3::X * ACROSS };
    let keys = (0..=STEPS).map(|step| {
        let fraction = step as f32 / STEPS as f32;
        let rotation = Quat::from_rotation_y(-std::f32::consts::TAU * fraction);
        let time_seconds = seconds * fraction;
        MotionKey { time_seconds, translation: around + rotation * radius, rotation, scale: Vec3::ONE }
    });
    Motion::from_keys(keys.collect())
}

/// Darker and glossier towards the foot, like a glaze that has run.
fn vary(mesh: &mut Mesh) {
    let height = |p: &Vec3| (p.y / NEWELL_HEIGHT as f32).clamp(0.0, 1.0);
    mesh.vertex_kd = mesh.positions.iter().map(|p| Rgb::grey(0.45 + 0.55 * height(p))).collect();
    mesh.vertex_ks = mesh.positions.iter().map(|p| Rgb::grey(1.0 - 0.7 * height(p))).collect();
}

fn add_floor(scene: &mut SceneBuilder, bounds: &Aabb) {
    let green = Spec::new("green", "phong")
        .with("kd", Rgb::new(0.10, 0.42, 0.14))
        .with("ks", 0.12f32)
        .with("exponent", 40.0f32);
    let material = scene.add_material(green);
    let middle = bounds.centre() * Vec3::new(1.0, 0.0, 1.0);
    let side = 8.0 * bounds.extent().max_element() + 120.0;
    scene.objects.push(Object::new("floor", Arc::new(shapes::floor(middle, side)), material));
}

/// A sun from the left, a weak one from the right, and a sky.
fn add_lights(scene: &mut SceneBuilder) {
    let sun = |name: &str, direction: Vec3, irradiance: Rgb| {
        Spec::new(name, "directional").with("direction", direction).with("irradiance", irradiance)
    };
    scene.lights.push(sun("key", Vec3::new(0.55, -1.0, -0.5), Rgb::new(2.3, 2.2, 2.0)));
    scene.lights.push(sun("fill", Vec3::new(-0.9, -0.6, -0.35), Rgb::new(0.35, 0.4, 0.5)));
    scene.lights.push(
        Spec::new("sky", "environment")
            .with("zenith", Rgb::new(0.16, 0.27, 0.52))
            .with("horizon", Rgb::new(0.62, 0.66, 0.72))
            .with("ground", Rgb::new(0.10, 0.12, 0.10)),
    );
}

fn add_camera(scene: &mut SceneBuilder, reader: &Reader, places: &[Vec3], bounds: &Aabb) {
    let (eye, look_at) = if reader.text("layout") == "paper" {
        (Vec3::new(9.0, 7.6, 15.4), Vec3::new(2.2, 0.9, -5.0))
    } else {
        let towards = Vec3::new(0.30, 0.62, 1.0).normalize();
        let middle = bounds.centre();
        (middle + towards * distance_for(places, middle, towards, bounds.radius()), middle)
    };
    let spec =
        Spec::new("eye", "perspective").with("fov", FOV).with("position", eye).with("look_at", look_at);
    let mut keyframes = Vec::new();
    if reader.bool("walk") {
        const STEPS: u32 = 8;
        for step in 0..=STEPS {
            let fraction = step as f32 / STEPS as f32;
            let (sin, cos) = sin_cos(std::f32::consts::FRAC_PI_2 * fraction);
            let from = (eye - look_at) * (1.0 - 0.35 * fraction);
            let turned = Vec3::new(cos * from.x + sin * from.z, from.y, cos * from.z - sin * from.x);
            let mut changes = Parameters::default();
            changes.set("position", look_at + turned);
            keyframes.push((reader.number("seconds") * fraction, changes));
        }
    }
    scene.cameras.push(CameraSpec { spec, keyframes });
}

const FOV: f32 = 40.0;

/// The camera distance at which the teapots cover [`COVERAGE`] of a square image.
fn distance_for(places: &[Vec3], middle: Vec3, towards: Vec3, radius: f32) -> f32 {
    let coarse = Teapot { tessellation: 2, ..Teapot::default() }.mesh();
    let (mut near, mut far) = (radius * 1.05, radius * 40.0);
    for _ in 0..16 {
        let distance = (near * far).sqrt();
        let triangles = places.iter().flat_map(|&place| {
            let corner = |i: u32| coarse.positions[i as usize] + place;
            coarse.triangles.iter().map(move |t| t.map(corner)).collect::<Vec<_>>()
        });
        let covered = Pinhole::new(middle + towards * distance, middle, FOV).coverage(triangles);
        if covered > COVERAGE { near = distance } else { far = distance }
    }
    (near * far).sqrt()
}
