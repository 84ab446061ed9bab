//! The immutable scene, and the [`Tracer`] with which integrators query it.

mod lambertian;
mod may_pass;
mod sheets;
mod tracer;

use crate::accel_choice::AccelChoice;
use crate::cameras::Camera;
use crate::corners::corner_uvs;
use crate::footprint::FootprintView;
use crate::geometry::Geometry;
use crate::lights::{Light, MeshLight, Picture, Sides, SphereLight};
use crate::materials::Material;
use crate::surface::Surface;
use crate::texture::{ColourMap, Texture, levels};
use bilux_accel::instancing::TwoLevel;
use bilux_accel::{Accelerator, CpuLevel, Query, Ray};
use bilux_math::{Aabb, Rgb, Vec3};
use lambertian::Lambertian;
pub use lambertian::LambertianPoint;
use may_pass::MayPass;
use sheets::Sheets;
use std::sync::Arc;
pub use tracer::Tracer;

/// A light of the scene.
#[derive(Clone)]
pub struct SceneLight {
    /// The user's name for it; may be empty.
    pub name: String,
    /// The light.
    pub light: Arc<dyn Light>,
    /// Its colour in `cast`, `whitted` and `cook`.
    pub classic_colour: Rgb,
}

impl SceneLight {
    pub(crate) fn new(name: &str, light: Arc<dyn Light>) -> SceneLight {
        SceneLight { name: name.to_owned(), light, classic_colour: Rgb::BLACK }
    }
}

/// The parts of a scene that do not change with time.
pub(crate) struct SceneParts {
    geometry: Geometry,
    materials: Vec<Arc<dyn Material>>,
    lights: Vec<SceneLight>,
    /// The light index of each object, then of each sphere.
    object_lights: Vec<Option<u32>>,
    cameras: Vec<(String, Arc<dyn Camera>)>,
    /// The textures of each material that can be filtered.
    textures: Vec<Vec<Arc<Texture>>>,
    classic_ambient: Rgb,
    has_backdrop: bool,
    has_surroundings: bool,
    has_nested: bool,
    has_holes: bool,
    hides_backs: bool,
    /// For each object, then for each sphere.
    passes: Vec<MayPass>,
    disperses: bool,
    absorbs: bool,
    /// For each object of triangles, see [`Scene::is_lambertian`].
    lambertian: Vec<Lambertian>,
}

impl SceneParts {
    pub(crate) fn new(
        geometry: Geometry,
        materials: Vec<Arc<dyn Material>>,
        mut lights: Vec<SceneLight>,
        panels: &[(usize, Rgb)],
        sphere_lights: &[(String, Option<Rgb>)],
        cameras: Vec<(String, Arc<dyn Camera>)>,
        textures: Vec<Vec<Arc<Texture>>>,
    ) -> SceneParts {
        let mut object_lights = vec![None; geometry.objects().len()];
        for (i, object) in geometry.objects().iter().enumerate().filter(|(_, o)| o.gives_light) {
            let (triangles, motion) = geometry.object_triangles(i as u32);
            let material = &materials[object.material as usize];
            let even = || ColourMap { colour: material.emission(), texture: None };
            let varies = material.emission_map().is_some() || material.opacity().is_some();
            let picture = varies.then(|| Picture {
                map: material.emission_map().cloned().unwrap_or_else(even),
                opacity: material.opacity().cloned(),
                uvs: corner_uvs(&object.mesh),
            });
            let given = (material.emission(), picture, material.emission_sides());
            let mirrored = object.motion.at(0.0).mirrors();
            let classic = panels.iter().find(|(o, _)| *o == i).map(|(_, colour)| *colour);
            let first = geometry.first_primitive(i as u32);
            if let Some(light) = MeshLight::new(triangles, mirrored, first, motion, given, classic) {
                object_lights[i] = Some(lights.len() as u32);
                lights.push(SceneLight::new(&object.mesh.name, Arc::new(light)));
            }
        }
        for (i, (sphere, (name, classic))) in geometry.spheres().iter().zip(sphere_lights).enumerate() {
            let material = &materials[sphere.material as usize];
            let radiance = material.emission() * material.opacity().map_or(1.0, |opacity| opacity.number);
            let primitive = geometry.sphere_primitive(i as u32);
            let light = SphereLight::new(*sphere, primitive, radiance, *classic);
            object_lights.push(Some(lights.len() as u32));
            lights.push(SceneLight::new(name, Arc::new(light)));
        }
        let of_object = |o: &crate::geometry::Placed| o.motion.at(0.0).bounds(&o.mesh.bounds());
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
        let has_surroundings = lights.iter().any(surrounds);
        let of_object = |o: &crate::geometry::Placed| materials[o.material as usize].nested();
        let has_nested = geometry.objects().iter().any(|o| of_object(o).is_some());
        let has_holes = materials.iter().any(|material| material.opacity().is_some());
        let hides_backs = materials.iter().any(|material| material.visible_sides() == Sides::Front);
        let passes = MayPass::of_all(&geometry, &materials);
        let disperses = materials.iter().any(|material| material.disperses());
        let absorbs = materials.iter().any(|material| !material.sigma_a().is_black());
        let lambertian = geometry.objects().iter().map(|o| Lambertian::of(o, &materials)).collect();
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
            has_nested,
            has_holes,
            hides_backs,
            passes,
            disperses,
            absorbs,
            lambertian,
        }
    }
}

