//! The guarantees of the scenes that ship with Bilux.

#![allow(clippy::print_stderr, reason = "a test that skips says so")]

use bilux_gallery::teapot::vessel::Vessel;
use bilux_gallery::teapot::{Teapot, patches};
use bilux_gallery::{GENERATORS, copies, generate};
use bilux_math::Vec3;
use bilux_scene::mesh::shapes;
use bilux_scene::{AccelChoice, Mesh, Object, Reader, SceneBuilder, Spec, Value};
use bilux_testing::solids;
use std::sync::Arc;

fn open_edges(mesh: &Mesh) -> usize {
    solids::open_edges(&mesh.positions, &mesh.triangles)
}

fn volume(mesh: &Mesh) -> f64 {
    solids::volume(&mesh.positions, &mesh.triangles)
}

fn least_agreement(mesh: &Mesh) -> f32 {
    solids::least_agreement(&mesh.positions, &mesh.normals, &mesh.triangles)
}

#[test]
fn teapot_triangle_count_accounts_for_the_poles() {
    for n in [1u32, 2, 4, 8, 16] {
        let teapot = Teapot { tessellation: n, ..Teapot::default() };
        let whole = teapot.mesh().triangles.len() as u32;
        // The four patches of the lid meet in a pole, and so do the four of the bottom.
        assert_eq!(whole, 32 * 2 * n * n - 8 * n, "tessellation {n}");
        let open = Teapot { bottom: false, ..teapot }.mesh().triangles.len() as u32;
        assert_eq!(whole - open, 4 * (2 * n * n - n), "the bottom at {n}");
    }
}

#[test]
fn neighbouring_patches_share_edges_bit_for_bit() {
    // At 1 the two halves of handle and spout are flat and coincide.
    for n in [2, 3, 8, 13] {
        let mesh = Teapot { tessellation: n, ..Teapot::default() }.mesh();
        // Newell's teapot is open in five places: the edge of the lid, the rim, and both ends of handle and spout.
        let rings = 4 * n + 4 * n + 4 * (2 * n);
        let open = open_edges(&mesh) as u32;
        assert_eq!(open, rings, "tessellation {n}");
    }
}

#[test]
fn normals_point_outwards_and_match_finite_differences() {
    for patch in patches(true) {
        let n = 4096;
        for (i, j) in [(0, 1000), (n / 3, n / 2), (n / 2, n - 1), (n - 1, 17), (1234, 3000)] {
            let at = |i: u32, j: u32| patch.at(i, j, n).0;
            let (i0, i1) = (i.max(1) - 1, (i + 1).min(n));
            let (j0, j1) = (j.max(1) - 1, (j + 1).min(n));
            let difference = (at(i1, j) - at(i0, j)).cross(at(i, j1) - at(i, j0)).normalize();
            let cosine = difference.dot(patch.at(i, j, n).1);
            assert!(cosine > 0.99999, "{cosine} at {i}, {j}");
        }
    }
    let mesh = Teapot { tessellation: 32, ..Teapot::default() }.mesh();
    assert!(least_agreement(&mesh) > 0.7, "{}", least_agreement(&mesh));
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
}

#[test]
fn poles_have_upright_normals() {
    let mesh = Teapot::default().mesh();
    let on_axis = |p: &Vec3| p.x.abs().max(p.z.abs()) == 0.0;
    let poles: Vec<_> = mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| on_axis(p)).collect();
    assert_eq!(poles.len(), 8 * 9);
    for (p, n) in poles {
        let wanted = if p.y > 1.0 { Vec3::Y } else { Vec3::NEG_Y };
        assert!(n.distance(wanted) < 1e-6, "{n} at {p}");
    }
}

#[test]
fn the_teapot_has_the_height_asked_for_and_stands_on_the_ground() {
    for height in [0.1, 1.0, 3.15, 250.0] {
        let bounds = Teapot { height, tessellation: 16, ..Teapot::default() }.mesh().bounds();
        assert_eq!(bounds.min.y, 0.0);
        assert!((f64::from(bounds.max.y) / height - 1.0).abs() < 1e-6, "{height}");
    }
}

