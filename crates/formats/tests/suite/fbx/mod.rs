//! FBX files, made here by a small writer.

mod broken;
mod caches;
mod looks;
mod meshes;
mod motion;
mod nurbs;
mod seeds;
mod writer;

use bilux_formats::{FormatError, ReadOptions, read_bytes};
use bilux_math::Vec3;
use bilux_scene::{Object, SceneBuilder};
use writer::{N, V, as_text, binary, file, link, n, object, p, properties, text};

/// A quad in the xy plane from the origin, with one uv and one normal for each corner.
fn quad(id: i64) -> N {
    let layer = |name: &'static str, list: &'static str, values: Vec<f64>| {
        let words = [("MappingInformationType", "ByPolygonVertex"), ("ReferenceInformationType", "Direct")];
        let mut children: Vec<N> =
            words.into_iter().map(|(key, word)| n(key, vec![text(word)], vec![])).collect();
        children.push(n(list, vec![V::Doubles(values)], vec![]));
        n(name, vec![V::Int(0)], children)
    };
    object(
        "Geometry",
        id,
        "quad",
        "Mesh",
        vec![
            n("Vertices", vec![V::Doubles(vec![0., 0., 0., 1., 0., 0., 1., 2., 0., 0., 2., 0.])], vec![]),
            n("PolygonVertexIndex", vec![V::Ints(vec![0, 1, 2, -4])], vec![]),
            layer("LayerElementNormal", "Normals", [0., 0., 1.].repeat(4)),
            layer("LayerElementUV", "UV", vec![0., 0., 1., 0., 1., 1., 0., 1.]),
        ],
    )
}

/// A node with properties.
fn model(id: i64, name: &'static str, list: Vec<N>) -> N {
    object("Model", id, name, "Mesh", vec![n("Version", vec![V::Int(232)], vec![]), properties(list)])
}

/// The axes x right, z up, and y to the back.
fn z_up() -> Vec<N> {
    [("UpAxis", 2.0), ("UpAxisSign", 1.0), ("FrontAxis", 1.0), ("FrontAxisSign", -1.0), ("CoordAxis", 0.0)]
        .map(|(name, value)| p(name, &[value]))
        .to_vec()
}

/// A quad at a node with properties, in metres with y up.
fn placed(list: Vec<N>) -> Vec<N> {
    file(
        vec![p("UnitScaleFactor", &[100.0])],
        vec![quad(1), model(2, "node", list)],
        vec![link(1, 2, ""), link(2, 0, "")],
    )
}

fn scene_of(bytes: &[u8]) -> Result<SceneBuilder, FormatError> {
    read_bytes(bytes, "fbx", None, "scene.fbx", &ReadOptions::default())
}

/// Reads nodes in binary, and checks that text and the other binary forms say the same.
#[track_caller]
fn read_all(nodes: &[N]) -> SceneBuilder {
    let scene = scene_of(&binary(7400, true, nodes)).unwrap();
    let of = |scene: &SceneBuilder| format!("{:?} {:?} {:?}", scene.objects, scene.materials, scene.warnings);
    for other in [binary(7400, false, nodes), binary(7700, true, nodes)] {
        assert_eq!(of(&scene), of(&scene_of(&other).unwrap()));
    }
    let other = scene_of(as_text(nodes).as_bytes()).unwrap();
    let objects = |scene: &SceneBuilder| format!("{:?}", scene.objects);
    assert_eq!(objects(&scene), objects(&other));
    scene
}

/// A point of an object, in world space.
fn at(object: &Object, p: [f32; 3]) -> Vec3 {
    object.motion.at(0.0).point(Vec3::from(p))
}

#[track_caller]
fn near(a: Vec3, b: [f32; 3]) {
    assert!((a - Vec3::from(b)).length() < 1e-5, "{a} is not {b:?}");
}
