//! Times structures on rays as a renderer sends them: from a camera, towards a light, and scattered off surfaces.
//!
//! ```text
//! cargo run --release -p bilux-accel --example ray_classes -- [--scene teapots|field|hills|FILE.obj] [--accel A,B,…] [--rounds N]
//!     [--rays LOG2] [--level baseline|avx2|avx512] [--build fast|balanced|best] [--class NAME] [--mode single|batch] [--dump DIR]
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::registry::Quality;
use bilux_accel::{Accelerator, BuildOptions, CpuLevel, Hit, Query, Ray, TriangleMesh, build};
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::transcendental::{cos, sin};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

type Triangles = Vec<[[f32; 3]; 3]>;

fn unit(seed: u64, i: u64) -> f32 {
    unit_f32(hash_words([seed, i]) as u32)
}

fn add(a: [f32; 3], b: [f32; 3], x: f32) -> [f32; 3] {
    std::array::from_fn(|k| a[k] + b[k] * x)
}

fn normalised(a: [f32; 3]) -> [f32; 3] {
    let length = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt().max(f32::MIN_POSITIVE);
    a.map(|x| x / length)
}

/// A surface of `n` by `m` cells.
fn sheet(n: usize, m: usize, place: impl Fn(f32, f32) -> [f32; 3]) -> Triangles {
    let at = |i: usize, j: usize| place(i as f32 / n as f32, j as f32 / m as f32);
    let cell = |cell: usize| {
        let (i, j) = (cell / m, cell % m);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..n * m).flat_map(cell).collect()
}

fn knot(n: usize, m: usize, at: [f32; 3], tube: f32) -> Triangles {
    let tau = std::f32::consts::TAU;
    let curve = |u: f32| {
        let a = u * tau;
        let r = 1.0 + 0.4 * cos(3.0 * a);
        [r * cos(2.0 * a), 0.5 * sin(3.0 * a) + 0.6, r * sin(2.0 * a)]
    };
    sheet(n, m, |u, v| {
        let (p, q) = (curve(u), curve(u + 1e-3));
        let along = normalised(add(q, p, -1.0));
        let side = normalised([along[2], 0.0, -along[0]]);
        let up = [
            along[1] * side[2] - along[2] * side[1],
            along[2] * side[0] - along[0] * side[2],
            along[0] * side[1] - along[1] * side[0],
        ];
        let r = tube * (1.0 + 0.2 * sin(40.0 * u * tau) * sin(6.0 * v * tau));
        add(at, add(add(p, side, r * cos(v * tau)), up, r * sin(v * tau)), 1.0)
    })
}

fn scene(name: &str) -> Result<Triangles, Box<dyn Error>> {
    let floor = |n: usize, size: f32| sheet(n, n, move |u, v| [(u - 0.5) * size, 0.0, (v - 0.5) * size]);
    Ok(match name {
        "teapots" => {
            let mut all = floor(2, 12.0);
            for i in 0..3 {
                all.extend(knot(84, 24, [i as f32 * 2.6 - 2.6, 0.0, 0.0], 0.25));
            }
            all
        }
        "field" => {
            let mut all = floor(2, 12.0);
            for i in 0..3 {
                all.extend(knot(1400, 125, [i as f32 * 2.6 - 2.6, 0.0, 0.0], 0.25));
            }
            all
        }
        "hills" => sheet(660, 660, |u, v| {
            let mut height = 0.0;
            let mut size = 1.0;
            for octave in 0..9 {
                let f = (1 << octave) as f32;
                height += size * sin(f * 3.1 * u + octave as f32) * cos(f * 2.7 * v + 1.3 * f * u);
                size *= 0.55;
            }
            let warp = 0.02 * sin(60.0 * u) * sin(50.0 * v);
            [(u - 0.5) * 8.0 + warp, height * 0.8, (v - 0.5) * 8.0 - warp]
        }),
        file => {
            let text = std::fs::read_to_string(file)?;
            let (mut points, mut all) = (Vec::new(), Vec::new());
            for line in text.lines() {
                let mut words = line.split_whitespace();
                match words.next() {
                    Some("v") => {
                        let p: Vec<f32> = words.take(3).map(str::parse).collect::<Result<_, _>>()?;
                        points.push([p[0], p[1], p[2]]);
                    }
                    Some("f") => {
                        let index = |word: &str| word.split('/').next().unwrap_or("").parse::<usize>();
                        let f: Vec<usize> = words.map(index).collect::<Result<_, _>>()?;
                        all.extend((2..f.len()).map(|i| [f[0], f[i - 1], f[i]].map(|i| points[i - 1])));
                    }
                    _ => {}
                }
            }
            all
        }
    })
}