#[test]
fn the_control_points_are_newells() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/asc/teapot.bpt");
    let Ok(text) = std::fs::read_to_string(path) else {
        eprintln!("skipped: {path} is not there");
        return;
    };
    let micro = |x: f64| (x * 1e6).round() as i64;
    let numbers: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
    // A count, then the degrees (3 3) and 16 points of each patch, z up.
    let mut theirs: Vec<Vec<[i64; 3]>> = numbers[1..]
        .chunks(50)
        .map(|patch| patch[2..].chunks(3).map(|p| [micro(p[0]), micro(p[2]), micro(-p[1])]).collect())
        .collect();
    let mut ours: Vec<Vec<[i64; 3]>> = patches(true)
        .map(|patch| patch.0.iter().flatten().map(|p| p.to_array().map(micro)).collect())
        .collect();
    for patch in theirs.iter_mut().chain(&mut ours) {
        patch.sort_unstable();
    }
    theirs.sort();
    ours.sort();
    assert_eq!(theirs, ours);
}

#[test]
fn every_generator_makes_a_scene_that_builds() {
    for row in GENERATORS {
        let scene = generate(&Spec::new("", row.entry.name)).unwrap();
        assert!(!scene.objects.is_empty(), "{}", row.entry.name);
        let built = scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0);
        assert!(built.is_ok(), "{}: {:?}", row.entry.name, built.err());
    }
}

#[test]
fn generators_reject_unknown_keys() {
    let error = |spec: &Spec| generate(spec).err().unwrap().to_string();
    assert!(error(&Spec::new("", "teapts")).contains("did you mean 'teapots'?"));
    let misspelt = Spec::new("", "teapots").with("cuont", Value::Integer(2));
    assert!(error(&misspelt).contains("did you mean 'count'?"), "{}", error(&misspelt));
    let none = Spec::new("", "teapots").with("count", Value::Integer(0));
    assert!(error(&none).contains("from 1 to"), "{}", error(&none));
    let layout = Spec::new("", "teapots").with("layout", "papr");
    assert!(error(&layout).contains("one of paper, equal-coverage"), "{}", error(&layout));
    let fine = Spec::new("", "teapot").with("tessellation", Value::Integer(257));
    assert!(error(&fine).contains("from 1 to 256"), "{}", error(&fine));
}

#[test]
fn five_teapots_are_about_twenty_thousand_triangles() {
    let five = generate(&Spec::new("", "teapots").with("count", Value::Integer(5))).unwrap();
    let triangles: usize = five.objects.iter().map(|o| o.mesh.triangles.len()).sum();
    assert!((19_000..21_000).contains(&triangles), "{triangles}");
}

#[test]
fn equal_coverage_is_independent_of_the_number_of_teapots() {
    use bilux_scene::{CameraSample, Tracer};
    let covered = |count: i64| {
        let spec = Spec::new("", "teapots")
            .with("layout", "equal-coverage")
            .with("count", Value::Integer(count))
            .with("tessellation", Value::Integer(3));
        let scene = generate(&spec).unwrap().build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let mut tracer = Tracer::new(&scene, false);
        let n = 100;
        let hits = (0..n * n).filter(|k| {
            let film = bilux_math::Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
            let sample = CameraSample { film, lens: bilux_math::Vec2::ZERO, time: 0.0 };
            let hit = tracer.closest(&scene.cameras()[0].1.ray(&sample));
            hit.is_some_and(|s| (s.object as i64) < count)
        });
        hits.count() as f64 / f64::from(n * n)
    };
    for count in [1, 2, 3, 5, 10, 100] {
        let share = covered(count);
        assert!((share - 0.2).abs() < 0.012, "{count} teapots cover {share}");
    }
}

#[test]
fn one_teapot_moves_among_still_ones_and_the_camera_walks() {
    let spec = Spec::new("", "teapots").with("moving", true).with("walk", true);
    let scene = generate(&spec).unwrap();
    let moving: Vec<bool> = scene.objects.iter().map(|o| !o.motion.is_still()).collect();
    assert_eq!(moving, [false, false, true, false]);
    assert!(scene.cameras[0].keyframes.len() > 2);
    assert_eq!(scene.cameras[0].keyframes.last().unwrap().0, 4.0);
}

