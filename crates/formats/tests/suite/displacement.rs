//! Surfaces that a picture moves.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_math::transcendental::{cos, sin};
use bilux_math::{Rgb, Vec3};
use bilux_pictures::{Picture, write_bytes};
use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashMap;

/// The scene of `main` in a folder with a picture of 64 by 64 texels: `f` of the place from the lower left corner, 0 to 1.
fn with_map(main: &str, text: &str, f: impl Fn(f32, f32) -> [f32; 3], max_memory: u64) -> SceneBuilder {
    const SIDE: usize = 64;
    let folder = tempfile::tempdir().unwrap();
    let at = |i: usize| (i as f32 + 0.5) / SIDE as f32;
    let texels = (0..SIDE * SIDE).map(|i| Rgb::from_array(f(at(i % SIDE), 1.0 - at(i / SIDE))));
    let picture = Picture::from_rgb(SIDE, SIDE, texels.collect()).unwrap();
    let bytes = write_bytes("pfm", &picture, &Default::default()).unwrap();
    std::fs::write(folder.path().join("map.pfm"), bytes).unwrap();
    let mtl = "newmtl m\ndisp -mm -0.25 0.5 map.pfm\n";
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    std::fs::write(folder.path().join(main), text).unwrap();
    read(&folder.path().join(main), &ReadOptions { max_memory, ..ReadOptions::default() }).unwrap()
}

fn model(shape: &str, displacement: &str, f: impl Fn(f32, f32) -> [f32; 3]) -> SceneBuilder {
    let text = format!(
        "[[model]]\n{shape}\ndisplacement = {{ map = {{ texture = \"map.pfm\" }}, {displacement} }}\n"
    );
    let scene = with_map("scene.toml", &text, f, 1 << 30);
    assert_eq!(warnings(&scene), "");
    scene
}

/// The number of edges that have a triangle on one side only, by the places of their ends.
fn open_edges(mesh: &Mesh) -> usize {
    let mut sides: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    let place = |i: u32| mesh.positions[i as usize].to_array().map(|x| (x + 0.0).to_bits());
    for [a, b, c] in &mesh.triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]].map(|edge| edge.map(place)) {
            let (edge, side) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
            *sides.entry(edge).or_default() += side;
        }
    }
    sides.into_iter().filter(|(edge, sum)| edge[0] != edge[1] && *sum != 0).count()
}

#[test]
fn heights_move_points_along_normals() {
    let scene = model("shape = \"sphere\"", "scale = 0.5, middle = 0.25", |_, _| [0.75; 3]);
    let mesh = &scene.objects[0].mesh;
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        // Chords of the ball's first triangles lie a little within it.
        assert!((position.length() - 1.25).abs() < 3e-3, "{position:?}");
        assert!(normal.dot(position.normalize()) > 0.999, "{position:?}: {normal:?}");
    }
}

#[test]
fn a_slope_has_the_height_and_the_normal_of_its_map() {
    // Heights of a slope: 0.3 u - 0.2 v over a square of 2 by 2.
    let f = |u: f32, v: f32| [0.3 * u - 0.2 * v; 3];
    let scene = model("shape = \"quad\"\nu = [2, 0, 0]\nv = [0, 0, -2]", "", f);
    let mesh = &scene.objects[0].mesh;
    assert!(
        mesh.triangles.len() > 64 * 64 && mesh.triangles.len() < 64 * 64 * 64,
        "{}",
        mesh.triangles.len()
    );
    let wanted = Vec3::new(-0.15, 1.0, -0.1).normalize();
    let is_inner = |p: &Vec3| p.x.abs() < 0.9 && p.z.abs() < 0.9;
    let mut count = 0;
    for (i, (p, n)) in mesh.positions.iter().zip(&mesh.normals).enumerate().filter(|(_, (p, _))| is_inner(p))
    {
        assert!((p.y - (0.15 * p.x + 0.1 * p.z + 0.05)).abs() < 1e-5, "{p:?} {:?}", mesh.uvs[i]);
        assert!(n.dot(wanted) > 0.9999, "{n:?}");
        count += 1;
    }
    assert!(count > 1000);
}

