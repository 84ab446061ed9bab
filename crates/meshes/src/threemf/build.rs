//! The scene: what is to be built, with the objects that it is made of.

use super::looks::{Look, Looks};
use super::mesh_data::MeshData;
use super::model::{Content, Model, Object, Reference, Resource, Role};
use super::package::Package;
use super::part::PartReader;
use super::pictures::Pictures;
use super::pieces::{Piece, Whole, pieces};
use super::slicers::{ObjectSettings, project};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::authors::program;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_math::{DMat4, Transform};
use bilux_scene::{Object as Placed, SceneBuilder, Span};
use std::collections::HashMap;

/// Components within components, up to this depth.
const MAX_DEPTH: usize = 64;

/// Reads the package.
pub(super) fn scene(
    reading: &mut Reading,
    source: &Source,
    package: &Package,
) -> Result<SceneBuilder, FormatError> {
    let mut sink = Sink::for_bare_files();
    let model = parts(reading, package, &mut sink.diagnostics)?;
    if model.items.is_empty() {
        let message = "nothing in it is to be built: its build is empty";
        return Err(FormatError::malformed(message, whole_file(&package.named(&model.parts[0]))));
    }
    let pictures = Pictures::of(&model, package);
    let mut project = project(package, reading)?;
    let filaments = std::mem::take(&mut project.filaments);
    let mut builder = Builder {
        reading,
        file: source.name,
        meshes: model.objects.iter().map(|_| None).collect(),
        has_filaments: !filaments.is_empty(),
        looks: Looks::with(pictures, filaments),
        settings: project.objects,
        sink,
    };
    let model = builder.build(model)?;
    let Builder { mut sink, .. } = builder;
    if sink.scene.objects.is_empty() {
        let message = "nothing that it builds has a shape that can be shown";
        return Err(FormatError::malformed(message, whole_file(source.name)));
    }
    sink.scene.written_by = program(&model.application);
    sink.scene.unit = model.unit;
    share_trees(&mut sink.scene);
    Ok(sink.finish())
}

/// Reads the main part, and those that it refers to.
fn parts(
    reading: &mut Reading,
    package: &Package,
    diagnostics: &mut Diagnostics,
) -> Result<Model, FormatError> {
    let main = package.model_part(reading, diagnostics)?;
    let mut model = Model { parts: vec![main], ..Model::default() };
    let mut next = 0;
    while let Some(part) = model.parts.get(next).cloned() {
        let Some(member) = package.member(&part).map(str::to_owned) else {
            let message =
                format!("the main part refers to the part '{part}', which the file does not contain");
            return Err(FormatError::malformed(message, whole_file(&package.named(&model.parts[0]))));
        };
        let (xml, file) = (package.xml(reading, &member)?, package.named(&member));
        PartReader { reading, model: &mut model, diagnostics, xml, part: next, file }.read()?;
        next += 1;
    }
    Ok(model)
}

/// Placement of an object, and the extruder that prints it.
#[derive(Clone, Copy)]
struct Place {
    transform: DMat4,
    extruder: u32,
    /// The number of objects that it is within.
    depth: usize,
}

struct Builder<'a, 'o> {
    reading: &'a mut Reading<'o>,
    file: &'a str,
    /// The pieces of each object, once it has been placed.
    meshes: Vec<Option<Vec<Piece>>>,
    looks: Looks,
    has_filaments: bool,
    /// Settings of a slicer for objects of the main part.
    settings: HashMap<u32, ObjectSettings>,
    sink: Sink,
}

impl Builder<'_, '_> {
    /// Places all items. Returns the model without its meshes.
    fn build(&mut self, mut model: Model) -> Result<Model, FormatError> {
        for item in std::mem::take(&mut model.items) {
            if !item.is_printed {
                self.sink.diagnostics.not_shown("objects that are not to be printed", || item.at.clone());
                continue;
            }
            let place = Place { transform: item.transform, extruder: 1, depth: 0 };
            self.place(&mut model, item.object, place, &item.at)?;
        }
        Ok(model)
    }