struct Class {
    name: &'static str,
    any: bool,
    rays: Vec<Ray>,
}

fn normal(t: &[[f32; 3]; 3], towards: [f32; 3]) -> [f32; 3] {
    let (a, b) = (add(t[1], t[0], -1.0), add(t[2], t[0], -1.0));
    let n = normalised([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]);
    let side = n[0] * towards[0] + n[1] * towards[1] + n[2] * towards[2];
    if side > 0.0 { n.map(|x| -x) } else { n }
}

fn classes(triangles: &Triangles, tree: &dyn Accelerator, log2: u32) -> Vec<Class> {
    let bounds = tree.bounds();
    let (centre, size) = (bounds.centre().to_array(), bounds.extent().length());
    let n = 1u64 << (log2 / 2);
    let eye = add(centre, [0.35, 0.45, 0.6], size * 0.62);
    let forward = normalised(add(centre, eye, -1.0));
    let right = normalised([-forward[2], 0.0, forward[0]]);
    let up = [
        right[1] * forward[2] - right[2] * forward[1],
        right[2] * forward[0] - right[0] * forward[2],
        right[0] * forward[1] - right[1] * forward[0],
    ];
    let mut primary = Vec::new();
    for index in 0..n * n {
        // Morton order.
        let even = |mut x: u64| {
            let mut out = 0;
            for bit in 0..16 {
                out |= (x & 1) << bit;
                x >>= 2;
            }
            out
        };
        let (x, y) = (even(index), even(index >> 1));
        let (sx, sy) = ((x as f32 + 0.5) / n as f32 * 1.1 - 0.55, 0.45 - (y as f32 + 0.5) / n as f32 * 0.9);
        primary.push(Ray::new(eye, normalised(add(add(forward, right, sx), up, sy))));
    }
    let scatter = |rays: &[Ray], seed: u64, length: f32| -> Vec<Ray> {
        let mut out = Vec::new();
        for (i, ray) in rays.iter().enumerate() {
            if let Some(hit) = tree.closest_hit(ray, &Query::default()) {
                let n = normal(&triangles[hit.primitive as usize], ray.direction);
                let v: [f32; 3] = std::array::from_fn(|k| unit(seed, i as u64 * 3 + k as u64) * 2.0 - 1.0);
                let mut ray = Ray::new(ray.at(hit.t), normalised(add(n, normalised(v), 0.999)));
                ray.exclude = hit.primitive();
                ray.t_max = length;
                out.push(ray);
            }
        }
        // As many rays in every class.
        let have = out.len();
        for i in 0..rays.len() - have {
            out.push(out[i % have]);
        }
        out
    };
    let light = add(add(centre, up, size * 0.8), right, size * 0.3);
    let mut shadow = scatter(&primary, 4, f32::INFINITY);
    for (i, ray) in shadow.iter_mut().enumerate() {
        let at = add(light, [unit(5, 2 * i as u64), 0.0, unit(5, 2 * i as u64 + 1)], size * 0.2);
        ray.direction = add(at, ray.origin, -1.0);
        ray.t_max = 0.999;
    }
    let bounce = scatter(&primary, 1, f32::INFINITY);
    let mut bounce2 = scatter(&bounce, 2, f32::INFINITY);
    for i in (1..bounce2.len()).rev() {
        bounce2.swap(i, (hash_words([9, i as u64]) % (i as u64 + 1)) as usize);
    }
    let ao = scatter(&primary, 3, size * 0.1);
    let class = |name, any, rays| Class { name, any, rays };
    vec![
        class("primary", false, primary),
        class("ao", true, ao),
        class("bounce", false, bounce),
        class("bounce2", false, bounce2),
        class("shadow", true, shadow),
    ]
}

fn run(tree: &dyn Accelerator, class: &Class, batches: bool) -> (f64, u64) {
    let start = Instant::now();
    let mut sum = 0u64;
    let query = Query::default();
    let weight = |hit: &Option<Hit>| {
        hit.map_or(0, |hit| u64::from(hit.t.to_bits()).wrapping_mul(31) + u64::from(hit.primitive))
    };
    if batches && class.any {
        let mut hits = vec![false; class.rays.len()];
        tree.any_hits(&class.rays, &query, &mut hits);
        sum = hits.iter().map(|&hit| u64::from(hit)).sum();
    } else if batches {
        let mut hits = vec![None; class.rays.len()];
        tree.closest_hits(&class.rays, &query, &mut hits);
        sum = hits.iter().map(weight).fold(0, u64::wrapping_add);
    } else if class.any {
        for ray in &class.rays {
            sum += u64::from(tree.any_hit(ray, &query));
        }
    } else {
        for ray in &class.rays {
            sum = sum.wrapping_add(weight(&tree.closest_hit(ray, &query)));
        }
    }
    (class.rays.len() as f64 / start.elapsed().as_secs_f64() / 1e6, sum)
}

