//! The immutable scene, and the [`Tracer`] with which integrators query it.

mod behind;
mod clearance;
mod contact;
mod enclosure;
mod may_pass;
mod media;
mod mesh_lights;
mod nesting;
mod open_boundaries;
mod parts;
mod scene_light;
mod shading;
mod sheets;
mod still_triangles;
mod top;
mod tracer;

use crate::cameras::Camera;
use crate::geometry::Geometry;
use crate::geometry::accel_choice::AccelChoice;
use crate::geometry::footprint::FootprintView;
use crate::geometry::placed::Placed;
use crate::lights::Light;
use crate::materials::Material;
use crate::media::{Medium, MediumLine};
use crate::surface::Surface;
use crate::texture::mipmaps;
use bilux_accel::instancing::TwoLevel;
use bilux_accel::{Accelerator, CpuLevel, Hit, Query, Ray};
use bilux_math::{Aabb, Rgb, Transform, Vec3};
pub use enclosure::Enclosure;
use may_pass::MayPass;
pub(crate) use mesh_lights::MeshLights;
pub use nesting::MAX_NESTED;
pub(crate) use parts::{LightSurfaces, SceneParts};
pub use scene_light::SceneLight;
pub use shading::Shading;
use sheets::Sheets;
use std::sync::Arc;
pub(crate) use top::Top;
pub use tracer::Tracer;

/// A scene at a time, ready for ray queries.
pub struct Scene {
    parts: Arc<SceneParts>,
    accelerator: Arc<TwoLevel>,
    /// The only tree of triangles, if there is just one and it is in world space: rays bypass the top level, and query
    /// it and then the spheres.
    alone: Option<Arc<dyn Accelerator>>,
    query: Query<'static>,
    shutter: [f32; 2],
    /// The camera for which textures are filtered.
    view: Option<FootprintView>,
    /// The gaps between the shells of sheets, if any.
    sheets: Option<Sheets>,
    /// The bounds of the objects whose medium changes light and has no priority.
    absorbers: Vec<Aabb>,
    cpu_level: CpuLevel,
}

impl Scene {
    pub(crate) fn new(
        parts: Arc<SceneParts>,
        accel: &AccelChoice,
        shutter: [f32; 2],
        top: &mut Top,
    ) -> Scene {
        let (accelerator, sheets) = top.of(&parts, accel, shutter);
        let alone = match parts.geometry.triangle_instances() {
            [only] if only.mask == u32::MAX && only.motion.is_still() && !parts.geometry.has_strokes() => {
                only.motion.at(0.0).is_identity().then(|| only.accelerator.clone())
            }
            _ => None,
        };
        let absorbs = |o: &&Placed| {
            let material = &parts.materials[o.material as usize];
            material.medium().is_some_and(|medium| !medium.is_clear()) && material.nested().is_none()
        };
        let bounds = |o: &Placed| {
            let bounds = o.motion.bounds_over(&o.mesh.bounds(), shutter);
            // Surfaces that lie on the bounds are inside, whatever is rounded.
            bounds.expanded(1e-3 * bounds.radius())
        };
        let absorbers = parts.geometry.objects().iter().filter(absorbs).map(bounds).collect();
        let cpu_level = accel.options.cpu_level.available();
        Scene {
            parts,
            accelerator,
            alone,
            query: accel.query,
            shutter,
            view: None,
            sheets,
            absorbers,
            cpu_level,
        }
    }

    /// Scene at another time; only the top level is rebuilt.
    pub fn at(&self, accel: &AccelChoice, shutter: [f32; 2]) -> Scene {
        let scene = Scene::new(self.parts.clone(), accel, shutter, &mut Top::default());
        match &self.view {
            Some(view) => scene.seen_by(view.clone()),
            None => scene,
        }
    }

    /// Scene with its textures filtered for images by a camera, with this many rows of pixels.
    ///
    /// Detail finer than half a pixel is averaged, so that fewer samples suffice. Emission and opacity stay as they
    /// are.
    pub fn filtered(self, camera: Arc<dyn Camera>, rows: u32) -> Scene {
        self.seen_by(FootprintView { camera, rows: rows as f32 })
    }

    fn seen_by(self, view: FootprintView) -> Scene {
        let SceneParts { geometry, textures, .. } = &*self.parts;
        if textures.iter().all(Vec::is_empty) {
            return self;
        }
        mipmaps::build(&view.needed(geometry, textures, self.shutter));
        Scene { view: Some(view), ..self }
    }

