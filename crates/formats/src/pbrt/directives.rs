//! Parses directives in order.

use super::colours::SPACES;
use super::lexer::{Lexer, Token, shown};
use super::parameters::{self, ParameterList};
use super::reader::{Entity, ObjectInstance, Pbrt, Scope};
use super::state::{MaterialKey, TARGETS};
use super::unknown;
use crate::FormatError;
use crate::text::name_of;
use bilux_math::DMat4;
use bilux_scene::{SceneError, Span};
use std::sync::Arc;

/// Every directive, including those of versions 2 and 3.
const DIRECTIVES: &[&str] = &[
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "Renderer",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "SurfaceIntegrator",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "TransformTimes",
    "Translate",
    "VolumeIntegrator",
    "WorldBegin",
    "WorldEnd",
];

/// Deeper nesting is refused, since each level keeps a copy of the state.
const MAX_DEPTH: usize = 10_000;

/// The maximum number of attributes of a kind: more than any shape or light has parameters, and each is searched
/// linearly.
const MAX_ATTRIBUTES: usize = 1000;

/// Reads a file to its end.
pub(super) fn run(pbrt: &mut Pbrt, lexer: &mut Lexer) -> Result<(), FormatError> {
    while let Some((token, offset)) = lexer.next()? {
        let at = lexer.place(offset);
        let Token::Word(word) = token else {
            let message = format!("a directive is expected here, not {}", shown(&token));
            return Err(FormatError::malformed(message, at));
        };
        let mut directive = Directive { pbrt, lexer, at };
        match word {
            b"Include" => directive.include()?,
            b"Import" => directive.import()?,
            b"AttributeBegin" => directive.push(Scope::Attribute)?,
            b"AttributeEnd" => directive.pop(Scope::Attribute)?,
            b"TransformBegin" => directive.push(Scope::Transform)?,
            b"TransformEnd" => directive.pop(Scope::Transform)?,
            b"ObjectBegin" => directive.object_begin()?,
            b"ObjectEnd" => directive.object_end()?,
            b"ObjectInstance" => directive.object_instance()?,
            b"WorldBegin" => directive.world_begin()?,
            b"WorldEnd" => {}
            b"ReverseOrientation" => pbrt.state.reverses = !pbrt.state.reverses,
            b"Identity" | b"Translate" | b"Scale" | b"Rotate" | b"LookAt" | b"Transform"
            | b"ConcatTransform" | b"CoordinateSystem" | b"CoordSysTransform" | b"ActiveTransform"
            | b"TransformTimes" => directive.transform(word)?,
            b"Camera" | b"Film" | b"PixelFilter" | b"Sampler" | b"Integrator" | b"Accelerator"
            | b"ColorSpace" | b"Option" | b"SurfaceIntegrator" | b"VolumeIntegrator" | b"Renderer" => {
                directive.option(word)?;
            }
            b"Material" | b"MakeNamedMaterial" | b"NamedMaterial" | b"Texture" => directive.surface(word)?,
            b"MakeNamedMedium" | b"MediumInterface" => directive.medium(word)?,
            b"LightSource" | b"AreaLightSource" => directive.light(word)?,
            b"Attribute" => directive.attribute()?,
            b"Shape" => directive.shape()?,
            _ => {
                let names = DIRECTIVES.iter().copied();
                return Err(unknown("directive", &name_of(word), names, &directive.at));
            }
        }
    }
    Ok(())
}

/// A directive that is being parsed.
pub(super) struct Directive<'d, 'a, 'o, 'r> {
    pub(super) pbrt: &'d mut Pbrt<'o, 'r>,
    pub(super) lexer: &'d mut Lexer<'a>,
    pub(super) at: Span,
}

impl Directive<'_, '_, '_, '_> {
    pub(super) fn error<T>(&self, message: impl Into<String>) -> Result<T, FormatError> {
        Err(FormatError::malformed(message, self.at.clone()))
    }

    /// Reads a kind and its parameters; `what` names the entity in messages, `target` selects the attributes that
    /// apply.
    fn entity(&mut self, what: &str, target: &str) -> Result<Entity, FormatError> {
        let (kind, _) = self.lexer.text(&format!("the kind of the {what}"))?;
        let list = self.parameters(format!("the {what} '{kind}'"), target)?;
        Ok(Entity { kind, parameters: list, at: self.at.clone() })
    }

    fn parameters(&mut self, what: String, target: &str) -> Result<ParameterList, FormatError> {
        let list = parameters::read(self.lexer, self.pbrt.state.space, &mut self.pbrt.reading.budget)?;
        let attributes = self.pbrt.state.attributes_of(target);
        self.pbrt.reading.budget.take::<Entity>(1, &self.at.file)?;
        Ok(ParameterList::new(what, self.at.clone(), list, attributes))
    }

