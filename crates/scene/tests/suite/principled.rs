//! A texture of one colour is the same as that colour, for every parameter of `principled`.

use bilux_math::registry::ParameterKind;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{
    AccelChoice, MATERIALS, Mesh, Object, Ray, SceneBuilder, Spec, Texture, Tracer, TransportMode, Value,
};
use std::sync::Arc;

/// Parameters that are no part of scattering, and those of what lies below the surface.
const APART: [&str; 6] =
    ["emission", "opacity", "normal", "coat_normal", "subsurface_weight", "subsurface_color"];

/// The BSDF towards some directions, where each parameter has a value of its own, as a number or as a texture.
fn scattered(thin: bool, textured: Option<&str>) -> Vec<[f32; 4]> {
    let row = MATERIALS.iter().find(|row| row.entry.name == "principled").unwrap();
    let mut builder = SceneBuilder::default();
    let mut spec = Spec::new("", "principled").with("thin_walled", thin);
    let own = |i: usize| 0.15 + 0.7 * (0.381_966 * i as f32).fract();
    for (i, parameter) in row.entry.parameters.iter().enumerate() {
        let name = parameter.name;
        let colour = match parameter.kind {
            _ if APART.contains(&name) => continue,
            ParameterKind::ColourTexture { .. } => Rgb::new(own(i), own(i + 1), own(i + 2)),
            ParameterKind::NumberTexture { min, max } => {
                Rgb::grey(min as f32 + own(i) * (max.min(min + 1.0) - min) as f32)
            }
            _ => continue,
        };
        let is_textured = textured.is_none_or(|only| only == name);
        if is_textured {
            builder.textures.push(Arc::new(Texture::new("", 1, 1, vec![colour], true)));
            spec.parameters.set(name, Value::Texture(builder.textures.len() - 1));
        } else if matches!(parameter.kind, ParameterKind::NumberTexture { .. }) {
            spec.parameters.set(name, colour.r);
        } else {
            spec.parameters.set(name, colour);
        }
    }
    let material = builder.add_material(spec);
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    builder.objects.push(Object::new("", Arc::new(mesh), material));
    let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let ray = Ray::new([0.2, 0.3, 5.0], [0.0, 0.0, -1.0]);
    let surface = Tracer::new(&scene, false).closest(&ray).unwrap();
    let bsdf = scene.material(&surface).bsdf(&surface);
    let wo = Vec3::new(0.3, -0.2, 0.9).normalize();
    let directions = [(0.5, 0.4, 0.6), (-0.3, 0.2, 0.9), (0.1, 0.8, 0.3), (-0.4, 0.3, -0.8)];
    let of = |(x, y, z)| {
        let (f, pdf) = bsdf.eval_and_pdf(wo, Vec3::new(x, y, z).normalize(), TransportMode::Radiance);
        [f.r, f.g, f.b, pdf]
    };
    directions.map(of).to_vec()
}

/// Blending equal texels rounds.
fn assert_alike(found: &[[f32; 4]], wanted: &[[f32; 4]], what: &str) {
    for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
        assert!((found - wanted).abs() <= 1e-4 * wanted.abs() + 1e-6, "{what}: {found}, not {wanted}");
    }
}

#[test]
fn a_texture_of_one_colour_is_that_colour() {
    let row = MATERIALS.iter().find(|row| row.entry.name == "principled").unwrap();
    for thin in [false, true] {
        let constants = scattered(thin, Some("none of them"));
        assert!(constants[0].iter().all(|&number| number > 0.0), "{constants:?}");
        assert_alike(&scattered(thin, None), &constants, "all");
        for parameter in row.entry.parameters {
            assert_alike(&scattered(thin, Some(parameter.name)), &constants, parameter.name);
        }
    }
}
