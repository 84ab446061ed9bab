//! Writes `.asc`.

use bilux_import::FormatError;
use bilux_import::bytes::float::push_f32s;
use bilux_import::input::reading::default_material;
use bilux_import::output::bake::{corners, flat_normal, in_place, name_of, warn_of_scene};
use bilux_import::output::values::{colour, number};
use bilux_import::output::writing::Writing;
use bilux_math::{Rgb, Vec2};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, ".asc", writing);
    let bare = default_material();
    for object in &scene.objects {
        let spec = scene.materials.get(object.material).unwrap_or(&bare);
        let config = Config::of(spec, &object.mesh, writing);
        if scene.objects.len() > 1 || config.is_some() {
            heading(object, &mut writing.main);
        }
        if let Some(config) = config {
            writing.main.extend_from_slice(b"config ");
            push_f32s(&mut writing.main, &config.0);
            writing.main.push(b'\n');
        }
        let mesh = in_place(object, writing);
        triangles(&mesh, writing);
    }
    Ok(())
}

/// Writes the `object NAME` line.
fn heading(object: &Object, out: &mut Vec<u8>) {
    let name = name_of(object).replace(['\n', '\r'], " ");
    out.extend_from_slice(b"object");
    if !name.is_empty() {
        out.push(b' ');
        out.extend_from_slice(name.as_bytes());
    }
    out.push(b'\n');
}

/// The values of a `config` line: ks, kd and reflectivity.
struct Config([f32; 7]);

impl Config {
    /// `None` if a reader arrives at the same material without the line.
    fn of(spec: &Spec, mesh: &Mesh, writing: &mut Writing) -> Option<Config> {
        if spec.kind == "phong" && spec.parameters.0.is_empty() && mesh.vertex_kd.is_empty() {
            return None;
        }
        let grey = |key: &str, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
        let (kd, ks, reflectivity) = match spec.kind.as_str() {
            "phong" => {
                let reflectivity = number(spec, "reflectivity").unwrap_or(1.0);
                (grey("kd", 0.7), grey("ks", 0.3), reflectivity)
            }
            "diffuse" => (grey("reflectance", 0.7), Rgb::BLACK, 0.0),
            "mirror" => (Rgb::BLACK, grey("reflectance", 0.95), 1.0),
            other => {
                writing.warn(format!(
                    ".asc files cannot store the material '{other}': it is written with a white highlight"
                ));
                (Rgb::BLACK, Rgb::WHITE, 1.0)
            }
        };
        for (key, value, _) in &spec.parameters.0 {
            if !["kd", "ks", "reflectivity", "reflectance"].contains(&key.as_str()) {
                writing.warn(format!(".asc files cannot store '{key}' of a material: left out"));
            } else if matches!(value, Value::Texture(_)) {
                writing.warn(".asc files cannot store textures: they are written as white");
            }
        }
        let implied = spec.kind == "phong" && (kd, ks, reflectivity) == (Rgb::WHITE, Rgb::WHITE, 1.0);
        if implied && !mesh.vertex_kd.is_empty() {
            return None;
        }
        Some(Config([ks.r, ks.g, ks.b, kd.r, kd.g, kd.b, reflectivity]))
    }
}

fn triangles(mesh: &Mesh, writing: &mut Writing) {
    let coloured = !(mesh.vertex_kd.is_empty() && mesh.vertex_ks.is_empty());
    let out = &mut writing.main;
    for &triangle in &mesh.triangles {
        let Some(points) = corners(mesh, triangle) else { continue };
        let flat = flat_normal(points);
        out.extend_from_slice(b"triangle\n");
        for (corner, point) in triangle.into_iter().zip(points) {
            let i = corner as usize;
            let normal = mesh.normals.get(i).copied().unwrap_or(flat);
            let uv = mesh.uvs.get(i).copied().unwrap_or(Vec2::ZERO);
            push_f32s(out, &[point.x, point.y, point.z, normal.x, normal.y, normal.z, uv.x, uv.y]);
            if coloured {
                let kd = mesh.vertex_kd.get(i).copied().unwrap_or(Rgb::WHITE);
                let ks = mesh.vertex_ks.get(i).copied().unwrap_or(Rgb::WHITE);
                out.push(b' ');
                push_f32s(out, &[kd.r, kd.g, kd.b, ks.r, ks.g, ks.b]);
            }
            out.push(b'\n');
        }
    }
}
