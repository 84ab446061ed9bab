//! One directive.

use super::entity::Entity;
use super::lexer::Lexer;
use super::parameters::{self, ParameterList};
use super::parser::Parser;
use bilux_import::FormatError;
use bilux_scene::Span;

/// A directive that is being parsed.
pub(super) struct Directive<'d, 'a, 'o, 'r> {
    pub(super) parser: &'d mut Parser<'o, 'r>,
    pub(super) lexer: &'d mut Lexer<'a>,
    pub(super) at: Span,
}

impl Directive<'_, '_, '_, '_> {
    pub(super) fn error<T>(&self, message: impl Into<String>) -> Result<T, FormatError> {
        Err(FormatError::malformed(message, self.at.clone()))
    }

    /// Reads a kind and its parameters; `what` names the entity in messages, `target` selects the attributes that
    /// apply.
    pub(super) fn entity(&mut self, what: &str, target: &str) -> Result<Entity, FormatError> {
        let (kind, _) = self.lexer.text(&format!("the kind of the {what}"))?;
        let list = self.parameters(format!("the {what} '{kind}'"), target)?;
        Ok(Entity { kind, parameters: list, at: self.at.clone() })
    }

    pub(super) fn parameters(&mut self, what: String, target: &str) -> Result<ParameterList, FormatError> {
        let list = parameters::read(
            self.lexer,
            self.parser.graphics.state.space,
            &mut self.parser.loader.reading.budget,
        )?;
        let attributes = self.parser.graphics.state.attributes_of(target);
        self.parser.loader.reading.budget.take::<Entity>(1, &self.at.file)?;
        Ok(ParameterList::new(what, self.at.clone(), list, attributes))
    }
}
