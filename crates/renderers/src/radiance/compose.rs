//! Puts a scene together: statements in their places, and what commands stand for.

use super::command::Command;
use super::files::{Files, Text};
use super::place::Place;
use super::statement::Statement;
use super::surfaces;
use super::world::World;
use super::xform::Xform;
use super::{genbox, sky};
use bilux_import::FormatError;
use bilux_scene::Span;
use std::path::Path;
use std::rc::Rc;

/// A scene that is put together.
pub(super) struct Composer<'o, 'r> {
    pub(super) world: World<'o, 'r>,
    pub(super) files: Files,
}

impl Composer<'_, '_> {
    /// Adds the statements of a text in a place.
    pub(super) fn run(&mut self, text: &Text, place: &Place) -> Result<(), FormatError> {
        for statement in &text.statements {
            match statement {
                Statement::Primitive(primitive) => {
                    self.files.visit(1, &primitive.at, self.world.reading)?;
                    if primitive.kind.is_surface() {
                        surfaces::add(&mut self.world, primitive, place)?;
                    } else {
                        let World { modifiers, reading, diagnostics, .. } = &mut self.world;
                        modifiers.define(primitive, place, &mut reading.budget, diagnostics)?;
                    }
                }
                Statement::Command(command) => {
                    self.files.visit_command(&command.at, self.world.reading)?;
                    self.command(command, text.folder.as_deref(), place)?;
                }
            }
        }
        Ok(())
    }

    /// Adds a file that is named in another one.
    pub(super) fn file(
        &mut self,
        name: &Rc<str>,
        folder: Option<&Path>,
        at: &Span,
        place: &Place,
    ) -> Result<(), FormatError> {
        let text = self.files.find(name, folder, at, self.world.reading)?;
        self.enter(&text, place, at)
    }

    fn enter(&mut self, text: &Text, place: &Place, at: &Span) -> Result<(), FormatError> {
        self.files.enter(text, at)?;
        let done = self.run(text, place);
        self.files.leave();
        done
    }

    /// Adds what a command would write, without running it.
    fn command(
        &mut self,
        command: &Command,
        folder: Option<&Path>,
        place: &Place,
    ) -> Result<(), FormatError> {
        let at = &command.at;
        let programs = command.programs.as_deref().unwrap_or_default();
        let mut stages = Vec::new();
        let mut made = None;
        for (i, words) in programs.iter().enumerate() {
            let (program, words) =
                words.split_first().map_or(("", words.as_slice()), |(first, rest)| (&**first, rest));
            let program = program.rsplit('/').next().unwrap_or_default();
            match (program, i) {
                ("xform", _) => {
                    let xform = Xform::parse(words, at)?;
                    if xform.files.is_empty() == (i == 0) {
                        return self.not_run(command);
                    }
                    if i == 0 {
                        made = Some(self.texts(&xform.files, folder, at)?);
                    }
                    stages.push(xform);
                }
                ("cat", 0) => made = Some(self.texts(words, folder, at)?),
                (_, 0) => {
                    let Some(statements) = self.generated(program, words, at)? else {
                        return self.not_run(command);
                    };
                    made = Some(vec![Rc::new(Text::new(statements, None))]);
                }
                _ => return self.not_run(command),
            }
        }
        match made {
            Some(texts) => self.staged(&stages, &texts, place, at),
            None => self.not_run(command),
        }
    }

    fn texts(
        &mut self,
        names: &[Rc<str>],
        folder: Option<&Path>,
        at: &Span,
    ) -> Result<Vec<Rc<Text>>, FormatError> {
        names.iter().map(|name| self.files.find(name, folder, at, self.world.reading)).collect()
    }

    /// Statements that a generator writes; `None` for any other program, and for a form of output that is not read here.
    fn generated(
        &mut self,
        program: &str,
        words: &[Rc<str>],
        at: &Span,
    ) -> Result<Option<Vec<Statement>>, FormatError> {
        let diagnostics = &mut self.world.diagnostics;
        match program {
            "genbox" => genbox::generate(words, at, diagnostics),
            "gensky" => sky::gensky(words, at).map(Some),
            "gendaylit" => sky::gendaylit(words, at, diagnostics).map(Some),
            _ => Ok(None),
        }
    }

    /// Adds texts in all of the places that a chain of transforms gives them; the last one is the outermost.
    fn staged(
        &mut self,
        stages: &[Xform],
        texts: &[Rc<Text>],
        place: &Place,
        at: &Span,
    ) -> Result<(), FormatError> {
        let Some((last, before)) = stages.split_last() else {
            return texts.iter().try_for_each(|text| self.enter(text, place, at));
        };
        self.files.visit(last.copies(), at, self.world.reading)?;
        for copy in 0..last.copies() {
            let Some(place) = place.within(last, copy) else {
                let message = "the transforms of xform are too large or too small for numbers: correct them";
                return Err(FormatError::malformed(message, at.clone()));
            };
            self.staged(before, texts, &place, at)?;
        }
        Ok(())
    }

    /// Names a command that is not read.
    fn not_run(&mut self, command: &Command) -> Result<(), FormatError> {
        let what = format!(
            "programs are not run, and what '!{}' writes is left out: write it to a file, and name that with '!xform FILE'",
            command.first_word()
        );
        self.world.diagnostics.note(&what, || command.at.clone());
        Ok(())
    }
}