#[test]
fn copies_stand_exactly_at_multiples_of_the_offset() {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(Spec::new("", "diffuse"));
    let mesh = Arc::new(shapes::icosphere(Vec3::new(0.1, 0.2, 0.3), 1.7, 1));
    scene.objects.push(Object::new("ball", mesh.clone(), material));
    let offset = Vec3::new(0.1, -0.7, 1e3);
    let row = copies(&scene, 100, offset);
    assert_eq!(row.objects.len(), 100);
    for (i, object) in row.objects.iter().enumerate() {
        assert!(Arc::ptr_eq(&object.mesh, &mesh));
        let by = (offset.as_dvec3() * i as f64).as_vec3();
        for &p in &mesh.positions {
            assert_eq!(object.motion.at(0.0).point(p), p + by, "copy {i}");
        }
    }
    assert_eq!(copies(&scene, 0, offset).objects.len(), 0);
}

#[test]
fn the_vessel_is_closed_and_faces_outwards() {
    for n in [4, 8, 16, 31] {
        let solid = Vessel { tessellation: n, height: 3.15, wall: None }.mesh();
        assert_eq!(open_edges(&solid), 0, "tessellation {n}");
        let hollow =
            Vessel { wall: Some(0.025), ..Vessel { tessellation: n, height: 3.15, wall: None } }.mesh();
        assert_eq!(open_edges(&hollow), 0, "tessellation {n}, hollow");
        assert!(volume(&solid) > 24.0 && volume(&hollow) < 0.2 * volume(&solid), "tessellation {n}");
        assert!(volume(&hollow) > 0.0);
    }
    let fine = Vessel { tessellation: 32, height: 3.15, wall: Some(0.025) }.mesh();
    assert!(least_agreement(&fine) > 0.6, "{}", least_agreement(&fine));
}

#[test]
fn the_filling_of_a_vessel_is_closed_and_inside() {
    let vessel = Vessel { tessellation: 16, height: 1.0, wall: Some(0.022) };
    let tea = vessel.filling(0.5);
    assert_eq!(open_edges(&tea), 0);
    let (low, high) = (tea.bounds().min, tea.bounds().max);
    assert!(low.y > 0.02 && high.y < 0.5 && high.y > 0.4, "{low} {high}");
    assert!(volume(&tea) > 0.3 * volume(&Vessel { wall: None, ..vessel }.mesh()));
    assert!(vessel.filling(-1.0).triangles.is_empty());
}

/// The objects of a built-in scene with this name.
fn named<'a>(scene: &'a SceneBuilder, name: &'a str) -> impl Iterator<Item = &'a Mesh> {
    scene.objects.iter().filter(move |object| object.name == name).map(|object| &*object.mesh)
}

#[test]
fn what_light_enters_is_closed_and_faces_outwards() {
    for (kind, names) in
        [("milk", &["tumbler", "milk"][..]), ("piglet", &["piglet"]), ("jade", &["dragon", "candle", "egg"])]
    {
        let scene = generate(&Spec::new("", kind)).unwrap();
        for name in names {
            assert!(named(&scene, name).count() > 0, "{kind}: {name}");
            for mesh in named(&scene, name) {
                assert_eq!(open_edges(mesh), 0, "{kind}: {name}");
                assert!(volume(mesh) > 0.0, "{kind}: {name}");
            }
        }
        // More than its trunk and its head, and less than all parts that it is blended of.
        let piglet = named(&scene, "piglet").map(volume).next().unwrap_or(0.006);
        assert!((0.0044..0.0078).contains(&piglet), "{piglet} cubic metres");
    }
}

