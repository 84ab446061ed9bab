//! No command writes over a file that it reads.

use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

/// Runs `bilux` in a folder; returns the exit status and what is printed to standard error.
fn bilux(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    let output = command.current_dir(folder).env("OIDN_LIB", "nowhere").args(arguments).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// The number of triangles in a scene file.
fn triangles(folder: &Path, scene: &str) -> u64 {
    let mut command = Command::cargo_bin("bilux").unwrap();
    let output = command.current_dir(folder).args(["info", scene, "--json"]).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    json["triangles"].as_u64().unwrap()
}

fn ply(triangles: usize) -> String {
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
    );
    header + &"3 0 1 2\n".repeat(triangles)
}

#[test]
fn a_conversion_in_place_keeps_the_files_of_its_input() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    // The names that a writer would choose itself, in another order.
    std::fs::write(path.join("scene-mesh-2.ply"), ply(2)).unwrap();
    std::fs::write(path.join("scene-mesh-1.ply"), ply(5)).unwrap();
    let shape = |n: u32| format!("Shape \"plymesh\" \"string filename\" \"scene-mesh-{n}.ply\"\n");
    let text = format!("WorldBegin\n{}{}Rotate 30 0 1 0\n{0}", shape(2), shape(1));
    std::fs::write(path.join("scene.pbrt"), text).unwrap();
    let kept = || {
        ["scene.pbrt", "scene-mesh-1.ply", "scene-mesh-2.ply"].map(|n| std::fs::read(path.join(n)).unwrap())
    };
    let (before, count) = (kept(), triangles(path, "scene.pbrt"));
    assert_eq!(count, 2 + 5 + 2);
    assert_eq!(bilux(path, &["convert", "scene.pbrt", "-o", "scene.toml"]).0, 0);
    assert!(before == kept(), "a file of the input was written over");
    assert_eq!((triangles(path, "scene.pbrt"), triangles(path, "scene.toml")), (count, count));
    // And back: the meshes of the new file are safe in turn.
    let new = std::fs::read(path.join("scene-mesh-3.ply")).unwrap();
    assert_eq!(bilux(path, &["convert", "scene.toml", "-o", "scene.gltf"]).0, 0);
    assert_eq!(std::fs::read(path.join("scene-mesh-3.ply")).unwrap(), new);
    // A glTF file whose data are where its own writer would put them.
    let binary = std::fs::read(path.join("scene.bin")).unwrap();
    std::fs::rename(path.join("scene.gltf"), path.join("other.gltf")).unwrap();
    assert_eq!(bilux(path, &["convert", "other.gltf", "-o", "scene.gltf"]).0, 0);
    assert_eq!(std::fs::read(path.join("scene.bin")).unwrap(), binary);
    assert_eq!((triangles(path, "other.gltf"), triangles(path, "scene.gltf")), (count, count));
}

#[test]
fn an_output_over_an_input_is_refused_before_anything_is_written() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let write = |name: &str, text: &str| std::fs::write(path.join(name), text).unwrap();
    write("a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    write("a.mtl", "newmtl a\nmap_Kd a.ppm\n");
    write("a.ppm", "P3 1 1 255 9 9 9\n");
    write("b.toml", "include = ['a.obj']\n");
    write("sky.ppm", "P3 2 1 255 9 9 9 9 9 9\n");
    let part = ["render", "a.obj", "--size", "8x8", "--spp", "4", "--samples", "0..2", "-o", "part.exr"];
    assert_eq!(bilux(path, &part).0, 0);
    let all = || {
        let files = std::fs::read_dir(path).unwrap().map(|file| file.unwrap().path());
        let mut files: Vec<_> = files.map(|file| (std::fs::read(&file).unwrap(), file)).collect();
        files.sort();
        files
    };
    let before = all();
    for wrong in [
        "render a.obj -o a.ppm",
        "render a.obj -o ./a.ppm --size 8x8 --spp 1 --frames 3",
        "render b.toml -o a.ppm",
        "render a.obj -o b.png --stats a.mtl",
        "render a.obj -o sky.ppm --env sky.ppm",
        "render a.obj -o sky.ppm --background sky.ppm",
        "convert a.obj -o a.obj",
        "convert b.toml -o a.obj",
        "convert a.ppm -o ./a.ppm",
        "generate teapots --from a.obj -o a.obj",
        "denoise a.ppm -o a.ppm",
        "merge part.exr -o part.exr",
        "compare a.ppm a.ppm --heat-map a.ppm",
    ] {
        let (status, said) = bilux(path, &wrong.split(' ').collect::<Vec<_>>());
        // Frames have names of their own.
        if wrong.contains("--frames") {
            assert_eq!(status, 0, "{wrong}: {said}");
            std::fs::remove_file(path.join("a-0003.ppm")).unwrap();
        } else {
            assert_eq!(status, 2, "{wrong}: {said}");
            assert!(said.contains("write to another file"), "{wrong}: {said}");
        }
        assert!(all() == before, "{wrong}");
    }
}
