//! Facts about the boundary of a medium that are known before a ray is traced.

use super::may_pass::MayPass;
use super::nesting::Nesting;
use super::scene_light::SceneLight;
use crate::geometry::Geometry;
use crate::geometry::placed::Placed;
use crate::materials::{Material, Nested};
use bilux_math::{Aabb, Transform, Vec3};
use std::sync::Arc;

/// The boundary of a medium that nothing leaves unseen: a closed mesh without holes, which does not move.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// Bounds of the medium: everything outside of them is outside of it.
    pub bounds: Aabb,
    /// Whether it is a surface, which blocks whatever is connected through it.
    pub is_solid: bool,
    /// A light may be inside.
    pub holds_light: bool,
}

impl Enclosure {
    /// Enclosures of all objects: none where the material has no medium that scatters, or the mesh is open or moves.
    pub(super) fn of_all(
        geometry: &Geometry,
        materials: &[Arc<dyn Material>],
        passes: &[MayPass],
        nesting: &Nesting,
        (lights, object_lights): (&[SceneLight], &[Option<u32>]),
    ) -> Vec<Option<Enclosure>> {
        if !materials.iter().any(|material| material.medium().is_some_and(|medium| medium.scatters())) {
            return Vec::new();
        }
        let lit = lit_places(geometry, lights, object_lights);
        let of = |((object, placed), passes): ((usize, &Placed), &MayPass)| {
            let material = &materials[placed.material as usize];
            let scatters = material.medium().is_some_and(|medium| medium.scatters());
            let has_holes = passes.has_holes || passes.is_one_sided;
            let to_world = placed.motion.static_transform().filter(|_| scatters && !has_holes)?;
            if !placed.mesh.has_inside() {
                return None;
            }
            let bounds = widened(to_world.bounds(&placed.mesh.bounds()));
            let holds_light = lit.iter().any(|place| !place.intersection(bounds).is_empty());
            let is_open =
                material.is_interface() || is_cut_open(object, bounds, geometry, materials, nesting);
            Some(Enclosure { bounds, is_solid: !is_open, holds_light })
        };
        geometry.objects().iter().enumerate().zip(passes).map(of).collect()
    }
}

/// Whether light may pass the surface of an object within these bounds without an event: where a stronger medium without a surface has
/// cut a part of it away, or where the index is the same on both sides.
fn is_cut_open(
    object: usize,
    bounds: Aabb,
    geometry: &Geometry,
    materials: &[Arc<dyn Material>],
    nesting: &Nesting,
) -> bool {
    let rank = |object: usize| nesting.ranks.get(object).copied().unwrap_or(0);
    if rank(object) == 0 {
        return false;
    }
    let material = |placed: &Placed| &*materials[placed.material as usize];
    let own = material(&geometry.objects()[object]);
    let index = own.in_contact().filter(|_| own.only_refracts());
    let is_like =
        |other: Option<Nested>| index.zip(other).is_some_and(|(index, other)| index.bends_like(&other));
    let opens = |(other, placed): (usize, &Placed)| {
        let other_material = material(placed);
        let is_cut = other_material.is_interface() && rank(other) > rank(object);
        let is_part = other != object && rank(other) > 0;
        let may = is_part && (is_cut || is_like(other_material.in_contact()));
        let reaches =
            |place: &Transform| !place.bounds(&placed.mesh.bounds()).intersection(bounds).is_empty();
        may && placed.motion.static_transform().is_none_or(reaches)
    };
    is_like(Some(Nested::AIR)) || geometry.objects().iter().enumerate().any(opens)
}

/// Bounds of the lights that are not infinitely far away.
fn lit_places(geometry: &Geometry, lights: &[SceneLight], object_lights: &[Option<u32>]) -> Vec<Aabb> {
    const ANYWHERE: Aabb = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    let of_object = |placed: &Placed| {
        let to_world = placed.motion.static_transform();
        to_world.map_or(ANYWHERE, |to_world| to_world.bounds(&placed.mesh.bounds()))
    };
    let finite = lights.iter().enumerate().filter(|(_, light)| !light.light.is_infinite());
    let place = |(index, light): (usize, &SceneLight)| {
        let object = object_lights.iter().position(|light| *light == Some(index as u32));
        match (object.and_then(|object| geometry.objects().get(object)), light.light.middle_and_reach()) {
            (Some(placed), _) => of_object(placed),
            (None, Some((middle, reach))) => Aabb { min: middle - reach, max: middle + reach },
            (None, None) => ANYWHERE,
        }
    };
    finite.map(place).collect()
}

/// By more than rounding moves points of the boundary.
fn widened(bounds: Aabb) -> Aabb {
    let most = bounds.min.abs().max(bounds.max.abs()).max_element();
    let margin = Vec3::splat(1e-5 * most);
    Aabb { min: bounds.min - margin, max: bounds.max + margin }
}
