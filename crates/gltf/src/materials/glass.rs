//! Transmissive materials without a thickness: thin walls in glTF, solid here if the mesh is closed.

use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use bilux_import::{FormatError, Glass};
use bilux_scene::Mesh;

/// True if a mesh is of glass that states no thickness and that is to be solid.
pub(crate) fn is_solid<'d>(
    material: Option<JsonNode<'d>>,
    mesh: &Mesh,
    wanted: Glass,
    data: &mut DataReader<'d, '_>,
) -> Result<bool, FormatError> {
    let Some(index) = material else { return Ok(false) };
    let node = data.document.named("materials", index)?;
    let Some(transmission) = node.extension("KHR_materials_transmission") else { return Ok(false) };
    let weight = transmission.number("transmissionFactor")?.unwrap_or(0.0);
    let volume = node.extension("KHR_materials_volume");
    let thickness = volume.map_or(Ok(None), |volume| volume.number("thicknessFactor"))?.unwrap_or(0.0);
    if weight <= 0.0 || thickness > 0.0 {
        return Ok(false);
    }
    match wanted {
        Glass::Solid => Ok(true),
        Glass::Thin => Ok(false),
        Glass::Auto => {
            let edges = (mesh.triangles.len() * 3 * 24 + mesh.positions.len() * 24) as u64;
            data.take_bytes(edges)?;
            let is_closed = mesh.is_closed();
            data.budget.release(edges);
            if is_closed {
                let what = "a transmissive material without a thickness, on a closed mesh, is shown as solid glass; \
                            --glass thin shows it as a thin wall";
                data.note(what, || node.at());
            } else {
                let what = "a transmissive material without a thickness, on an open mesh, is shown as a thin wall; \
                            --glass solid shows it as solid glass";
                data.diagnostics.remark(what, || node.at());
            }
            Ok(is_closed)
        }
    }
}
