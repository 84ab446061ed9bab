//! The shapes of the trees that are built over one mesh, and the cost of rays in each.
//!
//! ```text
//! cargo run --release -p bilux-accel --example bsp_shapes -- [MESH.asc [COPIES]]
//! ```
//! Without a file, the mesh is a torus of 20,000 triangles. Copies stand next to each other, each an object of its
//! own. The rays are those of a 256 × 256 image, and from each hit a mirrored ray and one towards a light.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::{
    Accelerator, BuildOptions, Counters, Primitive, Query, Ray, TriangleMesh, build,
    registry::{BspGroup, BspSplit, Quality},
};
use bilux_math::{Vec3, transcendental};
use std::{error::Error, sync::Arc, time::Instant};

type Triangle = [[f32; 3]; 3];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let one = match arguments.next() {
        Some(path) => read_asc(&std::fs::read_to_string(path)?),
        None => torus(200, 50),
    };
    let copies = arguments.next().map_or(Ok(1), |copies| copies.parse())?;
    let mesh = Arc::new(side_by_side(&one, copies)?);
    println!("{} triangles, {copies} objects", mesh.len());
    println!(
        "{:16} {:>8} {:>6} {:>5} {:>7} {:>8} {:>8} {:>9} {:>9} {:>7}",
        "structure",
        "build s",
        "refs/n",
        "depth",
        "MiB",
        "nodes/r",
        "tests/r",
        "us/ray",
        "vs brute",
        "vs bvh"
    );
    let mesh_size = mesh.len();
    let rays = Rays::of(&mesh)?;
    let brute = rays.sample(64).measure(&*build("brute", mesh.clone(), &BuildOptions::default())?);
    println!(
        "{:16} {:49} {:8.0} {:9.3}",
        "brute",
        "",
        brute.1.triangles as f64 / brute.1.rays as f64,
        brute.0
    );
    let mut bvh = None;
    for (label, name, options) in structures() {
        let start = Instant::now();
        let Ok(tree) = build(name, mesh.clone(), &options) else { continue };
        let build_seconds = start.elapsed().as_secs_f64();
        let (micros, counters) = rays.measure(&*tree);
        let bvh = *bvh.get_or_insert(micros);
        let shape = tree.shape();
        let per_ray = |count: u64| count as f64 / counters.rays as f64;
        println!(
            "{label:16} {build_seconds:8.3} {:6.2} {:5} {:7.2} {:8.1} {:8.2} {micros:9.3} {:9.0} {:7.2}",
            shape.references as f64 / mesh_size as f64,
            shape.depth,
            tree.memory_bytes() as f64 / 1_048_576.0,
            per_ray(counters.nodes),
            per_ray(counters.triangles),
            brute.0 / micros,
            bvh / micros,
        );
    }
    Ok(())
}

/// Label, name and options of each structure; the others are compared with the first available one.
fn structures() -> Vec<(&'static str, &'static str, BuildOptions)> {
    let with = |bsp_split, bsp_group, quality| BuildOptions {
        bsp_split,
        bsp_group,
        quality,
        ..BuildOptions::default()
    };
    let (mean, fuchs) = (BspSplit::Mean, BspSplit::Fuchs);
    let (polygons, objects) = (BspGroup::Polygons, BspGroup::Objects);
    vec![
        ("bvh", "bvh", with(mean, polygons, Quality::Balanced)),
        ("kd", "kd", with(mean, polygons, Quality::Balanced)),
        ("bsp-sah fast", "bsp-sah", with(mean, polygons, Quality::Fast)),
        ("bsp-sah", "bsp-sah", with(mean, polygons, Quality::Balanced)),
        ("bsp-sah best", "bsp-sah", with(mean, polygons, Quality::Best)),
        ("bsp mean", "bsp", with(mean, polygons, Quality::Balanced)),
        ("bsp fuchs", "bsp", with(fuchs, polygons, Quality::Balanced)),
        ("bsp objects", "bsp", with(mean, objects, Quality::Balanced)),
        ("bsp fuchs obj.", "bsp", with(fuchs, objects, Quality::Balanced)),
    ]
}

/// Rays for closest-hit queries, and rays for any-hit queries.
struct Rays {
    closest: Vec<Ray>,
    any: Vec<Ray>,
}

