//! The top level of a scene file.

use super::document::{Item, Table};
use super::include::{Part, gather};
use super::{overlay, specs};
use crate::FormatError;
use crate::reading::{Reading, Source, default_material};
use crate::text::whole_file;
use bilux_scene::presets::mentions_light;
use bilux_scene::{SceneBuilder, SceneError, Span};
use std::collections::HashMap;
use std::path::PathBuf;

/// The maximum number of names that an error about an unknown name lists.
pub(super) const MAX_NAMES: usize = 100;

/// More settings than any render has; each one is compared with all others.
const MAX_SETTINGS: usize = 1000;

/// The keys of the top level.
pub(super) const KEYS: [&str; 9] =
    ["include", "base", "render", "camera", "light", "material", "model", "replace", "change"];

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let parts = gather(reading, source)?;
    let base = match parts.iter().find_map(|part| part.root.find("base")) {
        Some(item) => overlay::base(reading, item, &parts)?,
        None => SceneBuilder::default(),
    };
    let mut native = Native {
        reading,
        scene: base,
        materials: HashMap::new(),
        default_material: None,
        brought: HashMap::new(),
    };
    for part in &parts {
        part.root.check_keys("a scene", KEYS.into_iter())?;
        native.settings(&part.root)?;
        native.names_of_materials(part)?;
    }
    for part in &parts {
        native.materials(part)?;
    }
    // Before the cameras of models: the first camera is the default.
    for part in &parts {
        native.lights_and_cameras(part)?;
    }
    let mut replaced = Vec::new();
    for part in &parts {
        for table in part.root.tables("model")? {
            native.model(table, part)?;
        }
        replaced.extend(part.root.tables("replace")?);
    }
    native.replace(&replaced)?;
    for part in &parts {
        native.change(part)?;
    }
    let mut scene = native.scene;
    // What a file says of light is all the light, be it black. A file that says nothing has a model without light.
    scene.describes_all_light |= !scene.environment_unspecified && mentions_light(&scene);
    if scene.objects.is_empty() && scene.lights.is_empty() {
        scene.warn("it has no [[model]], so there is nothing to render: add one", whole_file(source.name));
    }
    Ok(scene)
}

/// The state while a scene file is converted to a scene.
pub(super) struct Native<'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) scene: SceneBuilder,
    /// The index and location of each named material.
    materials: HashMap<String, (usize, Span)>,
    default_material: Option<usize>,
    /// The index of the first material of each model file.
    pub(super) brought: HashMap<PathBuf, usize>,
}

impl Native<'_, '_> {
    /// `[render]`: passed on unchanged.
    fn settings(&mut self, root: &Table) -> Result<(), FormatError> {
        for table in root.tables("render")? {
            for (key, at, item) in &table.entries {
                if self.scene.settings.0.len() >= MAX_SETTINGS {
                    let message = format!("there are more than {MAX_SETTINGS} settings: remove some");
                    return Err(SceneError::invalid(message, at).into());
                }
                let value = specs::plain_value(key, item)?;
                self.scene.settings.set_at(key, value, at.clone());
            }
        }
        Ok(())
    }

    /// Collects names first, since materials may refer to each other in any order.
    fn names_of_materials(&mut self, part: &Part) -> Result<(), FormatError> {
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

    fn materials(&mut self, part: &Part) -> Result<(), FormatError> {
        for table in part.root.tables("material")? {
            let spec = self.material(table, part)?;
            self.scene.add_material(spec);
        }
        Ok(())
    }

    fn lights_and_cameras(&mut self, part: &Part) -> Result<(), FormatError> {
        for table in part.root.tables("light")? {
            let light = self.light(table, part)?;
            self.scene.lights.push(light);
        }
        for table in part.root.tables("camera")? {
            let camera = self.camera(table, part)?;
            self.scene.cameras.push(camera);
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