fn write(folder: &str, triangles: &Triangles, classes: &[Class]) -> Result<(), Box<dyn Error>> {
    let words = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    let count = triangles.len() as u32;
    // Vertices shared by bits.
    let mut known = std::collections::HashMap::new();
    let (mut points, mut indices) = (Vec::new(), Vec::new());
    for p in triangles.iter().flatten() {
        let next = known.len() as u32;
        let bits = p.map(f32::to_bits);
        indices.push(*known.entry(bits).or_insert_with(|| {
            points.extend(bits);
            next
        }));
    }
    let header = [u32::from_le_bytes(*b"MSH1"), known.len() as u32, count];
    std::fs::write(format!("{folder}/mesh.msh"), [words(&header), words(&points), words(&indices)].concat())?;
    for class in classes {
        let header = [u32::from_le_bytes(*b"RAY1"), u32::from(class.any), class.rays.len() as u32];
        let rays = class.rays.iter().flat_map(|r| {
            let ([a, b, c], [x, y, z]) = (r.origin, r.direction);
            // What the other side does not know how to exclude.
            let start = if r.exclude == bilux_accel::Primitive::NONE { 0.0 } else { 1e-4 };
            [a, b, c, r.t_min.max(start), x, y, z, r.t_max].map(f32::to_bits)
        });
        let rays: Vec<u32> = rays.collect();
        std::fs::write(format!("{folder}/{}.ray", class.name), [words(&header), words(&rays)].concat())?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene_name = "teapots".to_owned();
    let mut accels = "bvh,bvh8".to_owned();
    let (mut rounds, mut log2) = (5, 20);
    let mut options = BuildOptions::default();
    let mut only = String::new();
    let (mut dump, mut batches) = (None, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(key) = arguments.next() {
        let value = arguments.next().ok_or("a value is missing")?;
        match key.as_str() {
            "--scene" => scene_name = value,
            "--accel" => accels = value,
            "--rounds" => rounds = value.parse()?,
            "--rays" => log2 = value.parse()?,
            "--class" => only = value,
            "--mode" => batches = value == "batch",
            "--dump" => dump = Some(value),
            "--build" => options.quality = Quality::from_name(&value).ok_or("no such quality")?,
            "--level" => {
                let level = CpuLevel::ALL.into_iter().find(|level| level.name() == value);
                options.cpu_level = level.ok_or("no such level")?;
            }
            _ => return Err(format!("unknown argument {key}").into()),
        }
    }
    let triangles = scene(&scene_name)?;
    let mesh = Arc::new(TriangleMesh::from_corners(triangles.clone())?);
    let mut trees = Vec::new();
    for name in accels.split(',') {
        let mut best = f64::INFINITY;
        let mut tree = None;
        for _ in 0..if rounds > 1 { 3 } else { 1 } {
            drop(tree.take());
            let start = Instant::now();
            tree = Some(build(name, Arc::clone(&mesh), &options)?);
            best = best.min(start.elapsed().as_secs_f64());
        }
        let tree = tree.ok_or("no tree")?;
        let bytes = tree.memory_bytes() as f64 / mesh.len() as f64;
        let shape = tree.shape();
        println!(
            "{scene_name} {} triangles: {name} built in {:.0} ms, {bytes:.1} bytes a triangle, {} nodes, {} leaves",
            mesh.len(),
            best * 1e3,
            shape.nodes,
            shape.leaves
        );
        trees.push((name.to_owned(), tree));
    }
    let classes = classes(&triangles, trees[0].1.as_ref(), log2);
    if let Some(folder) = dump {
        write(&folder, &triangles, &classes)?;
    }
    for class in classes.iter().filter(|class| only.is_empty() || class.name == only) {
        let mut speeds = vec![Vec::new(); trees.len()];
        let mut sums = Vec::new();
        for _ in 0..rounds {
            sums.clear();
            for ((_, tree), speeds) in trees.iter().zip(&mut speeds) {
                let (speed, sum) = run(tree.as_ref(), class, batches);
                speeds.push(speed);
                sums.push(sum);
            }
        }
        print!("{:8}", class.name);
        for (speeds, (name, _)) in speeds.iter_mut().zip(&trees) {
            speeds.sort_by(f64::total_cmp);
            let median = speeds.get(speeds.len() / 2).copied().unwrap_or(0.0);
            print!("  {name} {median:6.2} (best {:6.2})", speeds.last().copied().unwrap_or(0.0));
        }
        println!("{}", if sums.iter().all(|sum| *sum == sums[0]) { "" } else { "  DIFFERENT" });
    }
    Ok(())
}
