//! The five classes of rays.

use super::batch::Batch;
use bilux::accel::{Accelerator, Bvh, Query, Ray, TriangleMesh};
use bilux::math::{Frame, Vec2, Vec3};
use bilux::scene::{Camera, CameraSample};
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::warp::sample_cosine_hemisphere;

/// A point from which rays start.
#[derive(Clone, Copy)]
struct Point {
    /// Offset from the surface, so that no engine hits the triangle that the ray leaves.
    position: Vec3,
    normal: Vec3,
    t: f32,
}

/// Makes `count` rays of every class, deterministically for each scene; returns `None` if the camera sees nothing.
/// `light` is the centre and the edges of an area light; without it, one is placed overhead.
pub(super) fn make(
    mesh: &TriangleMesh,
    camera: &dyn Camera,
    light: Option<[Vec3; 3]>,
    count: usize,
) -> Option<Vec<Batch>> {
    let tree = Bvh::new(mesh);
    let width = (1..).find(|w: &usize| w * w >= count)?;
    let primary: Vec<Ray> =
        morton_in_tiles(width).take(count).map(|[x, y]| pixel(camera, x, y, width)).collect();
    let by_pixel = (0..count).map(|k| pixel(camera, k % width, k / width, width));
    let first = arrivals(&tree, mesh, by_pixel);
    let scale = median_t(&first)?;
    let diffuse = |points: &[Point], salt: u64| -> Vec<Ray> {
        (0..count).map(|k| scattered(&points[k % points.len()], salt, k)).collect()
    };
    let bounce = diffuse(&first, 1);
    let second = arrivals(&tree, mesh, bounce.iter().copied());
    let mut bounce2 = diffuse(if second.is_empty() { &first } else { &second }, 2);
    shuffle(&mut bounce2);
    let short = |ray: Ray| Ray { t_max: 0.1 * scale, ..ray };
    let ao = diffuse(&first, 3).into_iter().map(short).collect();
    let light = light.unwrap_or_else(|| overhead(&first, scale));
    let shadow = (0..count).map(|k| to_light(&first[k % first.len()], light, k)).collect();
    let batch = |class: &str, any: bool, rays: Vec<Ray>| Batch { class: class.to_owned(), any, rays };
    Some(vec![
        batch("primary", false, primary),
        batch("ao", true, ao),
        batch("bounce", false, bounce),
        batch("bounce2", false, bounce2),
        batch("shadow", true, shadow),
    ])
}

/// The pixels of a square picture, tile by tile, each tile in Morton order.
fn morton_in_tiles(width: usize) -> impl Iterator<Item = [usize; 2]> {
    let tiles = width.div_ceil(16);
    let even_bits = |k: usize| (0..4).fold(0, |bits, b| bits | (k >> (2 * b) & 1) << b);
    let in_tile = move |tile: usize| {
        (0..256).map(move |k| [tile % tiles * 16 + even_bits(k), tile / tiles * 16 + even_bits(k >> 1)])
    };
    (0..tiles * tiles).flat_map(in_tile).filter(move |p| p[0] < width && p[1] < width)
}

/// A ray through the centre of a pixel, with a direction of unit length.
fn pixel(camera: &dyn Camera, x: usize, y: usize, width: usize) -> Ray {
    let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / width as f32;
    let ray = camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 });
    let direction = Vec3::from(ray.direction).normalize_or_zero();
    Ray { t_min: 0.0, t_max: f32::INFINITY, ..Ray::new(ray.origin, direction.to_array()) }
}

/// Points that rays hit; rays that miss are left out.
fn arrivals(tree: &Bvh, mesh: &TriangleMesh, rays: impl Iterator<Item = Ray>) -> Vec<Point> {
    let arrive = |ray: Ray| {
        let hit = tree.closest_hit(&ray, &Query::default())?;
        let [a, b, c] = mesh.triangles()[hit.primitive as usize].map(Vec3::from);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let normal = if normal.dot(Vec3::from(ray.direction)) > 0.0 { -normal } else { normal };
        let position = a + (b - a) * hit.u + (c - a) * hit.v;
        // An offset of many ulps of the largest coordinate that went into the point.
        let size = a.abs().max(b.abs()).max(c.abs()).max(Vec3::from(ray.origin).abs()).max_element();
        Some(Point { position: position + normal * (size * 64.0 * f32::EPSILON), normal, t: hit.t })
    };
    rays.filter_map(arrive).collect()
}

fn median_t(points: &[Point]) -> Option<f32> {
    let mut ts: Vec<f32> = points.iter().map(|p| p.t).collect();
    ts.sort_by(f32::total_cmp);
    ts.get(ts.len() / 2).copied()
}

/// Two numbers in 0..1 for ray `k`.
fn chances(salt: u64, k: usize) -> Vec2 {
    let bits = hash_words([salt, k as u64]);
    Vec2::new(unit_f32(bits as u32), unit_f32((bits >> 32) as u32))
}

/// A cosine-distributed ray away from a diffuse surface.
fn scattered(point: &Point, salt: u64, k: usize) -> Ray {
    let local = sample_cosine_hemisphere(chances(salt, k));
    let direction = Frame::from_normal(point.normal).to_world(local);
    Ray::new(point.position.to_array(), direction.to_array())
}

/// A square light above the visible points, a third as wide as their median distance from the camera.
fn overhead(points: &[Point], scale: f32) -> [Vec3; 3] {
    let mut middles: Vec<Vec3> = points.iter().map(|p| p.position).collect();
    let mut median = |axis: usize| {
        middles.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
        middles[middles.len() / 2][axis]
    };
    let middle = Vec3::new(median(0), median(1), median(2));
    [middle + Vec3::Y * (0.8 * scale), Vec3::X * (0.33 * scale), Vec3::Z * (0.33 * scale)]
}

/// A ray to a point on the light that stops just short of it.
fn to_light(point: &Point, [middle, u, v]: [Vec3; 3], k: usize) -> Ray {
    let chance = chances(4, k) - 0.5;
    let direction = middle + u * chance.x + v * chance.y - point.position;
    Ray { t_max: 0.999, ..Ray::new(point.position.to_array(), direction.to_array()) }
}

fn shuffle(rays: &mut [Ray]) {
    for k in (1..rays.len()).rev() {
        rays.swap(k, (hash_words([5, k as u64]) % (k as u64 + 1)) as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::morton_in_tiles;

    #[test]
    fn every_pixel_comes_once_and_tile_by_tile() {
        for width in [1, 15, 16, 50] {
            let mut pixels: Vec<_> = morton_in_tiles(width).collect();
            assert_eq!(&pixels[..pixels.len().min(2)], &[[0, 0], [1, 0]][..pixels.len().min(2)]);
            pixels.sort_unstable();
            pixels.dedup();
            assert_eq!(pixels.len(), width * width);
        }
    }
}