    /// Adds an object and all within it.
    fn place(
        &mut self,
        model: &mut Model,
        object: Reference,
        place: Place,
        at: &Span,
    ) -> Result<(), FormatError> {
        let Some(Resource::Object(number)) = model.find(object) else {
            let part = model.parts.get(object.part).map_or("", |part| part);
            let message = format!("there is no object {} in '{part}'", object.id);
            return Err(FormatError::malformed(message, at.clone()));
        };
        if place.depth > MAX_DEPTH {
            let message = format!("components are nested more than {MAX_DEPTH} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        // Objects that contain the same ones many times over grow fast, so each visit counts.
        self.reading.budget.take_bytes(size_of::<Placed>() as u64, self.file)?;
        match model.objects[number].role {
            Role::Printed => {}
            Role::Support => {
                self.sink.diagnostics.not_shown("supports", || model.objects[number].at.clone());
                return Ok(());
            }
            Role::Modifier => {
                self.sink.diagnostics.not_shown("modifiers", || model.objects[number].at.clone());
                return Ok(());
            }
            Role::Other if place.depth == 0 => {
                let message =
                    "an object of the type 'other' is to be built, but such objects are only for reference";
                return Err(FormatError::malformed(message, at.clone()));
            }
            Role::Other => {
                self.sink
                    .diagnostics
                    .not_shown("objects of the type 'other'", || model.objects[number].at.clone());
                return Ok(());
            }
        }
        self.place_content(model, number, object, place, at)
    }

    fn place_content(
        &mut self,
        model: &mut Model,
        number: usize,
        object: Reference,
        place: Place,
        at: &Span,
    ) -> Result<(), FormatError> {
        let settings = self.settings.get(&object.id).filter(|_| object.part == 0);
        let extruder = settings.and_then(|settings| settings.extruder).unwrap_or(place.extruder);
        let Content::Components(components) = &mut model.objects[number].content else {
            // An object of a single part is that part.
            let alone = settings.map(|settings| &settings.parts).filter(|parts| parts.len() == 1);
            let own = alone.and_then(|parts| parts.values().next()).and_then(|part| part.extruder);
            let place = Place { extruder: own.unwrap_or(extruder), ..place };
            return self.place_mesh(model, number, object, place, at);
        };
        let components = std::mem::take(components);
        for component in &components {
            let settings = self.settings.get(&object.id).filter(|_| object.part == 0);
            let part = settings.and_then(|settings| settings.parts.get(&component.object.id).copied());
            let part = part.unwrap_or_default();
            if let Some(what) = part.unprinted {
                self.sink.diagnostics.not_shown(what, || component.at.clone());
                continue;
            }
            let inner = Place {
                transform: place.transform * component.transform,
                extruder: part.extruder.unwrap_or(extruder),
                depth: place.depth + 1,
            };
            self.place(model, component.object, inner, &component.at)?;
        }
        model.objects[number].content = Content::Components(components);
        Ok(())
    }

    fn place_mesh(
        &mut self,
        model: &mut Model,
        number: usize,
        object: Reference,
        Place { transform, extruder, .. }: Place,
        at: &Span,
    ) -> Result<(), FormatError> {
        let Some(place) = Transform::from_matrix(transform) else {
            self.sink.diagnostics.note("a transform flattens an object, which is left out", || at.clone());
            return Ok(());
        };
        if self.meshes[number].is_none() {
            let data = match &mut model.objects[number].content {
                Content::Mesh(data) => std::mem::take(&mut **data),
                Content::Components(_) => MeshData::default(),
            };
            let Object { property, name, .. } = &model.objects[number];
            let whole = Whole {
                model,
                name,
                property: *property,
                has_filaments: self.has_filaments,
                settings: self.settings.get(&object.id).filter(|_| object.part == 0),
            };
            let made = pieces(self.reading, self.file, &whole, data, &mut self.sink.diagnostics)?;
            self.meshes[number] = Some(made);
        }
        for piece in self.meshes[number].clone().unwrap_or_default() {
            self.reading.budget.take_bytes((2 * size_of::<Placed>()) as u64, self.file)?;
            let look = match piece.look {
                Look::Filament(0) => Look::Filament(extruder),
                look => look,
            };
            let material = self.looks.material(look, model, self.reading, &mut self.sink)?;
            let name = &model.objects[number].name;
            let mut placed = Placed::new(name, piece.mesh, material);
            if !place.is_identity() {
                placed = placed.placed(place);
            }
            self.sink.scene.objects.push(placed);
        }
        Ok(())
    }
}