#[test]
fn milk_reaches_into_its_glass_and_not_out_of_it() {
    let scene = generate(&Spec::new("", "milk")).unwrap();
    for (glass, milk) in named(&scene, "tumbler").zip(named(&scene, "milk")) {
        let axis = glass.bounds().centre();
        let across = |p: &Vec3| (*p - axis).with_y(0.0).length();
        let upper = glass.positions.iter().filter(|p| p.y > axis.y).map(across);
        let [inner, outer] = [upper.clone().fold(f32::INFINITY, f32::min), upper.fold(0.0, f32::max)];
        let bottom = glass.positions.iter().filter(|p| across(p) < 1e-6).map(|p| p.y);
        let [under, floor] = [bottom.clone().fold(1.0, f32::min), bottom.fold(0.0, f32::max)];
        let lowest = milk.bounds().min.y;
        assert!(under + 0.001 < lowest && lowest < floor - 0.0005, "{under} {lowest} {floor}");
        // The wall of the milk, below its surface and above the round corner.
        let low = milk.positions.iter().filter(|p| (0.02..0.05).contains(&p.y));
        let radii: Vec<f32> = low.map(across).collect();
        assert!(radii.len() > 1000);
        assert!(radii.iter().all(|r| (inner + 0.0003..outer - 0.0003).contains(r)), "{inner} {outer}");
        assert!(milk.positions.iter().all(|p| across(p) < outer), "{outer}");
    }
}

#[test]
fn the_scan_is_closed_faces_outwards_and_is_irregular() {
    let mut volumes = Vec::new();
    for detail in [8, 32, 64] {
        let scene = generate(&Spec::new("", "scan").with("detail", Value::Integer(detail))).unwrap();
        let statue = &scene.objects[0].mesh;
        assert_eq!(open_edges(statue), 0, "detail {detail}");
        volumes.push(volume(statue));
        let area = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| statue.positions[i as usize]);
            (b - a).cross(c - a).length()
        };
        let mut areas: Vec<f32> = statue.triangles.iter().map(area).collect();
        areas.sort_by(f32::total_cmp);
        let n = areas.len();
        assert!(areas[0] > 0.0 && areas[n * 9 / 10] > 10.0 * areas[n / 10]);
    }
    // A finer scan has the same shape.
    assert!(volumes[1] > 0.0 && (volumes[1] / volumes[2] - 1.0).abs() < 0.05, "{volumes:?}");
}

#[test]
fn the_interior_grows_with_its_detail_and_everything_is_in_the_room() {
    let triangles = |detail: i64| {
        let scene = generate(&Spec::new("", "interior").with("detail", Value::Integer(detail))).unwrap();
        let bounds = scene.bounds(0.0);
        assert!(bounds.min.cmpge(Vec3::new(-3.21, -0.11, -2.51)).all(), "{bounds:?}");
        assert!(bounds.max.cmple(Vec3::new(3.11, 2.81, 2.51)).all(), "{bounds:?}");
        for object in &scene.objects {
            // A corner's normal may point away from its triangle only where a thin rim turns sharply.
            let mesh = &object.mesh;
            let looks_away = |t: &&[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                let normal = (b - a).cross(c - a);
                t.iter().any(|&i| normal.dot(mesh.normals[i as usize]) < 0.0)
            };
            let away = mesh.triangles.iter().filter(looks_away).count();
            assert!(away * 20 <= mesh.triangles.len(), "{}: {away}", object.name);
        }
        scene.objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>()
    };
    assert!((50_000..100_000).contains(&triangles(1)));
    assert!((200_000..300_000).contains(&triangles(2)));
}

/// Triangles charged before a scene is made are about those that it then has, with each mesh once.
#[test]
fn generators_know_how_many_triangles_they_make() {
    let sized = |name: &str, key: &str, size: i64| Spec::new("", name).with(key, Value::Integer(size));
    let small = GENERATORS.iter().map(|row| Spec::new("", row.entry.name));
    let large = [
        sized("trio", "tessellation", 40),
        sized("teapots", "tessellation", 20),
        sized("teapot", "tessellation", 30),
        sized("cornell-spheres", "level", 6),
        sized("interior", "detail", 2),
        sized("scan", "detail", 100),
    ];
    for spec in small.chain(large) {
        let row = GENERATORS.iter().find(|row| row.entry.name == spec.kind).unwrap();
        let scene = generate(&spec).unwrap();
        let mut meshes: Vec<_> = scene.objects.iter().map(|object| &object.mesh).collect();
        meshes.dedup_by(|a, b| Arc::ptr_eq(a, b));
        let made: u64 = meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
        let said = (row.triangles)(&Reader::new(&spec, &row.entry).unwrap());
        let is_near = said > made / 2 && said < 2 * made;
        assert!(is_near || said == 0 && made < 1_000_000, "{spec:?}: {said}, not {made}");
    }
}
