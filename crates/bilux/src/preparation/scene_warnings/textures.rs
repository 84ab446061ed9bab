//! Textures with numbers that their parameter cannot take, such as colours from 0 to 255.

use bilux_math::registry::ParameterKind;
use bilux_scene::materials::MATERIALS;
use bilux_scene::texture::{Image, Texels};
use bilux_scene::{SceneBuilder, Spec, Value, Warning};

/// Said of each parameter of a material whose texture goes beyond the range that a number in its place may have.
pub(super) fn beyond_range(scene: &SceneBuilder) -> Vec<Warning> {
    scene.materials.iter().flat_map(|material| of_material(material, scene)).collect()
}

fn of_material<'s>(material: &'s Spec, scene: &'s SceneBuilder) -> impl Iterator<Item = Warning> + 's {
    let row = MATERIALS.iter().find(|row| row.entry.name == material.kind);
    material.parameters.0.iter().filter_map(move |(key, value, at)| {
        let Value::Texture(index) = value else { return None };
        let texture = scene.textures.get(*index)?;
        let parameter = row?.entry.parameters.iter().find(|parameter| parameter.name == key)?;
        let (ParameterKind::ColourTexture { min, max } | ParameterKind::NumberTexture { min, max }) =
            parameter.kind
        else {
            return None;
        };
        let beyond = extremes(&texture.image).into_iter().find(|x| f64::from(*x) < min || f64::from(*x) > max);
        beyond.map(|extreme| Warning {
            message: format!(
                "the texture '{}' has {extreme} in it, but {key} of '{}' is from {min} to {max}: colours as a screen shows them, \
                 from 0 to 255, are bytes (uint8); others are fractions",
                texture.name, material.name
            ),
            at: at.clone(),
        })
    })
}

/// The least and the largest number of an image whose texels are not bytes, which cannot be out of range.
fn extremes(image: &Image) -> Vec<f32> {
    let Texels::Floats { colours, .. } = &image.texels else { return Vec::new() };
    let all = || colours.iter().flat_map(|colour| colour.to_array());
    vec![all().fold(f32::INFINITY, f32::min), all().fold(f32::NEG_INFINITY, f32::max)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;
    use bilux_scene::Texture;
    use std::sync::Arc;

    #[test]
    fn numbers_beyond_the_range_of_a_parameter_are_said() {
        let warnings = |texels: Texels, key: &str| {
            let mut scene = SceneBuilder::default();
            let image = Image { width: 2, height: 1, texels };
            scene.textures.push(Arc::new(Texture::of("paint", Arc::new(image), false)));
            let material = Spec::new("wall", "principled").with(key, Value::Texture(0));
            scene.add_material(material);
            beyond_range(&scene).iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
        };
        let floats =
            |a: f32, b: f32| Texels::Floats { colours: vec![Rgb::grey(a), Rgb::grey(b)], alpha: Vec::new() };
        assert_eq!(warnings(floats(0.0, 1.0), "base_color"), "");
        assert_eq!(warnings(Texels::Bytes(vec![[255; 4], [0; 4]]), "base_color"), "");
        assert_eq!(warnings(floats(0.0, 80.0), "emission"), "", "light may be as bright as it likes");
        for key in ["base_color", "base_metalness"] {
            assert!(warnings(floats(0.25, 255.0), key).contains("'paint' has 255 in it"), "{key}");
            assert!(warnings(floats(-0.5, 0.5), key).contains("'paint' has -0.5 in it"), "{key}");
        }
    }
}
