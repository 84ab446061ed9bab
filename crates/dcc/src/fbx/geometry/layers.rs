//! Layers as the file has them: lists of values, and what they belong to.

use crate::fbx::tree::{Node, Number, Value};
use bilux_import::FormatError;
use bilux_import::bytes::text::quoted;
use bilux_import::meshes::polygon_mesh::{Layer, Mapping, Workshop};

/// Mapping of a layer's elements to what they belong to.
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

/// Corners and control points, to which the elements of layers belong.
#[derive(Clone, Copy)]
pub(super) struct Surface<'s> {
    /// The control point of each corner.
    pub(super) corners: &'s [u32],
    /// The number of control points.
    pub(super) positions: usize,
}

/// Reads a layer: its values are in a list of one name, their indices, if any, in another.
pub(super) fn read<T: Copy, N: Number, const WIDTH: usize>(
    layer: Node,
    list: &str,
    index_list: &str,
    value: impl Fn([N; WIDTH]) -> T,
    surface: Surface,
    workshop: &mut Workshop,
) -> Result<Layer<T>, FormatError> {
    let Some(values) = layer.child(list) else { return Ok(Layer::default()) };
    let reference = layer.child_value("ReferenceInformationType").and_then(Value::text);
    let is_direct = reference == Some(b"Direct");
    let index_list = layer.child(index_list).filter(|_| !is_direct);
    let mapping = mapping_of(layer).unwrap_or(Mapping::ByCorner);
    if mapping == Mapping::ByCorner && index_list.is_none() {
        return shared(values, value, surface, workshop);
    }
    let count = values.most_numbers()? / WIDTH;
    workshop.budget.take_bytes((count * size_of::<T>()) as u64, layer.file())?;
    let mut all = Vec::with_capacity(count);
    values.each_number(|some: &[N]| all.extend(some.as_chunks::<WIDTH>().0.iter().map(|&n| value(n))))?;
    let indices = match index_list {
        Some(indices) => indices.numbers(workshop.budget)?,
        None => Vec::new(),
    };
    if mapping == Mapping::Other && list != "Smoothing" {
        let name = quoted(layer.name());
        let what =
            format!("{name} belongs to something other than corners, vertices and polygons, and is left out");
        workshop.diagnostics.note(&what, || layer.at());
        return Ok(Layer::default());
    }
    Ok(Layer::indexed(all, indices, mapping))
}

/// Reads values of corners, of which most are equal to the one before at the same control point: these are held once.
fn shared<T: Copy, N: Number, const WIDTH: usize>(
    values: Node,
    value: impl Fn([N; WIDTH]) -> T,
    surface: Surface,
    workshop: &mut Workshop,
) -> Result<Layer<T>, FormatError> {
    /// No value.
    const NONE: u32 = u32::MAX;
    let count = (values.most_numbers()? / WIDTH).min(surface.corners.len());
    // Values grow by doubling; the last one at each control point is needed only here.
    let needed = count * (2 * size_of::<T>() + 4) + surface.positions * (4 + size_of::<[N; WIDTH]>());
    workshop.budget.take_bytes(needed as u64, values.file())?;
    let (mut all, mut indices) = (Vec::new(), Vec::with_capacity(count));
    let mut last = vec![(NONE, [N::of(0.0); WIDTH]); surface.positions];
    values.each_number(|some: &[N]| {
        for &numbers in some.as_chunks::<WIDTH>().0 {
            let Some(&position) = surface.corners.get(indices.len()) else { return };
            let Some((index, known)) = last.get_mut(position as usize) else { return };
            if *index == NONE || !numbers.iter().zip(&*known).all(|(a, b)| a.is(*b)) {
                (*index, *known) = (all.len() as u32, numbers);
                all.push(value(numbers));
            }
            indices.push(*index as i32);
        }
    })?;
    all.shrink_to_fit();
    let held = size_of_val(&all[..]) + size_of_val(&indices[..]);
    workshop.budget.release(needed.saturating_sub(held) as u64);
    Ok(Layer::indexed(all, indices, Mapping::ByCorner))
}
