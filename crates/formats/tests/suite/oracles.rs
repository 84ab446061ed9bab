//! Compares our readers with those of other projects on real files.

use crate::shared_files::{files, scenes};
use bilux_formats::{ReadOptions, read};
use bilux_math::Vec3;
use bilux_scene::SceneBuilder;
use std::path::{Path, PathBuf};

/// The corners of all triangles, in order.
fn corners(scene: &SceneBuilder) -> Vec<Vec3> {
    let of = |mesh: &bilux_scene::Mesh| -> Vec<Vec3> {
        mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]).collect()
    };
    scene.objects.iter().flat_map(|o| of(&o.mesh)).collect()
}

/// Reads every file of a format and calls `compare` with it; returns how many were compared.
fn each(kind: &str, mut compare: impl FnMut(&Path, Vec<Vec3>) -> bool) -> usize {
    let Some(root) = scenes() else { return usize::MAX };
    let mut all: Vec<PathBuf> = Vec::new();
    files(&root.join(kind), &mut all);
    let is_kind = |p: &PathBuf| p.extension().is_some_and(|e| e.eq_ignore_ascii_case(kind));
    let options = ReadOptions { crease_angle: 0.0, ..ReadOptions::default() };
    let read_all = all.iter().filter(|p| is_kind(p)).filter_map(|p| Some((p, read(p, &options).ok()?)));
    // Other readers treat points and lines differently.
    let has_strokes = |scene: &SceneBuilder| scene.objects.iter().any(|o| o.mesh.stroke_count() > 0);
    let read_all = read_all.filter(|(_, scene)| !has_strokes(scene));
    read_all.filter(|(path, scene)| compare(path, corners(scene))).count()
}

#[test]
fn obj_agrees_with_tobj() {
    let compared = each("obj", |path, ours| {
        let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
        let no_materials = |_: &Path| Err(tobj::LoadError::GenericFailure);
        let Ok(bytes) = std::fs::read(path) else { return false };
        let Ok((models, _)) = tobj::load_obj_buf(&mut &bytes[..], &options, no_materials) else {
            return false;
        };
        let point = |mesh: &tobj::Mesh, i: u32| Vec3::from_slice(&mesh.positions[3 * i as usize..]);
        let theirs: Vec<Vec3> = models
            .iter()
            .flat_map(|m| m.mesh.indices.iter().map(|&i| point(&m.mesh, i)).collect::<Vec<_>>())
            .collect();
        // Readers may triangulate polygons along other diagonals, but the set of corners is the same.
        let sorted = |mut points: Vec<Vec3>| {
            points.sort_by(|a, b| a.to_array().map(f32::to_bits).cmp(&b.to_array().map(f32::to_bits)));
            points.dedup();
            points
        };
        assert_eq!(ours.len(), theirs.len(), "{}", path.display());
        assert_eq!(sorted(ours), sorted(theirs), "{}", path.display());
        true
    });
    assert!(compared >= 30, "{compared}");
}

#[test]
fn stl_agrees_with_stl_io() {
    let compared = each("stl", |path, ours| {
        let Ok(file) = std::fs::File::open(path) else { return false };
        let Ok(theirs) = stl_io::read_stl(&mut std::io::BufReader::new(file)) else { return false };
        let point = |i: usize| Vec3::from(theirs.vertices[i].0);
        let theirs: Vec<Vec3> = theirs.faces.iter().flat_map(|f| f.vertices).map(point).collect();
        // stl_io reads only the first solid.
        assert_eq!(ours[..theirs.len()], theirs[..], "{}", path.display());
        true
    });
    assert!(compared >= 10, "{compared}");
}

#[test]
fn ply_agrees_with_ply_rs() {
    use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
    let compared = each("ply", |path, ours| {
        let Ok(bytes) = std::fs::read(path) else { return false };
        let Ok(theirs) = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]) else { return false };
        let number = |vertex: &DefaultElement, key: &str| match vertex[key] {
            Property::Float(x) => x,
            Property::Double(x) => x as f32,
            _ => f32::NAN,
        };
        let points: Vec<Vec3> = theirs.payload["vertex"]
            .iter()
            .map(|v| Vec3::new(number(v, "x"), number(v, "y"), number(v, "z")))
            .collect();
        let indices = |face: &DefaultElement| -> Vec<usize> {
            let list = ["vertex_indices", "vertex_index"].iter().find_map(|key| face.get(*key));
            match list {
                Some(Property::ListInt(list)) => list.iter().map(|&i| i as usize).collect(),
                Some(Property::ListUInt(list)) => list.iter().map(|&i| i as usize).collect(),
                _ => Vec::new(),
            }
        };
        let faces: Vec<Vec<usize>> = theirs.payload["face"].iter().map(indices).collect();
        let triangles: usize = faces.iter().map(|f| f.len() - 2).sum();
        assert_eq!(ours.len(), 3 * triangles, "{}", path.display());
        if faces.iter().all(|f| f.len() == 3) {
            let theirs: Vec<Vec3> = faces.iter().flatten().map(|&i| points[i]).collect();
            assert_eq!(ours, theirs, "{}", path.display());
        }
        true
    });
    assert!(compared >= 10, "{compared}");
}