impl Rays {
    fn of(mesh: &Arc<TriangleMesh>) -> Result<Rays, Box<dyn Error>> {
        const SIZE: usize = 256;
        let tree = build("bsp-sah", mesh.clone(), &BuildOptions::default())?;
        let (centre, radius) = (mesh.bounds().centre(), mesh.bounds().radius());
        let eye = centre + radius * Vec3::new(0.9, 0.8, 1.8);
        let light = centre + radius * Vec3::new(-1.0, 3.0, 2.0);
        let forward = (centre - eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let mut rays = Rays { closest: Vec::new(), any: Vec::new() };
        for pixel in 0..SIZE * SIZE {
            let place = |i: usize| (i as f32 + 0.5) / SIZE as f32 - 0.5;
            let direction = forward + right * place(pixel % SIZE) - up * place(pixel / SIZE);
            let ray = Ray::new(eye.to_array(), direction.to_array());
            rays.closest.push(ray);
            let Some(hit) = tree.closest_hit(&ray, &Query::default()) else { continue };
            let [a, b, c] = mesh.triangles()[hit.primitive as usize].map(Vec3::from);
            let normal = (b - a).cross(c - a).normalize();
            let exclude = Primitive { instance: 0, index: hit.primitive };
            let leave = |direction: Vec3| Ray { exclude, ..Ray::new(ray.at(hit.t), direction.to_array()) };
            rays.closest.push(leave(direction.reflect(normal)));
            rays.any.push(Ray { t_max: 1.0, ..leave(light - Vec3::from(ray.at(hit.t))) });
        }
        Ok(rays)
    }

    /// Every `step`-th ray, for structures that are too slow for all rays.
    fn sample(&self, step: usize) -> Rays {
        let sample = |rays: &[Ray]| rays.iter().step_by(step).copied().collect();
        Rays { closest: sample(&self.closest), any: sample(&self.any) }
    }

    /// Microseconds per ray, the minimum of seven runs, and the counted work.
    fn measure(&self, tree: &dyn Accelerator) -> (f64, Counters) {
        let query = Query::default();
        let mut counters = Counters::default();
        for ray in &self.closest {
            tree.closest_hit_counted(ray, &query, &mut counters);
        }
        for ray in &self.any {
            tree.any_hit_counted(ray, &query, &mut counters);
        }
        let run = || {
            let start = Instant::now();
            let nearest = self.closest.iter().filter_map(|ray| tree.closest_hit(ray, &query)).count();
            let any = self.any.iter().filter(|ray| tree.any_hit(ray, &query)).count();
            std::hint::black_box(nearest + any);
            start.elapsed().as_secs_f64() * 1e6 / (self.closest.len() + self.any.len()) as f64
        };
        ((0..7).map(|_| run()).fold(f64::INFINITY, f64::min), counters)
    }
}

/// A keyword, then three times eight numbers, of which the first three are a position.
fn read_asc(text: &str) -> Vec<Triangle> {
    let numbers: Vec<f32> = text.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
    let vertex = |numbers: &[f32]| [numbers[0], numbers[1], numbers[2]];
    let triangle = |n: &[f32]| [vertex(&n[0..]), vertex(&n[8..]), vertex(&n[16..])];
    numbers.chunks_exact(24).map(triangle).collect()
}

fn torus(around: usize, across: usize) -> Vec<Triangle> {
    let point = |i: usize, j: usize| {
        let turn = |k: usize, of: usize| (k % of) as f32 / of as f32 * std::f32::consts::TAU;
        let (a, b) = (turn(i, around), turn(j, across));
        let radius = 1.0 + 0.4 * transcendental::cos(b);
        [radius * transcendental::cos(a), 0.4 * transcendental::sin(b), radius * transcendental::sin(a)]
    };
    let quad = |k: usize| {
        let (i, j) = (k / across, k % across);
        let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    (0..around * across).flat_map(quad).collect()
}

/// Copies of a mesh along a slanted line, each an object.
fn side_by_side(one: &[Triangle], copies: usize) -> Result<TriangleMesh, Box<dyn Error>> {
    let extent = TriangleMesh::from_corners(one.to_vec())?.bounds().extent();
    let step = extent * Vec3::new(0.9, 0.1, 0.6);
    let moved = |copy: usize| {
        let offset = step * copy as f32;
        one.iter().map(move |triangle| triangle.map(|vertex| (Vec3::from(vertex) + offset).to_array()))
    };
    let n = one.len() as u32;
    let groups = (0..copies as u32).map(|copy| copy * n..(copy + 1) * n).collect();
    Ok(TriangleMesh::from_corners((0..copies).flat_map(moved).collect())?.with_groups(groups)?)
}
