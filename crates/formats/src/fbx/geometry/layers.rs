//! The layers of a mesh: something for each corner, polygon or control point, by an index or without.

use super::workshop::Workshop;
use crate::FormatError;
use crate::fbx::tree::{Node, Number, Value};
use crate::text::quoted;

/// What the elements of a layer belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mapping {
    #[default]
    ByCorner,
    ByPosition,
    ByPolygon,
    AllSame,
    /// To edges, or to something unknown.
    Other,
}

impl Mapping {
    fn of(layer: Node) -> Option<Mapping> {
        Some(match layer.child_value("MappingInformationType")?.text()? {
            b"ByPolygonVertex" => Mapping::ByCorner,
            b"ByVertice" | b"ByVertex" | b"ByControlPoint" => Mapping::ByPosition,
            b"ByPolygon" => Mapping::ByPolygon,
            b"AllSame" => Mapping::AllSame,
            _ => Mapping::Other,
        })
    }
}

/// A layer, which may be empty.
pub(in crate::fbx) struct Layer<T> {
    values: Vec<T>,
    /// The index of each element's value, if values are shared.
    indices: Vec<i32>,
    mapping: Mapping,
}

impl<T> Default for Layer<T> {
    fn default() -> Layer<T> {
        Layer { values: Vec::new(), indices: Vec::new(), mapping: Mapping::default() }
    }
}

/// The layers of a kind, in the order of their numbers.
pub(in crate::fbx) fn nodes<'d>(mesh: Node<'d>, element: &str) -> Vec<Node<'d>> {
    let mut layers: Vec<Node> = mesh.children_named(element).collect();
    layers.sort_by_key(|layer| layer.value(0).and_then(Value::integer).unwrap_or(0));
    layers
}

impl<T: Copy> Layer<T> {
    /// A layer with shared values.
    pub(super) fn indexed(values: Vec<T>, indices: Vec<i32>, mapping: Mapping) -> Layer<T> {
        Layer { values, indices, mapping }
    }

    /// Reads a layer: its values are in a list of one name, their indices, if any, in another.
    pub(super) fn read<N: Number, const WIDTH: usize>(
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
        let mapping = Mapping::of(layer).unwrap_or(Mapping::ByCorner);
        if mapping == Mapping::Other && list != "Smoothing" {
            let name = quoted(layer.name());
            let what = format!(
                "{name} belongs to something other than corners, vertices and polygons, and is left out"
            );
            workshop.oddities.note(&what, || layer.at());
            return Ok(Layer::default());
        }
        Ok(Layer { values, indices, mapping })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    pub(super) fn mapping(&self) -> Mapping {
        self.mapping
    }

    pub(super) fn values(&self) -> &[T] {
        &self.values
    }

    pub(super) fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// What a corner of a polygon at a control point has.
    #[inline]
    pub(super) fn at(&self, corner: usize, polygon: usize, position: usize) -> Option<T> {
        let element = match self.mapping {
            Mapping::ByCorner => corner,
            Mapping::ByPosition => position,
            Mapping::ByPolygon => polygon,
            Mapping::AllSame => 0,
            Mapping::Other => return None,
        };
        let index = match &self.indices[..] {
            [] => element,
            indices => usize::try_from(*indices.get(element)?).ok()?,
        };
        self.values.get(index).copied()
    }
}
