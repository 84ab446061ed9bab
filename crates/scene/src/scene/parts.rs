//! Parts of a scene that are the same at all times.

use super::clearance::Clearance;
use super::enclosure::Enclosure;
use super::may_pass::MayPass;
use super::mesh_lights::{MeshLights, max_pieces};
use super::nesting::Nesting;
use super::open_boundaries::OpenBoundaries;
use super::scene_light::SceneLight;
use super::shading::ObjectShading;
use crate::cameras::Camera;
use crate::geometry::Geometry;
use crate::geometry::placed::Placed;
use crate::lights::SphereLight;
use crate::materials::Material;
use crate::texture::Texture;
use bilux_math::{Aabb, Rgb};
use std::sync::Arc;

/// The parts of a scene that do not change with time.
pub(crate) struct SceneParts {
    pub(super) geometry: Geometry,
    pub(super) materials: Vec<Arc<dyn Material>>,
    pub(super) lights: Vec<SceneLight>,
    /// The light index of each object, then of each sphere.
    pub(super) object_lights: Vec<Option<u32>>,
    pub(super) cameras: Vec<(String, Arc<dyn Camera>)>,
    /// The textures of each material that can be filtered.
    pub(super) textures: Vec<Vec<Arc<Texture>>>,
    pub(super) classic_ambient: Rgb,
    pub(super) has_backdrop: bool,
    pub(super) has_surroundings: bool,
    /// Indices of the infinite lights.
    pub(super) infinite: Vec<usize>,
    pub(super) nesting: Nesting,
    pub(super) open_boundaries: OpenBoundaries,
    /// For each object of triangles, whether its material has an inside of its own.
    pub(super) bounds_medium: Vec<bool>,
    pub(super) has_holes: bool,
    pub(super) hides_backs: bool,
    /// For each object, then for each sphere.
    pub(super) passes: Vec<MayPass>,
    /// For each object of triangles; none at all where no medium scatters.
    pub(super) enclosures: Vec<Option<Enclosure>>,
    pub(super) clearance: Clearance,
    pub(super) disperses: bool,
    pub(super) has_panes: bool,
    pub(super) absorbs: bool,
    pub(super) scatters: bool,
    pub(super) has_varying_media: bool,
    pub(super) has_coloured_distances: bool,
    /// For each object of triangles.
    pub(super) shading: Vec<ObjectShading>,
}

/// The surfaces that came from lights.
#[derive(Clone, Copy)]
pub(crate) struct LightSurfaces<'a> {
    /// Objects, and the light's classic colour.
    pub(crate) panels: &'a [(usize, Rgb)],
    /// The name of each sphere, and its classic colour if that was given.
    pub(crate) spheres: &'a [(String, Option<Rgb>)],
}

impl SceneParts {
    /// The object that lies within more media than a path may be in, and how many these are.
    pub(crate) fn too_deep(&self) -> Option<(usize, usize)> {
        self.nesting.too_deep
    }

