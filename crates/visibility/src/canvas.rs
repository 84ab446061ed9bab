//! The image in progress: the only place where triangles are written to pixels.

use crate::VisibilityOptions;
use crate::result::{BACKGROUND, VisibilityCounts, VisibilityResult};
use crate::screen::Rect;
use crate::view::View;
use bilux_accel::Culling;
use bilux_accel::TriangleMesh;
use bilux_accel::triangle::PreparedRay;
use bilux_math::DVec3;

/// Marks a pixel that has no owner yet.
pub(crate) const NO_OWNER: u32 = u32::MAX;

/// The contents of each pixel, and the work so far.
#[derive(Debug)]
pub(crate) struct Canvas<'a> {
    pub(crate) view: &'a View,
    pub(crate) counts: VisibilityCounts,
    triangles: &'a [[[f32; 3]; 3]],
    culling: Culling,
    rays: Vec<Option<PreparedRay>>,
    ids: Vec<u32>,
    t: Vec<f32>,
    owner: Vec<u32>,
}

/// A triangle found at a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelHit {
    pub(crate) pixel: usize,
    pub(crate) triangle: u32,
    pub(crate) t: f32,
}

impl<'a> Canvas<'a> {
    pub(crate) fn new(view: &'a View, mesh: &'a TriangleMesh, options: &VisibilityOptions) -> Canvas<'a> {
        let rays = view.prepared_rays();
        let pixels = rays.len();
        Canvas {
            view,
            counts: VisibilityCounts::default(),
            triangles: mesh.triangles(),
            culling: options.culling,
            rays,
            ids: vec![BACKGROUND; pixels],
            t: vec![f32::INFINITY; pixels],
            owner: vec![NO_OWNER; pixels],
        }
    }

    /// Runs the ray test on a triangle at one pixel.
    #[inline]
    pub(crate) fn hit(&mut self, pixel: usize, triangle: u32) -> Option<PixelHit> {
        let ray = self.rays[pixel].as_ref()?;
        self.counts.triangle_tests += 1;
        let crossing = ray.cross(&self.triangles[triangle as usize])?;
        let counts = crossing.t >= ray.ray.t_min && !(crossing.back && self.culling == Culling::Back);
        counts.then_some(PixelHit { pixel, triangle, t: crossing.t })
    }

    /// Calls `act` for each pixel of a rectangle.
    #[inline]
    pub(crate) fn each_pixel(&mut self, rect: Rect, mut act: impl FnMut(&mut Self, usize)) {
        let width = self.view.width();
        for y in rect.y.0..rect.y.1 {
            for x in rect.x.0..rect.x.1 {
                act(self, y * width + x);
            }
        }
    }

    /// The owner that wrote the pixel last, or [`NO_OWNER`].
    #[inline]
    pub(crate) fn owner(&self, pixel: usize) -> u32 {
        self.owner[pixel]
    }

    /// Writes a pixel, whatever it held.
    #[inline]
    pub(crate) fn put(&mut self, hit: PixelHit, owner: u32) {
        let PixelHit { pixel, triangle, t } = hit;
        self.counts.overdraw += u64::from(self.owner[pixel] != NO_OWNER);
        self.ids[pixel] = triangle;
        self.t[pixel] = t;
        self.owner[pixel] = owner;
    }

    /// Writes a pixel if this hit beats the existing one by depth, ties to the lowest triangle.
    #[inline]
    pub(crate) fn put_if_nearer(&mut self, hit: PixelHit, owner: u32) {
        self.counts.depth_comparisons += 1;
        let (t, id) = (self.t[hit.pixel], self.ids[hit.pixel]);
        if self.owner[hit.pixel] == NO_OWNER || hit.t < t || (hit.t == t && hit.triangle < id) {
            self.put(hit, owner);
        }
    }

    /// The direction through a pixel centre.
    #[inline]
    pub(crate) fn direction(&self, pixel: usize) -> DVec3 {
        self.view.direction(pixel)
    }

    /// Writes a pixel if it has another owner, or if this hit is nearer.
    #[inline]
    pub(crate) fn put_first_or_nearer(&mut self, hit: PixelHit, owner: u32) {
        if self.owner[hit.pixel] == owner {
            self.put_if_nearer(hit, owner);
        } else {
            self.put(hit, owner);
        }
    }

    /// Writes a triangle that is known to be visible in a whole rectangle, without the ray test.
    pub(crate) fn fill(&mut self, rect: Rect, triangle: u32) {
        self.each_pixel(rect, |canvas, pixel| {
            if canvas.rays[pixel].is_some() {
                canvas.put(PixelHit { pixel, triangle, t: f32::INFINITY }, triangle);
            }
        });
    }

    pub(crate) fn finish(self, build_seconds: f64) -> VisibilityResult {
        VisibilityResult { ids: self.ids, counts: self.counts, build_seconds }
    }
}
