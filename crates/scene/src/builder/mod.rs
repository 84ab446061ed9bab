//! A scene under construction: plain data, as files describe it.
mod built_parts;
pub mod change;
pub mod inventory;
mod merging;

use crate::builder::inventory::Inventory;
use crate::cameras::{self, CameraSpec};
use crate::geometry::accel_choice::AccelChoice;
use crate::geometry::axis::UpHint;
use crate::geometry::footprint;
use crate::geometry::placed::Visibility;
use crate::geometry::spheres::PlacedSphere;
use crate::geometry::strokes::StrokeWidths;
use crate::geometry::{Geometry, Placed};
use crate::grid::Grid;
use crate::kept::MeshPool;
use crate::lights::{self, BuiltLight};
use crate::materials::{Material, MaterialInputs};
use crate::mesh::Mesh;
use crate::mesh::sides::Sides;
use crate::messages::error::{SceneError, Warning};
use crate::parameters::{Parameters, Span, Spec, Value};
use crate::scene::{LightSurfaces, MAX_NESTED, Scene, SceneLight, SceneParts};
use crate::texture::Texture;
use bilux_math::motion::Motion;
use bilux_math::{DVec3, Rgb, Transform};
pub use built_parts::BuiltParts;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh placed in the scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// The user's name for it; may be empty.
    pub name: String,
    /// Triangles of the object.
    pub mesh: Arc<Mesh>,
    /// Index into [`SceneBuilder::materials`].
    pub material: usize,
    /// Position and motion.
    pub motion: Motion,
    /// Keep one copy of the mesh's tree, however many instances the scene has.
    ///
    /// Otherwise, and for objects that do not move, triangles go into one tree of the whole scene.
    pub instanced: bool,
    /// Kind of the object, for labels, such as "chair"; empty for none.
    pub category: String,
    /// Which rays see it.
    pub visibility: Visibility,
}

impl Object {
    /// A mesh in its original position, with the material of this index.
    pub fn new(name: &str, mesh: Arc<Mesh>, material: usize) -> Object {
        Object {
            name: name.to_owned(),
            mesh,
            material,
            motion: Motion::REST,
            instanced: false,
            category: String::new(),
            visibility: Visibility::Full,
        }
    }

    /// Places the object by a transform.
    pub fn placed(self, transform: Transform) -> Object {
        Object { motion: Motion::still(transform), ..self }
    }
}

/// A scene under construction. All fields are plain data; [`SceneBuilder::build`] checks them.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    /// Textures on surfaces.
    pub textures: Vec<Arc<Texture>>,
    /// The materials of surfaces.
    pub materials: Vec<Spec>,
    /// The visible objects.
    pub objects: Vec<Object>,
    /// Light sources, other than emissive materials.
    pub lights: Vec<Spec>,
    /// The cameras; the first is the default.
    pub cameras: Vec<CameraSpec>,
    /// The file's format has light sources, but cannot describe the environment around a scene.
    pub environment_unspecified: bool,
    /// The file's format has light sources, but cannot state how a picture is exposed.
    pub exposure_unspecified: bool,
    /// The file describes all light that its scene has, so that a scene without any is black.
    pub describes_all_light: bool,
    /// Surfaces that emit light are known to light next to nothing of what the camera sees, beside other lights. Integrators sample them rarely, with the
    /// same mean.
    pub has_faint_emitters: bool,
    /// The up axis, as far as the file or its format states it.
    pub up: UpHint,
    /// Metres per unit of length of the file; 0 means one metre, as in scenes that state no unit.
    pub unit: f64,
    /// The program that wrote the file, as the file says; empty if it does not.
    pub written_by: String,
    /// A common offset of all positions in the file, left out of ours so that 32-bit floats hold the rest.
    pub origin: DVec3,
    /// The widths of points and lines.
    pub stroke_widths: StrokeWidths,
    /// Render settings that the file asks for; this crate does not interpret them.
    pub settings: Parameters,
    /// Problems found while reading.
    pub warnings: Vec<Warning>,
    /// Remarks on the file where nothing is wrong with it, such as on data that have no effect.
    pub notes: Vec<Warning>,
    /// Other choices that the file offers.
    pub inventory: Inventory,
    /// All objects at several times of their animation, if requested. Automatic cameras frame these, so that they stay
    /// still while objects move.
    pub movement: Option<Arc<SceneBuilder>>,
    /// The files that the scene was read from, by their full names, so that nothing is written over them.
    pub files: BTreeSet<PathBuf>,
}

