//! `--preset course` with `cast` gives the picture of the course's renderer, within a grey level.
#![allow(clippy::print_stderr, reason = "a test that skips says so")]

use bilux::gallery::teapot::Teapot;
use bilux_math::Vec3;
use bilux_scene::{AccelChoice, Mesh, Object, SceneBuilder, Spec, presets};
use bilux_transport::{PixelAnchor, RenderSettings, Silent, integrators, render};
use bilux_validation::course_oracle::{SIZE, course_picture};
use std::fmt::Write;
use std::sync::Arc;

/// The corners of an `.asc` file as a mesh, read as simply as possible.
fn mesh_of(asc: &str) -> Mesh {
    let numbers: Vec<f32> = asc.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let vector = |v: &[f32]| Vec3::new(v[0], v[1], v[2]);
    let corners = numbers.len() as u32 / 8;
    Mesh {
        positions: numbers.chunks(8).map(vector).collect(),
        normals: numbers.chunks(8).map(|v| vector(&v[3..])).collect(),
        triangles: (0..corners / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    }
}

/// Our picture of the file: the preset, `cast`, and bytes proportional to light.
fn ours(asc: &str) -> Vec<u8> {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(Spec::new("", "diffuse"));
    scene.objects.push(Object::new("file", Arc::new(mesh_of(asc)), material));
    presets::apply("course", &mut scene).unwrap();
    let mut cast = Spec::new("", "cast");
    for key in ["viewer", "specular", "shadows"] {
        let (value, _) = scene.settings.find(key).unwrap();
        cast.parameters.set(key, value.clone());
    }
    let scene = scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let settings = RenderSettings {
        pixel_anchor: PixelAnchor::Corner,
        ..RenderSettings::new(SIZE as u32, SIZE as u32, 1)
    };
    let integrator = integrators::build(&cast).unwrap();
    let camera = scene.cameras()[0].1.clone();
    let film = render(&scene, &*camera, &*integrator, &settings, &Silent).unwrap().film;
    let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
    film.to_rgb().iter().flat_map(|c| c.to_array().map(byte)).collect()
}

/// Pixels that differ by more than a grey level in some channel.
fn differing(a: &[u8], b: &[u8]) -> usize {
    let far = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    a.chunks(3).zip(b.chunks(3)).filter(|pair| far(*pair)).count()
}

fn teapot_file() -> String {
    let mesh = Teapot { height: 1.1, ..Teapot::default() }.mesh();
    let mut asc = String::new();
    for triangle in &mesh.triangles {
        asc.push_str("triangle\n");
        for &i in triangle {
            let (p, n) = (mesh.positions[i as usize], mesh.normals[i as usize]);
            let (x, y, z, nx, ny, nz) = (p.x, p.y, p.z, n.x, n.y, n.z);
            writeln!(asc, "{x} {y} {z} {nx} {ny} {nz} 0 0").unwrap();
        }
    }
    asc
}

/// Pixels that may differ: where an edge passes a pixel's corner more closely than f32 resolves, the two may see different things.
const ON_EDGES: usize = 4;

#[test]
fn a_teapot_is_the_picture_that_its_authors_saw() {
    let asc = teapot_file();
    let (ours, theirs) = (ours(&asc), course_picture(&asc).unwrap());
    let background = theirs.chunks(3).filter(|p| *p == [128, 112, 96]).count();
    assert!((SIZE * SIZE / 10..SIZE * SIZE).contains(&background), "{background}");
    let differing = differing(&ours, &theirs);
    assert!(differing <= ON_EDGES, "{differing} pixels");
}

#[test]
fn real_files_too() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/asc");
    for name in ["teapot_lf.asc", "teapot_cr.asc", "teapot_floor_cr.asc"] {
        let Ok(asc) = std::fs::read_to_string(format!("{folder}/{name}")) else {
            eprintln!("skipped: {folder}/{name} is not there");
            continue;
        };
        let differing = differing(&ours(&asc), &course_picture(&asc).unwrap());
        assert!(differing <= ON_EDGES, "{name}: {differing} pixels");
    }
}

#[test]
fn a_light_on_the_wrong_side_is_noticed() {
    let asc = teapot_file();
    let mirrored: Vec<u8> =
        ours(&asc).chunks(3 * SIZE).flat_map(|row| row.rchunks(3).flatten().copied()).collect();
    assert!(differing(&mirrored, &course_picture(&asc).unwrap()) > SIZE * SIZE / 50);
}
