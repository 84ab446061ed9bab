//! Knowledge of the boundary of a medium before a ray is traced saves work, and changes no bit of a picture.

use crate::common::media::{any, boxed, grid_in, smoke};
use crate::common::{built, diffuse, floor, integrator, look, put, shoot, sky};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, SceneBuilder, Spec};
use bilux_transport::RenderSettings;
use std::sync::Arc;

/// This box with a triangle of no area along an edge: no ray hits it, but the mesh does not count as closed.
fn opened(mesh: &Mesh) -> Arc<Mesh> {
    let mut mesh = mesh.clone();
    let [a, b, _] = mesh.triangles[0];
    let middle = mesh.positions.len() as u32;
    mesh.positions.push((mesh.positions[a as usize] + mesh.positions[b as usize]) * 0.5);
    mesh.triangles.push([a, b, middle]);
    assert!(!mesh.is_closed());
    Arc::new(mesh)
}

/// A box of this material around the origin, before a floor, under a sky and a lamp; a small body and another lamp are in it or not.
fn scene(material: &Spec, is_open: bool, is_full: bool) -> SceneBuilder {
    let lamp = |p: Vec3| Spec::new("", "point").with("position", p).with("intensity", 6.0f32);
    let mut builder =
        SceneBuilder { lights: vec![lamp(Vec3::new(1.5, 3.0, 1.0))], ..SceneBuilder::default() };
    let mesh = boxed(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
    assert!(mesh.is_closed());
    put(&mut builder, "box", if is_open { opened(&mesh) } else { mesh }, material.clone());
    put(&mut builder, "floor", floor(-0.25, 4.0), diffuse(0.6f32));
    if is_full {
        builder.lights.push(lamp(Vec3::new(0.25, 1.25, 0.25)));
        put(&mut builder, "body", boxed(Vec3::splat(0.5), Vec3::splat(0.75)), diffuse(0.3f32));
    }
    sky(&mut builder, 0.5);
    look(&mut builder, Vec3::new(1.0, 2.5, 5.0), Vec3::new(0.0, 0.75, 0.0), 35.0);
    builder
}

#[test]
fn closed_and_open_boundaries_give_the_same_picture_for_less_and_more_work() {
    let milk = Spec::new("", "dielectric").with("eta", 1.3f32).with("roughness", 0.3f32);
    let milk = milk.with("scattering", Rgb::new(9.0, 6.0, 4.0)).with("absorption", 0.05f32);
    let grid = grid_in(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0), [12, 9, 17], any);
    let media = [
        milk.clone(),
        milk.with("priority", 3),
        Spec::new("", "interface").with("scattering", Rgb::new(4.0, 3.0, 2.0)).with("absorption", 0.02f32),
        smoke(Rgb::grey(0.1), Rgb::new(9.0, 7.0, 8.0), grid),
    ];
    for (medium, material) in media.iter().enumerate() {
        for is_full in [false, true] {
            for name in ["path", "light", "bdpt", "vcm", "sppm"] {
                if name == "sppm" && medium == 3 {
                    continue;
                }
                let rendered = [false, true].map(|is_open| {
                    let settings = RenderSettings { count_work: true, ..RenderSettings::new(16, 16, 2) };
                    shoot(&built(&scene(material, is_open, is_full)), &*integrator(name), &settings)
                });
                let what = format!("{name} in medium {medium}, full: {is_full}");
                let [closed, open] = rendered.map(|rendered| {
                    let work = rendered.counters.rays + rendered.counters.nodes;
                    (rendered.film.to_rgb(), work)
                });
                assert!(closed.0 == open.0, "{what}");
                assert!(closed.1 < open.1 || medium == 3, "{what}: {} and {}", closed.1, open.1);
            }
        }
    }
}
