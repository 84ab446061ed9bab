//! `[[model]]`: meshes from a file, a shape or a generator, placed in the scene.

use super::document::{Item, Table, TomlValue};
use super::include::Part;
use super::place::{self, motion};
use super::plain::{missing, plain_value};
use super::reader::{MAX_NAMES, Native};
use super::shapes::SHAPES;
use crate::FORMATS;
use bilux_gallery::GENERATORS;
use bilux_import::FormatError;
use bilux_import::geometry::displacement::Moved;
use bilux_import::tables::files::read_file;
use bilux_math::registry::{Entry, ParameterKind};
use bilux_math::{DMat4, Motion, Transform};
use bilux_scene::{Mesh, Object, Reader, SceneBuilder, SceneError, Spec, Value, Visibility};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Memory that making a generated mesh takes, in sizes of that mesh.
const MAKING: u64 = 3;

/// Bytes of a mesh for each of its triangles, with the half of a vertex that it has.
const TRIANGLE: u64 = 24;

/// The keys of every model except those that place it; exactly one of the first three is its source.
pub(super) const KEYS: [&str; 11] = [
    "file",
    "shape",
    "generate",
    "name",
    "material",
    "materials",
    "instance",
    "category",
    "visibility",
    "displacement",
    "with",
];

impl Native<'_, '_> {
    pub(super) fn model(&mut self, table: &Table, part: &Part) -> Result<(), FormatError> {
        let sources: Vec<(&str, &Item)> =
            KEYS[..3].iter().filter_map(|key| Some((*key, table.find(key)?))).collect();
        let (model, origin) = match sources.as_slice() {
            [("file", item)] => {
                let path = self.path_of_model(table, item, part)?;
                (self.file_model(&path, table, item)?, Some(path))
            }
            [("shape", item)] => (self.shape_model(table, item)?, None),
            [("generate", item)] => (self.generated_model(table, item)?, None),
            _ => return Err(missing("one of file, shape or generate (the source of the model)", table)),
        };
        let first = self.scene.objects.len();
        let displacement = self.displacement(table, part)?;
        self.place(table, &model, origin)?;
        if let Some(map) = displacement {
            self.displaced
                .extend((first..self.scene.objects.len()).map(|object| (Moved::Object(object), map.clone())));
        }
        self.add_requested_parts(table, &model)
    }

    /// Adds the objects of a model; one without materials gets the plain one.
    fn place(
        &mut self,
        table: &Table,
        model: &SceneBuilder,
        origin: Option<PathBuf>,
    ) -> Result<(), FormatError> {
        let motion = motion(table)?;
        let instanced = table.switch("instance")?;
        let (name, category) = (table.text("name")?, table.text("category")?);
        let visibility = visibility(table)?;
        let given = table.find("material").map(|item| self.material_named(item)).transpose()?;
        let renamed = self.renamed_materials(table, model)?;
        // The index of the model's first material in this scene, once one of its materials is needed.
        let mut first = origin.as_ref().and_then(|path| self.brought.get(path).copied());
        for object in &model.objects {
            self.reading.budget.take::<[Object; 2]>(1, &table.at.file)?;
            let mut placed = Object { motion: object.motion.then(&motion), ..object.clone() };
            self.reading.budget.take_bytes(placed.motion.heap_bytes() as u64, &table.at.file)?;
            placed.instanced |= instanced;
            placed.visibility = visibility.unwrap_or(placed.visibility);
            if let Some(category) = category {
                placed.category = category.to_owned();
            }
            placed.material = match (renamed.get(object.material).copied().flatten(), given) {
                (Some(index), _) | (None, Some(index)) => index,
                (None, None) if model.materials.is_empty() => self.default_material(),
                (None, None) => *first.get_or_insert_with(|| self.add_materials_of(model)) + object.material,
            };
            if let Some(name) = name {
                let part = &placed.name;
                let several = model.objects.len() > 1 && !part.is_empty();
                placed.name = if several { format!("{name}/{part}") } else { name.to_owned() };
            }
            self.scene.objects.push(placed);
        }
        self.brought.extend(origin.zip(first));
        Ok(())
    }

