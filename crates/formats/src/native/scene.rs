//! The top level of a scene file.

use super::document::Table;
use super::include::{Part, gather};
use super::overlay;
use super::plain::plain_value;
use super::reader::Native;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::presets::mentions_light;
use bilux_scene::{SceneBuilder, SceneError};

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
    let mut native = Native::new(reading, base);
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
    native.reading.displacements.append(&mut native.displaced);
    let mut scene = native.scene;
    // What a file says of light is all the light, be it black. A file that says nothing has a model without light.
    scene.describes_all_light |= !scene.environment_unspecified && mentions_light(&scene);
    if scene.objects.is_empty() && scene.lights.is_empty() {
        scene.warn("it has no [[model]], so there is nothing to render: add one", whole_file(source.name));
    }
    Ok(scene)
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
                let value = plain_value(key, item)?;
                self.scene.settings.set_at(key, value, at.clone());
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
}
