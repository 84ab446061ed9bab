//! Point clouds and lines, read and written: PLY without faces, OBJ's `p` and `l`, XYZ, LAS, and glTF's modes.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb, Vec3};
use bilux_scene::{Axis, Mesh, SceneBuilder, UpHint};
use std::sync::Arc;

fn only(scene: &SceneBuilder) -> &Mesh {
    assert_eq!(scene.objects.len(), 1);
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    &scene.objects[0].mesh
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   property uchar red\nproperty uchar green\nproperty uchar blue\n";
const VERTICES: &str = "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n";

#[test]
fn a_ply_without_faces_is_a_cloud_and_with_edges_it_is_lines() {
    for faces in ["", "element face 0\nproperty list uchar int vertex_indices\n"] {
        let scene = read_text("ply", format!("{PLY}{faces}end_header\n{VERTICES}")).unwrap();
        let mesh = only(&scene);
        assert_eq!((&mesh.points[..], mesh.triangles.len()), (&[0, 1, 2][..], 0));
        assert_eq!(mesh.vertex_kd[1], Rgb::new(0.0, 1.0, 0.0));
        assert_eq!(warnings(&scene), "");
    }
    let edges = "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
    let scene = read_text("ply", format!("{PLY}{edges}end_header\n{VERTICES}0 1\n1 2\n")).unwrap();
    assert_eq!((&only(&scene).lines[..], only(&scene).points.len()), (&[[0, 1], [1, 2]][..], 0));
    let scene = read_text("ply", format!("{PLY}{edges}end_header\n{VERTICES}0 1\n1 3\n")).unwrap();
    assert_eq!(only(&scene).lines, [[0, 1]]);
    assert!(warnings(&scene).contains("some edges refer to vertices"), "{}", warnings(&scene));
    let message = refusal(
        "ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
    );
    assert!(message.contains("no faces and no vertices"), "{message}");
}

#[test]
fn points_and_lines_of_an_obj_are_objects_beside_its_faces() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\no net\nl 1 2/1 3\nl -1 1\no dots\np 4 2\no face\nf 1 2 3\n";
    let scene = read_text("obj", text).unwrap();
    let named = |name: &str| &scene.objects.iter().find(|o| o.name == name).unwrap().mesh;
    let net = named("net");
    let ends = |i: usize| net.lines[i].map(|v| net.positions[v as usize]);
    assert_eq!(net.lines.len(), 3);
    assert_eq!(ends(0), [Vec3::ZERO, Vec3::X]);
    assert_eq!(ends(2), [Vec3::splat(5.0), Vec3::ZERO]);
    assert_eq!(net.vertex_kd[0], Rgb::new(1.0, 0.0, 0.0));
    let dots = named("dots");
    assert_eq!((dots.points.len(), dots.positions[dots.points[0] as usize]), (2, Vec3::splat(5.0)));
    assert_eq!(named("face").triangles.len(), 1);
    assert_eq!(warnings(&scene), "");
    // Vertices alone form a point cloud.
    let scene = read_text("obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\n").unwrap();
    assert_eq!((&only(&scene).points[..], only(&scene).vertex_kd.len()), (&[0, 1][..], 2));
    for (text, wanted) in [
        ("v 0 0 0\nl 1 2\n", "vertex 2, but the file has only 1"),
        ("v 0 0 0\np x\n", "'x' is not a vertex of a point"),
        ("v 0 0 0\nl 1 -3\n", "refers to a vertex that the file does not have"),
        ("o nothing\n", "no faces and no vertices"),
    ] {
        let message = refusal("obj", text);
        assert!(message.contains(wanted), "{text:?}: {message}");
    }
}

