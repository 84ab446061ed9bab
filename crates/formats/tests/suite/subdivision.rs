//! Polygons as the cages of subdivision surfaces.

use crate::warnings;
use bilux_formats::{ReadOptions, Scheme, read_bytes};
use bilux_scene::SceneBuilder;

/// A cube with the side 2, of two materials, with texture coordinates.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
                    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng caps\nusemtl a\nf 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\n\
                    g sides\nusemtl b\nf 1/1 2/2 6/3 5/4\nf 3/1 4/2 8/3 7/4\nf 1/1 5/2 8/3 4/4\nf 2/1 3/2 7/3 6/4\n";

fn read(text: &str, scheme: Option<Scheme>, max_memory: u64) -> SceneBuilder {
    let options = ReadOptions { subdivide: scheme, max_memory, ..ReadOptions::default() };
    read_bytes(text.as_bytes(), "obj", None, "cube.obj", &options).unwrap()
}

#[test]
fn a_cube_becomes_round_with_its_objects_and_texture_coordinates() {
    let flat = read(CUBE, None, 1 << 30);
    let round = read(CUBE, Some(Scheme::CatmullClark), 1 << 30);
    assert_eq!(flat.bounds(0.0).max.to_array(), [1.0; 3]);
    // The middle of a side ends at (16 + 4 (4 · 3/4) + 4 · 5/9) / 36 of it, by the masks of [Halstead 1993].
    let wanted = (16.0 + 12.0 + 20.0 / 9.0) / 36.0;
    assert!((round.bounds(0.0).max - wanted).abs().max_element() < 1e-6, "{:?}", round.bounds(0.0));
    let names =
        |scene: &SceneBuilder| scene.objects.iter().map(|o| (o.name.clone(), o.material)).collect::<Vec<_>>();
    assert_eq!(names(&round), names(&flat));
    for object in &round.objects {
        let mesh = &object.mesh;
        assert!(mesh.triangles.len() > 1000 && mesh.uvs.len() == mesh.positions.len());
        assert!(mesh.uvs.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
        let outward = mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| p.normalize().dot(*n) > 0.9);
        assert!(outward);
    }
    // Normals are smooth where the objects meet.
    let normals = |object: usize| {
        let mesh = &round.objects[object].mesh;
        let pairs = mesh.positions.iter().zip(&mesh.normals);
        pairs.map(|(p, n)| (p.to_array().map(f32::to_bits), *n)).collect::<std::collections::HashMap<_, _>>()
    };
    let (caps, sides) = (normals(0), normals(1));
    let shared: Vec<_> = caps.iter().filter_map(|(p, n)| Some((n, sides.get(p)?))).collect();
    assert!(shared.len() > 100 && shared.iter().all(|(a, b)| a.dot(**b) > 0.99999), "{}", shared.len());
    round.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
}

#[test]
fn triangles_are_rounded_by_loop_and_bilinear_keeps_the_shape() {
    let round = read(CUBE, Some(Scheme::Loop), 1 << 30);
    assert!(round.bounds(0.0).max.max_element() < 0.9);
    let same = read(CUBE, Some(Scheme::Bilinear), 1 << 30);
    assert_eq!(same.bounds(0.0).max.to_array(), [1.0; 3]);
}

#[test]
fn a_cage_is_as_fine_as_it_is_large_in_the_picture_and_as_memory_allows() {
    let count = |scene: &SceneBuilder| scene.objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>();
    let fine = read(CUBE, Some(Scheme::CatmullClark), 1 << 30);
    let coarse = read(CUBE, Some(Scheme::CatmullClark), 1 << 20);
    assert!(warnings(&coarse).contains("take more memory than is allowed"), "{}", warnings(&coarse));
    assert!(count(&coarse) < count(&fine) && count(&coarse) >= 48, "{}", count(&coarse));
    // What is small in the picture needs less.
    let with_far = read(
        &format!("{CUBE}v 500 0 0\nv 500 1 0\nv 500 0 1\nf 9 10 11\n"),
        Some(Scheme::CatmullClark),
        1 << 30,
    );
    assert!(count(&with_far) < count(&fine) / 4, "{} {}", count(&with_far), count(&fine));
}

#[test]
fn broken_cages_do_no_harm() {
    for faces in
        ["f 1 2 3\nf 1 2 3\nf 3 2 1\nf 1 3 5\n", "f 1 1 2\nf 1 2 2 3\n", "f 1 2 3 4 5 6 7 8\n", "f 1 2 nan\n"]
    {
        let text = CUBE.lines().take(8).map(|line| format!("{line}\n")).collect::<String>() + faces;
        for (_, scheme) in Scheme::ALL {
            let options =
                ReadOptions { subdivide: Some(scheme), max_memory: 16 << 20, ..ReadOptions::default() };
            if let Ok(scene) = read_bytes(text.as_bytes(), "obj", None, "x", &options) {
                let _ = scene.build(&Default::default(), [0.0, 0.0], 1.0);
            }
        }
    }
}