    pub(crate) fn new(
        geometry: Geometry,
        materials: Vec<Arc<dyn Material>>,
        mut lights: Vec<SceneLight>,
        of_lights: LightSurfaces<'_>,
        cameras: Vec<(String, Arc<dyn Camera>)>,
        textures: Vec<Vec<Arc<Texture>>>,
        mesh_lights: &mut MeshLights,
    ) -> SceneParts {
        let mut object_lights =
            emissive_objects(&geometry, &materials, of_lights.panels, &mut lights, mesh_lights);
        for (i, (sphere, (name, classic))) in geometry.spheres().iter().zip(of_lights.spheres).enumerate() {
            let material = &materials[sphere.material as usize];
            let radiance = material.emission() * material.opacity().map_or(1.0, |opacity| opacity.number);
            let primitive = geometry.sphere_primitive(i as u32);
            let light = SphereLight::new(*sphere, primitive, radiance, *classic);
            object_lights.push(Some(lights.len() as u32));
            lights.push(SceneLight::new(name, Arc::new(light)));
        }
        let of_object = |o: &Placed| o.motion.at(0.0).bounds(&o.mesh.bounds());
        let bounds = geometry
            .objects()
            .iter()
            .filter(|o| !o.gives_light)
            .map(of_object)
            .fold(Aabb::EMPTY, Aabb::union);
        for light in &mut lights {
            light.classic_colour = light.light.classic_colour(&bounds);
        }
        let classic_ambient = lights.iter().map(|l| l.light.classic_ambient()).sum();
        let has_backdrop = lights.iter().any(|l| l.light.is_backdrop());
        let surrounds =
            |l: &SceneLight| l.light.is_infinite() && !l.light.is_delta() && !l.light.is_backdrop();
        let infinite = (0..lights.len()).filter(|&i| lights[i].light.is_infinite()).collect();
        let has_surroundings = lights.iter().any(surrounds);
        let open_boundaries = OpenBoundaries::of(geometry.objects(), &materials);
        let nesting = Nesting::of(geometry.objects(), &materials, &open_boundaries);
        let bounds_medium = bounds_media(&geometry, &materials);
        let passes = MayPass::of_all(&geometry, &materials);
        let hides_backs = passes.iter().any(|passes| passes.is_one_sided || passes.hides_from_camera);
        let has_holes = passes.iter().any(|passes| passes.has_holes);
        let disperses = materials.iter().any(|material| material.disperses());
        let has_panes = materials.iter().any(|material| material.is_pane());
        let media = || materials.iter().filter_map(|material| material.medium());
        let absorbs = media().any(|medium| !medium.is_clear());
        let scatters = media().any(|medium| medium.is_walked());
        let enclosures =
            Enclosure::of_all(&geometry, &materials, &passes, &nesting, (&lights, &object_lights));
        let clearance = Clearance::of(&geometry, &materials);
        let has_varying_media = media().any(|medium| medium.density.is_some());
        let has_coloured_distances = media().any(|medium| medium.has_coloured_distances());
        let shading = geometry.objects().iter().map(|o| ObjectShading::of(o, &materials)).collect();
        SceneParts {
            geometry,
            materials,
            lights,
            object_lights,
            cameras,
            textures,
            classic_ambient,
            has_backdrop,
            has_surroundings,
            infinite,
            nesting,
            open_boundaries,
            bounds_medium,
            has_holes,
            hides_backs,
            passes,
            enclosures,
            clearance,
            disperses,
            has_panes,
            absorbs,
            scatters,
            has_varying_media,
            has_coloured_distances,
            shading,
        }
    }

    /// Marks the lights of the first objects as faint.
    pub(crate) fn mark_faint(&mut self, objects: usize) {
        for light in self.object_lights.iter().take(objects).flatten() {
            self.lights[*light as usize].is_faint = true;
        }
    }

    /// Sets the layers of light that objects and spheres belong to, as far as they emit any, and names for those without.
    pub(crate) fn group_surfaces(&mut self, name_and_group_of: impl Fn(usize) -> [String; 2]) {
        for (object, light) in self.object_lights.iter().enumerate() {
            let Some(light) = light.map(|light| &mut self.lights[light as usize]) else { continue };
            let [name, group] = name_and_group_of(object);
            light.group = group;
            if light.name.is_empty() {
                light.name = name;
            }
        }
    }
}

/// For each object of triangles, whether its material has an inside of its own.
fn bounds_media(geometry: &Geometry, materials: &[Arc<dyn Material>]) -> Vec<bool> {
    let has_inside = |o: &Placed| {
        let material = &materials[o.material as usize];
        material.medium().is_some() || material.nested().is_some()
    };
    geometry.objects().iter().map(has_inside).collect()
}

/// Adds the lights of emissive objects, and says which light each object is.
fn emissive_objects(
    geometry: &Geometry,
    materials: &[Arc<dyn Material>],
    panels: &[(usize, Rgb)],
    lights: &mut Vec<SceneLight>,
    mesh_lights: &mut MeshLights,
) -> Vec<Option<u32>> {
    let mut object_lights = vec![None; geometry.objects().len()];
    let max_pieces = max_pieces(geometry, materials);
    for (i, object) in geometry.objects().iter().enumerate().filter(|(_, o)| o.gives_light) {
        let classic = panels.iter().find(|(o, _)| *o == i).map(|(_, colour)| *colour);
        let material = &materials[object.material as usize];
        if let Some(light) = mesh_lights.of_object(geometry, i as u32, material, classic, max_pieces) {
            object_lights[i] = Some(lights.len() as u32);
            lights.push(SceneLight::new(&object.mesh.name, light));
        }
    }
    object_lights
}