impl SceneBuilder {
    /// Adds a material and gives its index.
    pub fn add_material(&mut self, spec: impl Into<Spec>) -> usize {
        self.materials.push(spec.into());
        self.materials.len() - 1
    }

    /// Adds a light.
    pub fn add_light(&mut self, spec: impl Into<Spec>) {
        self.lights.push(spec.into());
    }

    /// Adds a camera that does not move.
    pub fn add_camera(&mut self, spec: impl Into<Spec>) {
        self.cameras.push(CameraSpec::new(spec));
    }

    /// Adds a warning.
    pub fn warn(&mut self, message: impl Into<String>, at: Span) {
        self.warnings.push(Warning { message: message.into(), at });
    }

    /// The grids of its materials, each once.
    pub fn grids(&self) -> Vec<&Arc<Grid>> {
        let mut grids: Vec<&Arc<Grid>> = Vec::new();
        for (_, value, _) in self.materials.iter().flat_map(|spec| &spec.parameters.0) {
            if let Value::Grid(grid) = value
                && !grids.iter().any(|known| Arc::ptr_eq(known, grid))
            {
                grids.push(grid);
            }
        }
        grids
    }

    /// The bounding box of all objects at a time in seconds, without lights.
    pub fn bounds(&self, time: f32) -> bilux_math::Aabb {
        let moved = |o: &Object| o.motion.at(time).bounds(&o.mesh.bounds());
        let shown = self.objects.iter().filter(|object| object.visibility != Visibility::Hidden);
        shown.map(moved).fold(bilux_math::Aabb::EMPTY, bilux_math::Aabb::union)
    }

    /// Checks everything and builds the trees. `shutter` is the exposure interval in seconds; `aspect` is the film's
    /// width over its height.
    ///
    /// # Errors
    /// The first problem found, with its location.
    pub fn build(&self, accel: &AccelChoice, shutter: [f32; 2], aspect: f32) -> Result<Scene, SceneError> {
        self.build_with(&mut BuiltParts::default(), accel, shutter, aspect)
    }

    /// Builds as [`SceneBuilder::build`] does, from what earlier builds left, and keeps what is new for later ones: trees of what
    /// did not move, materials, lights and their tables. It does not matter which scene was built before.
    ///
    /// # Errors
    /// As for [`SceneBuilder::build`]; then `parts` stays as it was.
    pub fn build_with(
        &self,
        parts: &mut BuiltParts,
        accel: &AccelChoice,
        shutter: [f32; 2],
        aspect: f32,
    ) -> Result<Scene, SceneError> {
        parts.begin();
        let built = self.build_parts(parts, accel, shutter, aspect);
        parts.end(built.is_ok());
        built
    }

