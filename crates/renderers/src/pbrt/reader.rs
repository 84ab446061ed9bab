//! Converts files to a scene: it first reads all directives and builds meshes, then resolves names.

use super::directives;
use super::finish::finish;
use super::lexer::Lexer;
use super::loader::Loader;
use super::parser::Parser;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::includes::Includes;
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::SceneBuilder;
use std::path::Path;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let working_folder = reading.options.working_folder.clone();
    let before = std::mem::replace(&mut reading.locator.working_folder, working_folder);
    let scene = read_whole(reading, source);
    reading.locator.working_folder = before;
    scene
}

fn read_whole(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let own = source.folder.zip(Path::new(&**source.name).file_name());
    let own = own.and_then(|(folder, file)| std::fs::canonicalize(folder.join(file)).ok());
    let loader = Loader::new(reading, source.folder.map(Path::to_owned));
    let mut parser = Parser::new(Includes::of(own), loader);
    directives::run(&mut parser, &mut Lexer::new(source.name, source.bytes))?;
    let Parser { document, graphics, shapes, mut loader, .. } = parser;
    if let Some((_, at, _)) = graphics.pushed.last() {
        let message = "what begins here is not closed before the file ends: add AttributeEnd or ObjectEnd";
        return Err(FormatError::malformed(message, at.clone()));
    }
    if let Some((name, _)) = &graphics.object {
        let message = format!("the object '{name}' is not closed before the file ends: add ObjectEnd");
        return Err(FormatError::malformed(message, whole_file(source.name)));
    }
    if !document.has_world {
        let what = "it has no WorldBegin, so there is nothing to render: add WorldBegin before the shapes";
        loader.diagnostics.note(what, || whole_file(source.name));
    }
    finish(&document, shapes, loader)
}
