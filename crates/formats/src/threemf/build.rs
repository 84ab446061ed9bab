//! The scene: what is to be built, with the objects that it is made of.

use super::looks::Looks;
use super::mesh_data::MeshData;
use super::model::{Component, Content, Model, Object, Reference, Resource, Role};
use super::package::Package;
use super::part::PartReader;
use super::pictures::Pictures;
use super::pieces::{Piece, pieces};
use crate::FormatError;
use crate::oddities::Oddities;
use crate::reading::{Reading, Source};
use crate::sharing::share_trees;
use crate::sink::Sink;
use crate::text::whole_file;
use bilux_math::{DMat4, Transform};
use bilux_scene::{Object as Placed, SceneBuilder, Span};

/// Components within components, up to this depth.
const MAX_DEPTH: usize = 64;

/// Reads the package.
pub(super) fn scene(
    reading: &mut Reading,
    source: &Source,
    package: &Package,
) -> Result<SceneBuilder, FormatError> {
    let mut sink = Sink::for_bare_files();
    let model = parts(reading, package, &mut sink.oddities)?;
    if model.items.is_empty() {
        let message = "nothing in it is to be built: its build is empty";
        return Err(FormatError::malformed(message, whole_file(&package.named(&model.parts[0]))));
    }
    let pictures = Pictures::of(&model, package);
    let mut builder = Builder {
        reading,
        file: source.name,
        meshes: model.objects.iter().map(|_| None).collect(),
        looks: Looks::with(pictures),
        sink,
    };
    let model = builder.build(model)?;
    let Builder { mut sink, .. } = builder;
    if sink.scene.objects.is_empty() {
        let message = "nothing that it builds has a shape that can be shown";
        return Err(FormatError::malformed(message, whole_file(source.name)));
    }
    if !model.application.is_empty() {
        let what = format!("this file was written by {}", model.application);
        sink.oddities.remark(&what, || whole_file(source.name));
    }
    sink.scene.unit = model.unit;
    share_trees(&mut sink.scene);
    Ok(sink.finish())
}

/// Reads the main part, and those that it refers to.
fn parts(reading: &mut Reading, package: &Package, oddities: &mut Oddities) -> Result<Model, FormatError> {
    let main = package.model_part(reading, oddities)?;
    let mut model = Model { parts: vec![main], ..Model::default() };
    let mut next = 0;
    while let Some(part) = model.parts.get(next).cloned() {
        let Some(member) = package.member(&part).map(str::to_owned) else {
            let message =
                format!("the main part refers to the part '{part}', which the file does not contain");
            return Err(FormatError::malformed(message, whole_file(&package.named(&model.parts[0]))));
        };
        let (xml, file) = (package.xml(reading, &member)?, package.named(&member));
        PartReader { reading, model: &mut model, oddities, xml, part: next, file }.read()?;
        next += 1;
    }
    Ok(model)
}

struct Builder<'a, 'o> {
    reading: &'a mut Reading<'o>,
    file: &'a str,
    /// The pieces of each object, once it has been placed.
    meshes: Vec<Option<Vec<Piece>>>,
    looks: Looks,
    sink: Sink,
}

impl Builder<'_, '_> {
    /// Places all items. Returns the model without its meshes.
    fn build(&mut self, mut model: Model) -> Result<Model, FormatError> {
        for item in std::mem::take(&mut model.items) {
            if !item.is_printed {
                self.sink.oddities.not_shown("objects that are not to be printed", || item.at.clone());
                continue;
            }
            self.place(&mut model, item.object, item.transform, &item.at, 0)?;
        }
        Ok(model)
    }

    /// Adds an object and all within it.
    fn place(
        &mut self,
        model: &mut Model,
        object: Reference,
        transform: DMat4,
        at: &Span,
        depth: usize,
    ) -> Result<(), FormatError> {
        let Some(Resource::Object(number)) = model.find(object) else {
            let part = model.parts.get(object.part).map_or("", |part| part);
            let message = format!("there is no object {} in '{part}'", object.id);
            return Err(FormatError::malformed(message, at.clone()));
        };
        if depth > MAX_DEPTH {
            let message = format!("components are nested more than {MAX_DEPTH} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        // Objects that contain the same ones many times over grow fast, so each visit counts.
        self.reading.budget.take_bytes(size_of::<Placed>() as u64, self.file)?;
        match model.objects[number].role {
            Role::Printed => {}
            Role::Support => {
                self.sink.oddities.not_shown("supports", || model.objects[number].at.clone());
                return Ok(());
            }
            Role::Other if depth == 0 => {
                let message =
                    "an object of the type 'other' is to be built, but such objects are only for reference";
                return Err(FormatError::malformed(message, at.clone()));
            }
            Role::Other => {
                self.sink
                    .oddities
                    .not_shown("objects of the type 'other'", || model.objects[number].at.clone());
                return Ok(());
            }
        }
        if let Content::Components(components) = &mut model.objects[number].content {
            let components = std::mem::take(components);
            for Component { object, transform: inner, at } in &components {
                self.place(model, *object, transform * *inner, at, depth + 1)?;
            }
            model.objects[number].content = Content::Components(components);
            return Ok(());
        }
        self.place_mesh(model, number, transform, at)
    }

    fn place_mesh(
        &mut self,
        model: &mut Model,
        number: usize,
        transform: DMat4,
        at: &Span,
    ) -> Result<(), FormatError> {
        let Some(place) = Transform::from_matrix(transform) else {
            self.sink.oddities.note("a transform flattens an object, which is left out", || at.clone());
            return Ok(());
        };
        if self.meshes[number].is_none() {
            let data = match &mut model.objects[number].content {
                Content::Mesh(data) => std::mem::take(&mut **data),
                Content::Components(_) => MeshData::default(),
            };
            let Object { property, name, .. } = &model.objects[number];
            self.meshes[number] = Some(pieces(self.reading, self.file, model, data, *property, name)?);
        }
        for piece in self.meshes[number].clone().unwrap_or_default() {
            self.reading.budget.take_bytes((2 * size_of::<Placed>()) as u64, self.file)?;
            let material = self.looks.material(piece.look, model, self.reading, &mut self.sink)?;
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
