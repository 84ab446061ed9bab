//! Parts of a scene so far.

use super::distant::DistantSource;
use super::look::Looks;
use super::modifiers::Modifiers;
use super::polygons::Polygons;
use super::round::RoundShapes;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_math::{DVec3, Vec3};
use bilux_scene::{Object, Span, Spec, Texture};
use std::sync::Arc;

/// The parts of a scene, and what making them needs.
pub(super) struct World<'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) diagnostics: Diagnostics,
    pub(super) modifiers: Modifiers,
    pub(super) looks: Looks,
    pub(super) materials: Vec<Spec>,
    pub(super) textures: Vec<Arc<Texture>>,
    pub(super) polygons: Polygons,
    pub(super) round: RoundShapes,
    pub(super) objects: Vec<Object>,
    pub(super) lights: Vec<Spec>,
    pub(super) sources: Vec<DistantSource>,
    /// Whether some surface emits light.
    pub(super) has_glow: bool,
}

impl<'o, 'r> World<'o, 'r> {
    pub(super) fn new(reading: &'r mut Reading<'o>) -> World<'o, 'r> {
        World {
            reading,
            diagnostics: Diagnostics::default(),
            modifiers: Modifiers::default(),
            looks: Looks::default(),
            materials: Vec::new(),
            textures: Vec::new(),
            polygons: Polygons::default(),
            round: RoundShapes::default(),
            objects: Vec::new(),
            lights: Vec::new(),
            sources: Vec::new(),
            has_glow: false,
        }
    }

    /// Adds a material.
    pub(super) fn material(&mut self, spec: Spec, at: &Span) -> Result<usize, FormatError> {
        self.reading.budget.take_bytes(size_of::<[Spec; 4]>() as u64, &at.file)?;
        self.materials.push(Spec { span: at.clone(), ..spec });
        Ok(self.materials.len() - 1)
    }

    /// Adds a light.
    pub(super) fn light(&mut self, spec: Spec, at: &Span) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(size_of::<[Spec; 4]>() as u64, &at.file)?;
        self.lights.push(Spec { span: at.clone(), ..spec });
        Ok(())
    }

    /// Adds an object.
    pub(super) fn object(&mut self, object: Object, at: &Span) -> Result<(), FormatError> {
        let bytes = size_of::<[Object; 2]>() + object.name.len() + object.motion.heap_bytes();
        self.reading.budget.take_bytes(bytes as u64, &at.file)?;
        self.objects.push(object);
        Ok(())
    }

    /// A point of a file, in place, with y up.
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        turned(p) - self.reading.origin
    }
}

/// A direction of a file with y up: north, which is y there, is -z here.
pub(super) fn turned(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}

/// Direction of a file with y up, as 32-bit floats.
pub(super) fn turned_f32(v: DVec3) -> Vec3 {
    turned(v).as_vec3()
}