    fn build_parts(
        &self,
        parts: &mut BuiltParts,
        accel: &AccelChoice,
        shutter: [f32; 2],
        aspect: f32,
    ) -> Result<Scene, SceneError> {
        let mut materials: Vec<Arc<dyn Material>> = self
            .materials
            .iter()
            .map(|spec| parts.material(spec, &MaterialInputs::new(&self.textures, &self.materials)))
            .collect::<Result<_, _>>()?;
        let mut meshes = self.known_meshes(materials.len(), &mut parts.meshes)?;
        let BuiltLights { lights, surfaces, panels, spheres, sphere_lights, groups } =
            self.build_lights(&mut materials, parts)?;
        for panel in &surfaces {
            meshes.push(parts.meshes.of(&panel.mesh, || Ok::<(), SceneError>(()))?);
        }
        let cameras = self
            .cameras
            .iter()
            .map(|camera| Ok((camera.spec.name.clone(), cameras::build(camera, aspect)?)))
            .collect::<Result<Vec<_>, SceneError>>()?;
        let filtered_of = |material| footprint::filtered(material, &self.materials, &self.textures);
        let filtered: Vec<Vec<Arc<Texture>>> = self.materials.iter().map(filtered_of).collect();
        let nothing = Arc::new(Mesh::default());
        let place = |object: &Object, mesh: Arc<Mesh>| Placed {
            mesh: if object.visibility == Visibility::Hidden { nothing.clone() } else { mesh },
            visibility: object.visibility,
            material: object.material as u32,
            motion: object.motion.clone(),
            instanced: object.instanced,
            gives_light: object.visibility != Visibility::Hidden
                && !materials[object.material].emission().is_black(),
            has_tangents: materials[object.material].needs_tangents(),
            is_filtered: filtered.get(object.material).is_some_and(|textures| !textures.is_empty()),
        };
        let objects = self.objects.iter().chain(&surfaces).zip(meshes);
        let placed = objects.map(|(object, mesh)| place(object, mesh)).collect();
        let has_strokes = self.objects.iter().any(|object| object.mesh.stroke_count() > 0);
        let size = if has_strokes { self.bounds(shutter[0]).extent().length() } else { 1.0 };
        let widths = self.stroke_widths.for_size(size);
        let geometry = Geometry::build(placed, spheres, widths, accel, &mut parts.trees)?;
        let of_lights = LightSurfaces { panels: &panels, spheres: &sphere_lights };
        let known = &mut parts.mesh_lights;
        let mut all = SceneParts::new(geometry, materials, lights, of_lights, cameras, filtered, known);
        if let Some((object, around)) = all.too_deep() {
            let name = self.objects.get(object).map_or("", name_of);
            let message = format!(
                "'{name}' lies within {around} other media that have a priority, and {} are possible: join some of \
                 them, or give priority 0 to glass that touches no other",
                MAX_NESTED - 1
            );
            fail(message)?;
        }
        all.group_surfaces(|object| match self.objects.get(object) {
            Some(object) => [name_of(object), self.group_of(object)].map(str::to_owned),
            None => groups.get(object - self.objects.len()).cloned().unwrap_or_default(),
        });
        if self.has_faint_emitters {
            all.mark_faint(self.objects.len());
        }
        Ok(Scene::new(Arc::new(all), accel, shutter, &mut parts.top))
    }

    /// The layer of light of an object that emits some: that of all objects of its material, if this has a name.
    fn group_of<'a>(&'a self, object: &'a Object) -> &'a str {
        let material = self.materials.get(object.material).map_or("", |spec| &spec.name);
        if material.is_empty() { name_of(object) } else { material }
    }

    /// The mesh of each object, once it has been checked.
    fn known_meshes(&self, materials: usize, pool: &mut MeshPool) -> Result<Vec<Arc<Mesh>>, SceneError> {
        let mut meshes: Vec<Arc<Mesh>> = Vec::with_capacity(self.objects.len());
        for (i, object) in self.objects.iter().enumerate() {
            check_material(object, materials)?;
            // Instances mostly come one after the other.
            let before =
                i.checked_sub(1).filter(|&before| Arc::ptr_eq(&self.objects[before].mesh, &object.mesh));
            meshes.push(match before {
                Some(before) => meshes[before].clone(),
                None => pool.of(&object.mesh, || check_mesh(object))?,
            });
        }
        Ok(meshes)
    }