    /// `materials = { NAME_IN_THE_FILE = "NAME_HERE" }`: for each material of the model its replacement, if any.
    fn renamed_materials(
        &self,
        table: &Table,
        model: &SceneBuilder,
    ) -> Result<Vec<Option<usize>>, FormatError> {
        let mut renamed = vec![None; model.materials.len()];
        let Some(item) = table.find("materials") else { return Ok(renamed) };
        let TomlValue::Table(names) = &item.node else {
            return Err(item.wrong("materials", "a table, as in { paint = \"gold\" }"));
        };
        let mut indices: HashMap<&str, Vec<usize>> = HashMap::new();
        for (i, spec) in model.materials.iter().enumerate() {
            indices.entry(&spec.name).or_default().push(i);
        }
        for (theirs, at, ours) in &names.entries {
            let index = self.material_named(ours)?;
            let Some(same) = indices.get(theirs.as_str()) else {
                let known = model.materials.iter().map(|spec| spec.name.as_str()).take(MAX_NAMES);
                return Err(SceneError::unknown("material of this model", theirs, known, at).into());
            };
            same.iter().for_each(|&slot| renamed[slot] = Some(index));
        }
        Ok(renamed)
    }

    fn path_of_model(&self, table: &Table, item: &Item, part: &Part) -> Result<PathBuf, FormatError> {
        table.check_keys("a model", KEYS.into_iter().chain(place::KEYS))?;
        let name = item.text("file")?;
        let path = self.reading.locator.locate(part.folder.as_deref(), name, &item.at)?;
        if self.reading.open.contains(&path) {
            let message =
                format!("'{name}' contains itself, directly or through other files: remove it here");
            return Err(FormatError::malformed(message, item.at.clone()));
        }
        Ok(path)
    }

    /// The scene of a file, which is read only once.
    fn file_model(
        &mut self,
        path: &Path,
        table: &Table,
        item: &Item,
    ) -> Result<Arc<SceneBuilder>, FormatError> {
        if let Some(model) = self.reading.models.get(path) {
            return Ok(model.clone());
        }
        let name = item.text("file")?;
        let extension =
            Path::new(name).extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(row) = FORMATS.named(&extension).filter(|row| row.reads()) else {
            return Err(FORMATS.unknown(Path::new(name), "read", |row| row.reads()));
        };
        self.reading.enter(path, &item.at)?;
        let shown = Path::new(&*table.at.file).with_file_name(name).display().to_string();
        let mut model = read_file(FORMATS, Some(row), self.reading, path, &shown.into())?;
        self.reading.leave();
        // A placed model keeps the coordinates of its file.
        let origin = std::mem::take(&mut model.origin);
        if let Some(origin) =
            Transform::from_matrix(DMat4::from_translation(origin)).filter(|t| !t.is_identity())
        {
            let origin = Motion::still(origin);
            model.objects.iter_mut().for_each(|object| object.motion = object.motion.then(&origin));
        }
        self.scene.warnings.append(&mut model.warnings);
        self.scene.notes.append(&mut model.notes);
        self.scene.inventory.animations.extend(model.inventory.animations.iter().cloned());
        let model = Arc::new(model);
        self.reading.models.insert(path.to_owned(), model.clone());
        Ok(model)
    }

    fn shape_model(&mut self, table: &Table, item: &Item) -> Result<Arc<SceneBuilder>, FormatError> {
        let kind = item.text("shape")?;
        let Some(row) = SHAPES.iter().find(|row| row.entry.name == kind) else {
            let names = SHAPES.iter().map(|row| row.entry.name);
            return Err(SceneError::unknown("shape", kind, names, &item.at).into());
        };
        let spec = self.parameters(table, kind, &row.entry)?;
        let reader = Reader::new(&spec, &row.entry)?;
        let pieces = row.entry.parameters.iter().filter(|p| matches!(p.kind, ParameterKind::Integer { .. }));
        let vertices: i64 = pieces.map(|p| reader.integer(p.name)).product();
        self.reading.budget.take_bytes(vertices as u64 * 64, &table.at.file)?;
        let mesh = (row.build)(&reader);
        let mut model = SceneBuilder::default();
        model.objects.push(Object::new(kind, Arc::new(mesh), 0));
        Ok(Arc::new(model))
    }

