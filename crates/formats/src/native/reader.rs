//! State that all parts of a scene file share while it is read.

use super::document::Item;
use super::include::Part;
use bilux_import::FormatError;
use bilux_import::geometry::displacement::{Displacement, Moved};
use bilux_import::input::reading::{Reading, default_material};
use bilux_scene::{SceneBuilder, SceneError, Span};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The maximum number of names that an error about an unknown name lists.
pub(super) const MAX_NAMES: usize = 100;

/// The state while a scene file is converted to a scene.
pub(super) struct Native<'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) scene: SceneBuilder,
    /// The index and location of each named material.
    materials: HashMap<String, (usize, Span)>,
    default_material: Option<usize>,
    /// The index of the first material of each model file.
    pub(super) brought: HashMap<PathBuf, usize>,
    /// Generated models by their kind and parameters.
    pub(super) generated: HashMap<String, Arc<SceneBuilder>>,
    /// The maps of displaced objects: those of files of models are done when these are read.
    pub(super) displaced: Vec<(Moved, Displacement)>,
}

impl<'o, 'r> Native<'o, 'r> {
    /// Nothing yet, upon a scene that may have something.
    pub(super) fn new(reading: &'r mut Reading<'o>, scene: SceneBuilder) -> Native<'o, 'r> {
        let (materials, brought, generated) = Default::default();
        Native {
            reading,
            scene,
            materials,
            default_material: None,
            brought,
            generated,
            displaced: Vec::new(),
        }
    }

    /// Collects names first, since materials may refer to each other in any order.
    pub(super) fn names_of_materials(&mut self, part: &Part) -> Result<(), FormatError> {
        for table in part.root.tables("material")? {
            let (name, at) = (table.text("name")?.unwrap_or_default(), table.at.clone());
            if name.is_empty() {
                let what = "name (what models call the material)".to_owned();
                return Err(SceneError::Missing { what, at }.into());
            }
            let index = self.materials.len();
            if let Some((_, first)) = self.materials.insert(name.to_owned(), (index, at.clone())) {
                let message =
                    format!("there is already a material '{name}', at {first}: give this one another name");
                return Err(SceneError::invalid(message, &at).into());
            }
        }
        Ok(())
    }

    /// The index of the material with this name.
    pub(super) fn material_named(&self, item: &Item) -> Result<usize, FormatError> {
        let name = item.text("material")?;
        let known = || self.materials.keys().map(String::as_str).take(MAX_NAMES);
        match self.materials.get(name) {
            Some(&(index, _)) => Ok(index),
            None => Err(SceneError::unknown("material", name, known(), &item.at).into()),
        }
    }

    /// The number of materials, the first ones, that belong to the scene file itself.
    pub(super) fn own_materials(&self) -> usize {
        self.materials.len()
    }

    /// The material of models that neither select nor contain one.
    pub(super) fn default_material(&mut self) -> usize {
        let scene = &mut self.scene;
        *self.default_material.get_or_insert_with(|| scene.add_material(default_material()))
    }
}
