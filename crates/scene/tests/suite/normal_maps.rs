//! Normal maps follow OpenGL's convention, however the surface and its texture are placed.

use bilux_math::{Rgb, Transform, Vec2, Vec3};
use bilux_scene::{AccelChoice, Mesh, Object, Ray, Scene, SceneBuilder, Spec, Texture, Tracer, Value};
use std::sync::Arc;

/// A square towards +z with a normal map that is `texel` everywhere.
fn square(texel: Rgb, uvs: [Vec2; 4], transform: Transform, scale: f32) -> Scene {
    let mut builder = SceneBuilder::default();
    let texture = Texture::new("", 1, 1, vec![texel], true);
    builder.textures.push(Arc::new(texture));
    let spec = Spec::new("", "diffuse").with("normal", Value::Texture(0)).with("normal_scale", scale);
    let material = builder.add_material(spec);
    let mesh = Mesh {
        positions: vec![
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(1.0, -1.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(-1.0, 1.0, 0.0),
        ],
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    builder.objects.push(Object::new("", Arc::new(mesh), material).placed(transform));
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

fn n_shade(scene: &Scene) -> Vec3 {
    let ray = Ray::new([0.1, 0.2, 5.0], [0.0, 0.0, -1.0]);
    Tracer::new(scene, false).closest(&ray).unwrap().n_shade
}

const UPRIGHT: [Vec2; 4] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];

#[test]
fn red_leans_along_u_and_green_along_v() {
    let (right, up) = (Rgb::new(0.8, 0.5, 0.9), Rgb::new(0.5, 0.8, 0.9));
    let (along, away) = (0.6, 0.8);
    let mirrored_u = UPRIGHT.map(|uv| Vec2::new(1.0 - uv.x, uv.y));
    let flat = Transform::IDENTITY;
    let mirror =
        Transform::from_matrix(bilux_math::DMat4::from_scale(bilux_math::DVec3::new(-1.0, 1.0, 1.0)))
            .unwrap();
    for (texel, uvs, transform, wanted) in [
        (right, UPRIGHT, flat, Vec3::new(along, 0.0, away)),
        (up, UPRIGHT, flat, Vec3::new(0.0, along, away)),
        (right, mirrored_u, flat, Vec3::new(-along, 0.0, away)),
        (up, mirrored_u, flat, Vec3::new(0.0, along, away)),
        (right, UPRIGHT, mirror, Vec3::new(-along, 0.0, away)),
        (up, UPRIGHT, mirror, Vec3::new(0.0, along, away)),
    ] {
        let found = n_shade(&square(texel, uvs, transform, 1.0));
        assert!((found - wanted.normalize()).length() < 1e-5, "{found}, not {wanted}");
    }
    let (half, none) = (square(right, UPRIGHT, flat, 0.5), square(right, UPRIGHT, flat, 0.0));
    assert!((n_shade(&half) - Vec3::new(0.3, 0.0, 0.8).normalize()).length() < 1e-5);
    assert_eq!(n_shade(&none), Vec3::Z);
}

#[test]
fn mapped_normals_never_point_inside() {
    let inwards = n_shade(&square(Rgb::new(0.9, 0.5, 0.2), UPRIGHT, Transform::IDENTITY, 1.0));
    assert!(inwards.z > 0.0 && (inwards.length() - 1.0).abs() < 1e-5, "{inwards}");
}

#[test]
fn the_parts_of_a_mix_have_no_normal_maps_of_their_own() {
    let mut builder = SceneBuilder::default();
    builder.textures.push(Arc::new(Texture::new("", 1, 1, vec![Rgb::WHITE], true)));
    let a = builder.add_material(Spec::new("", "diffuse").with("normal", Value::Texture(0)));
    builder.add_material(Spec::new("", "mix").with("a", Value::Material(a)).with("b", Value::Material(a)));
    let error = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap().to_string();
    assert!(error.contains("'a' has a normal map"), "{error}");
}
