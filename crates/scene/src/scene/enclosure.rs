//! What is known of the boundary of a medium before a ray is traced.

use super::may_pass::MayPass;
use super::scene_light::SceneLight;
use crate::geometry::Geometry;
use crate::materials::Material;
use crate::placed::Placed;
use bilux_math::{Aabb, Vec3};
use std::sync::Arc;

/// The boundary of a medium that nothing leaves unseen: a closed mesh without holes, which does not move.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// What is outside of these is outside of the medium.
    pub bounds: Aabb,
    /// It is a surface, which blocks whatever is connected through it.
    pub is_solid: bool,
    /// A light may be inside.
    pub holds_light: bool,
}

impl Enclosure {
    /// Those of all objects: none where the material has no medium that scatters, or the mesh is open or moves.
    pub(super) fn of_all(
        geometry: &Geometry,
        materials: &[Arc<dyn Material>],
        passes: &[MayPass],
        lights: &[SceneLight],
        object_lights: &[Option<u32>],
    ) -> Vec<Option<Enclosure>> {
        if !materials.iter().any(|material| material.medium().is_some_and(|medium| medium.scatters())) {
            return Vec::new();
        }
        let lit = lit_places(geometry, lights, object_lights);
        let of = |(placed, passes): (&Placed, &MayPass)| {
            let material = &materials[placed.material as usize];
            let scatters = material.medium().is_some_and(|medium| medium.scatters());
            let has_holes = passes.has_holes || passes.is_one_sided;
            let to_world = placed.motion.static_transform().filter(|_| scatters && !has_holes)?;
            if !placed.mesh.has_inside() {
                return None;
            }
            let bounds = widened(to_world.bounds(&placed.mesh.bounds()));
            let holds_light = lit.iter().any(|place| !place.intersection(bounds).is_empty());
            Some(Enclosure { bounds, is_solid: !material.is_interface(), holds_light })
        };
        geometry.objects().iter().zip(passes).map(of).collect()
    }
}

/// Where the lights are that are not infinitely far away.
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