    /// The exposure interval, in seconds.
    pub fn shutter(&self) -> [f32; 2] {
        self.shutter
    }

    /// The bounding box of everything.
    pub fn bounds(&self) -> Aabb {
        Accelerator::bounds(&*self.accelerator)
    }

    /// The acceleration structure.
    pub fn accelerator(&self) -> &dyn Accelerator {
        &*self.accelerator
    }

    /// All surfaces and their trees.
    pub fn geometry(&self) -> &Geometry {
        &self.parts.geometry
    }

    /// All lights.
    pub fn lights(&self) -> &[SceneLight] {
        &self.parts.lights
    }

    /// The lights that rays reach where they leave the scene, each with its index in [`Scene::lights`].
    pub fn infinite_lights(&self) -> impl Iterator<Item = (usize, &dyn Light)> {
        self.parts.infinite.iter().map(|&index| (index, &*self.parts.lights[index].light))
    }

    /// Index in [`Scene::lights`] of an object that is a light.
    pub fn light_index_of(&self, object: u32) -> Option<usize> {
        self.parts.object_lights[object as usize].map(|i| i as usize)
    }

    /// The light of an object.
    pub fn light_of(&self, object: u32) -> Option<&SceneLight> {
        self.parts.object_lights[object as usize].map(|i| &self.parts.lights[i as usize])
    }

    /// The constant light Ia of Equation 1.
    pub fn classic_ambient(&self) -> Rgb {
        self.parts.classic_ambient
    }

    /// All cameras with their names; the first is the default.
    pub fn cameras(&self) -> &[(String, Arc<dyn Camera>)] {
        &self.parts.cameras
    }

    /// The material of a surface.
    pub fn material(&self, surface: &Surface) -> &dyn Material {
        self.material_of(surface.object)
    }

    /// The material of an object.
    pub fn material_of(&self, object: u32) -> &dyn Material {
        &*self.parts.materials[self.parts.geometry.material_of(object) as usize]
    }

    /// Radiance that a surface emits towards `wo`: triangles on the sides that their material sets, spheres outwards.
    #[inline]
    pub fn emission(&self, surface: &Surface, wo: Vec3) -> Rgb {
        if self.is_dark(surface.object) {
            return Rgb::BLACK;
        }
        let material = self.material(surface);
        let emission = match material.emission_map() {
            // The same value as in light sampling, down to the last texel.
            Some(map) => map.at(surface.uv_pair()),
            None => material.emission(),
        };
        let emission = emission * self.emission_factor(surface);
        let shines = || match self.light_index_of(surface.object) {
            Some(light) => self.lights()[light].light.emits_towards(surface, wo),
            None => true,
        };
        if emission.is_black() || !shines() { Rgb::BLACK } else { emission }
    }

    /// The factor of an object's vertices on its emission.
    #[inline]
    fn emission_factor(&self, surface: &Surface) -> Rgb {
        match self.parts.geometry.objects().get(surface.object as usize) {
            Some(placed) if placed.mesh.emission_by_kd => surface.vertex_kd.unwrap_or(Rgb::WHITE),
            _ => Rgb::WHITE,
        }
    }

    /// True when some object's medium has a priority.
    #[inline]
    pub fn has_nested(&self) -> bool {
        !self.parts.nesting.ranks.is_empty()
    }

    /// Of media that overlap, the one whose object has the highest of these numbers exists; 0 for an object whose material takes no part
    /// in that. Higher for a higher priority, and of equal ones for what lies within the other.
    #[inline]
    pub fn nesting(&self, object: u32) -> u32 {
        self.parts.nesting.ranks.get(object as usize).copied().unwrap_or(0)
    }

    /// Distance that a ray may travel inside an object whose medium changes light and has no priority, if it begins in
    /// one: up to where it leaves the objects' bounds. `None` where it begins in none.
    pub fn absorption_distance(&self, ray: &Ray) -> Option<f32> {
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        let around = self.absorbers.iter().filter(|bounds| bounds.contains(origin));
        let exit = |bounds: &Aabb| {
            let far = Vec3::select(direction.cmpgt(Vec3::ZERO), bounds.max, bounds.min);
            // An axis that the ray is perpendicular to gives infinity, or NaN, which `min` ignores.
            ((far - origin) / direction)
                .to_array()
                .into_iter()
                .fold(f32::INFINITY, |t, axis| t.min(axis.abs()))
        };
        around.map(exit).reduce(f32::max)
    }

