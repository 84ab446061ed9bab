//! `bilux bench rays`: its rows, and the files that it shares with other programs.

use bilux::accel::{ACCELERATORS, Ray, TriangleMesh};
use bilux_bench::rays::{Batch, Options, files, run};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn quick() -> Options {
    Options { scenes: vec![PathBuf::from("teapots3")], count: 300, rounds: 1, ..Options::default() }
}

#[test]
fn our_structures_agree_on_every_class() {
    let accels: Vec<String> = ACCELERATORS.iter().map(|row| row.entry.name.to_owned()).collect();
    let report = run(&Options { accels: accels.clone(), ..quick() }, &|_| {}).unwrap();
    for accel in &accels {
        let rows: Vec<_> = report.rows.iter().filter(|r| r["engine"] == **accel).collect();
        let classes = |mode: &str| -> Vec<_> {
            rows.iter().filter(|r| r["mode"] == mode).map(|r| r["class"].as_str().unwrap()).collect()
        };
        let all = ["primary", "ao", "bounce", "bounce2", "shadow"];
        assert_eq!(classes("single"), all, "{accel}");
        assert_eq!(classes("batch"), if accel == "bvh8" { &all[..] } else { &[] }, "{accel}");
        for row in rows {
            let keys: Vec<_> = row.as_object().unwrap().keys().map(String::as_str).collect();
            let wanted =
                "scene triangles class engine mode mrays build_seconds bytes_per_triangle mismatches";
            assert_eq!(keys, wanted.split(' ').collect::<Vec<_>>());
            assert_eq!(
                (row["triangles"].as_u64(), row["mismatches"].as_u64()),
                (Some(12_098), Some(0)),
                "{row}"
            );
            assert!(
                row["mrays"].as_f64().unwrap() > 0.0 && row["bytes_per_triangle"].as_f64().unwrap() > 0.0
            );
        }
    }
    assert!(report.text.contains("teapots3: 12098 triangles"), "{}", report.text);
}

#[test]
fn meshes_and_rays_come_back_from_files_as_they_were() {
    let folder = TempDir::new().unwrap();
    let (mesh_path, rays_path) = (folder.path().join("m.msh"), folder.path().join("some.ray"));
    let corners = vec![[[0.0, 0.5, -0.0], [1.0, 0.0, 2.0], [3.0, f32::MAX, 1e-40]]; 3];
    let mesh = TriangleMesh::from_corners(corners.clone()).unwrap();
    files::write_mesh(&mesh_path, &mesh).unwrap();
    assert_eq!(files::read_mesh(&mesh_path).unwrap().triangles(), corners);
    let ray = Ray { t_min: 0.25, ..Ray::new([1.0, 2.0, 3.0], [0.0, -0.0, 1.0]) };
    let batch = Batch { class: "some".to_owned(), any: true, rays: vec![ray, Ray { t_max: 9.0, ..ray }] };
    files::write_rays(&rays_path, &batch).unwrap();
    assert_eq!(files::read_rays(&rays_path).unwrap(), batch);
    assert_eq!(std::fs::metadata(&rays_path).unwrap().len(), 12 + 2 * 32);
    assert_eq!(std::fs::metadata(&mesh_path).unwrap().len(), 12 + 3 * 12 + 3 * 12);
}

#[test]
fn dumped_scenes_are_traced_again_and_their_hits_written() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    run(&Options { dump: Some(folder.path().to_owned()), ..quick() }, &|_| {}).unwrap();
    let from_files = |rays: &str| Options {
        mesh: Some(at("teapots3.msh")),
        rays: vec![at(rays)],
        hits: Some(at("hits")),
        scenes: Vec::new(),
        ..quick()
    };
    let report = run(&from_files("teapots3-bounce.ray"), &|_| {}).unwrap();
    assert_eq!(report.rows[0]["class"], "teapots3-bounce");
    let hits = std::fs::read(at("hits")).unwrap();
    assert_eq!(hits.len(), 300 * 16);
    let primitives = hits.chunks(16).map(|hit| u32::from_le_bytes(hit[12..].try_into().unwrap()));
    assert!(primitives.clone().any(|p| p == u32::MAX) && primitives.clone().any(|p| p < 12_098));
    run(&from_files("teapots3-shadow.ray"), &|_| {}).unwrap();
    let hits = std::fs::read(at("hits")).unwrap();
    assert!(hits.len() == 300 && hits.iter().all(|&hit| hit < 2));
}

#[test]
fn files_with_false_counts_are_refused_before_allocation() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("bad");
    let refused = |bytes: &[u8], read: fn(&Path) -> String| {
        std::fs::write(&path, bytes).unwrap();
        read(&path)
    };
    let mesh = |path: &Path| files::read_mesh(path).err().unwrap().to_string();
    let rays = |path: &Path| files::read_rays(path).err().unwrap().to_string();
    assert!(refused(b"", mesh).contains("MSH1"));
    assert!(refused(b"RAY1\0\0\0\0\0\0\0\0", mesh).contains("MSH1"));
    assert!(refused(b"MSH1\xff\xff\xff\xff\xff\xff\xff\xff", mesh).contains("bytes"));
    assert!(refused(b"RAY1\0\0\0\0\xff\xff\xff\xff", rays).contains("bytes"));
    assert!(refused(b"RAY1\x07\0\0\0\0\0\0\0", rays).contains("kind"));
    let mut outside = b"MSH1\0\0\0\0\x01\0\0\0".to_vec();
    outside.extend([0; 12]);
    assert!(refused(&outside, mesh).contains("vertex"));
}

#[test]
fn unknown_names_are_reported() {
    let error = |options: Options| run(&options, &|_| {}).err().unwrap().to_string();
    let accels = vec!["bhv".to_owned()];
    assert!(error(Options { accels, ..quick() }).contains("bvh"));
    let library = |name: &str| vec![(name.to_owned(), PathBuf::from("none.so"))];
    assert!(error(Options { against: library("embree"), ..quick() }).contains("none.so"));
    assert!(error(Options { against: library("optix"), ..quick() }).contains("embree"));
    assert!(error(Options { hits: Some("hits".into()), ..quick() }).contains("--mesh"));
}
