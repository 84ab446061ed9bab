//! `KHR_materials_variants`: alternative materials for the same meshes.

use super::animation::named_or_numbered;
use super::json::JsonNode;
use super::reader::Gltf;
use crate::FormatError;

const NAME: &str = "KHR_materials_variants";

impl<'d> Gltf<'d, '_, '_> {
    /// Reads the variants of the file, and selects the one that the options name.
    pub(super) fn variants(&mut self) -> Result<(), FormatError> {
        let root = self.document.root;
        let list = root.extension(NAME).map_or(Ok(Vec::new()), |extension| extension.list("variants"))?;
        let names: Vec<String> = list.iter().map(|variant| variant.name().to_owned()).collect();
        if let Some(wanted) = &self.reading.options.variant {
            self.variant = Some(named_or_numbered("variant", wanted, &names, &root.at())?);
        }
        self.scene.inventory.variants = names;
        Ok(())
    }

    /// The material of a primitive in the selected variant, if the variant maps it.
    pub(super) fn variant_of(&self, primitive: JsonNode<'d>) -> Result<Option<JsonNode<'d>>, FormatError> {
        let (Some(wanted), Some(extension)) = (self.variant, primitive.extension(NAME)) else {
            return Ok(None);
        };
        for mapping in extension.list("mappings")? {
            for variant in mapping.list("variants")? {
                if variant.as_count()? == wanted {
                    return mapping.need("material").map(Some);
                }
            }
        }
        Ok(None)
    }
}
