//! A scene under construction: plain data, as files describe it.

use crate::accel_choice::AccelChoice;
use crate::axis::UpHint;
use crate::cameras::{self, CameraSpec};
use crate::error::{SceneError, Warning};
use crate::footprint;
use crate::geometry::{Geometry, Placed};
use crate::inventory::Inventory;
use crate::lights::{self, BuiltLight};
use crate::materials::{self, Material, MaterialInputs};
use crate::mesh::Mesh;
use crate::parameters::{Parameters, Span, Spec};
use crate::scene::{Scene, SceneLight, SceneParts};
use crate::sides::Sides;
use crate::spheres::PlacedSphere;
use crate::strokes::StrokeWidths;
use crate::texture::Texture;
use bilux_math::motion::Motion;
use bilux_math::{DVec3, Rgb, Transform};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh placed in the scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// The user's name for it; may be empty.
    pub name: String,
    /// Its triangles.
    pub mesh: Arc<Mesh>,
    /// Index into [`SceneBuilder::materials`].
    pub material: usize,
    /// Its position and motion.
    pub motion: Motion,
    /// Keep one copy of the mesh's tree, however many instances the scene has.
    ///
    /// Otherwise, and for objects that do not move, triangles go into one tree of the whole scene.
    pub instanced: bool,
}

impl Object {
    /// A mesh in its original position, with the material of this index.
    pub fn new(name: &str, mesh: Arc<Mesh>, material: usize) -> Object {
        Object { name: name.to_owned(), mesh, material, motion: Motion::REST, instanced: false }
    }

    /// The same object, transformed.
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
    /// The up axis, as far as the file or its format states it.
    pub up: UpHint,
    /// Metres per unit of length of the file; 0 means one metre, as in scenes that state no unit.
    pub unit: f64,
    /// A common offset of all positions in the file, left out of ours so that 32-bit floats hold the rest.
    pub origin: DVec3,
    /// The widths of points and lines.
    pub stroke_widths: StrokeWidths,
    /// Render settings that the file asks for; this crate does not interpret them.
    pub settings: Parameters,
    /// Problems found while reading.
    pub warnings: Vec<Warning>,
    /// What is worth knowing about the file though nothing is wrong with it, such as data that have no effect.
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

    /// Adds a warning.
    pub fn warn(&mut self, message: impl Into<String>, at: Span) {
        self.warnings.push(Warning { message: message.into(), at });
    }

    /// The bounding box of all objects at a time in seconds, without lights.
    pub fn bounds(&self, time: f32) -> bilux_math::Aabb {
        let moved = |o: &Object| o.motion.at(time).bounds(&o.mesh.bounds());
        self.objects.iter().map(moved).fold(bilux_math::Aabb::EMPTY, bilux_math::Aabb::union)
    }

    /// Checks everything and builds the trees. `shutter` is the exposure interval in seconds; `aspect` is the film's
    /// width over its height.
    ///
    /// # Errors
    /// The first problem found, with its location.
    pub fn build(&self, accel: &AccelChoice, shutter: [f32; 2], aspect: f32) -> Result<Scene, SceneError> {
        let mut materials: Vec<Arc<dyn Material>> = self
            .materials
            .iter()
            .map(|spec| materials::build(spec, &MaterialInputs::new(&self.textures, &self.materials)))
            .collect::<Result<_, _>>()?;
        for object in &self.objects {
            check_mesh(object, materials.len())?;
        }
        let BuiltLights { lights, surfaces, panels, spheres, sphere_lights } =
            self.build_lights(&mut materials)?;
        let cameras = self
            .cameras
            .iter()
            .map(|camera| Ok((camera.spec.name.clone(), cameras::build(camera, aspect)?)))
            .collect::<Result<Vec<_>, SceneError>>()?;
        let filtered_of = |material| footprint::filtered(material, &self.materials, &self.textures);
        let filtered: Vec<Vec<Arc<Texture>>> = self.materials.iter().map(filtered_of).collect();
        let placed = self.objects.iter().chain(&surfaces).map(|object| Placed {
            mesh: object.mesh.clone(),
            material: object.material as u32,
            motion: object.motion.clone(),
            instanced: object.instanced,
            gives_light: !materials[object.material].emission().is_black(),
            has_tangents: materials[object.material].needs_tangents(),
            is_filtered: filtered.get(object.material).is_some_and(|textures| !textures.is_empty()),
        });
        let has_strokes = self.objects.iter().any(|object| object.mesh.stroke_count() > 0);
        let size = if has_strokes { self.bounds(shutter[0]).extent().length() } else { 1.0 };
        let widths = self.stroke_widths.for_size(size);
        let geometry = Geometry::build(placed.collect(), spheres, widths, accel)?;
        let parts = SceneParts::new(geometry, materials, lights, &panels, &sphere_lights, cameras, filtered);
        Ok(Scene::new(Arc::new(parts), accel, shutter))
    }

    /// Builds lights without a surface; lights with one become objects or spheres.
    fn build_lights(&self, materials: &mut Vec<Arc<dyn Material>>) -> Result<BuiltLights, SceneError> {
        let mut built = BuiltLights::default();
        let mut glowing = |emission: Rgb, sides: Sides| -> Result<usize, SceneError> {
            let black = Spec::new("", "diffuse").with("reflectance", 0.0).with("emission", emission);
            let black = black.with("emission_sides", sides.name());
            materials.push(materials::build(&black, &MaterialInputs::default())?);
            Ok(materials.len() - 1)
        };
        for spec in &self.lights {
            match lights::build(spec, &self.textures)? {
                BuiltLight::Light(light) => built.lights.push(SceneLight::new(&spec.name, light)),
                BuiltLight::Several(lights) => {
                    built.lights.extend(lights.into_iter().map(|light| SceneLight::new(&spec.name, light)));
                }
                BuiltLight::Surface { mesh, emission, sides, classic } => {
                    let material = glowing(emission, sides)?;
                    if let Some(colour) = classic {
                        built.panels.push((self.objects.len() + built.surfaces.len(), colour));
                    }
                    built.surfaces.push(Object::new(&spec.name, mesh, material));
                }
                BuiltLight::Sphere { centre, radius, emission, classic } => {
                    let material = glowing(emission, Sides::Both)? as u32;
                    built.spheres.push(PlacedSphere { centre, radius, material });
                    built.sphere_lights.push((spec.name.clone(), classic));
                }
            }
        }
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
}

/// Checks that a mesh has as many attributes as positions, and that its indices are in range.
fn check_mesh(object: &Object, materials: usize) -> Result<(), SceneError> {
    let mesh = &*object.mesh;
    let name = if object.name.is_empty() { &mesh.name } else { &object.name };
    let fail = |message: String| Err(SceneError::invalid(message, &Span::default()));
    if object.material >= materials {
        return fail(format!(
            "object '{name}' has material {}, but there are only {materials}",
            object.material
        ));
    }
    let count = mesh.positions.len();
    let attributes = [
        ("normals", mesh.normals.len()),
        ("texture coordinates", mesh.uvs.len()),
        ("second texture coordinates", mesh.uvs2.len()),
        ("tangents", mesh.tangents.len()),
        ("vertex kd", mesh.vertex_kd.len()),
        ("vertex ks", mesh.vertex_ks.len()),
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