#[test]
fn xyz_columns_are_found_by_name_or_by_content() {
    let kd = |text: &str| read_text("xyz", text).unwrap().objects[0].mesh.vertex_kd.clone();
    assert_eq!(kd("0 0 0\n1 1 1\n"), []);
    assert_eq!(kd("0 0 0 255 0 0\n1 1 1 0 51 0\n")[1], Rgb::new(0.0, srgb_decode(0.2), 0.0));
    assert_eq!(kd("0,0,0,1,0,0\n1,1,1,0,0.5,0\n")[1], Rgb::new(0.0, srgb_decode(0.5), 0.0));
    assert_eq!(kd("0 0 0 0 0 1\n1 1 1 0.6 0.8 0\n"), [], "these are normals");
    assert_eq!(kd("2\n0 0 0 -3 255 0 0\n1 1 1 9 0 255 0\n")[0], Rgb::new(1.0, 0.0, 0.0));
    assert_eq!(kd("0 0 0 0 0 1 0 255 0\n1 1 1 0 1 0 9 0 0\n")[0], Rgb::new(0.0, 1.0, 0.0));
    let named = read_text("txt", "//X;Z;Y;B;G;R\n1;2;3;255;0;0\n4;5;6;0;0;255\n").unwrap();
    assert_eq!(only(&named).positions[0], Vec3::new(1.0, 3.0, 2.0));
    assert_eq!(only(&named).vertex_kd[0], Rgb::new(0.0, 0.0, 1.0));
    let greys = kd("0 0 0 100\n0 0 1 300\n0 0 2 200\n");
    assert!(greys[0].r < greys[2].r && greys[2].r < greys[1].r, "{greys:?}");
    assert_eq!(named.up, UpHint::Usually(Axis::Z));
    for (text, wanted) in [
        ("3\nwater\nO 0 0 0\n", "scene.xyz:3:1: this is an XYZ file of a molecule"),
        ("1\nC 0 0 0\n", "a molecule"),
        ("1 2\n3 4\n", "it contains no points"),
        ("some words\n", "it contains no points"),
        ("some words\nand more\n", "scene.xyz:2:1: a point is expected here"),
    ] {
        let message = refusal("xyz", text);
        assert!(message.contains(wanted), "{text:?}: {message}");
    }
}

#[test]
fn coordinates_of_a_country_keep_their_millimetres() {
    let text = "500000.125 4600000.25 30\n500000.126 4600000.251 30.001\n";
    let scene = read_text("xyz", text).unwrap();
    let [a, b] = only(&scene).positions[..] else { panic!() };
    assert_eq!(scene.origin, DVec3::new(500000.0, 4600000.0, 0.0));
    assert!(((b - a) - Vec3::splat(0.001)).length() < 1e-5, "{}", b - a);
}

fn corpus(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/../../fuzz/corpus/scene_las/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn las_has_positions_and_colours_in_all_of_its_formats() {
    for name in ["format_2.las", "format_3_longer_records.las", "format_7.las", "format_10.las"] {
        let scene = read_text("las", corpus(name)).unwrap();
        let mesh = only(&scene);
        assert_eq!(
            mesh.positions,
            [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.25), Vec3::new(2.0, 2.0, 0.5)],
            "{name}"
        );
        assert_eq!(scene.origin, DVec3::new(500_000.0, 4_600_000.0, 0.0), "{name}");
        assert_eq!(mesh.vertex_kd[0].b, 1.0, "{name}");
        assert!((mesh.vertex_kd[0].g - srgb_decode(30000.0 / 65535.0)).abs() < 1e-6, "{name}");
        assert_eq!(scene.up, UpHint::Is(Axis::Z));
    }
    for name in ["format_0_intensity.las", "no_colours.las"] {
        let mesh = read_text("las", corpus(name)).unwrap().objects[0].mesh.clone();
        assert!(mesh.vertex_kd[0].r < mesh.vertex_kd[2].r, "{name}");
    }
    for (name, wanted) in [
        ("broken_compressed.laz", "the record that says how they are compressed is missing"),
        ("broken_cut_off.laz", "they are damaged, or the file was cut off"),
        ("broken_chunk_count.laz", "they are damaged, or the file was cut off"),
        ("broken_layers.laz", "they are damaged, or the file was cut off"),
        ("broken_cut_off.las", "3 points of 26 bytes from byte 227 on, but there are bytes for only 1"),
        ("broken_count.las", "was cut off"),
        ("broken_format.las", "format 20, but only 0 to 10 exist"),
        ("broken_scale.las", "scale"),
        ("broken_version.las", "LAS 2.2, but only 1.0 to 1.4"),
    ] {
        let message = refusal("las", corpus(name));
        assert!(message.contains(wanted), "{name}: {message}");
    }
}

#[test]
fn compressed_points_are_those_of_the_same_file_without_compression() {
    for name in ["same_12", "same_14"] {
        let [plain, packed] =
            ["las", "laz"].map(|extension| read_text("las", corpus(&format!("{name}.{extension}"))).unwrap());
        assert_eq!((only(&plain), plain.origin), (only(&packed), packed.origin), "{name}");
        assert_eq!(only(&packed).positions.len(), 40);
    }
    // The first versions have no chunks: their one stream is what a file of one chunk has after the place of its table.
    let mut old = corpus("same_12.laz");
    let record = old.windows(14).position(|bytes| bytes == b"laszip encoded").unwrap() + 52;
    let points = u32::from_le_bytes(*old[96..].first_chunk().unwrap()) as usize;
    old.drain(points..points + 8);
    old[record] = 1;
    let plain = read_text("las", corpus("same_12.las")).unwrap();
    assert_eq!(only(&plain), only(&read_text("las", old).unwrap()));
}