#[test]
fn vectors_move_points_along_tangents_or_axes() {
    let quad = "shape = \"quad\"\nu = [2, 0, 0]\nv = [0, 0, -2]";
    // The tangent is x, the normal y, and the bitangent -z.
    for (along, wanted) in [("axes", [0.1, 0.2, 0.3]), ("tangents", [0.1, 0.2, -0.3])] {
        let scene = model(quad, &format!("along = \"{along}\""), |_, _| [0.1, 0.2, 0.3]);
        let low = scene.objects[0].mesh.positions.iter().copied().reduce(Vec3::min).unwrap();
        assert!((low - Vec3::from(wanted) - Vec3::new(-1.0, 0.0, -1.0)).length() < 1e-5, "{along}: {low:?}");
    }
}

#[test]
fn what_was_closed_stays_closed() {
    let rough = |u: f32, v: f32| [0.5 + 0.5 * sin(40.0 * u) * cos(31.0 * v + 9.0 * u); 3];
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
                vt 0 1\nmtllib m.mtl\nusemtl m\nf 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\n\
                f 3/1 4/2 8/3 7/4\nf 1/1 5/2 8/3 4/4\nf 2/1 3/2 7/3 6/4\n";
    for shape in ["cube", "sphere"] {
        let scene = match shape {
            "cube" => with_map("m.obj", cube, rough, 1 << 30),
            shape => model(&format!("shape = \"{shape}\""), "scale = 0.1", rough),
        };
        let mesh = &scene.objects[0].mesh;
        assert!(mesh.triangles.len() > 10_000, "{shape}");
        assert_eq!(open_edges(mesh), 0, "{shape}");
        scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    }
}

/// Each format states these heights in its own way: half of the map, less a quarter.
#[test]
fn maps_of_materials_mean_the_same_in_every_format() {
    let f = |u: f32, _: f32| [u; 3];
    let obj = "mtllib m.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
               usemtl m\nf 1/1 2/2 3/3 4/4\n";
    let usd = r#"#usda 1.0
        def Mesh "m" {
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
            texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
            uniform token subdivisionScheme = "none"
            rel material:binding = </mat>
        }
        def Material "mat" {
            token outputs:surface.connect = </mat/s.outputs:surface>
            def Shader "s" {
                uniform token info:id = "UsdPreviewSurface"
                float inputs:displacement.connect = </mat/t.outputs:r>
                token outputs:surface
            }
            def Shader "t" {
                uniform token info:id = "UsdUVTexture"
                asset inputs:file = @map.pfm@
                float4 inputs:scale = (0.5, 0.5, 0.5, 1)
                float4 inputs:bias = (-0.25, -0.25, -0.25, 0)
                float outputs:r
            }
        }"#;
    for (main, text) in [("m.obj", obj), ("m.usda", usd)] {
        let scene = with_map(main, text, f, 1 << 30);
        assert_eq!(warnings(&scene), "", "{main}");
        let mesh = &scene.objects[0].mesh;
        assert!(mesh.triangles.len() > 64 * 64, "{main}: {}", mesh.triangles.len());
        for p in mesh.positions.iter().filter(|p| (0.1..1.9).contains(&p.x)) {
            assert!((p.z - (0.25 * p.x - 0.25)).abs() < 1e-5, "{main}: {p:?}");
        }
    }
}

#[test]
fn what_cannot_be_displaced_is_said() {
    let f = |u: f32, v: f32| [u * v; 3];
    let bare = "mtllib m.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nusemtl m\nf 1 2 3\n";
    let said = warnings(&with_map("m.obj", bare, f, 1 << 30));
    assert!(said.contains("m.mtl:2") && said.contains("has no texture coordinates"), "{said}");
    let ball = "[[model]]\nshape = \"sphere\"\ndisplacement = { map = { texture = \"map.pfm\" } }\n";
    let scene = with_map("scene.toml", ball, f, 4 << 20);
    let said = warnings(&scene);
    assert!(said.contains("coarser than its map"), "{said}");
    let wrong = [
        ("displacement = 1", "a table, as in { map"),
        ("displacement = { scale = 1 }", "map (the picture of a displacement)"),
        ("displacement = { map = 1 }", "a texture, as in"),
        (
            "displacement = { map = { texture = \"x.png\" }, along = \"up\" }",
            "must be one of normal, tangents, axes",
        ),
        ("displacement = { map = { texture = \"x.png\" }, sacle = 1 }", "scale"),
    ];
    for (line, wanted) in wrong {
        let text = format!("[[model]]\nshape = \"sphere\"\n{line}\n").replace("x.png", "map.pfm");
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("map.pfm"), b"PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0").unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let said = read(&path, &ReadOptions::default()).map(drop).unwrap_err().to_string();
        assert!(said.contains(wanted), "{said}");
    }
}
