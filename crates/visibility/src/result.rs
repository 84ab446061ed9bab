//! The answer of an algorithm, and its cost.

/// The id of a pixel in which nothing is visible.
pub const BACKGROUND: u32 = u32::MAX;

/// An image of triangle indices and the work behind it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisibilityResult {
    /// The triangle visible at each pixel centre, row by row from the top; [`BACKGROUND`] where there is none.
    pub ids: Vec<u32>,
    /// The work.
    pub counts: VisibilityCounts,
    /// Seconds spent on a structure that does not depend on the eye's position, and which a static scene therefore
    /// pays for once; 0 for algorithms without one. Included in the time of the whole run.
    pub build_seconds: f64,
}

/// Work done for one image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VisibilityCounts {
    /// Ray tests: one triangle at one pixel centre.
    pub triangle_tests: u64,
    /// Hit points assigned to a side of a split plane, because the triangle reaches both: the outline of pieces.
    pub side_tests: u64,
    /// Comparisons of two depths at a pixel; a z-buffer makes one for each hit.
    pub depth_comparisons: u64,
    /// Comparisons for ordering: of two depths while sorting, of two pieces by their planes and outlines, of the eye
    /// with a plane, of a face with the cluster's other faces.
    pub sort_comparisons: u64,
    /// Polygons cut in two.
    pub splits: u64,
    /// Pieces available for drawing, including those that only reach into the thickness of a plane.
    pub pieces: u64,
    /// Pixels written that were written again later.
    pub overdraw: u64,
    /// Back faces rejected by the eye's side of their partition plane, without a ray test.
    pub culled_back_faces: u64,
    /// Subtrees skipped because their projected bound was covered.
    pub skipped_subtrees: u64,
    /// Windows that the screen was divided into.
    pub windows: u64,
}

/// The number of pixels in which two images differ; images of different sizes differ in every pixel of the larger.
pub fn wrong_pixels(ids: &[u32], reference: &[u32]) -> usize {
    if ids.len() != reference.len() {
        return ids.len().max(reference.len());
    }
    ids.iter().zip(reference).filter(|(a, b)| a != b).count()
}