#[test]
fn scans_of_e57_have_their_poses_and_colours() {
    let read = |name: &str| {
        let path = format!("{}/../../fuzz/corpus/scene_e57/{name}", env!("CARGO_MANIFEST_DIR"));
        read_text("e57", std::fs::read(path).unwrap())
    };
    let scene = read("coloured.e57").unwrap();
    let mesh = only(&scene);
    assert_eq!((mesh.positions.len(), mesh.positions[3], &*mesh.name), (8, Vec3::new(3.0, 6.0, 9.0), "hall"));
    assert!((mesh.vertex_kd[7].r - srgb_decode(210.0 / 255.0)).abs() < 0.01 && mesh.vertex_kd[7].g == 1.0);
    let scene = read("posed.e57").unwrap();
    // A quarter turn about z, then a translation by (10, 20, 30).
    let [first, second] = [0, 1].map(|i| scene.objects[i].mesh.clone());
    assert_eq!(first.positions[1], Vec3::new(1.0, 2.0, 3.0));
    assert!((second.positions[1] - Vec3::new(8.0, 21.0, 33.0)).length() < 1e-5, "{}", second.positions[1]);
    let grey = read("intensity.e57").unwrap().objects[0].mesh.clone();
    assert!(grey.vertex_kd[0].r < grey.vertex_kd[7].r);
    for (name, wanted) in [
        ("broken_cut_off.e57", "cut off"),
        ("broken_checksum.e57", "its checksum is wrong"),
        ("broken_length.e57", "states more data than there are"),
    ] {
        let message = read(name).unwrap_err().to_string();
        assert!(message.contains(wanted), "{name}: {message}");
    }
}

