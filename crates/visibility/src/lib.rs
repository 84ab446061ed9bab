//! Hidden-surface removal: what the eye sees at every pixel centre, computed by each of the algorithms that were
//! known before rays were affordable.
//!
//! All of them answer one question, with one signature: which triangle is nearest along the ray through the centre of
//! each pixel of a [`View`]. Those in [`VISIBILITY`] that are `exact` produce the image of [`View::cast`], pixel by
//! pixel, even where triangles touch, intersect, overlap in a cycle or coincide.
//!
//! ```
//! use bilux_accel::TriangleMesh;
//! use bilux_visibility::{View, VisibilityOptions, visibility};
//!
//! let mesh = TriangleMesh::new(
//!     vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
//!     vec![[0, 1, 2]],
//! )?;
//! let view = View::pinhole([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 60.0, 32, 32)?;
//! let seen = visibility("newell", &view, &mesh, &VisibilityOptions::default())?;
//! assert_eq!(seen.ids[16 * 32 + 16], 0);
//! assert_eq!(seen.ids[0], u32::MAX);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Why an order of pieces can be exact
//! Coverage and depth are those of the shared ray test on the original triangles. Pieces never cover a pixel by
//! themselves: a pixel belongs to the piece in whose cell the *hit point* of the original lies. Along one ray the
//! distance to a plane is a monotone function of `t`, rounding included, so the ray visits cells in the order of
//! their hits. Planes have the thickness of the ray test's own error; what falls inside that thickness, and only
//! that, is settled by comparing depths. `docs/adr/0005-visibility.md` has the argument.

mod bsp_back_to_front;
mod bsp_front_to_back;
mod canvas;
mod coverage;
mod newell;
mod painter;
mod partition;
mod piece;
mod polygon;
mod result;
mod schumacker;
mod screen;
mod splitter;
mod view;
mod warnock;
mod z_buffer;

pub use result::{BACKGROUND, VisibilityCounts, VisibilityResult, wrong_pixels};
pub use view::{View, ViewError};

use bilux_accel::Culling;
use bilux_accel::TriangleMesh;
use bilux_math::registry::Entry;

/// Every available algorithm.
pub static VISIBILITY: &[VisibilityEntry] = &[
    painter::ENTRY,
    newell::ENTRY,
    warnock::ENTRY,
    z_buffer::ENTRY,
    bsp_back_to_front::ENTRY,
    bsp_front_to_back::ENTRY,
    schumacker::ENTRY,
];

/// One algorithm.
#[derive(Clone, Copy, Debug)]
pub struct VisibilityEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// True when its image is that of [`View::cast`] for any triangles.
    pub exact: bool,
    /// Runs the algorithm.
    pub run: VisibilityFn,
}

/// Type of the function that runs an algorithm.
pub type VisibilityFn = fn(&View, &TriangleMesh, &VisibilityOptions) -> VisibilityResult;

/// Options of an algorithm. The switches below `culling` change how much work an answer takes, never the answer;
/// algorithms without such a step ignore them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct VisibilityOptions {
    /// Which side of triangles is visible. Part of the question.
    pub culling: Culling,
    /// With [`Culling::Back`], reject back faces by the eye's side of their partition plane (on by default).
    pub cull_by_partition: bool,
    /// Skip subtrees whose projected bound is already covered (on by default).
    pub skip_covered: bool,
}

impl Default for VisibilityOptions {
    fn default() -> VisibilityOptions {
        VisibilityOptions { culling: Culling::None, cull_by_partition: true, skip_covered: true }
    }
}

/// The error when no algorithm has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no visibility algorithm '{0}'")]
pub struct UnknownAlgorithm(pub String);

/// Runs the algorithm of this name.
///
/// # Errors
/// Returns an error when no algorithm has this name.
pub fn visibility(
    name: &str,
    view: &View,
    mesh: &TriangleMesh,
    options: &VisibilityOptions,
) -> Result<VisibilityResult, UnknownAlgorithm> {
    match VISIBILITY.iter().find(|row| row.entry.name == name) {
        Some(row) => Ok((row.run)(view, mesh, options)),
        None => Err(UnknownAlgorithm(name.to_owned())),
    }
}