    /// Builds lights without a surface; lights with one become objects or spheres.
    fn build_lights(
        &self,
        materials: &mut Vec<Arc<dyn Material>>,
        parts: &mut BuiltParts,
    ) -> Result<BuiltLights, SceneError> {
        let mut built = BuiltLights::default();
        let mut glowing =
            |parts: &mut BuiltParts, emission: Rgb, sides: Sides| -> Result<usize, SceneError> {
                let black = Spec::new("", "diffuse").with("reflectance", 0.0).with("emission", emission);
                let black = black.with("emission_sides", sides.name());
                materials.push(parts.material(&black, &MaterialInputs::default())?);
                Ok(materials.len() - 1)
            };
        let (mut of_surfaces, mut of_spheres) = (Vec::new(), Vec::new());
        for spec in &self.lights {
            let group = lights::group_of(spec);
            let alone = |light| SceneLight { group: group.clone(), ..SceneLight::new(&spec.name, light) };
            match parts.light(spec, &self.textures)? {
                BuiltLight::Light(light) => built.lights.push(alone(light)),
                BuiltLight::Several(lights) => built.lights.extend(lights.into_iter().map(alone)),
                BuiltLight::Surface { mesh, emission, sides, classic } => {
                    let material = glowing(parts, emission, sides)?;
                    if let Some(colour) = classic {
                        built.panels.push((self.objects.len() + built.surfaces.len(), colour));
                    }
                    built.surfaces.push(Object::new(&spec.name, mesh, material));
                    of_surfaces.push([spec.name.clone(), group]);
                }
                BuiltLight::Sphere { centre, radius, emission, classic } => {
                    let material = glowing(parts, emission, Sides::Both)? as u32;
                    built.spheres.push(PlacedSphere { centre, radius, material });
                    built.sphere_lights.push((spec.name.clone(), classic));
                    of_spheres.push([spec.name.clone(), group]);
                }
            }
        }
        built.groups = [of_surfaces, of_spheres].concat();
        Ok(built)
    }
}

/// The result of building the lights.
#[derive(Default)]
struct BuiltLights {
    /// Lights without a surface.
    lights: Vec<SceneLight>,
    /// Lights with a surface, placed after the objects.
    surfaces: Vec<Object>,
    /// The classic colours of objects that came from lights, if given.
    panels: Vec<(usize, Rgb)>,
    spheres: Vec<PlacedSphere>,
    /// The name of each sphere, and its classic colour if given.
    sphere_lights: Vec<(String, Option<Rgb>)>,
    /// The names and the layers of light of the surfaces, then of the spheres.
    groups: Vec<[String; 2]>,
}

fn fail(message: String) -> Result<(), SceneError> {
    Err(SceneError::invalid(message, &Span::default()))
}

/// Name of an object in messages.
fn name_of(object: &Object) -> &str {
    if object.name.is_empty() { &object.mesh.name } else { &object.name }
}

/// Checks that there is the object's material.
fn check_material(object: &Object, materials: usize) -> Result<(), SceneError> {
    if object.material < materials {
        return Ok(());
    }
    let (name, material) = (name_of(object), object.material);
    fail(format!("object '{name}' has material {material}, but there are only {materials}"))
}

/// Checks that a mesh has as many attributes as positions, and that its indices are in range.
fn check_mesh(object: &Object) -> Result<(), SceneError> {
    let (mesh, name) = (&*object.mesh, name_of(object));
    let count = mesh.positions.len();
    let attributes = [
        ("normals", mesh.normals.len()),
        ("texture coordinates", mesh.uvs.len()),
        ("second texture coordinates", mesh.uvs2.len()),
        ("tangents", mesh.tangents.len()),
        ("vertex kd", mesh.vertex_kd.len()),
        ("vertex ks", mesh.vertex_ks.len()),
        ("vertex opacities", mesh.vertex_opacity.len()),
        ("point widths", mesh.point_widths.len()),
    ];
    for (what, n) in attributes {
        if n != 0 && n != count {
            return fail(format!("mesh '{name}' has {n} {what} for {count} vertices"));
        }
    }
    let out_of_range = |t: &&[u32; 3]| t.iter().any(|&i| i as usize >= count);
    if let Some(bad) = mesh.triangles.iter().find(out_of_range) {
        return fail(format!("mesh '{name}' has the triangle {bad:?}, but only {count} vertices"));
    }
    let strokes = || mesh.points.iter().chain(mesh.lines.iter().flatten());
    if let Some(bad) = strokes().find(|&&i| i as usize >= count) {
        return fail(format!(
            "mesh '{name}' has a point or a line at vertex {bad}, but only {count} vertices"
        ));
    }
    Ok(())
}
