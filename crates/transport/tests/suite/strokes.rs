//! Points and lines, which rays hit as spheres and capsules, look the same from both ends. See
//! docs/adr/0025-points-and-curves.md.

use crate::common::statistics::{assert_like_path, assert_unlike_path};
use crate::common::{built, diffuse, floor, look, put, quad, sky};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec, StrokeWidths};
use std::sync::Arc;

/// A zigzag, with points above it; all of them cast shadows on each other.
fn strokes() -> Arc<Mesh> {
    let zigzag = (0..7).map(|i| Vec3::new(i as f32 * 0.4 - 1.2, 0.3 + 0.5 * (i % 2) as f32, 0.2));
    let cloud = (0..12).map(|i| {
        let place = [5, 7, 11].map(|step| (i * step % 13) as f32 / 12.0);
        Vec3::new(2.4 * place[0] - 1.2, 1.1 + 0.5 * place[1], 1.6 * place[2] - 0.8)
    });
    let positions: Vec<Vec3> = zigzag.chain(cloud).collect();
    let vertex_kd = (0..positions.len()).map(|i| Rgb::new(0.8, 0.3 + 0.1 * (i % 4) as f32, 0.5)).collect();
    let (points, lines) = ((7..19).collect(), (0..6).map(|i| [i, i + 1]).collect());
    Arc::new(Mesh { positions, vertex_kd, points, lines, ..Mesh::default() })
}

/// The strokes of a material on a floor, `width` times as wide as usual.
fn stage(material: Spec, width: f32, light: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let stroke_widths = StrokeWidths { points: 0.3 * width, lines: 0.2 * width };
    let mut builder = SceneBuilder { stroke_widths, ..SceneBuilder::default() };
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(&mut builder, "strokes", strokes(), material);
    light(&mut builder);
    look(&mut builder, Vec3::new(0.0, 1.6, 4.5), Vec3::new(0.0, 0.7, 0.0), 40.0);
    built(&builder)
}

/// Two large panels and a dim sky, as in a photo studio.
fn studio(builder: &mut SceneBuilder) {
    for (x, intensity) in [(-2.5, 14.0f32), (1.5, 5.0)] {
        let panel =
            Spec::new("", "rect").with("position", Vec3::new(x, 2.6, 0.5)).with("intensity", intensity);
        builder.lights.push(panel.with("edge_u", Vec3::X).with("edge_v", Vec3::Z));
    }
    sky(builder, 0.2);
}

/// An emissive mesh behind the strokes.
fn screen(builder: &mut SceneBuilder) {
    let wall = quad(Vec3::new(-1.5, 0.1, -1.2), Vec3::X * 3.0, Vec3::Y * 2.0);
    put(builder, "screen", wall, diffuse(0.2f32).with("emission", Rgb::new(2.0, 1.5, 1.0)));
}

/// Lacquer: a lobe that follows the normals, and a diffuse one below it.
fn lacquer() -> Spec {
    Spec::new("", "principled").with("base_color", Rgb::new(0.6, 0.2, 0.1)).with("specular_roughness", 0.4f32)
}

#[test]
fn points_and_lines_look_the_same_from_both_ends() {
    let all = ["light", "bdpt", "vcm", "auto"];
    assert_like_path("studio", &stage(diffuse(0.6f32), 1.0, studio), &all);
    assert_like_path("studio, lacquer", &stage(lacquer(), 1.0, studio), &all);
    assert_like_path("screen", &stage(diffuse(0.6f32), 1.0, screen), &all);
    assert_like_path("screen, lacquer", &stage(lacquer(), 1.0, screen), &all);
    // Strokes that emit are no lights: only camera paths find what they emit.
    let glowing = || diffuse(0.3f32).with("emission", Rgb::new(3.0, 2.0, 1.0));
    let found = ["bdpt", "vcm", "auto"];
    assert_like_path("glowing strokes", &stage(glowing(), 1.0, |builder| sky(builder, 0.1)), &found);
    assert_like_path("glowing strokes in a studio", &stage(glowing(), 1.0, studio), &found);
}

/// Planted bug: strokes that are a tenth wider from one end than from the other.
#[test]
fn strokes_of_another_width_are_detected() {
    for light in [studio, screen] {
        let (right, wrong) = (stage(lacquer(), 1.0, light), stage(lacquer(), 1.1, light));
        assert_unlike_path(&right, &wrong, &["light", "bdpt"]);
    }
}
