//! An effect, and the parameters that it names.

use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::input::diagnostics::Diagnostics;

/// Reflection model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Model {
    Constant,
    Lambert,
    Phong,
    Blinn,
}

/// The common profile of a material's effect.
pub(super) struct Effect<'d> {
    pub(super) element: Element<'d>,
    pub(super) model: Model,
    /// The values of the model.
    pub(super) shader: Element<'d>,
    /// Elements that may hold parameters, the nearest first.
    scopes: Vec<Element<'d>>,
}

impl<'d> Effect<'d> {
    /// The effect of a material; `None`, with a note, if there is none for all renderers.
    pub(super) fn of(
        material: Element<'d>,
        document: &Document<'d>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Effect<'d>> {
        let instance = material.child("instance_effect")?;
        let element = document.referred(instance, "url", diagnostics)?;
        let profile = element.child("profile_COMMON");
        let technique = profile.and_then(|profile| profile.child("technique"));
        let models = [
            ("constant", Model::Constant),
            ("lambert", Model::Lambert),
            ("phong", Model::Phong),
            ("blinn", Model::Blinn),
        ];
        let shader = technique.and_then(|technique| {
            models.iter().find_map(|(name, model)| Some((technique.child(name)?, *model)))
        });
        let Some((shader, model)) = shader else {
            let what =
                "an effect has no common profile, only that of one kind of hardware: its material is plain";
            diagnostics.note(what, || element.at());
            return None;
        };
        let scopes = [Some(instance), technique, profile, Some(element)];
        Some(Effect { element, model, shader, scopes: scopes.into_iter().flatten().collect() })
    }

    /// The element that declares or sets a parameter.
    pub(super) fn parameter(&self, name: &str) -> Option<Element<'d>> {
        self.scopes.iter().find_map(|scope| {
            scope.children().find(|child| match child.name() {
                "newparam" => child.attribute("sid") == Some(name),
                "setparam" => child.attribute("ref") == Some(name),
                _ => false,
            })
        })
    }

    /// A colour, a number or a texture of the model: as it is there, or as a parameter says.
    pub(super) fn value(&self, name: &str) -> Option<Element<'d>> {
        let value = self.shader.child(name)?.children().find(|value| value.name() != "extra")?;
        match value.name() {
            "param" => self.parameter(value.attribute("ref")?)?.children().next(),
            _ => Some(value),
        }
    }

    /// The texture of something that programs add to the common profile.
    pub(super) fn added_texture(&self, names: &[&str]) -> Option<Element<'d>> {
        let elements = self.element.descendants().filter(|element| names.contains(&element.name()));
        elements.filter_map(|element| element.child("texture")).next()
    }
}
