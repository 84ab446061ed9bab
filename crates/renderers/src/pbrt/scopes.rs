//! The directives that begin and end attributes, objects and the world.

use super::directive::Directive;
use super::document::ObjectInstance;
use super::parser::Scope;
use bilux_import::FormatError;
use bilux_math::DMat4;

/// Deeper nesting is refused, since each level keeps a copy of the state.
const MAX_DEPTH: usize = 10_000;

impl Directive<'_, '_, '_, '_> {
    pub(super) fn push(&mut self, scope: Scope) -> Result<(), FormatError> {
        if self.parser.graphics.pushed.len() >= MAX_DEPTH {
            return self.error(format!("attributes are nested more than {MAX_DEPTH} levels deep"));
        }
        self.parser.graphics.pushed.push((scope, self.at.clone(), self.parser.graphics.state.clone()));
        Ok(())
    }

    pub(super) fn pop(&mut self, scope: Scope) -> Result<(), FormatError> {
        let Some((began, at, state)) = self.parser.graphics.pushed.pop() else {
            return self.error("this ends something that was never begun: remove it");
        };
        if (began == Scope::Object) != (scope == Scope::Object) {
            // Version 3 uses one stack for both, and its own scenes interleave them.
            let what = "objects and attributes are not properly nested: each End closes the last Begin";
            self.parser.loader.note(what, || at);
        }
        if began == Scope::Transform {
            // In version 3, TransformEnd restores only the transforms.
            (self.parser.graphics.state.matrices, self.parser.graphics.state.is_active) =
                (state.matrices, state.is_active);
        } else {
            self.parser.graphics.state = state;
        }
        Ok(())
    }

    pub(super) fn object_begin(&mut self) -> Result<(), FormatError> {
        let (name, _) = self.lexer.text("the name of an object")?;
        if let Some((open, _)) = &self.parser.graphics.object {
            return self.error(format!("objects cannot be defined inside objects: end '{open}' first"));
        }
        if self.parser.document.objects.contains_key(&name) {
            return self.error(format!("there is already an object '{name}': give this one another name"));
        }
        self.push(Scope::Object)?;
        self.parser.graphics.object = Some((name, Vec::new()));
        Ok(())
    }

    pub(super) fn object_end(&mut self) -> Result<(), FormatError> {
        let Some((name, pieces)) = self.parser.graphics.object.take() else {
            return self.error("this ends an object that was never begun: remove it");
        };
        self.parser.document.objects.insert(name, pieces);
        self.pop(Scope::Object)
    }

    pub(super) fn object_instance(&mut self) -> Result<(), FormatError> {
        let (object, _) = self.lexer.text("the name of an object")?;
        if self.parser.graphics.object.is_some() {
            return self.error("objects cannot contain instances: move this one after ObjectEnd");
        }
        self.parser.loader.reading.budget.take::<ObjectInstance>(1, &self.at.file)?;
        let matrices = self.parser.graphics.state.matrices;
        self.parser.document.instances.push(ObjectInstance { object, matrices, at: self.at.clone() });
        Ok(())
    }

    pub(super) fn world_begin(&mut self) -> Result<(), FormatError> {
        if std::mem::replace(&mut self.parser.document.has_world, true) {
            return self.error("the world has already begun: remove this");
        }
        let state = &mut self.parser.graphics.state;
        (state.matrices, state.is_active) = ([DMat4::IDENTITY; 2], [true; 2]);
        self.parser.graphics.systems.insert("world".to_owned(), state.matrices);
        Ok(())
    }
}
