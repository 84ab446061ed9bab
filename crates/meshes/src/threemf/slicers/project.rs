//! Project of a slicer.

use crate::threemf::colour::Colour;
use std::collections::HashMap;

/// The project of a slicer.
#[derive(Default)]
pub(in crate::threemf) struct Project {
    /// The colours of filaments; the first is that of extruder 1.
    pub(in crate::threemf) filaments: Vec<Option<Colour>>,
    /// By the ids of objects of the main part.
    pub(in crate::threemf) objects: HashMap<u32, ObjectSettings>,
}

/// Settings of an object in a project.
#[derive(Default)]
pub(in crate::threemf) struct ObjectSettings {
    pub(in crate::threemf) extruder: Option<u32>,
    /// Ranges of triangles (PrusaSlicer).
    pub(in crate::threemf) volumes: Vec<Volume>,
    /// By the ids of components (Bambu Studio, OrcaSlicer).
    pub(in crate::threemf) parts: HashMap<u32, PartSettings>,
}

/// A part of an object's mesh.
pub(in crate::threemf) struct Volume {
    /// The first and the last triangle.
    pub(in crate::threemf) first: u32,
    pub(in crate::threemf) last: u32,
    pub(in crate::threemf) settings: PartSettings,
}

/// Settings of a part in a project.
#[derive(Clone, Copy, Default)]
pub(in crate::threemf) struct PartSettings {
    pub(in crate::threemf) extruder: Option<u32>,
    /// Kind of the part, if it is not printed.
    pub(in crate::threemf) unprinted: Option<&'static str>,
}

impl ObjectSettings {
    /// The settings of a triangle of the object's own mesh.
    pub(in crate::threemf) fn of_triangle(&self, triangle: u32) -> PartSettings {
        let is_in = |volume: &&Volume| (volume.first..=volume.last).contains(&triangle);
        self.volumes.iter().find(is_in).map(|volume| volume.settings).unwrap_or_default()
    }
}
