//! Edits of a scene and its settings.

use crate::Error;
use bilux_math::Motion;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::lights::surrounds;
use bilux_scene::{Mesh, Object, Parameters, SceneBuilder, SceneError, Span, Spec, Texture, Value};
use std::fmt::Debug;
use std::sync::Arc;

/// An edit of a scene or its settings. Objects, materials, lights and cameras are named by their index from 0.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Places or moves an object.
    Place(usize, Motion),
    /// Gives an object another mesh.
    Mesh(usize, Arc<Mesh>),
    /// Gives an object another material of the scene.
    AssignMaterial(usize, usize),
    /// Puts another object in the place of one.
    Replace(usize, Object),
    /// Adds an object as the last one.
    Add(Object),
    /// Removes an object; those after it move up by one.
    Remove(usize),
    /// Changes a material, wherever it is.
    Material(usize, Spec),
    /// Adds a material as the last one.
    AddMaterial(Spec),
    /// Adds a texture as the last one.
    AddTexture(Arc<Texture>),
    /// Changes a light.
    Light(usize, Spec),
    /// Replaces all lights.
    Lights(Vec<Spec>),
    /// Replaces what lights the scene from all around, by another or by nothing. What only the camera sees stays.
    Environment(Option<Spec>),
    /// Changes a camera.
    Camera(usize, CameraSpec),
    /// Replaces all cameras.
    Cameras(Vec<CameraSpec>),
    /// Changes one of the user's settings.
    Set(String, Value),
    /// Replaces all of the user's settings.
    Settings(Parameters),
}

impl Edit {
    /// Makes the edit. Returns true if it changes the scene.
    ///
    /// # Errors
    /// If it names what there is not.
    pub(super) fn make(self, scene: &mut SceneBuilder, user: &mut Parameters) -> Result<bool, Error> {
        Ok(match self {
            Edit::Place(index, motion) => put(&mut object(scene, index)?.motion, motion),
            Edit::Mesh(index, mesh) => {
                let own = &mut object(scene, index)?.mesh;
                let changes = !Arc::ptr_eq(own, &mesh);
                *own = mesh;
                changes
            }
            Edit::AssignMaterial(index, material) => put(&mut object(scene, index)?.material, material),
            Edit::Replace(index, by) => {
                *object(scene, index)? = by;
                true
            }
            Edit::Add(object) => {
                scene.objects.push(object);
                true
            }
            Edit::Remove(index) => {
                object(scene, index)?;
                scene.objects.remove(index);
                true
            }
            Edit::Material(index, spec) => put(one("material", &mut scene.materials, index)?, spec),
            Edit::AddMaterial(spec) => {
                scene.materials.push(spec);
                true
            }
            Edit::AddTexture(texture) => {
                scene.textures.push(texture);
                true
            }
            Edit::Light(index, spec) => put(one("light", &mut scene.lights, index)?, spec),
            Edit::Lights(lights) => put(&mut scene.lights, lights),
            Edit::Environment(environment) => put_environment(scene, environment),
            Edit::Camera(index, camera) => {
                *one("camera", &mut scene.cameras, index)? = camera;
                true
            }
            Edit::Cameras(cameras) => {
                scene.cameras = cameras;
                true
            }
            Edit::Set(key, value) => {
                user.set(&key, value);
                false
            }
            Edit::Settings(settings) => {
                *user = settings;
                false
            }
        })
    }
}

/// Replaces a value. Returns true if the new one differs: as text, since 0 equals -0, but may not have its consequences.
fn put<T: Debug>(old: &mut T, new: T) -> bool {
    let changes = format!("{old:?}") != format!("{new:?}");
    *old = new;
    changes
}

fn put_environment(scene: &mut SceneBuilder, environment: Option<Spec>) -> bool {
    let is_around = |light: &Spec| surrounds(&light.kind) && !light.is_backdrop();
    let before = scene.lights.clone();
    // It keeps its number.
    let first = scene.lights.iter().position(is_around);
    scene.lights.retain(|light| !is_around(light));
    if let Some(environment) = environment {
        scene.lights.insert(first.unwrap_or(scene.lights.len()).min(scene.lights.len()), environment);
    }
    put(&mut scene.lights.clone(), before)
}

fn object(scene: &mut SceneBuilder, index: usize) -> Result<&mut Object, Error> {
    one("object", &mut scene.objects, index)
}

fn one<'s, T>(what: &str, all: &'s mut [T], index: usize) -> Result<&'s mut T, Error> {
    let count = all.len();
    let message = || format!("there is no {what} {index}: the scene has {count}, counted from 0");
    all.get_mut(index).ok_or_else(|| SceneError::invalid(message(), &Span::default()).into())
}
