//! Materials.

use super::json::Node;
use super::reader::Gltf;
use crate::FormatError;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// A material as primitives use it.
#[derive(Clone, Copy)]
pub(super) struct UsedMaterial {
    /// Its index in the scene.
    pub(super) index: usize,
    /// Which texture coordinates it is looked up by.
    pub(super) uv_set: usize,
}

impl<'d> Gltf<'d, '_, '_> {
    /// The material that `index` names, or the default one.
    pub(super) fn material(&mut self, index: Option<Node<'d>>) -> Result<UsedMaterial, FormatError> {
        let key = index.map(|index| index.as_count()).transpose()?;
        if let Some(material) = self.materials.get(&key) {
            return Ok(*material);
        }
        let spec = match index {
            Some(index) => spec(self.document.named("materials", index)?)?,
            None => Spec::new("default", "diffuse"),
        };
        let used = UsedMaterial { index: self.scene.add_material(spec), uv_set: 0 };
        self.materials.insert(key, used);
        Ok(used)
    }
}

fn spec(node: Node) -> Result<Spec, FormatError> {
    let base = match node.get("pbrMetallicRoughness") {
        Some(pbr) => pbr.numbers::<4>("baseColorFactor")?,
        None => None,
    };
    let [r, g, b, _] = base.unwrap_or([1.0; 4]).map(|c| c.clamp(0.0, 1.0) as f32);
    let emission = node.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]).map(|c| c.max(0.0) as f32);
    let mut spec = Spec::new(node.name(), "diffuse").with("reflectance", Rgb::new(r, g, b));
    if emission != [0.0; 3] {
        spec.parameters.set("emission", Rgb::from_array(emission));
    }
    spec.span = node.at();
    Ok(spec)
}
