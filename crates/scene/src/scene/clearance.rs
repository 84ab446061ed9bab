//! How far points of a dense medium are from the surfaces around: a ball of less than this radius is all medium.

use super::enclosure::Enclosure;
use crate::corners::world_corners;
use crate::geometry::Geometry;
use crate::materials::Material;
use crate::placed::Placed;
use bilux_accel::registry::Quality;
use bilux_accel::{BuildOptions, Bvh8, TriangleMesh};
use bilux_math::Vec3;
use std::sync::Arc;

/// The triangles around dense media.
pub(super) struct Clearance(Option<Bvh8>);

/// A medium is dense if its bounds are wider than this many mean free paths.
const DENSE: f32 = 20.0;

impl Clearance {
    /// That of all media whose boundary is known.. Where the triangles around are too many for a tree, none of them counts as
    /// dense.
    pub(super) fn of(
        geometry: &Geometry,
        materials: &[Arc<dyn Material>],
        enclosures: &mut [Option<Enclosure>],
    ) -> Clearance {
        let objects = geometry.objects();
        let is_dense = |enclosure: &Enclosure, placed: &Placed| {
            let medium = materials[placed.material as usize].medium();
            let width = enclosure.bounds.extent().length();
            medium.is_some_and(|medium| {
                medium.density.is_none() && medium.sigma_t().max_channel() * width > DENSE
            })
        };
        let all = enclosures.iter_mut().zip(objects);
        let mut dense: Vec<&mut Enclosure> =
            all.filter_map(|(it, placed)| it.as_mut().filter(|it| is_dense(it, placed))).collect();
        if dense.is_empty() {
            return Clearance(None);
        }
        let mut corners = Vec::new();
        for placed in objects {
            let Some(to_world) = placed.motion.static_transform() else { continue };
            let bounds = to_world.bounds(&placed.mesh.bounds());
            if dense.iter().any(|inside| !inside.bounds.intersection(bounds).is_empty()) {
                corners.extend(world_corners(&placed.mesh, to_world));
            }
        }
        let options = BuildOptions { quality: Quality::Fast, ..BuildOptions::default() };
        let tree = TriangleMesh::from_corners(corners).ok().and_then(|mesh| Bvh8::new(&mesh, &options).ok());
        dense.iter_mut().for_each(|inside| inside.is_dense = tree.is_some());
        Clearance(tree)
    }

    /// The distance in metres to the nearest triangle, or `within` where that is less.
    #[inline]
    pub(super) fn at(&self, p: Vec3, within: f32) -> f32 {
        self.0.as_ref().map_or(within, |tree| tree.clearance(p.to_array(), within))
    }
}
