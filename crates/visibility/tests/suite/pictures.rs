//! Every exact algorithm gives the image of ray casting.

use bilux_accel::{BuildOptions, Culling, TriangleMesh, build};
use bilux_math::{hash, transcendental};
use bilux_testing::effort;
use bilux_visibility::{
    BACKGROUND, VISIBILITY, View, VisibilityOptions, VisibilityResult, visibility, wrong_pixels,
};
use std::f32::consts::TAU;

type Triangle = [[f32; 3]; 3];

/// Numbers in [-1, 1) from a seed.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 += 1;
        hash::unit_f32((hash::mix64(self.0) >> 32) as u32) * 2.0 - 1.0
    }
    fn point(&mut self, scale: f32) -> [f32; 3] {
        std::array::from_fn(|_| self.next() * scale)
    }
}

fn soup(count: usize, size: f32, seed: u64) -> Vec<Triangle> {
    let mut numbers = Numbers(seed << 32);
    let mut triangle = || {
        let centre = numbers.point(1.0);
        std::array::from_fn(|_| {
            let offset = numbers.point(size);
            std::array::from_fn(|axis| centre[axis] + offset[axis])
        })
    };
    (0..count).map(|_| triangle()).collect()
}

/// A closed surface around the y axis, with a tube 0.6 thick.
fn torus(radius: f32, around: usize, across: usize, offset: [f32; 3]) -> Vec<Triangle> {
    let point = |i: usize, j: usize| {
        let (a, b) = ((i % around) as f32 / around as f32 * TAU, (j % across) as f32 / across as f32 * TAU);
        let r = radius + 0.3 * transcendental::cos(b);
        let (sin, cos) = transcendental::sin_cos(a);
        let p = [r * cos, 0.3 * transcendental::sin(b), r * sin];
        [p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]]
    };
    let quads = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn floor(height: f32, half: f32) -> Vec<Triangle> {
    let corner = |x: f32, z: f32| [x * half, height, z * half];
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    vec![[a, b, c], [a, c, d]]
}

/// Three bars that overlap in a cycle.
fn cycle() -> Vec<Triangle> {
    (0..3)
        .map(|k| {
            let turn = |x: f32, y: f32, z: f32| {
                let (sin, cos) = transcendental::sin_cos(k as f32 * TAU / 3.0);
                [x * cos - y * sin, x * sin + y * cos, z]
            };
            [turn(-1.0, 0.2, -0.3), turn(-1.0, 0.8, -0.3), turn(1.6, 0.5, 0.3)]
        })
        .collect()
}

fn mesh(triangles: Vec<Triangle>) -> TriangleMesh {
    TriangleMesh::from_corners(triangles).unwrap()
}

fn view_from(eye: [f32; 3], size: usize) -> View {
    View::pinhole(eye, [0.0; 3], [0.0, 1.0, 0.0], 50.0, size, size).unwrap()
}

fn wide_view_from(eye: [f32; 3], look_at: [f32; 3]) -> View {
    View::pinhole(eye, look_at, [0.0, 1.0, 0.0], 90.0, 48, 32).unwrap()
}

fn by_rays(view: &View, mesh: &TriangleMesh, culling: Culling) -> Vec<u32> {
    let brute = build("brute", mesh.clone().into(), &BuildOptions::default()).unwrap();
    view.cast(brute.as_ref(), culling)
}

