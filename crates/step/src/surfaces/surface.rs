//! Interface of all surfaces.

use bilux_math::{DVec2, DVec3};

/// A line of parameters that is a single point, as at the tip of a cone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pole {
    /// The parameter that varies along the line: 0 for u, 1 for v.
    pub(crate) along: usize,
    /// The other parameter.
    pub(crate) at: f64,
    pub(crate) point: DVec3,
}

/// A surface in space with two parameters.
pub(crate) trait Surface: Send + Sync {
    fn point(&self, uv: DVec2) -> DVec3;

    /// The derivatives by u and by v.
    fn derivatives(&self, uv: DVec2) -> [DVec3; 2];

    /// The parameters of the surface's point nearest to a point; `near` are those of a neighbour.
    fn parameters(&self, p: DVec3, near: Option<DVec2>) -> DVec2;

    /// The bytes that it takes.
    fn size(&self) -> usize {
        256
    }

    /// The periods of the parameters of closed surfaces.
    fn periods(&self) -> [Option<f64>; 2] {
        [None; 2]
    }

    /// The first and the last of each parameter, which may be infinite.
    fn domain(&self) -> [[f64; 2]; 2];

    fn poles(&self) -> Vec<Pole> {
        Vec::new()
    }

    /// True if all of its normals are the same.
    fn is_plane(&self) -> bool {
        false
    }

    /// The centre and the radius of a sphere.
    fn sphere(&self) -> Option<(DVec3, f64)> {
        None
    }

    /// The unit normal on the side where u turns to v counter-clockwise; zero where there is none.
    fn normal(&self, uv: DVec2) -> DVec3 {
        let [along_u, along_v] = self.derivatives(uv);
        let (u, v) = (along_u.try_normalize(), along_v.try_normalize());
        match (u, v) {
            (Some(u), Some(v)) => u.cross(v).try_normalize().unwrap_or(DVec3::ZERO),
            _ => DVec3::ZERO,
        }
    }
}

/// Derivatives by differences, with a step that suits the size of a domain.
pub(super) fn differences(surface: &dyn Surface, uv: DVec2, step: DVec2) -> [DVec3; 2] {
    let domain = surface.domain();
    let periods = surface.periods();
    [0, 1].map(|axis| {
        let mut shift = DVec2::ZERO;
        shift[axis] = step[axis];
        let (mut low, mut high) = (uv - shift, uv + shift);
        if periods[axis].is_none() {
            low[axis] = low[axis].max(domain[axis][0]);
            high[axis] = high[axis].min(domain[axis][1]);
        }
        let width = high[axis] - low[axis];
        if width > 0.0 { (surface.point(high) - surface.point(low)) / width } else { DVec3::ZERO }
    })
}