#[test]
fn points_and_lines_come_back_where_a_format_holds_them_and_else_as_triangles() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nl 1 2 3\n";
    let folder = std::env::temp_dir().join(format!("bilux-clouds-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for text in [text, &text.replace("l ", "p ")] {
        let scene = read_text("obj", text).unwrap();
        let drawn = |scene: &SceneBuilder| {
            let mesh: &Arc<Mesh> = &scene.objects[0].mesh;
            let at = |i: &u32| (mesh.positions[*i as usize], mesh.vertex_kd[*i as usize]);
            let points: Vec<_> = mesh.points.iter().map(at).collect();
            let lines: Vec<_> = mesh.lines.iter().flatten().map(at).collect();
            format!("{points:?} {lines:?}")
        };
        for extension in ["obj", "ply", "glb", "toml"] {
            let path = folder.join(format!("there.{extension}"));
            let lost = write(&path, &scene, &WriteOptions::default()).unwrap();
            let of_phong = |message: &str| extension == "glb" && message.contains("phong");
            assert!(lost.iter().all(|w| of_phong(&w.message)), "{extension}: {lost:?}");
            let back = read(&path, &ReadOptions::default()).unwrap();
            assert_eq!(drawn(&back), drawn(&scene), "{extension}");
        }
        for extension in ["stl", "off", "asc", "pbrt"] {
            let path = folder.join(format!("there.{extension}"));
            let lost = write(&path, &scene, &WriteOptions::default()).unwrap();
            assert!(
                lost.iter().any(|w| w.message.contains("small spheres and tubes")),
                "{extension}: {lost:?}"
            );
            let back = read(&path, &ReadOptions::default()).unwrap();
            let triangles: usize = back.objects.iter().map(|o| o.mesh.triangles.len()).sum();
            assert!(triangles >= 3 * 20, "{extension}: {triangles}");
            assert!(back.bounds(0.0).extent().x > 1.0);
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_mesh_far_from_zero_keeps_the_digits_of_its_file() {
    let folder = std::env::temp_dir().join(format!("bilux-far-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let vertices = ["1000000.125 2000000 -5.5", "1000000.25 2000000 -5.5", "1000000.125 2000000.0625 -5.5"];
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{}\n3 0 1 2\n",
        vertices.join("\n")
    );
    let obj = format!("v {}\nf 1 2 3\n", vertices.join("\nv "));
    for (name, text) in [("far.obj", obj), ("far.ply", ply)] {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(scene.origin, DVec3::new(1_000_000.0, 2_000_000.0, -6.0), "{name}");
        let wanted = [Vec3::new(0.125, 0.0, 0.5), Vec3::new(0.25, 0.0, 0.5), Vec3::new(0.125, 0.0625, 0.5)];
        assert_eq!(only(&scene).positions, wanted, "{name}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// All points of one intensity, in files whose range of intensities is empty: one grey for all, no black and no NaN.
#[test]
fn an_empty_range_of_intensities_is_one_grey() {
    let path = format!("{}/../../fuzz/corpus/scene_e57/empty_range.e57", env!("CARGO_MANIFEST_DIR"));
    let e57 = read(path.as_ref(), &ReadOptions::default()).unwrap();
    let greys = &e57.objects[0].mesh.vertex_kd;
    assert!(greys.iter().all(|grey| *grey == greys[0] && grey.r > 0.1 && grey.r < 0.9), "{greys:?}");
    for (format, text) in [("xyz", "0 0 0 7\n1 0 0 7\n2 0 0 7\n"), ("pts", "3\n0 0 0 0\n1 0 0 0\n2 0 0 0\n")]
    {
        let scene = read_text(format, text).unwrap();
        assert!(only(&scene).vertex_kd.iter().all(|colour| colour.is_finite()), "{format}");
        let is_black = |kd: Rgb| kd.is_black();
        assert!(!scene.materials[0].colour("kd").is_some_and(is_black), "{format}");
    }
}

/// Points in one stream without chunks, as LASzip 1.2 wrote them: chunks of the same points, without the table of chunks and the
/// place of that table.
#[test]
fn the_first_laz_files_have_no_chunks() {
    let chunked = corpus("same_12.laz");
    let place = chunked.windows(14).position(|word| word == b"laszip encoded").unwrap();
    let record = place - 2 + 54;
    let points = u32::from_le_bytes(chunked[96..100].try_into().unwrap()) as usize;
    let table = u64::from_le_bytes(chunked[points..points + 8].try_into().unwrap()) as usize;
    let mut stream = chunked[..points].to_vec();
    stream.extend(&chunked[points + 8..table]);
    // The compressor of one stream, version 1.2, and no size of chunks.
    stream[record] = 1;
    stream[record + 4..record + 6].copy_from_slice(&[1, 2]);
    let positions = |bytes: &[u8]| only(&read_text("las", bytes).unwrap()).positions.clone();
    for size in [0u32, u32::MAX, 50_000] {
        stream[record + 12..record + 16].copy_from_slice(&size.to_le_bytes());
        assert_eq!(positions(&stream), positions(&chunked), "chunks of {size}");
    }
}

/// A scan with colours and one with intensities alone, in one file: the second is grey by its own. [ASTM E2807, 8.4.4]
#[test]
fn every_scan_of_e57_has_the_colours_that_it_has() {
    use e57::{E57Writer, Record, RecordValue};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.e57");
    let mut writer = E57Writer::from_file(&path, "file").unwrap();
    let place = [Record::CARTESIAN_X_F32, Record::CARTESIAN_Y_F32, Record::CARTESIAN_Z_F32];
    let colour = [Record::COLOR_RED_U8, Record::COLOR_GREEN_U8, Record::COLOR_BLUE_U8];
    let at = |x: f32| [x, 2.0, -1.0].map(RecordValue::Single).to_vec();
    let mut coloured = writer.add_pointcloud("a", [place.to_vec(), colour.to_vec()].concat()).unwrap();
    for (x, rgb) in [(0.0, [255, 0, 0]), (1.0, [0, 0, 255])] {
        coloured.add_point([at(x), rgb.map(RecordValue::Integer).to_vec()].concat()).unwrap();
    }
    coloured.finalize().unwrap();
    let mut grey =
        writer.add_pointcloud("b", [place.to_vec(), vec![Record::INTENSITY_UNIT_F32]].concat()).unwrap();
    for (x, intensity) in [(2.0, 0.0), (3.0, 1.0)] {
        grey.add_point([at(x), vec![RecordValue::Single(intensity)]].concat()).unwrap();
    }
    grey.finalize().unwrap();
    writer.finalize().unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let colours: Vec<_> = scene.objects.iter().flat_map(|one| one.mesh.vertex_kd.iter().copied()).collect();
    assert_eq!(colours[..2], [bilux_math::Rgb::new(1.0, 0.0, 0.0), bilux_math::Rgb::new(0.0, 0.0, 1.0)]);
    // From 0.15 to 0.95 as screens show it.
    for (found, wanted) in colours[2..].iter().zip([0.0194, 0.8900]) {
        assert!((*found - bilux_math::Rgb::grey(wanted)).map(f32::abs).max_channel() < 2e-3, "{found:?}");
    }
}
