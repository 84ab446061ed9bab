//! The immutable scene, and the [`Tracer`] through which integrators ask it.

use crate::builder::AccelChoice;
use crate::cameras::Camera;
use crate::geometry::{Geometry, triangle_uvs};
use crate::lights::{Light, MeshLight, Picture, SphereLight};
use crate::materials::Material;
use crate::surface::Surface;
use bilux_accel::instancing::TwoLevel;
use bilux_accel::{Accelerator, Counters, Query, Ray};
use bilux_math::{Aabb, Rgb, Vec3};
use std::sync::Arc;

/// A light of the scene.
#[derive(Clone)]
pub struct SceneLight {
    /// What the user calls it; may be empty.
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

/// What of a scene does not change with time.
pub(crate) struct SceneParts {
    geometry: Geometry,
    materials: Vec<Arc<dyn Material>>,
    lights: Vec<SceneLight>,
    /// For each object the light that it is, spheres after them.
    object_lights: Vec<Option<u32>>,
    cameras: Vec<(String, Arc<dyn Camera>)>,
    classic_ambient: Rgb,
    has_nested: bool,
}

impl SceneParts {
    pub(crate) fn new(
        geometry: Geometry,
        materials: Vec<Arc<dyn Material>>,
        mut lights: Vec<SceneLight>,
        panels: &[(usize, Rgb)],
        lamps: &[(String, Option<Rgb>)],
        cameras: Vec<(String, Arc<dyn Camera>)>,
    ) -> SceneParts {
        let mut object_lights = vec![None; geometry.objects().len()];
        for (i, object) in geometry.objects().iter().enumerate().filter(|(_, o)| o.gives_light) {
            let (triangles, motion) = geometry.object_triangles(i as u32);
            let material = &materials[object.material as usize];
            let picture = material.emission_map().map(|map| Picture {
                map: map.clone(),
                uvs: object.mesh.triangles.iter().map(|t| triangle_uvs(&object.mesh, *t)).collect(),
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
        for (i, (sphere, (name, classic))) in geometry.spheres().iter().zip(lamps).enumerate() {
            let radiance = materials[sphere.material as usize].emission();
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
        let of_object = |o: &crate::geometry::Placed| materials[o.material as usize].nested();
        let has_nested = geometry.objects().iter().any(|o| of_object(o).is_some());
        SceneParts { geometry, materials, lights, object_lights, cameras, classic_ambient, has_nested }
    }
}

/// A scene at a time, ready to be asked.
pub struct Scene {
    parts: Arc<SceneParts>,
    accelerator: TwoLevel,
    /// The only tree of triangles, where there is one alone and it stands in the world as it is: asked without the level
    /// above, and then the spheres.
    alone: Option<Arc<dyn Accelerator>>,
    query: Query<'static>,
    shutter: [f32; 2],
}

impl Scene {
    pub(crate) fn new(parts: Arc<SceneParts>, accel: &AccelChoice, shutter: [f32; 2]) -> Scene {
        let accelerator = parts.geometry.top_level(accel, shutter);
        let alone = match parts.geometry.triangle_instances() {
            [only] if only.mask == u32::MAX && only.motion.is_still() => {
                only.motion.at(0.0).is_identity().then(|| only.accelerator.clone())
            }
            _ => None,
        };
        Scene { parts, accelerator, alone, query: accel.query, shutter }
    }

    /// The same scene at another time: only the top level is built anew.
    pub fn at(&self, accel: &AccelChoice, shutter: [f32; 2]) -> Scene {
        Scene::new(self.parts.clone(), accel, shutter)
    }

    /// When light is let in, in seconds.
    pub fn shutter(&self) -> [f32; 2] {
        self.shutter
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb {
        Accelerator::bounds(&self.accelerator)
    }

    /// The structure that answers rays.
    pub fn accelerator(&self) -> &dyn Accelerator {
        &self.accelerator
    }

    /// All surfaces and their trees.
    pub fn geometry(&self) -> &Geometry {
        &self.parts.geometry
    }

    /// Every light.
    pub fn lights(&self) -> &[SceneLight] {
        &self.parts.lights
    }

    /// Index in [`Scene::lights`] of the light that an object is.
    pub fn light_index_of(&self, object: u32) -> Option<usize> {
        self.parts.object_lights[object as usize].map(|i| i as usize)
    }

    /// The light that an object is.
    pub fn light_of(&self, object: u32) -> Option<&SceneLight> {
        self.parts.object_lights[object as usize].map(|i| &self.parts.lights[i as usize])
    }

    /// The constant light Ia of Equation 1.
    pub fn classic_ambient(&self) -> Rgb {
        self.parts.classic_ambient
    }

    /// Every camera with its name; the first is the default.
    pub fn cameras(&self) -> &[(String, Arc<dyn Camera>)] {
        &self.parts.cameras
    }

    /// What a surface is made of.
    pub fn material(&self, surface: &Surface) -> &dyn Material {
        self.material_of(surface.object)
    }

    /// What an object is made of.
    pub fn material_of(&self, object: u32) -> &dyn Material {
        &*self.parts.materials[self.parts.geometry.material_of(object) as usize]
    }

    /// Radiance that a surface itself gives out towards `wo`: triangles on those sides that their material says, spheres
    /// outwards.
    #[inline]
    pub fn emission(&self, surface: &Surface, wo: Vec3) -> Rgb {
        let material = self.material(surface);
        let emission = match material.emission_map() {
            Some(map) => map.at(surface.uv),
            None => material.emission(),
        };
        let shines = || match self.light_index_of(surface.object) {
            Some(light) => self.lights()[light].light.shines(surface, wo),
            None => true,
        };
        if emission.is_black() || !shines() { Rgb::BLACK } else { emission }
    }

    /// True when some object is of a medium with a priority.
    #[inline]
    pub fn has_nested(&self) -> bool {
        self.parts.has_nested
    }

    /// Radiance from infinity in a direction away from the scene.
    pub fn background(&self, direction: Vec3) -> Rgb {
        self.parts.lights.iter().map(|l| l.light.le(direction)).sum()
    }

    /// The greatest channel of the radiance that any surface gives out, or that comes from infinity straight
    /// above, below or from a side.
    pub fn brightest_radiance(&self) -> f32 {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let surfaces = self.parts.materials.iter().map(|m| m.emission());
        let infinity = axes.into_iter().map(|axis| self.background(axis));
        surfaces.chain(infinity).map(Rgb::max_channel).fold(0.0, f32::max)
    }

    /// The greatest channel of all that lights give in the classic modes.
    pub fn classic_brightness(&self) -> f32 {
        let lights: Rgb = self.parts.lights.iter().map(|l| l.classic_colour).sum();
        (lights + self.parts.classic_ambient).max_channel()
    }

    /// True when some surface gives light.
    pub fn has_luminous_surfaces(&self) -> bool {
        self.parts.object_lights.iter().any(Option::is_some)
    }
}

/// Asks a scene on behalf of one thread, and counts.
pub struct Tracer<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// What the rays took; only `rays` unless counting is on.
    pub counters: Counters,
    counting: bool,
}

impl<'s> Tracer<'s> {
    /// A tracer; with `counting`, every node and triangle test is counted.
    pub fn new(scene: &'s Scene, counting: bool) -> Tracer<'s> {
        Tracer { scene, counters: Counters::default(), counting }
    }

    /// What a ray meets first.
    #[inline]
    pub fn closest(&mut self, ray: &Ray) -> Option<Surface> {
        let (accelerator, query) = (&self.scene.accelerator, &self.scene.query);
        let hit = if self.counting {
            accelerator.closest_hit_counted(ray, query, &mut self.counters)
        } else {
            self.counters.rays += 1;
            match &self.scene.alone {
                Some(tree) if ray.mask != 0 => self.scene.parts.geometry.closest_hit(&**tree, ray, query),
                _ => accelerator.closest_hit(ray, query),
            }
        }?;
        let mut surface = self.scene.parts.geometry.surface(ray, &hit);
        if surface.tangent != Vec3::ZERO {
            surface.n_shade = self.scene.material(&surface).n_shade(&surface);
        }
        Some(surface)
    }

    /// True when anything is between a ray's ends.
    #[inline]
    pub fn occluded(&mut self, ray: &Ray) -> bool {
        let (accelerator, query) = (&self.scene.accelerator, &self.scene.query);
        if self.counting {
            accelerator.any_hit_counted(ray, query, &mut self.counters)
        } else {
            self.counters.rays += 1;
            match &self.scene.alone {
                Some(tree) if ray.mask != 0 => self.scene.parts.geometry.any_hit(&**tree, ray, query),
                _ => accelerator.any_hit(ray, query),
            }
        }
    }

    /// True when something that gives no light itself is between a ray's ends: in the classic modes the
    /// surface of a lamp does not shade.
    pub fn blocked(&mut self, ray: &Ray) -> bool {
        if !self.occluded(ray) {
            return false;
        }
        if !self.scene.has_luminous_surfaces() {
            return true;
        }
        let mut rest = *ray;
        while let Some(surface) = self.closest(&rest) {
            if self.scene.light_of(surface.object).is_none() {
                return true;
            }
            rest.exclude = surface.primitive;
            rest.t_min = surface.t.next_up();
        }
        false
    }
}
