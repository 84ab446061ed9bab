//! A fine, irregular closed mesh, like a scanned statue: a coiled dragon, worn and scaly, made of triangles whose sizes
//! and shapes vary as those of scans do, including slivers.

mod dragon;
mod noise;

use crate::modelling::isosurface::Samples;
use crate::{GeneratorEntry, integer};
use bilux_math::glam::UVec3;
use bilux_math::registry::Entry;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::typed::cameras::Perspective;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec};
use dragon::Dragon;
use std::f32::consts::PI;
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "scan",
        summary: "a coiled dragon like a scanned statue: closed, finely and unevenly tessellated",
        source: "Doi 1991",
        parameters: &[integer(
            "detail",
            "samples along the height: 64 make 58,000 triangles, 252 make 900,000",
            8,
            800,
            "64",
        )],
    },
    triangles: |reader| 14 * (reader.integer("detail") as u64).pow(2),
    generate: |reader| {
        let mut scene = SceneBuilder::default();
        let clay = Spec::new("fired clay", "diffuse").with("reflectance", Rgb::new(0.62, 0.34, 0.20));
        let clay = scene.add_material(clay);
        scene.objects.push(Object::new("statue", Arc::new(statue(reader.integer("detail") as u32)), clay));
        let stone = Spec::new("stone", "diffuse").with("reflectance", Rgb::new(0.36, 0.38, 0.40));
        let stone = scene.add_material(stone);
        scene.objects.push(Object::new("floor", Arc::new(shapes::floor(Vec3::ZERO, 40.0)), stone));
        light(&mut scene);
        let eye = Perspective::new("front")
            .position(Vec3::new(1.5, 1.35, 2.6))
            .look_at(Vec3::new(0.0, 0.5, 0.0))
            .fov(29.0);
        scene.add_camera(eye);
        Ok(scene)
    },
};

/// The statue, closed, sunk slightly into y = 0 so that it stands firmly, with smooth normals.
pub(super) fn statue(detail: u32) -> Mesh {
    let dragon = Dragon::new();
    let bounds = dragon.bounds();
    let side = bounds.extent().y / detail as f32;
    let cells = (bounds.extent() / side).ceil().as_uvec3() + 1;
    // Scanners sample some parts more densely: here the samples lie closer towards the top and the front.
    let position = |corner: UVec3| {
        let s = corner.as_vec3() / cells.as_vec3();
        let warp = |s: f32, strength: f32| s + strength * sin_cos(PI * s).0 / PI;
        bounds.min + Vec3::new(warp(s.x, 0.3), warp(s.y, 0.45), warp(s.z, 0.25)) * bounds.extent()
    };
    let samples = Samples { cells, values: sampled(&dragon, cells, &position) };
    let mut mesh = Mesh { name: "statue".to_owned(), ..samples.surface(position) };
    let lowest = mesh.bounds().min.y + 0.012;
    mesh.positions.iter_mut().for_each(|p| p.y -= lowest);
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// The field at every corner. In blocks far from the surface, only its sign.
fn sampled(dragon: &Dragon, cells: UVec3, position: &impl Fn(UVec3) -> Vec3) -> Vec<f32> {
    const BLOCK: u32 = 4;
    let corners = cells + 1;
    let mut values = vec![0.0; corners.element_product() as usize];
    let blocks = corners.map(|n| n.div_ceil(BLOCK));
    for b in 0..blocks.element_product() {
        let block = UVec3::new(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
        let (first, end) = (block * BLOCK, ((block + 1) * BLOCK).min(corners));
        let (low, high) = (position(first), position(end - 1));
        let (near, sign) = dragon.near((low + high) * 0.5, (high - low).length() * 0.5);
        for (k, j) in (first.z..end.z).flat_map(|k| (first.y..end.y).map(move |j| (k, j))) {
            for i in first.x..end.x {
                let place = ((k * corners.y + j) * corners.x + i) as usize;
                values[place] =
                    if near.is_empty() { sign } else { near.field(position(UVec3::new(i, j, k))) };
            }
        }
    }
    values
}

fn light(scene: &mut SceneBuilder) {
    scene.lights.push(
        Spec::new("key", "rect")
            .with("position", Vec3::new(2.6, 3.0, 1.2))
            .with("edge_u", Vec3::new(-0.5, 0.0, 1.1))
            .with("edge_v", Vec3::new(-0.8, 0.9, -0.4))
            .with("radiance", Rgb::new(13.0, 12.0, 10.5))
            .with("classic", Rgb::new(0.75, 0.72, 0.66)),
    );
    scene.lights.push(
        Spec::new("sky", "environment")
            .with("zenith", Rgb::new(0.50, 0.60, 0.75))
            .with("horizon", Rgb::new(0.30, 0.33, 0.38))
            .with("ground", Rgb::new(0.10, 0.10, 0.10)),
    );
    scene.lights.push(Spec::new("ambient", "ambient").with("colour", 0.25f32));
}
