//! Parses directives in order.

use super::directive::Directive;
use super::entity::Entity;
use super::lexer::{Lexer, Token, shown};
use super::media;
use super::parameters;
use super::parser::{Parser, Scope};
use super::shapes;
use super::state::{MaterialKey, TARGETS};
use bilux_import::FormatError;
use bilux_import::appearance::spectra::colours::SPACES;
use bilux_import::bytes::text::name_of;
use bilux_import::input::names::unknown;
use bilux_scene::SceneError;
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

/// The maximum number of attributes of a kind: more than any shape or light has parameters, and each is searched
/// linearly.
const MAX_ATTRIBUTES: usize = 1000;

/// Reads a file to its end.
pub(super) fn run(parser: &mut Parser, lexer: &mut Lexer) -> Result<(), FormatError> {
    while let Some((token, offset)) = lexer.next()? {
        let at = lexer.place(offset);
        let Token::Word(word) = token else {
            let message = format!("a directive is expected here, not {}", shown(&token));
            return Err(FormatError::malformed(message, at));
        };
        let mut directive = Directive { parser, lexer, at };
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
            b"ReverseOrientation" => parser.graphics.state.reverses = !parser.graphics.state.reverses,
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

impl Directive<'_, '_, '_, '_> {
    /// Includes a file. Parameters that follow belong to its last directive, as for pbrt, which has one stream of tokens.
    fn include(&mut self) -> Result<(), FormatError> {
        let (name, at) = self.lexer.text("the name of a file")?;
        let at = self.lexer.place(at);
        let Parser { includes, loader, .. } = &mut *self.parser;
        let mut file = includes.open(&name, &at, loader.folder.as_deref(), loader.reading)?;
        let begins = file.bytes.len() + 1;
        let more = self.lexer.skip_parameters()?;
        if let Some((_, text)) = more {
            loader.reading.budget.take_bytes(text.len() as u64 + 1, &file.name)?;
            file.bytes.push(b'\n');
            file.bytes.extend_from_slice(text);
        }
        let lexer = Lexer::new(&file.name, &file.bytes);
        let mut lexer = match more {
            Some((offset, _)) => lexer.going_on(begins, self.lexer, offset),
            None => lexer,
        };
        run(self.parser, &mut lexer)?;
        self.parser.includes.close(file, self.parser.loader.reading);
        Ok(())
    }

    /// Includes a file and then restores the state.
    fn import(&mut self) -> Result<(), FormatError> {
        let state = self.parser.graphics.state.clone();
        self.include()?;
        self.parser.graphics.state = state;
        Ok(())
    }

    fn attribute(&mut self) -> Result<(), FormatError> {
        let (target, at) = self.lexer.text("the target of the attribute")?;
        let list = parameters::read(
            self.lexer,
            self.parser.graphics.state.space,
            &mut self.parser.loader.reading.budget,
        )?;
        let Some(index) = TARGETS.iter().position(|known| *known == target) else {
            let at = self.lexer.place(at);
            return Err(unknown("target of attributes", &target, TARGETS, &at));
        };
        let all = Arc::make_mut(&mut self.parser.graphics.state.attributes[index]);
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
                self.parser.graphics.state.space = *space;
            }
            b"Option" => {
                // Options of pbrt itself; some state the type before the name, as parameters do.
                let (name, _) = self.lexer.text("the name of an option")?;
                self.lexer.need("the value of an option")?;
                let what = format!("the option '{name}' applies only to pbrt and has no effect here");
                let at = self.at.clone();
                self.parser.loader.note(&what, || at);
            }
            _ => {
                let what = name_of(word).to_lowercase();
                let entity = self.entity(&what, "")?;
                if self.parser.document.has_world {
                    let message = format!("'{}' belongs before WorldBegin: move it there", name_of(word));
                    return self.error(message);
                }
                self.set_option(&what, entity);
            }
        }
        Ok(())
    }

    fn set_option(&mut self, what: &str, entity: Entity) {
        let Parser { document, graphics, loader, .. } = &mut *self.parser;
        match what {
            "camera" => {
                if !graphics.state.media[1].is_empty() {
                    let what = "a medium around the camera counts only inside shapes that bound it";
                    loader.note(what, || entity.at.clone());
                }
                let to_world = graphics.state.matrices.map(|m| m.inverse());
                graphics.systems.insert("camera".to_owned(), to_world);
            }
            "volumeintegrator" | "renderer" => {
                loader.note(&format!("'{what}' of pbrt-v2 is not used"), || entity.at.clone());
            }
            _ => {}
        }
        document.options.record(what, entity, graphics.state.matrices);
    }

    fn surface(&mut self, word: &[u8]) -> Result<(), FormatError> {
        match word {
            b"Material" => {
                let entity = self.entity("material", "material")?;
                self.parser.document.materials.push(entity);
                self.parser.graphics.state.material =
                    MaterialKey::Index(self.parser.document.materials.len() - 1);
            }
            b"NamedMaterial" => {
                let (name, _) = self.lexer.text("the name of a material")?;
                self.parser.graphics.state.material = MaterialKey::Named(name.into());
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
                if let Some((_, first)) = self.parser.document.named_materials.get(name.as_str()) {
                    let what = format!(
                        "there is already a material of this name, at {first}: the later one is used"
                    );
                    let at = self.at.clone();
                    self.parser.loader.note(&what, || at);
                }
                let index = self.parser.document.materials.len();
                self.parser.document.materials.push(Entity { kind, parameters, at: self.at.clone() });
                self.parser.document.named_materials.insert(name.into(), (index, self.at.clone()));
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
        self.parser.document.textures[usize::from(is_number)].insert(name, entity);
        Ok(())
    }

    fn medium(&mut self, word: &[u8]) -> Result<(), FormatError> {
        if word == b"MakeNamedMedium" {
            let (name, _) = self.lexer.text("the name of a medium")?;
            let parameters = self.parameters(format!("the medium '{name}'"), "medium")?;
            let to_world = self.parser.graphics.state.matrices[0];
            let medium = media::read(&name, &parameters, to_world, &mut self.parser.loader)?;
            self.parser.document.media.insert(name.into(), medium);
            return Ok(());
        }
        let (inside, _) = self.lexer.text("the name of the medium inside")?;
        let outside = match self.lexer.peek()? {
            Some((Token::Quoted(_), _)) => self.lexer.text("the name of the medium outside")?.0,
            _ => inside.clone(),
        };
        self.parser.graphics.state.media = [inside.into(), outside.into()];
        Ok(())
    }

    fn light(&mut self, word: &[u8]) -> Result<(), FormatError> {
        if word == b"AreaLightSource" {
            let entity = self.entity("area light", "light")?;
            self.parser.document.area_lights.push(entity);
            self.parser.graphics.state.area_light = Some(self.parser.document.area_lights.len() - 1);
            return Ok(());
        }
        let entity = self.entity("light", "light")?;
        let matrices = self.parser.graphics.state.matrices;
        if matrices[0] != matrices[1] {
            let at = self.at.clone();
            self.parser
                .loader
                .note("moving lights are not supported: this one stays at its start position", || at);
        }
        self.parser.document.lights.push((entity, matrices[0]));
        Ok(())
    }

    fn shape(&mut self) -> Result<(), FormatError> {
        let entity = self.entity("shape", "shape")?;
        if !self.parser.document.has_world {
            return self.error("'Shape' belongs after WorldBegin: move it there");
        }
        let Parser { document, graphics, shapes, loader, .. } = &mut *self.parser;
        let made = shapes::shape(&entity, &graphics.state, shapes, loader)?;
        entity.parameters.report_unused(&mut loader.diagnostics);
        match &mut graphics.object {
            Some((_, pieces)) => pieces.extend(made),
            None => document.pieces.extend(made),
        }
        Ok(())
    }
}