/// A scene at a time, ready for ray queries.
pub struct Scene {
    parts: Arc<SceneParts>,
    accelerator: TwoLevel,
    /// The only tree of triangles, if there is just one and it is in world space: rays bypass the top level, and query
    /// it and then the spheres.
    alone: Option<Arc<dyn Accelerator>>,
    query: Query<'static>,
    shutter: [f32; 2],
    /// The camera for which textures are filtered.
    view: Option<FootprintView>,
    /// The gaps between the shells of sheets, if any.
    sheets: Option<Sheets>,
    /// The bounds of the objects that absorb light and whose medium has no priority.
    absorbers: Vec<Aabb>,
    cpu_level: CpuLevel,
}

impl Scene {
    pub(crate) fn new(parts: Arc<SceneParts>, accel: &AccelChoice, shutter: [f32; 2]) -> Scene {
        let accelerator = parts.geometry.top_level(accel, shutter);
        let alone = match parts.geometry.triangle_instances() {
            [only] if only.mask == u32::MAX && only.motion.is_still() && !parts.geometry.has_strokes() => {
                only.motion.at(0.0).is_identity().then(|| only.accelerator.clone())
            }
            _ => None,
        };
        let sheets = Sheets::find(&parts, &accelerator, shutter[0]);
        let absorbs = |o: &&crate::geometry::Placed| {
            let material = &parts.materials[o.material as usize];
            !material.sigma_a().is_black() && material.nested().is_none()
        };
        let bounds = |o: &crate::geometry::Placed| {
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

    /// The same scene at another time: rebuilds only the top level.
    pub fn at(&self, accel: &AccelChoice, shutter: [f32; 2]) -> Scene {
        let scene = Scene::new(self.parts.clone(), accel, shutter);
        match &self.view {
            Some(view) => scene.seen_by(view.clone()),
            None => scene,
        }
    }

    /// The same scene with its textures filtered for images by a camera, with this many rows of pixels.
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
        levels::build(&view.needed(geometry, textures, self.shutter));
        Scene { view: Some(view), ..self }
    }

    /// The exposure interval, in seconds.
    pub fn shutter(&self) -> [f32; 2] {
        self.shutter
    }

    /// The bounding box of everything.
    pub fn bounds(&self) -> Aabb {
        Accelerator::bounds(&self.accelerator)
    }

    /// The acceleration structure.
    pub fn accelerator(&self) -> &dyn Accelerator {
        &self.accelerator
    }

    /// All surfaces and their trees.
    pub fn geometry(&self) -> &Geometry {
        &self.parts.geometry
    }

    /// All lights.
    pub fn lights(&self) -> &[SceneLight] {
        &self.parts.lights
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
        let material = self.material(surface);
        let emission = match material.emission_map() {
            // The same value as in light sampling, down to the last texel.
            Some(map) => map.at(surface.uv_pair()),
            None => material.emission(),
        };
        let shines = || match self.light_index_of(surface.object) {
            Some(light) => self.lights()[light].light.emits_towards(surface, wo),
            None => true,
        };
        if emission.is_black() || !shines() { Rgb::BLACK } else { emission }
    }

    /// True when some object's medium has a priority.
    #[inline]
    pub fn has_nested(&self) -> bool {
        self.parts.has_nested
    }

    /// How far a ray may travel inside an object that absorbs light and whose medium has no priority, if it begins in
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

    /// True when no medium changes what light carries: none absorbs, has a priority or disperses.
    #[inline]
    pub fn has_clear_media(&self) -> bool {
        !self.parts.absorbs && !self.parts.has_nested && !self.parts.disperses
    }

    /// The instruction set of the acceleration structures, which loops over many paths use too.
    pub fn cpu_level(&self) -> CpuLevel {
        self.cpu_level
    }

    /// True when an object emits nothing, and its BSDF is a single Lambertian lobe: its surfaces are shaded many at a
    /// time.
    #[inline]
    pub fn is_lambertian(&self, object: u32) -> bool {
        self.parts.lambertian.get(object as usize).is_some_and(|kind| !matches!(kind, Lambertian::No))
    }

    /// True when some material refracts each wavelength differently.
    #[inline]
    pub fn disperses(&self) -> bool {
        self.parts.disperses
    }

    /// Radiance from infinity, along a direction away from the scene, after this many specular events.
    pub fn background(&self, direction: Vec3, events: u32) -> Rgb {
        let shown = self.parts.lights.iter().filter(|l| self.shows(&*l.light, events, true));
        shown.map(|l| l.light.le(direction)).sum()
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
}
