//! Distance of points of a dense medium from the surfaces around: a ball of less than this radius is all medium.

use crate::geometry::Geometry;
use crate::geometry::corners::world_corners;
use crate::geometry::placed::Placed;
use crate::materials::Material;
use bilux_accel::registry::Quality;
use bilux_accel::{BuildOptions, Bvh8, TriangleMesh};
use bilux_math::{Aabb, Vec3};
use std::sync::Arc;

/// The triangles around dense media.
pub(super) struct Clearance {
    /// For each object, whether its inside is one; none where there is no tree.
    dense: Vec<bool>,
    tree: Option<Bvh8>,
}

/// A medium is dense if its bounds are wider than this many mean free paths along each axis.
const DENSE: f32 = 8.0;

impl Clearance {
    /// Clearance of all media that are the same everywhere and do not move. Where the triangles around are too many for a tree, no
    /// medium counts as dense.
    pub(super) fn of(geometry: &Geometry, materials: &[Arc<dyn Material>]) -> Clearance {
        let bounds = |placed: &Placed| Some(placed.motion.static_transform()?.bounds(&placed.mesh.bounds()));
        let dense_bounds = |placed: &Placed| {
            let medium = materials[placed.material as usize].medium()?;
            let is_even = medium.scatters() && medium.density.is_none();
            let width = |bounds: &Aabb| bounds.extent().min_element();
            bounds(placed).filter(|bounds| is_even && medium.sigma_t().max_channel() * width(bounds) > DENSE)
        };
        let of_objects: Vec<Option<Aabb>> = geometry.objects().iter().map(dense_bounds).collect();
        let dense: Vec<Aabb> = of_objects.iter().flatten().copied().collect();
        if dense.is_empty() {
            return Clearance { dense: Vec::new(), tree: None };
        }
        let mut corners = Vec::new();
        for placed in geometry.objects() {
            let is_near = |bounds: &Aabb| dense.iter().any(|inside| !inside.intersection(*bounds).is_empty());
            if let (Some(to_world), Some(_)) =
                (placed.motion.static_transform(), bounds(placed).filter(is_near))
            {
                corners.extend(world_corners(&placed.mesh, to_world));
            }
        }
        let options = BuildOptions { quality: Quality::Fast, ..BuildOptions::default() };
        let tree = TriangleMesh::from_corners(corners).ok().and_then(|mesh| Bvh8::new(&mesh, &options).ok());
        let is_known = |bounds: Option<Aabb>| bounds.is_some() && tree.is_some();
        Clearance { dense: of_objects.into_iter().map(is_known).collect(), tree }
    }

    /// Whether the inside of an object is a dense medium.
    #[inline]
    pub(super) fn is_dense(&self, object: u32) -> bool {
        self.dense.get(object as usize).copied().unwrap_or_default()
    }

    /// The distance in metres to the nearest triangle, or `within` where that is less.
    #[inline]
    pub(super) fn at(&self, p: Vec3, within: f32) -> f32 {
        self.tree.as_ref().map_or(within, |tree| tree.clearance(p.to_array(), within))
    }
}
