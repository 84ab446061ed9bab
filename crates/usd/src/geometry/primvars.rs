//! Attributes of surfaces: one for all, or one for each face, vertex or corner.

use crate::layers::value::{Array, Value};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::sync::Arc;

/// Elements that have a value each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    Constant,
    Uniform,
    Vertex,
    /// Of vertices, and linear between them where a surface is smooth.
    Varying,
    FaceVarying,
}

/// Values, and which of them a place has.
#[derive(Clone, Debug)]
pub(crate) struct Primvar {
    pub(crate) values: Arc<Array>,
    pub(crate) indices: Option<Arc<Array>>,
    pub(crate) interpolation: Interpolation,
}

/// The numbers of a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) corner: usize,
    pub(crate) vertex: usize,
    pub(crate) face: usize,
}

impl Place {
    /// Of values that are constant.
    pub(crate) const ONLY: Place = Place { corner: 0, vertex: 0, face: 0 };
}

impl Primvar {
    /// A primvar of a prim, or an attribute that is one by another name.
    pub(crate) fn read(
        stage: &Stage,
        prim: u32,
        name: &str,
        unstated: Interpolation,
        budget: &mut Budget,
    ) -> Result<Option<Primvar>, FormatError> {
        let Some(values) = stage.array(prim, name, budget)? else { return Ok(None) };
        if values.len() == 0 {
            return Ok(None);
        }
        let stated = stage.metadata(prim, name, "interpolation");
        let interpolation = match stated.as_ref().and_then(Value::text).map(|text| &**text) {
            Some("constant") => Interpolation::Constant,
            Some("uniform") => Interpolation::Uniform,
            Some("vertex") => Interpolation::Vertex,
            Some("varying") => Interpolation::Varying,
            Some("faceVarying") => Interpolation::FaceVarying,
            _ => unstated,
        };
        let indices = match name.starts_with("primvars:") {
            true => stage.array(prim, &format!("{name}:indices"), budget)?.filter(|list| list.len() > 0),
            false => None,
        };
        Ok(Some(Primvar { values, indices, interpolation }))
    }

    /// True if all corners of a point have one value.
    pub(crate) fn is_by_point(&self) -> bool {
        matches!(self.interpolation, Interpolation::Constant | Interpolation::Vertex | Interpolation::Varying)
    }

    /// The index of a place's value; `None` if there is none.
    #[inline]
    pub(crate) fn index(&self, place: Place) -> Option<usize> {
        let number = match self.interpolation {
            Interpolation::Constant => 0,
            Interpolation::Uniform => place.face,
            Interpolation::Vertex | Interpolation::Varying => place.vertex,
            Interpolation::FaceVarying => place.corner,
        };
        let index = match &self.indices {
            None => number,
            Some(list) if number < list.len() => list.numbers.at(number) as i64 as usize,
            Some(_) => return None,
        };
        (index < self.values.len()).then_some(index)
    }

    /// The value of a place; zeros if there is none.
    #[inline]
    pub(crate) fn at<const N: usize>(&self, place: Place) -> [f32; N] {
        self.index(place).map_or([0.0; N], |index| self.values.floats::<N>(index))
    }
}