    fn generated_model(&mut self, table: &Table, item: &Item) -> Result<Arc<SceneBuilder>, FormatError> {
        let kind = item.text("generate")?;
        let Some(row) = GENERATORS.iter().find(|row| row.entry.name == kind) else {
            let names = GENERATORS.iter().map(|row| row.entry.name);
            return Err(SceneError::unknown("built-in scene", kind, names, &item.at).into());
        };
        let spec = self.parameters(table, kind, &row.entry)?;
        let key =
            format!("{kind} {:?}", spec.parameters.0.iter().map(|(k, v, _)| (k, v)).collect::<Vec<_>>());
        if let Some(known) = self.generated.get(&key) {
            return Ok(known.clone());
        }
        let reader = Reader::new(&spec, &row.entry)?;
        // Making it takes more than it takes, and time: a file could ask for many.
        let mut making = MAKING * TRIANGLE * (row.triangles)(&reader);
        self.reading.budget.take_bytes(making, &table.at.file)?;
        let model = (row.generate)(&reader)?;
        let mut last: Option<&Arc<Mesh>> = None;
        for object in &model.objects {
            if !last.is_some_and(|mesh| Arc::ptr_eq(mesh, &object.mesh)) {
                self.charge_mesh(&object.mesh, table)?;
                let made = MAKING * object.mesh.size();
                self.reading.budget.take_bytes(made.saturating_sub(making), &table.at.file)?;
                making = making.saturating_sub(made);
            }
            last = Some(&object.mesh);
        }
        let model = Arc::new(model);
        self.generated.insert(key, model.clone());
        Ok(model)
    }

    /// The keys of a model that are parameters of its shape or generator.
    fn parameters(&self, table: &Table, kind: &str, entry: &Entry) -> Result<Spec, FormatError> {
        let structural = || KEYS.into_iter().chain(place::KEYS);
        let names = entry.parameters.iter().map(|p| p.name);
        table.check_keys(&format!("a model made of '{kind}'"), structural().chain(names))?;
        let mut spec = Spec { span: table.at.clone(), ..Spec::new("", kind) };
        for (key, at, item) in table.entries.iter().filter(|(key, ..)| !structural().any(|k| k == key)) {
            spec.parameters.set_at(key, plain_value(key, item)?, at.clone());
        }
        Ok(spec)
    }

    fn charge_mesh(&mut self, mesh: &Mesh, table: &Table) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(mesh.size(), &table.at.file)
    }

    /// `with = ["lights", "cameras"]`: the other parts of a model's scene to add.
    fn add_requested_parts(&mut self, table: &Table, model: &SceneBuilder) -> Result<(), FormatError> {
        let Some(item) = table.find("with") else { return Ok(()) };
        if place::KEYS.iter().any(|key| table.find(key).is_some()) {
            let message = "lights and cameras are not moved, so 'with' cannot be combined with a transform";
            return Err(SceneError::invalid(message, &item.at).into());
        }
        for word in item.list("with", "a list of \"lights\" and \"cameras\"")? {
            match word.text("with")? {
                "lights" => {
                    let lights: Vec<Spec> = model.lights.iter().map(|light| self.moved(light, 0)).collect();
                    if lights.iter().any(|light| light.parameters.0.iter().any(|(_, v, _)| is_texture(v))) {
                        self.scene.textures.extend(model.textures.iter().cloned());
                    }
                    self.scene.lights.extend(lights);
                }
                "cameras" => self.scene.cameras.extend(model.cameras.iter().cloned()),
                other => {
                    let known = ["lights", "cameras"];
                    return Err(SceneError::unknown("part of a scene", other, known, &word.at).into());
                }
            }
        }
        Ok(())
    }
}

/// Which rays see a model, if the table says it.
fn visibility(table: &Table) -> Result<Option<Visibility>, FormatError> {
    let Some(item) = table.find("visibility") else { return Ok(None) };
    let word = item.text("visibility")?;
    let names = Visibility::ALL.map(Visibility::name);
    let found = Visibility::named(word);
    found.map(Some).ok_or_else(|| SceneError::unknown("visibility", word, names, &item.at).into())
}

fn is_texture(value: &Value) -> bool {
    matches!(value, Value::Texture(_))
}
