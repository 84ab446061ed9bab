//! The supported extensions.

use crate::document::json::JsonNode;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_scene::error::nearest_name;

/// Extensions that are read, either fully or with a warning about what is not.
const KNOWN: &[&str] = &[
    "EXT_lights_area",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    #[cfg(feature = "draco")]
    crate::geometry::draco::NAME,
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_scatter",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    #[cfg(feature = "ktx2")]
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Extensions that do not affect the rendered image.
const WITHOUT_VISIBLE_EFFECT: &[&str] = &["KHR_xmp", "KHR_xmp_json_ld"];

/// Refuses a file that requires an unsupported extension, and warns about all others that are not supported.
pub(crate) fn check(root: JsonNode, diagnostics: &mut Diagnostics) -> Result<(), FormatError> {
    for name in root.list("extensionsRequired")? {
        let text = name.as_text()?;
        if !KNOWN.contains(&text) && !WITHOUT_VISIBLE_EFFECT.contains(&text) {
            let known: Vec<String> = KNOWN.iter().map(|&name| name.to_owned()).collect();
            let meant = nearest_name(text, &known).filter(|n| n.len().abs_diff(text.len()) < 3);
            let meant = meant.map_or_else(String::new, |name| format!(" (did you mean {name}?)"));
            let message = format!(
                "this file requires the extension {text}, which is not supported{meant}: export the file without it"
            );
            return Err(name.error(message));
        }
    }
    note_unknown(root, diagnostics);
    Ok(())
}

/// Looks for extensions at every place where they are used. The parser limits the nesting of the JSON.
fn note_unknown(node: JsonNode, diagnostics: &mut Diagnostics) {
    for (key, value) in node.entries() {
        if key == "extras" {
            continue;
        }
        if key == "extensions" {
            for (name, used) in value.entries() {
                if !KNOWN.contains(&name) && !WITHOUT_VISIBLE_EFFECT.contains(&name) {
                    let what = format!("the extension {name} is not supported and is ignored");
                    diagnostics.note(&what, || used.at());
                }
            }
        }
        note_unknown(value, diagnostics);
        value.children().for_each(|item| note_unknown(item, diagnostics));
    }
}
