//! From a document to a layer.

use super::nodes::Nodes;
use crate::layers::layer::{Layer, PRIM_BYTES, PrimSpec, Specifier};
use crate::layers::value::{Text, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::text::whole_file;
use bilux_import::bytes::xml::Xml;
use std::path::PathBuf;
use std::sync::Arc;

/// Last byte at which the outermost element of a document may begin, after comments.
const HEAD: usize = 4096;

/// True for documents of MaterialX.
pub(crate) fn is_document(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let start = head.iter().position(|byte| !byte.is_ascii_whitespace() && *byte < 0x80);
    start.is_some_and(|start| head[start] == b'<') && head.windows(10).any(|window| window == b"<materialx")
}

/// Reads a document as a layer.
pub(crate) fn read(
    bytes: &[u8],
    name: &Arc<str>,
    folder: Option<PathBuf>,
    budget: &mut Budget,
) -> Result<Layer<'static>, FormatError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|_| FormatError::malformed("this document is not in UTF-8", whole_file(name)))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let spent = budget.spent();
    let xml = Xml::parse(text, name, budget)?;
    let parsed = budget.spent() - spent;
    let layer = Layer { name: name.clone(), folder, prims: vec![PrimSpec::default()], ..Layer::default() };
    let mut nodes = Nodes::new(layer, &xml);
    let all = nodes.prim(0, "MaterialX", "", xml.root(), budget)?;
    let materials = nodes.prim(all, "Materials", "", xml.root(), budget)?;
    nodes.layer.prims[0].fields.0.push(("defaultPrim".into(), Value::Text("MaterialX".into())));
    for element in xml.root().children().filter(|element| element.is_element()) {
        let is_material = matches!(element.tag_name().name(), "surfacematerial" | "material")
            || element.attribute("type") == Some("material");
        if let Some(name) = element.attribute("name").filter(|_| is_material) {
            let path = format!("/MaterialX/Materials/{name}");
            let prim = nodes.prim(materials, name, "Material", element, budget)?;
            nodes.material(prim, &path, element, budget)?;
        }
    }
    let layer = nodes.layer;
    budget.release(parsed);
    Ok(layer)
}

impl<'d> Nodes<'d> {
    /// Adds a prim for an element.
    pub(super) fn prim(
        &mut self,
        parent: u32,
        name: &str,
        kind: &str,
        element: roxmltree::Node,
        budget: &mut Budget,
    ) -> Result<u32, FormatError> {
        budget.take_bytes(PRIM_BYTES + name.len() as u64, &self.layer.name)?;
        let prim = self.layer.child(parent, Text::from(name));
        let at = self.xml.at(element);
        let spec = &mut self.layer.prims[prim as usize];
        (spec.specifier, spec.type_name, spec.at) = (Specifier::Def, kind.into(), (at.line, at.column));
        Ok(prim)
    }
}