fn check_with(what: &str, view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> usize {
    let reference = by_rays(view, mesh, options.culling);
    for row in VISIBILITY.iter().filter(|row| row.exact) {
        let seen = (row.run)(view, mesh, options);
        let wrong = wrong_pixels(&seen.ids, &reference);
        assert_eq!(wrong, 0, "{what}: {} has wrong pixels ({options:?})", row.entry.name);
    }
    reference.iter().filter(|&&id| id != BACKGROUND).count()
}

/// Compares all exact algorithms with ray casting, with and without culling, with switches on and off. Returns the
/// number of pixels in which anything is visible, back faces included.
fn check(what: &str, view: &View, triangles: Vec<Triangle>) -> usize {
    let mesh = mesh(triangles);
    let back = VisibilityOptions { culling: Culling::Back, ..VisibilityOptions::default() };
    check_with(what, view, &mesh, &back);
    let off = VisibilityOptions { cull_by_partition: false, skip_covered: false, ..back };
    check_with(what, view, &mesh, &off);
    check_with(what, view, &mesh, &VisibilityOptions::default())
}

fn run(name: &str, view: &View, mesh: &TriangleMesh) -> VisibilityResult {
    visibility(name, view, mesh, &VisibilityOptions::default()).unwrap()
}

#[test]
fn random_triangles() {
    for seed in 0..12 {
        let (count, size) = [(3, 1.0), (30, 0.7), (150, 0.25), (400, 0.08)][seed % 4];
        let eye = Numbers(seed as u64 + 77).point(2.0);
        let view = view_from([eye[0], eye[1], eye[2] + 3.0], 48);
        assert!(check("soup", &view, soup(count, size, seed as u64)) > 20);
    }
}

/// Corners on a grid, so that edges run through pixel centres, surfaces fold onto themselves, and planes pass through
/// the eye; sizes and positions of every kind.
fn nasty(seed: u64) -> (Option<View>, Vec<Triangle>) {
    let mut numbers = Numbers(seed << 20);
    let mut pick = |choices: &[f32]| {
        let index = (numbers.next() + 1.0) * 0.5 * choices.len() as f32;
        (choices[index as usize], numbers.point(1.0), numbers.point(1.0))
    };
    let grid = pick(&[1e9, 4.0, 8.0, 16.0]).0;
    let snap = |x: f32| (x * grid).round() / grid;
    let size = pick(&[0.1, 0.4, 1.5]).0;
    let mut triangles: Vec<Triangle> = if pick(&[0.0, 1.0]).0 == 0.0 {
        let count = pick(&[5.0, 30.0, 80.0]).0 as usize;
        soup(count, size, seed).into_iter().map(|t| t.map(|p| p.map(snap))).collect()
    } else {
        let heights: Vec<[f32; 3]> = (0..49).map(|_| pick(&[0.0]).1).collect();
        let point = |i: usize, j: usize| {
            let [x, y, z] = heights[i * 7 + j];
            [snap(i as f32 / 3.0 - 1.0 + 0.3 * x), snap(j as f32 / 3.0 - 1.0 + 0.3 * y), snap(0.5 * size * z)]
        };
        let cells = (0..36).map(|k| (k / 6, k % 6));
        cells
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    };
    if pick(&[0.0, 1.0]).0 == 0.0 {
        let turned: Vec<Triangle> = triangles.iter().step_by(5).map(|t| [t[1], t[0], t[2]]).collect();
        triangles.extend(turned);
    }
    let (choice, near, far) = pick(&[0.0, 1.0, 2.0, 3.0]);
    let [a, b, c] = triangles[0];
    let eye = match choice as u32 {
        0 => [0.0, 0.0, 4.0],
        1 => near.map(snap),
        2 => [4.0 * near[0], 4.0 * near[1], 4.0],
        _ => std::array::from_fn(|k| a[k] + 3.0 * near[0] * (b[k] - a[k]) + 3.0 * near[1] * (c[k] - a[k])),
    };
    let target = if choice == 0.0 { [0.0; 3] } else { far.map(snap) };
    let (scale, shift) = (pick(&[1.0, 1.0, 1e-4, 1e6]).0, pick(&[0.0, 0.0, 100.0]).0);
    let fov = pick(&[90.0, 28.072_487, 53.130_1]).0;
    let place = |p: [f32; 3]| p.map(|c| (c + shift) * scale);
    let view = View::pinhole(place(eye), place(target), [0.0, 1.0, 0.0], fov, 32, 32);
    (view.ok(), triangles.into_iter().map(|t| t.map(place)).collect())
}

#[test]
fn nasty_scenes() {
    let (mut seen, scenes) = (0, effort(100, 4_000));
    for seed in 0..scenes {
        if let (Some(view), triangles) = nasty(seed) {
            let culling = if seed % 2 == 0 { Culling::None } else { Culling::Back };
            let middle = triangles.len() as u32 / 2;
            let end = triangles.len() as u32;
            let grouped = mesh(triangles).with_groups(vec![0..middle, middle..end]).unwrap();
            let options = VisibilityOptions { culling, ..VisibilityOptions::default() };
            seen += check_with(&format!("nasty {seed}"), &view, &grouped, &options);
        }
    }
    assert!(seen > 125 * scenes as usize, "the scenes must be seen: {seen}");
}

#[test]
fn crossing_triangles() {
    let fan = |k: usize| {
        let (sin, cos) = transcendental::sin_cos(k as f32 * TAU / 16.0);
        [[-1.0, 0.1 * sin, 0.0], [1.0, sin, cos], [1.0, -sin, -cos]]
    };
    assert!(check("through one line", &view_from([0.3, 0.4, 3.0], 64), (0..8).map(fan).collect()) > 100);
    check("end on", &view_from([3.0, 0.0, 0.0], 64), (0..8).map(fan).collect());
}

#[test]
fn a_cycle_of_three() {
    let view = view_from([0.0, 0.0, 4.0], 96);
    assert!(check("cycle", &view, cycle()) > 500);
    let mesh = mesh(cycle());
    let reference = by_rays(&view, &mesh, Culling::None);
    let plain = run("painter", &view, &mesh);
    assert!(wrong_pixels(&plain.ids, &reference) > 10, "no order of whole triangles can be right here");
    assert!(run("newell", &view, &mesh).counts.splits > 0);
}

#[test]
fn a_cycle_that_no_plane_of_its_own_cuts() {
    // Thin bars along skew lines. The plane of each also contains the direction of the next, which therefore lies
    // wholly behind it.
    let bars = cycle();
    let direction = |t: &Triangle| -> [f32; 3] { std::array::from_fn(|axis| t[2][axis] - t[0][axis]) };
    let tilted = (0..3)
        .map(|k| {
            let next = direction(&bars[(k + 1) % 3]);
            let [a, _, c] = bars[k];
            [a, std::array::from_fn(|axis| a[axis] + 0.06 * next[axis]), c]
        })
        .collect();
    assert!(check("tilted cycle", &view_from([0.0, 0.0, 4.0], 96), tilted) > 100);
}

#[test]
fn coincident_and_coplanar_triangles() {
    let mut triangles = soup(20, 0.8, 5);
    triangles.extend(triangles.clone().into_iter().rev());
    triangles.extend(floor(-0.2, 1.0));
    triangles.extend(floor(-0.2, 0.5));
    check("duplicates", &view_from([0.5, 1.0, 3.0], 64), triangles.clone());
    check("in the plane", &view_from([0.5, -0.2, 3.0], 64), triangles);
    let squares = (0..6).flat_map(|k| floor(0.0, 1.0 - k as f32 * 0.1)).collect();
    assert!(check("only coplanar", &view_from([0.2, 2.0, 1.0], 64), squares) > 500);
}

#[test]
fn closed_surfaces() {
    let mut triangles = torus(0.8, 24, 12, [0.0; 3]);
    check("torus", &view_from([0.5, 1.5, 2.5], 96), triangles.clone());
    let tube = wide_view_from([0.8, 0.0, 0.01], [0.8, 0.0, -1.0]);
    assert_eq!(check("from within the tube", &tube, triangles.clone()), 48 * 32);
    triangles.extend(torus(0.8, 24, 12, [0.7, 0.1, 0.2]));
    triangles.extend(floor(-0.3, 3.0));
    check("interlocked on a floor", &view_from([0.5, 1.5, 2.5], 96), triangles.clone());
    check("edge on", &view_from([2.5, -0.3, 0.0], 64), triangles);
}

#[test]
fn groups_are_clusters() {
    let offsets = [[-1.2, 0.0, 0.0], [1.2, 0.0, 0.0], [0.0, 0.0, -1.2], [0.0, 1.0, 1.2]];
    let one = torus(0.5, 16, 8, [0.0; 3]).len() as u32;
    let triangles: Vec<Triangle> = offsets.into_iter().flat_map(|offset| torus(0.5, 16, 8, offset)).collect();
    let grouped = mesh(triangles).with_groups((0..4).map(|k| k * one..(k + 1) * one).collect()).unwrap();
    check_with("groups", &view_from([2.0, 1.5, 3.0], 96), &grouped, &VisibilityOptions::default());
}

#[test]
fn the_camera_plane_and_the_eye_inside() {
    for seed in 0..6 {
        let mut triangles = soup(60, 1.5, 100 + seed);
        triangles.extend(floor(-0.4, 50.0));
        let eye = Numbers(seed).point(0.5);
        check("inside", &wide_view_from(eye, [0.1, -0.3, -1.0]), triangles);
    }
    let touching = vec![
        [[0.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]],
        [[0.0; 3], [0.0, -1.0, -1.0], [1.0, 0.0, -2.0]],
    ];
    check("eye at a corner", &wide_view_from([0.0; 3], [0.0, 0.0, -1.0]), touching);
}

#[test]
fn triangles_nearer_than_the_minimum_distance_are_invisible() {
    let view = view_from([0.0, 0.5, 3.0], 64).with_t_min(2.9).unwrap();
    assert!(check("near", &view, soup(100, 0.6, 9)) > 100);
}

#[test]
fn degenerate_and_non_finite_triangles() {
    let mut triangles = soup(30, 0.5, 3);
    for k in 0..10 {
        let t = triangles[k];
        triangles.push([t[0], t[0], t[1]]);
        triangles.push([t[0], t[0], t[0]]);
        triangles.push([t[0], t[1], [f32::NAN, 0.0, 0.0]]);
        triangles.push([t[0], t[1], [0.0, f32::INFINITY, 0.0]]);
        let middle = std::array::from_fn(|axis| 0.5 * (t[0][axis] + t[1][axis]));
        triangles.push([t[0], middle, t[1]]);
    }
    check("senseless", &view_from([0.2, 0.1, 3.0], 64), triangles.clone());
    triangles.push([[3e38, 0.0, 0.0], [-3e38, 1.0, 0.0], [0.0, -3e38, 1.0]]);
    check("huge", &view_from([0.2, 0.1, 3.0], 32), triangles);
    check("nothing", &view_from([0.2, 0.1, 3.0], 16), vec![]);
    check("nothing finite", &view_from([0.2, 0.1, 3.0], 16), vec![[[f32::NAN; 3]; 3]; 4]);
    let tiny = soup(40, 0.5, 4).into_iter().map(|t| t.map(|p| p.map(|c| c * 1e-30))).collect();
    check("tiny", &view_from([0.0, 0.0, 3e-30], 32), tiny);
}

#[test]
fn directions_of_any_kind() {
    let pinhole = view_from([0.3, 0.2, 3.0], 40);
    let mut numbers = Numbers(1);
    let mut bent: Vec<[f32; 3]> = (0..1600)
        .map(|pixel| {
            let length = 1.5 + numbers.next();
            pinhole.ray(pixel).unwrap().direction.map(|c| (c + 0.02 * numbers.next()) * length)
        })
        .collect();
    bent[7] = [0.0; 3];
    bent[800] = [f32::NAN; 3];
    let view = View::new([0.3, 0.2, 3.0], 40, 40, bent, 0.0).unwrap();
    assert!(check("bent", &view, soup(80, 0.5, 8)) > 100);
    let mirrored = (0..1600).map(|pixel| pinhole.ray(1599 - pixel).unwrap().direction).collect();
    let view = View::new([0.3, 0.2, 3.0], 40, 40, mirrored, 0.0).unwrap();
    assert!(check("upside down", &view, soup(80, 0.5, 8)) > 100);
    let one = View::new([0.3, 0.2, 3.0], 1, 1, vec![[0.0, 0.0, -1.0]], 0.0).unwrap();
    check("one pixel", &one, soup(80, 0.5, 8));
}

#[test]
fn ordering_saves_depth_comparisons() {
    let mut triangles = torus(0.8, 48, 24, [0.0; 3]);
    triangles.extend(torus(0.8, 48, 24, [0.9, 0.2, 0.3]));
    let (mesh, view) = (mesh(triangles), view_from([0.5, 1.5, 2.5], 128));
    let by_depth = run("z-buffer", &view, &mesh).counts.depth_comparisons;
    for name in ["newell", "bsp-back-to-front", "bsp-front-to-back", "schumacker"] {
        let compared = run(name, &view, &mesh).counts.depth_comparisons;
        assert!(compared * 10 < by_depth, "{name}: {compared} of {by_depth}");
    }
    let seen = run("bsp-front-to-back", &view, &mesh).counts;
    let options = VisibilityOptions { skip_covered: false, ..VisibilityOptions::default() };
    let all = visibility("bsp-front-to-back", &view, &mesh, &options).unwrap().counts;
    assert!(seen.skipped_subtrees > 0 && seen.sort_comparisons < all.sort_comparisons);
    let culled = VisibilityOptions { culling: Culling::Back, ..VisibilityOptions::default() };
    let culled = visibility("bsp-front-to-back", &view, &mesh, &culled).unwrap().counts;
    assert!(culled.culled_back_faces > 0 && culled.triangle_tests < seen.triangle_tests);
}

#[test]
fn too_many_pieces_are_left_to_depth() {
    // Each of these triangles intersects most of the others.
    let (mesh, view) = (mesh(soup(1500, 1.5, 6)), view_from([0.3, 0.4, 4.0], 24));
    let reference = run("z-buffer", &view, &mesh).ids;
    for row in VISIBILITY.iter().filter(|row| row.exact) {
        let seen = (row.run)(&view, &mesh, &VisibilityOptions::default());
        let (name, pieces) = (row.entry.name, seen.counts.pieces);
        assert_eq!(wrong_pixels(&seen.ids, &reference), 0, "{name}");
        assert!(pieces < 600_000, "{name}: {pieces}");
    }
}

#[test]
#[allow(clippy::print_stderr)]
fn the_teapot() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/asc/teapot_lf.asc");
    let Ok(text) = std::fs::read_to_string(path) else {
        eprintln!("skipped: there is no shared teapot");
        return;
    };
    let numbers: Vec<f32> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let corner = |v: &[f32]| [v[0], v[1], v[2]];
    let teapot: Vec<Triangle> =
        numbers.chunks_exact(24).map(|t| [corner(t), corner(&t[8..]), corner(&t[16..])]).collect();
    assert!(teapot.len() > 900);
    let view = View::pinhole([1.0, 4.0, 8.0], [0.0, 1.5, 0.0], [0.0, 1.0, 0.0], 40.0, 128, 128).unwrap();
    assert!(check("teapot", &view, teapot) > 2000);
}

#[test]
fn an_unknown_name_is_refused() {
    let view = view_from([0.0, 0.0, 3.0], 4);
    let error = visibility("newel", &view, &mesh(vec![]), &VisibilityOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "there is no visibility algorithm 'newel'");
}