/// The cube as USD, with more lines in its mesh. A triangle far away makes it small in the picture, so that it gets few polygons.
fn usd(lines: &str) -> SceneBuilder {
    let text = format!(
        "#usda 1.0\n(defaultPrim = \"c\")\ndef Mesh \"c\" {{\n\
         int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]\n\
         int[] faceVertexIndices = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]\n\
         point3f[] points = [(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1), (-1, -1, 1), (1, -1, 1), (-1, 1, 1), \
         (1, 1, 1)]\n{lines}\n}}\n\
         def Mesh \"far\" {{\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n\
         point3f[] points = [(20, 0, 0), (20, 1, 0), (20, 0, 1)]\nuniform token subdivisionScheme = \"none\"\n}}\n"
    );
    let mut scene = read_bytes(text.as_bytes(), "usda", None, "cube.usda", &ReadOptions::default()).unwrap();
    scene.objects.truncate(1);
    scene
}

#[test]
fn meshes_of_usd_are_refined_by_their_schemes_and_creases() {
    let size = |scene: &SceneBuilder| scene.bounds(0.0).max;
    let round = (16.0 + 12.0 + 20.0 / 9.0) / 36.0;
    // The scheme of meshes that state none is Catmull and Clark's. [OpenUSD, UsdGeomMesh]
    for lines in [
        "",
        "uniform token subdivisionScheme = \"catmullClark\"",
        "uniform token orientation = \"leftHanded\"",
    ] {
        let scene = usd(lines);
        assert!((size(&scene) - round).abs().max_element() < 1e-6, "{lines}: {:?}", size(&scene));
        let mesh = &scene.objects[0].mesh;
        let side = if lines.contains("leftHanded") { -1.0 } else { 1.0 };
        let outward =
            mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| side * p.normalize().dot(*n) > 0.9);
        assert!(outward, "{lines}");
        assert_eq!(warnings(&scene), "", "{lines}");
    }
    // Normals count where nothing else says that the mesh is a subdivision surface: exporters of polygons forget to say `none`.
    let normals = "normal3f[] normals = [(0, 0, 1)] (interpolation = \"constant\")";
    for lines in [
        format!("{normals}\nuniform token subdivisionScheme = \"catmullClark\""),
        format!("{normals}\nint[] cornerIndices = [0]\nfloat[] cornerSharpnesses = [0]"),
    ] {
        let scene = usd(&lines);
        assert!((size(&scene) - round).abs().max_element() < 1e-6, "{lines}: {:?}", size(&scene));
        assert_eq!(warnings(&scene), "", "{lines}");
        assert!(scene.notes.iter().any(|note| note.message.contains("normals of subdivision surfaces")));
    }
    let flat = ["uniform token subdivisionScheme = \"none\"", normals];
    for lines in flat {
        assert_eq!(
            (size(&usd(lines)).to_array(), usd(lines).objects[0].mesh.triangles.len()),
            ([1.0; 3], 12),
            "{lines}"
        );
    }
    // The upper square keeps its place, as sharp as can be; its corners are kept too.
    let sharp = usd(
        "int[] creaseIndices = [4, 5, 7, 6, 4]\nint[] creaseLengths = [5]\nfloat[] creaseSharpnesses = [10]\n\
                     int[] cornerIndices = [4, 5, 6, 7]\nfloat[] cornerSharpnesses = [10, 10, 10, 10]",
    );
    assert_eq!(size(&sharp).to_array(), [1.0; 3]);
    assert!(sharp.bounds(0.0).min.max_element() > -1.0 && sharp.bounds(0.0).min.z > -0.9);
    // Less sharp lies between.
    let soft = usd(
        "int[] creaseIndices = [4, 5, 7, 6, 4]\nint[] creaseLengths = [5]\nfloat[] creaseSharpnesses = [1.5, 1.5, 1.5, 1.5]",
    );
    let side = size(&soft).x;
    assert!(side > round + 0.02 && side < 0.95, "{side}");
}

#[test]
fn many_surfaces_take_as_long_as_there_are_of_them() {
    let mut text = "#usda 1.0\n".to_owned();
    for i in 0..4000 {
        text += &format!(
            "def Mesh \"m{i}\" {{\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n\
             point3f[] points = [({i}, 0, 0), ({i}, 1, 0), ({i}, 0, 1)]\n}}\n"
        );
    }
    let begin = std::time::Instant::now();
    let scene = read_bytes(text.as_bytes(), "usda", None, "many.usda", &ReadOptions::default()).unwrap();
    assert_eq!(scene.objects.len(), 4000);
    // A second on a slow machine; much longer if each looked at all.
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}
