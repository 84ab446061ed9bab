//! Materials: the common profile of effects, as `principled`.

mod bindings;
mod common;
mod effect;
mod pictures;
mod transparency;

use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::appearance::fitting::fitted;
use bilux_import::appearance::principled_draft::PrincipledDraft;
use bilux_import::input::reading::{Reading, default_material};
use bilux_import::input::sink::Sink;
use bilux_scene::Spec;
pub(super) use bindings::{Bindings, Worn};
use effect::Effect;
use std::collections::HashMap;

/// The materials that have been added to the scene.
#[derive(Default)]
pub(super) struct Materials<'d> {
    used: HashMap<Worn<'d>, usize>,
}

impl<'d> Materials<'d> {
    /// The index of a material in the scene.
    pub(super) fn index(
        &mut self,
        worn: Worn<'d>,
        posed: &Posed<'_, 'd>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<usize, FormatError> {
        if let Some(&index) = self.used.get(&worn) {
            return Ok(index);
        }
        let document = posed.document;
        reading.budget.take::<(Worn, Spec, [u8; 1024])>(1, document.root.file())?;
        let material = worn.material;
        let spec = match material.and_then(|material| Effect::of(material, document, &mut sink.diagnostics)) {
            Some(effect) => {
                let mut spec = Spec::new(&material.map(|m| m.label()).unwrap_or_default(), "principled");
                spec.span = effect.element.at();
                let draft = PrincipledDraft::new(spec, reading, sink, document.root.file());
                let mut filling = common::Filling { draft, effect: &effect, worn: &worn, posed };
                filling.fill()?;
                let spec = filling.draft.spec;
                fitted(spec, &mut sink.diagnostics)
            }
            None => default_material(),
        };
        let index = sink.scene.add_material(spec);
        self.used.insert(worn, index);
        Ok(index)
    }
}