    fn include(&mut self) -> Result<(), FormatError> {
        let (name, at) = self.lexer.text("the name of a file")?;
        let at = self.lexer.place(at);
        self.pbrt.include(&name, &at)
    }

    /// Includes a file and then restores the state.
    fn import(&mut self) -> Result<(), FormatError> {
        let state = self.pbrt.state.clone();
        self.include()?;
        self.pbrt.state = state;
        Ok(())
    }

    fn push(&mut self, scope: Scope) -> Result<(), FormatError> {
        if self.pbrt.pushed.len() >= MAX_DEPTH {
            return self.error(format!("attributes are nested more than {MAX_DEPTH} levels deep"));
        }
        self.pbrt.pushed.push((scope, self.at.clone(), self.pbrt.state.clone()));
        Ok(())
    }

    fn pop(&mut self, scope: Scope) -> Result<(), FormatError> {
        let Some((began, at, state)) = self.pbrt.pushed.pop() else {
            return self.error("this ends something that was never begun: remove it");
        };
        if (began == Scope::Object) != (scope == Scope::Object) {
            // Version 3 uses one stack for both, and its own scenes interleave them.
            let what = "objects and attributes are not properly nested: each End closes the last Begin";
            self.pbrt.oddities.note(what, || at);
        }
        if began == Scope::Transform {
            // In version 3, TransformEnd restores only the transforms.
            (self.pbrt.state.matrices, self.pbrt.state.is_active) = (state.matrices, state.is_active);
        } else {
            self.pbrt.state = state;
        }
        Ok(())
    }

    fn object_begin(&mut self) -> Result<(), FormatError> {
        let (name, _) = self.lexer.text("the name of an object")?;
        if let Some((open, _)) = &self.pbrt.definition {
            return self.error(format!("objects cannot be defined inside objects: end '{open}' first"));
        }
        if self.pbrt.definitions.contains_key(&name) {
            return self.error(format!("there is already an object '{name}': give this one another name"));
        }
        self.push(Scope::Object)?;
        self.pbrt.definition = Some((name, Vec::new()));
        Ok(())
    }

    fn object_end(&mut self) -> Result<(), FormatError> {
        let Some((name, pieces)) = self.pbrt.definition.take() else {
            return self.error("this ends an object that was never begun: remove it");
        };
        self.pbrt.definitions.insert(name, Arc::new(pieces));
        self.pop(Scope::Object)
    }

    fn object_instance(&mut self) -> Result<(), FormatError> {
        let (object, _) = self.lexer.text("the name of an object")?;
        if self.pbrt.definition.is_some() {
            return self.error("objects cannot contain instances: move this one after ObjectEnd");
        }
        self.pbrt.reading.budget.take::<ObjectInstance>(1, &self.at.file)?;
        let matrices = self.pbrt.state.matrices;
        self.pbrt.uses.push(ObjectInstance { object, matrices, at: self.at.clone() });
        Ok(())
    }

    fn world_begin(&mut self) -> Result<(), FormatError> {
        if std::mem::replace(&mut self.pbrt.in_world, true) {
            return self.error("the world has already begun: remove this");
        }
        let state = &mut self.pbrt.state;
        (state.matrices, state.is_active) = ([DMat4::IDENTITY; 2], [true; 2]);
        self.pbrt.systems.insert("world".to_owned(), state.matrices);
        Ok(())
    }

    fn attribute(&mut self) -> Result<(), FormatError> {
        let (target, at) = self.lexer.text("the target of the attribute")?;
        let list = parameters::read(self.lexer, self.pbrt.state.space, &mut self.pbrt.reading.budget)?;
        let Some(index) = TARGETS.iter().position(|known| *known == target) else {
            let at = self.lexer.place(at);
            return Err(unknown("target of attributes", &target, TARGETS, &at));
        };
        let all = Arc::make_mut(&mut self.pbrt.state.attributes[index]);
        if all.len() + list.len() > MAX_ATTRIBUTES {
            return self.error(format!("there are more than {MAX_ATTRIBUTES} attributes of one kind"));
        }
        // Later attributes take precedence.
        all.splice(0..0, list);
        Ok(())
    }

