//! The box of docs/performance.md: a Cornell box with a glass and a mirror sphere of 9,024 triangles each under a
//! one-sided light, in numbers that both sides get.

use super::mitsuba::{Scratch, ply};
use crate::render::Reference;
use bilux::Error;
use bilux::math::transcendental::{cos, sin};
use bilux::math::{Rgb, Vec3};
use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Mesh, Object, SceneBuilder, Spec};
use serde_json::{Value, json};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// The width and the height of its pictures.
pub(super) const SIDE: u32 = 256;
/// Scattering events of a path.
pub(super) const MAX_DEPTH: u32 = 16;

const FOV: f32 = 39.3;
const EYE: Vec3 = Vec3::new(0.0, 0.0, 3.9);

const WHITE: Rgb = Rgb::new(0.725, 0.71, 0.68);
const RED: Rgb = Rgb::new(0.63, 0.065, 0.05);
const GREEN: Rgb = Rgb::new(0.14, 0.45, 0.091);

/// Converged picture of the box, by a renderer that is not ours and seeds that are not measured.
///
/// # Errors
/// If the file that was compiled in is broken.
pub(super) fn reference() -> Result<Reference, Error> {
    Reference::read_sized(include_bytes!("../../references/box.exr"), (SIDE, SIDE))
}

#[derive(Clone, Copy)]
enum Surface {
    Diffuse(Rgb),
    Light(f32),
    Glass(f32),
    Mirror(f32),
}

struct Part {
    name: &'static str,
    mesh: Mesh,
    surface: Surface,
}

/// The parts of the box; those with four corners are given by one of them and two edges.
fn parts() -> Vec<Part> {
    let quad = |name, corner: [f32; 3], u: Vec3, v: Vec3, surface| {
        let mesh = Mesh { normals: Vec::new(), ..Mesh::quad(corner.into(), u, v) };
        Part { name, mesh, surface }
    };
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let sphere = |name, middle: [f32; 3], surface| Part { name, mesh: sphere(middle.into(), 0.35), surface };
    vec![
        quad("floor", [-1.0, -1.0, 1.0], x, -z, Surface::Diffuse(WHITE)),
        quad("ceiling", [-1.0, 1.0, -1.0], x, z, Surface::Diffuse(WHITE)),
        quad("back", [-1.0, -1.0, -1.0], x, y, Surface::Diffuse(WHITE)),
        quad("left", [-1.0, -1.0, 1.0], -z, y, Surface::Diffuse(RED)),
        quad("right", [1.0, -1.0, -1.0], z, y, Surface::Diffuse(GREEN)),
        quad("light", [-0.25, 0.99, -0.25], x * 0.25, z * 0.25, Surface::Light(15.0)),
        sphere("glass", [0.4, -0.64, 0.3], Surface::Glass(1.5)),
        sphere("mirror", [-0.4, -0.64, -0.3], Surface::Mirror(0.95)),
    ]
}

/// A sphere of 96 × 48 patches, with smooth normals.
fn sphere(middle: Vec3, radius: f32) -> Mesh {
    let (around, down) = (96u32, 48u32);
    let normal = |k: u32| {
        let theta = PI * (k / around) as f32 / down as f32;
        let phi = TAU * (k % around) as f32 / around as f32;
        Vec3::new(sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi))
    };
    let normals: Vec<Vec3> = (0..(down + 1) * around).map(normal).collect();
    let mut triangles = Vec::new();
    for row in 0..down {
        for i in 0..around {
            let [a, b] = [i, (i + 1) % around].map(|i| row * around + i);
            let upper = (row > 0).then_some([a, b, a + around]);
            let lower = (row < down - 1).then_some([b, b + around, a + around]);
            triangles.extend(upper.into_iter().chain(lower));
        }
    }
    Mesh {
        positions: normals.iter().map(|&n| middle + n * radius).collect(),
        normals,
        triangles,
        ..Mesh::default()
    }
}

/// Our side.
pub(super) fn scene() -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    for Part { name, mesh, surface } in parts() {
        let diffuse = |reflectance: Rgb| Spec::new(name, "diffuse").with("reflectance", reflectance);
        let material = match surface {
            Surface::Diffuse(colour) => diffuse(colour),
            Surface::Light(radiance) => {
                diffuse(Rgb::BLACK).with("emission", Rgb::grey(radiance)).with("emission_sides", "front")
            }
            Surface::Glass(eta) => Spec::new(name, "dielectric").with("eta", eta),
            Surface::Mirror(reflectance) => Spec::new(name, "mirror").with("reflectance", reflectance),
        };
        let material = scene.add_material(material);
        scene.objects.push(Object::new(name, Arc::new(mesh), material));
    }
    let camera =
        Spec::new("front", "perspective").with("position", EYE).with("look_at", Vec3::ZERO).with("fov", FOV);
    scene.cameras.push(CameraSpec { spec: camera, keyframes: Vec::new() });
    scene
}

/// The other side: what Mitsuba's `load_dict` takes.
///
/// # Errors
/// If a mesh cannot be written.
pub(super) fn for_mitsuba(scratch: &Scratch) -> Result<Value, Error> {
    let mut scene = super::mitsuba::scene(EYE, Vec3::ZERO, FOV, [SIDE; 2], MAX_DEPTH);
    for Part { name, mesh, surface } in parts() {
        let rgb = |value: Rgb| json!({ "type": "rgb", "value": value.to_array() });
        let bsdf = match surface {
            Surface::Diffuse(colour) => json!({ "type": "diffuse", "reflectance": rgb(colour) }),
            Surface::Light(_) => json!({ "type": "diffuse", "reflectance": rgb(Rgb::BLACK) }),
            Surface::Glass(eta) => json!({ "type": "dielectric", "int_ior": eta, "ext_ior": 1.0 }),
            Surface::Mirror(reflectance) => {
                let reflectance = rgb(Rgb::grey(reflectance));
                json!({ "type": "conductor", "material": "none", "specular_reflectance": reflectance })
            }
        };
        let mut shape = json!({ "type": "ply", "filename": ply(scratch, name, mesh)?, "bsdf": bsdf });
        if let Surface::Light(radiance) = surface {
            shape["emitter"] = json!({ "type": "area", "radiance": rgb(Rgb::grey(radiance)) });
        }
        scene[name] = shape;
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_face_outwards_and_walls_inwards() {
        for Part { name, mesh, .. } in parts() {
            let middle = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
            for corners in &mesh.triangles {
                let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
                let front = (b - a).cross(c - a);
                let away = (a + b + c) / 3.0 - middle;
                let is_right =
                    if mesh.normals.is_empty() { front.dot(middle) < 0.0 } else { front.dot(away) > 0.0 };
                assert!(is_right, "{name}: {corners:?}");
            }
            assert!(matches!(mesh.triangles.len(), 2 | 9024), "{name}: {}", mesh.triangles.len());
        }
    }

    #[test]
    fn the_reference_is_of_this_box() {
        let reference = reference().unwrap();
        assert!((reference.mean() - 0.2473).abs() < 1e-3 && reference.relmse < 1e-3, "{}", reference.mean());
    }
}
