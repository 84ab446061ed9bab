//! The layers of a mesh: something for each corner, polygon or control point, by an index or without.

/// Parts of a mesh to which the elements of a layer belong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mapping {
    #[default]
    ByCorner,
    ByPosition,
    ByPolygon,
    AllSame,
    /// To edges, or to something unknown.
    Other,
}

/// A layer, which may be empty.
pub struct Layer<T> {
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

impl<T: Copy> Layer<T> {
    /// A layer with shared values.
    pub fn indexed(values: Vec<T>, indices: Vec<i32>, mapping: Mapping) -> Layer<T> {
        Layer { values, indices, mapping }
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    pub fn mapping(&self) -> Mapping {
        self.mapping
    }

    pub fn values(&self) -> &[T] {
        &self.values
    }

    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Value at a corner of a polygon at a control point.
    #[inline]
    pub fn at(&self, corner: usize, polygon: usize, position: usize) -> Option<T> {
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