    fn option(&mut self, word: &[u8]) -> Result<(), FormatError> {
        match word {
            b"ColorSpace" => {
                let (name, at) = self.lexer.text("the name of a colour space")?;
                let Some((_, space)) = SPACES.iter().find(|(known, _)| *known == name.to_lowercase()) else {
                    let names = SPACES.iter().map(|(name, _)| *name);
                    return Err(unknown("colour space", &name, names, &self.lexer.place(at)));
                };
                self.pbrt.state.space = *space;
            }
            b"Option" => {
                // Options of pbrt itself; some state the type before the name, as parameters do.
                let (name, _) = self.lexer.text("the name of an option")?;
                self.lexer.need("the value of an option")?;
                let what = format!("the option '{name}' applies only to pbrt and has no effect here");
                let at = self.at.clone();
                self.pbrt.oddities.note(&what, || at);
            }
            _ => {
                let what = name_of(word).to_lowercase();
                let entity = self.entity(&what, "")?;
                if self.pbrt.in_world {
                    let message = format!("'{}' belongs before WorldBegin: move it there", name_of(word));
                    return self.error(message);
                }
                self.pbrt.option(&what, entity);
            }
        }
        Ok(())
    }

    fn surface(&mut self, word: &[u8]) -> Result<(), FormatError> {
        match word {
            b"Material" => {
                let entity = self.entity("material", "material")?;
                self.pbrt.materials.push(entity);
                self.pbrt.state.material = MaterialKey::Index(self.pbrt.materials.len() - 1);
            }
            b"NamedMaterial" => {
                let (name, _) = self.lexer.text("the name of a material")?;
                self.pbrt.state.material = MaterialKey::Named(name.into());
            }
            b"MakeNamedMaterial" => {
                let (name, _) = self.lexer.text("the name of a material")?;
                let parameters = self.parameters(format!("the material '{name}'"), "material")?;
                let kind = match parameters.text("type")? {
                    Some(kind) => kind.to_owned(),
                    None => {
                        let what = "type (of the material, as in \"string type\" \"diffuse\")".to_owned();
                        return Err(SceneError::Missing { what, at: self.at.clone() }.into());
                    }
                };
                if let Some((_, first)) = self.pbrt.named_materials.get(name.as_str()) {
                    let what = format!(
                        "there is already a material of this name, at {first}: the later one is used"
                    );
                    let at = self.at.clone();
                    self.pbrt.oddities.note(&what, || at);
                }
                let index = self.pbrt.materials.len();
                self.pbrt.materials.push(Entity { kind, parameters, at: self.at.clone() });
                self.pbrt.named_materials.insert(name.into(), (index, self.at.clone()));
            }
            _ => self.texture()?,
        }
        Ok(())
    }

    fn texture(&mut self) -> Result<(), FormatError> {
        let (name, _) = self.lexer.text("the name of a texture")?;
        let (of, at) = self.lexer.text("what the texture is of: \"spectrum\" or \"float\"")?;
        let entity = self.entity("texture", "texture")?;
        let is_number = match of.as_str() {
            "float" => true,
            "spectrum" | "color" => false,
            other => {
                let at = self.lexer.place(at);
                return Err(unknown("type of textures", other, ["float", "spectrum"], &at));
            }
        };
        self.pbrt.textures.define(name, is_number, entity, self.pbrt.state.matrices[0]);
        Ok(())
    }

    fn medium(&mut self, word: &[u8]) -> Result<(), FormatError> {
        if word == b"MakeNamedMedium" {
            let (name, _) = self.lexer.text("the name of a medium")?;
            let parameters = self.parameters(format!("the medium '{name}'"), "medium")?;
            return self.pbrt.add_medium(name, &parameters);
        }
        let (inside, _) = self.lexer.text("the name of the medium inside")?;
        let outside = match self.lexer.peek()? {
            Some((Token::Quoted(_), _)) => self.lexer.text("the name of the medium outside")?.0,
            _ => inside.clone(),
        };
        self.pbrt.state.media = [inside.into(), outside.into()];
        Ok(())
    }

    fn light(&mut self, word: &[u8]) -> Result<(), FormatError> {
        if word == b"AreaLightSource" {
            let entity = self.entity("area light", "light")?;
            self.pbrt.area_lights.push(entity);
            self.pbrt.state.area_light = Some(self.pbrt.area_lights.len() - 1);
            return Ok(());
        }
        let entity = self.entity("light", "light")?;
        let matrices = self.pbrt.state.matrices;
        if matrices[0] != matrices[1] {
            let at = self.at.clone();
            self.pbrt
                .oddities
                .note("moving lights are not supported: this one stays at its start position", || at);
        }
        self.pbrt.lights.push((entity, matrices[0]));
        Ok(())
    }

    fn shape(&mut self) -> Result<(), FormatError> {
        let entity = self.entity("shape", "shape")?;
        if !self.pbrt.in_world {
            return self.error("'Shape' belongs after WorldBegin: move it there");
        }
        let made = self.pbrt.shape(&entity)?;
        entity.parameters.report_unused(&mut self.pbrt.oddities);
        match &mut self.pbrt.definition {
            Some((_, pieces)) => pieces.extend(made),
            None => self.pbrt.pieces.extend(made),
        }
        Ok(())
    }
}
