//! Subdivision of a mesh, as the file states it.

use crate::layers::value::Array;
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::subdivision::Linear;
use std::sync::Arc;

/// Scheme by which a mesh is subdivided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// Polygons.
    None,
    CatmullClark,
    Loop,
    Bilinear,
}

/// A scheme, and where it stays sharp.
#[derive(Clone, Debug)]
pub(crate) struct Subdivision {
    pub(crate) scheme: Scheme,
    /// The file says so itself: exporters of polygons with normals forget to.
    pub(crate) is_stated: bool,
    /// Vertices of creases, those of one crease after those of another.
    pub(crate) crease_indices: Option<Arc<Array>>,
    /// Vertices in each crease.
    pub(crate) crease_lengths: Option<Arc<Array>>,
    /// One for each crease, or for each of its edges; 10 and more are as sharp as an edge can be.
    pub(crate) crease_sharpnesses: Option<Arc<Array>>,
    pub(crate) corner_indices: Option<Arc<Array>>,
    pub(crate) corner_sharpnesses: Option<Arc<Array>>,
    /// Places where values of corners are linear.
    pub(crate) linear: Linear,
    /// Corners of the border are rounded.
    pub(crate) rounds_corners: bool,
}

impl Scheme {
    /// The scheme by which the surface is refined, if it is.
    pub(crate) fn refined(self) -> Option<bilux_import::geometry::subdivision::Scheme> {
        match self {
            Scheme::None | Scheme::Bilinear => None,
            Scheme::CatmullClark => Some(bilux_import::geometry::subdivision::Scheme::CatmullClark),
            Scheme::Loop => Some(bilux_import::geometry::subdivision::Scheme::Loop),
        }
    }
}

impl Subdivision {
    pub(crate) fn read(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Subdivision, FormatError> {
        let stated = stage.text(prim, "subdivisionScheme", budget)?;
        let scheme = match stated.as_deref() {
            Some("none") => Scheme::None,
            Some("loop") => Scheme::Loop,
            Some("bilinear") => Scheme::Bilinear,
            _ => Scheme::CatmullClark,
        };
        let border = stage.text(prim, "interpolateBoundary", budget)?;
        let linear = match stage.text(prim, "faceVaryingLinearInterpolation", budget)?.as_deref() {
            Some("none") => Linear::None,
            Some("cornersOnly") => Linear::Corners,
            Some("cornersPlus2") => Linear::Darts,
            Some("boundaries") => Linear::Borders,
            Some("all") => Linear::All,
            _ => Linear::Junctions,
        };
        let mut list = |name: &str| -> Result<Option<Arc<Array>>, FormatError> {
            Ok(stage.array(prim, name, budget)?.filter(|list| list.len() > 0))
        };
        Ok(Subdivision {
            scheme,
            is_stated: stated.is_some(),
            crease_indices: list("creaseIndices")?,
            crease_lengths: list("creaseLengths")?,
            crease_sharpnesses: list("creaseSharpnesses")?,
            corner_indices: list("cornerIndices")?,
            corner_sharpnesses: list("cornerSharpnesses")?,
            linear,
            rounds_corners: border.as_deref() == Some("edgeOnly"),
        })
    }

    /// True if the limit surface is smooth.
    pub(crate) fn is_smooth(&self) -> bool {
        matches!(self.scheme, Scheme::CatmullClark | Scheme::Loop)
    }

    /// True if some edges or corners are sharper than others.
    pub(crate) fn has_creases(&self) -> bool {
        let creases = self.crease_indices.is_some() && self.crease_lengths.is_some();
        creases && self.crease_sharpnesses.is_some()
            || self.corner_indices.is_some() && self.corner_sharpnesses.is_some()
    }
}