    /// The part of a ray from this distance on, in metres, through the grids of the medium of an object, if it has any.
    #[inline]
    pub fn medium_line(&self, object: u32, medium: &Medium, ray: &Ray, begin: f32) -> Option<MediumLine> {
        if medium.density.is_none() && medium.glow.is_none() {
            return None;
        }
        let direction = Vec3::from(ray.direction).normalize();
        let origin = Vec3::from(ray.origin) + direction * begin;
        // Spheres have no space of their own.
        let placed = self.parts.geometry.objects().get(object as usize);
        let to_world = || placed.map_or(Transform::IDENTITY, |placed| placed.motion.at(ray.time));
        medium.line(to_world, origin, direction)
    }

    /// The instruction set of the acceleration structures, which loops over many paths use too.
    pub fn cpu_level(&self) -> CpuLevel {
        self.cpu_level
    }

    /// Scattering of the surfaces of an object, for shading many at a time.
    #[inline]
    pub fn shading(&self, object: u32) -> Shading {
        self.parts.shading.get(object as usize).map_or(Shading::General, |object| object.kind)
    }

    /// True when no surface of an object emits light.
    #[inline]
    pub fn is_dark(&self, object: u32) -> bool {
        self.parts.shading.get(object as usize).is_some_and(|object| object.is_dark)
    }

    /// True when some material refracts each wavelength differently.
    #[inline]
    pub fn disperses(&self) -> bool {
        self.parts.disperses
    }

    /// Radiance from infinity, along a direction away from the scene, after this many specular events.
    pub fn background(&self, direction: Vec3, events: u32) -> Rgb {
        let shown = self.infinite_lights().filter(|(_, light)| self.shows(*light, events, true));
        shown.map(|(_, light)| light.le(direction)).sum()
    }

    /// True when an infinite light is visible to a ray after this many scattering events, all specular if `specular`.
    ///
    /// The camera itself sees backdrops in place of the environment that lights the scene; mirrors and smooth glass
    /// show backdrops only if there is no environment.
    #[inline]
    pub fn shows(&self, light: &dyn Light, events: u32, specular: bool) -> bool {
        match (light.is_backdrop(), events) {
            (true, 0) => true,
            (true, _) => specular && !self.parts.has_surroundings,
            (false, 0) => !self.parts.has_backdrop,
            (false, _) => true,
        }
    }

    /// The maximum channel of the emitted radiance of any surface, and of the radiance from infinity along the six
    /// axes.
    pub fn brightest_radiance(&self) -> f32 {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let surfaces = self.parts.materials.iter().map(|m| m.emission());
        let from = |axis: Vec3| self.parts.lights.iter().map(|l| l.light.le(axis)).sum();
        let infinity = axes.into_iter().map(from);
        surfaces.chain(infinity).map(Rgb::max_channel).fold(0.0, f32::max)
    }

    /// The maximum channel of the sum of all lights in the classic modes.
    pub fn classic_brightness(&self) -> f32 {
        let lights: Rgb = self.parts.lights.iter().map(|l| l.classic_colour).sum();
        (lights + self.parts.classic_ambient).max_channel()
    }

    /// True when some surface is emissive.
    pub fn has_emissive_surfaces(&self) -> bool {
        self.parts.object_lights.iter().any(Option::is_some)
    }

    /// The normal at the end of segments that arrive from a direction, for [`Tracer::ending_on`].
    pub fn normal_towards(&self, surface: &Surface, direction: Vec3) -> Vec3 {
        self.parts.normal_towards(surface, direction)
    }

    /// The hit behind the backs of sheets, on their other shell, if `hit` is on the back of one; otherwise `hit`.
    ///
    /// `next` finds the closest hit of a ray.
    #[inline]
    pub(crate) fn behind_shells(&self, ray: &Ray, hit: Hit, next: impl FnMut(&Ray) -> Option<Hit>) -> Hit {
        match &self.sheets {
            Some(sheets) => self.parts.behind(sheets, ray, hit, next).unwrap_or(hit),
            None => hit,
        }
    }
}
