//! The scene of a file.

use super::part21::{Table, parse};
use super::pieces::{Pieces, pieces};
use super::structure::placements::{Placed, placed};
use super::structure::styles::{Style, Styles};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::authors::program;
use bilux_import::input::reading::{Reading, Source, plain_material};
use bilux_import::input::sink::Sink;
use bilux_math::Transform;
use bilux_scene::{Object, SceneBuilder, Spec};
use std::collections::{HashMap, HashSet};

/// Extensions of STEP files.
pub(super) const EXTENSIONS: &[&str] = &["step", "stp", "p21"];

pub(super) fn scene(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut table = parse(reading, source.bytes, source.name)?;
    let mut sink = Sink::for_bare_files();
    sink.diagnostics = table.take_faults();
    let styles = Styles::of_file(&table);
    let (shapes, unit) = placed(reading, &table, &styles, &mut sink.diagnostics)?;
    let mut builder =
        Builder { table: &table, styles: &styles, sink, made: HashMap::new(), looks: HashMap::new() };
    for shape in &shapes {
        builder.add(reading, shape)?;
    }
    let mut sink = builder.finished();
    let elsewhere = parts_in_other_files(&table);
    if sink.scene.objects.is_empty() {
        let message = nothing_to_show(&table, &elsewhere);
        return Err(FormatError::malformed(message, whole_file(source.name)));
    }
    if let [(_, id), ..] = elsewhere[..] {
        let what = format!("parts in other files ({})", listed(&elsewhere));
        sink.diagnostics.not_shown(&what, || table.span(id));
    }
    sink.scene.unit = unit;
    sink.scene.written_by = written_by(&table);
    share_trees(&mut sink.scene);
    Ok(sink.finish())
}

/// Why there is nothing to show, and what to do.
fn nothing_to_show(table: &Table, elsewhere: &[(String, u64)]) -> String {
    if !table.is_whole {
        return "it has no end (END-ISO-10303-21;): it was cut off before all that can be shown; get the file again".to_owned();
    }
    if elsewhere.is_empty() {
        return "it has no solid or surface that can be shown: export the part as an AP214 or AP242 solid"
            .to_owned();
    }
    format!(
        "its parts are in other files ({}), which are not read: convert these, or export the assembly into a single file",
        listed(elsewhere)
    )
}

/// The most names of other files that a message lists.
const LISTED: usize = 8;

fn listed(files: &[(String, u64)]) -> String {
    let names: Vec<String> = files.iter().take(LISTED).map(|(name, _)| format!("'{name}'")).collect();
    let more = files.len().saturating_sub(LISTED);
    let end = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.join(", ") + &end
}

/// The files of parts that this one refers to, each once, and where.
fn parts_in_other_files(table: &Table) -> Vec<(String, u64)> {
    let is_step = |name: &String| {
        let ending = name.rsplit('.').next().unwrap_or_default();
        EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(ending))
    };
    let (mut found, mut known) = (Vec::new(), HashSet::new());
    // The name of a file is that of its document, or an identification that is assigned to it.
    for kind in ["DOCUMENT_FILE", "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT"] {
        for (id, values) in table.all(kind) {
            let Some(name) = [values.text(0), values.text(1)].into_iter().find(is_step) else { continue };
            if known.insert(name.clone()) {
                found.push((name, id));
            }
        }
    }
    found
}

/// The program that wrote the file: the originating system, or else the preprocessor.
fn written_by(table: &Table) -> String {
    let Some(name) = table.header("FILE_NAME") else { return String::new() };
    let texts = [name.text(5), name.text(4)];
    texts
        .iter()
        .map(|text| program(text))
        // Programs that do not say what they are write this.
        .find(|text| text.chars().any(char::is_alphabetic) && !text.eq_ignore_ascii_case("unknown"))
        .unwrap_or_default()
}

struct Builder<'a, 'b> {
    table: &'a Table<'b>,
    styles: &'a Styles,
    sink: Sink,
    /// The meshes of shapes that have been placed.
    made: HashMap<u64, Pieces>,
    looks: HashMap<Option<[u32; 4]>, usize>,
}

impl Builder<'_, '_> {
    fn add(&mut self, reading: &mut Reading, shape: &Placed) -> Result<(), FormatError> {
        let Some(place) = Transform::from_matrix(shape.place) else {
            let at = || self.table.span(shape.item);
            self.sink.diagnostics.note("a transform flattens a part, which is left out", at);
            return Ok(());
        };
        if !self.made.contains_key(&shape.item) {
            let made = pieces(reading, self.table, self.styles, shape)?;
            self.made.insert(shape.item, made);
        }
        for piece in self.made[&shape.item].pieces.clone() {
            reading.budget.take_bytes((2 * size_of::<Object>()) as u64, &self.table.file())?;
            let material = self.material(reading, piece.style.or(shape.style))?;
            let mut object = Object::new(&shape.name, piece.mesh, material);
            if !place.is_identity() {
                object = object.placed(place);
            }
            self.sink.scene.objects.push(object);
        }
        Ok(())
    }

    fn material(&mut self, reading: &mut Reading, style: Option<Style>) -> Result<usize, FormatError> {
        let key = style.map(|style| style.key());
        if let Some(&known) = self.looks.get(&key) {
            return Ok(known);
        }
        let spec = match style {
            None => plain_material(false, false),
            Some(Style { colour, opacity }) => {
                let spec = Spec::new("colour", "principled").with("base_color", colour);
                // Nobody designs what cannot be seen: programs that do not use the number write 1.
                if opacity > 0.0 && opacity < 1.0 { spec.with("opacity", opacity) } else { spec }
            }
        };
        reading.budget.take_bytes(size_of::<[Spec; 4]>() as u64, "materials")?;
        let index = self.sink.scene.add_material(spec);
        self.looks.insert(key, index);
        Ok(index)
    }

    /// Says how many faces are missing.
    fn finished(mut self) -> Sink {
        let lost: usize = self.made.values().map(|made| made.lost).sum();
        let faces: usize = self.made.values().map(|made| made.faces).sum();
        if lost > 0 {
            let what = format!(
                "{lost} of {faces} faces, whose boundary does not fit their surface or which are malformed"
            );
            self.sink.diagnostics.not_shown(&what, || whole_file(&self.table.file()));
        }
        self.sink
    }
}
