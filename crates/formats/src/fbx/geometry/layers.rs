//! Layers as the file has them: lists of values, and what they belong to.

use crate::FormatError;
use crate::fbx::tree::{Node, Number, Value};
use crate::polygon_mesh::{Layer, Mapping, Workshop};
use crate::text::quoted;

/// What the elements of a layer belong to.
fn mapping_of(layer: Node) -> Option<Mapping> {
    Some(match layer.child_value("MappingInformationType")?.text()? {
        b"ByPolygonVertex" => Mapping::ByCorner,
        b"ByVertice" | b"ByVertex" | b"ByControlPoint" => Mapping::ByPosition,
        b"ByPolygon" => Mapping::ByPolygon,
        b"AllSame" => Mapping::AllSame,
        _ => Mapping::Other,
    })
}

/// The layers of a kind, in the order of their numbers.
pub(in crate::fbx) fn nodes<'d>(mesh: Node<'d>, element: &str) -> Vec<Node<'d>> {
    let mut layers: Vec<Node> = mesh.children_named(element).collect();
    layers.sort_by_key(|layer| layer.value(0).and_then(Value::integer).unwrap_or(0));
    layers
}

/// Reads a layer: its values are in a list of one name, their indices, if any, in another.
pub(super) fn read<T: Copy, N: Number, const WIDTH: usize>(
    layer: Node,
    list: &str,
    index_list: &str,
    value: impl Fn([N; WIDTH]) -> T,
    workshop: &mut Workshop,
) -> Result<Layer<T>, FormatError> {
    let Some(values) = layer.child(list) else { return Ok(Layer::default()) };
    let numbers: Vec<N> = values.numbers(workshop.budget)?;
    let count = numbers.len() / WIDTH;
    workshop.budget.take_bytes((count * size_of::<T>()) as u64, layer.file())?;
    let values: Vec<T> = numbers.as_chunks::<WIDTH>().0.iter().map(|&numbers| value(numbers)).collect();
    workshop.budget.release(size_of_val(&numbers[..]) as u64);
    drop(numbers);
    let reference = layer.child_value("ReferenceInformationType").and_then(Value::text);
    let is_direct = reference == Some(b"Direct");
    let indices = match layer.child(index_list).filter(|_| !is_direct) {
        Some(indices) => indices.numbers(workshop.budget)?,
        None => Vec::new(),
    };
    let mapping = mapping_of(layer).unwrap_or(Mapping::ByCorner);
    if mapping == Mapping::Other && list != "Smoothing" {
        let name = quoted(layer.name());
        let what =
            format!("{name} belongs to something other than corners, vertices and polygons, and is left out");
        workshop.oddities.note(&what, || layer.at());
        return Ok(Layer::default());
    }
    Ok(Layer::indexed(values, indices, mapping))
}
