//! Contents of the directives of a file: all that a scene is made of, before names are resolved.

use super::entity::Entity;
use super::options::Options;
use super::state::{MaterialKey, Matrices};
use bilux_import::FormatError;
use bilux_import::appearance::filling::Medium;
use bilux_import::input::names::unknown;
use bilux_math::DMat4;
use bilux_scene::{Mesh, Span};
use std::collections::HashMap;
use std::sync::Arc;

/// Everything that is named or placed, in the order of the file. Names may be defined after they are used.
#[derive(Default)]
pub(super) struct Document {
    pub(super) options: Options,
    /// True once the world has begun.
    pub(super) has_world: bool,
    pub(super) textures: NamedTextures,
    pub(super) materials: Vec<Entity>,
    /// The indices of those with names, and where they are named.
    pub(super) named_materials: HashMap<Arc<str>, (usize, Span)>,
    pub(super) media: HashMap<Arc<str>, Medium>,
    pub(super) area_lights: Vec<Entity>,
    /// Each with its transform to world space.
    pub(super) lights: Vec<(Entity, DMat4)>,
    pub(super) pieces: Vec<Piece>,
    /// The pieces of objects, which instances place.
    pub(super) objects: HashMap<String, Vec<Piece>>,
    pub(super) instances: Vec<ObjectInstance>,
}

/// Textures by name: those of colours, and those of numbers.
pub(super) type NamedTextures = [HashMap<String, Entity>; 2];

/// A shape of the scene, before its material is resolved.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) form: ShapeGeometry,
    /// The transforms to world space, or to the space of the object definition that contains it.
    pub(super) matrices: Matrices,
    pub(super) attributes: SurfaceAttributes,
    /// The number of shapes that pbrt counts, each of which emits the full power of its light.
    pub(super) shapes: u32,
    pub(super) at: Span,
}

/// The geometry of a shape.
#[derive(Clone, Debug)]
pub(super) enum ShapeGeometry {
    /// A triangle mesh.
    Mesh(Arc<Mesh>),
    /// A whole sphere around the origin; `reversed` turns it inside out.
    Sphere { radius: f32, reversed: bool },
}

/// The material and media of a shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct SurfaceAttributes {
    pub(super) material: MaterialKey,
    /// The index of its area light.
    pub(super) area_light: Option<usize>,
    pub(super) alpha: Alpha,
    pub(super) media: [Arc<str>; 2],
}

/// The opacity of a shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    #[default]
    Whole,
    /// The bits of a number.
    Even(u32),
    /// The name of a texture.
    Texture(Arc<str>, u32, u32),
}

/// An instance of an object.
pub(super) struct ObjectInstance {
    pub(super) object: String,
    pub(super) matrices: Matrices,
    pub(super) at: Span,
}

impl Document {
    /// The medium on one side of a surface; an error if it is not defined.
    pub(super) fn medium(&self, name: &str, at: &Span) -> Result<Medium, FormatError> {
        if name.is_empty() {
            return Ok(Medium::default());
        }
        match self.media.get(name) {
            Some(medium) => Ok(medium.clone()),
            None => Err(unknown("medium", name, self.media.keys().map(|name| &**name), at)),
        }
    }
}
