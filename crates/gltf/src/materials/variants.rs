//! `KHR_materials_variants`: alternative materials for the same meshes.

use crate::document::json::JsonNode;
use bilux_import::FormatError;
use bilux_import::input::choice::named_or_numbered;

const NAME: &str = "KHR_materials_variants";

/// The variants of a file.
pub(crate) struct Variants {
    pub(crate) names: Vec<String>,
    /// The index of the one that is shown, if one is.
    shown: Option<usize>,
}

impl Variants {
    /// All of a document, of which the one that `wanted` names is shown.
    pub(crate) fn read(root: JsonNode, wanted: Option<&str>) -> Result<Variants, FormatError> {
        let list = root.extension(NAME).map_or(Ok(Vec::new()), |extension| extension.list("variants"))?;
        let names: Vec<String> = list.iter().map(|variant| variant.name().to_owned()).collect();
        let shown = wanted.map(|wanted| named_or_numbered("variant", wanted, &names, &root.at()));
        Ok(Variants { shown: shown.transpose()?, names })
    }

    /// The material of a primitive in the variant that is shown, if the variant maps it.
    pub(crate) fn material_of<'d>(
        &self,
        primitive: JsonNode<'d>,
    ) -> Result<Option<JsonNode<'d>>, FormatError> {
        let (Some(shown), Some(extension)) = (self.shown, primitive.extension(NAME)) else {
            return Ok(None);
        };
        for mapping in extension.list("mappings")? {
            for variant in mapping.list("variants")? {
                if variant.as_count()? == shown {
                    return mapping.need("material").map(Some);
                }
            }
        }
        Ok(None)
    }
}
