//! The materials of shapes, with what their attributes add: emission, media, opacity.

use super::document::{Alpha, Document, ObjectInstance, Piece, SurfaceAttributes};
use super::light_maker::{AreaEmission, LightMaker};
use super::loader::{Loader, SpectrumType};
use super::materials::{MaterialMaker, material};
use super::state::MaterialKey;
use bilux_import::FormatError;
use bilux_import::appearance::filling::fill;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::{DMat4, Rgb};
use bilux_scene::{MATERIALS, Span, Spec, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Resolves the attributes of shapes. Those with the same ones share the result.
pub(super) struct Surfaces<'d, 'o, 'r> {
    document: &'d Document,
    /// The factor by which the film scales light.
    gain: f32,
    pub(super) maker: MaterialMaker<'d, 'o, 'r>,
    /// Materials without attributes.
    base: HashMap<MaterialKey, Option<Spec>>,
    /// The indices of materials, keyed by the surface attributes, the bits of a radiance that depends on the shape, and those of
    /// its matrix if it is filled from a grid, which has a place of its own.
    materials: HashMap<(SurfaceAttributes, [u32; 3], [u64; 16]), Option<usize>>,
    glows: HashMap<usize, AreaEmission>,
}

/// Emission of a shape.
pub(super) struct Glow {
    pub(super) radiance: TextureOrValue,
    pub(super) both_sides: bool,
}

impl<'d, 'o, 'r> Surfaces<'d, 'o, 'r> {
    pub(super) fn new(document: &'d Document, gain: f32, loader: Loader<'o, 'r>) -> Surfaces<'d, 'o, 'r> {
        let maker = MaterialMaker::new(document, loader);
        let (base, materials, glows) = (HashMap::new(), HashMap::new(), HashMap::new());
        Surfaces { document, gain, maker, base, materials, glows }
    }

    /// Makes lights with the same textures and the same gain.
    pub(super) fn light_maker(&mut self) -> LightMaker<'_, 'd, 'o, 'r> {
        LightMaker { textures: &mut self.maker.textures, gain: self.gain }
    }

    /// The emission of a piece; pieces of object instances have none.
    pub(super) fn area_emission_of(
        &mut self,
        piece: &Piece,
        used: Option<&ObjectInstance>,
    ) -> Result<Option<AreaEmission>, FormatError> {
        let Some(index) = piece.attributes.area_light else { return Ok(None) };
        if used.is_some() {
            self.maker.note("surfaces of object instances emit no light, as in pbrt", || piece.at.clone());
            return Ok(None);
        }
        if let Some(glow) = self.glows.get(&index) {
            return Ok(Some(glow.clone()));
        }
        let entity = &self.document.area_lights[index];
        let glow = self.light_maker().area_emission(entity)?;
        self.glows.insert(index, glow.clone());
        Ok(Some(glow))
    }

    /// The material without attributes, built once.
    pub(super) fn base_material(&mut self, piece: &Piece) -> Result<Option<Spec>, FormatError> {
        if let Some(known) = self.base.get(&piece.attributes.material) {
            return Ok(known.clone());
        }
        let made = material(&piece.attributes.material, &piece.at, &mut self.maker)?;
        self.base.insert(piece.attributes.material.clone(), made.clone());
        Ok(made)
    }

    /// The index of a piece's material with all of its attributes; `None` for an interface that is invisible.
    pub(super) fn modified_material(
        &mut self,
        piece: &Piece,
        glow: Option<Glow>,
        to_world: &DMat4,
    ) -> Result<Option<usize>, FormatError> {
        let attributes = &piece.attributes;
        let bits = match glow.as_ref().map(|glow| &glow.radiance) {
            Some(TextureOrValue::Colour(colour)) => colour.to_array().map(f32::to_bits),
            Some(TextureOrValue::Picture(picture)) => picture.factor.to_array().map(f32::to_bits),
            None => [0; 3],
        };
        // In an object instance nothing emits, so its material differs.
        let medium = self.document.medium(&attributes.media[0], &piece.at)?;
        let varies = medium.density.is_some() || medium.emission_grid.is_some();
        let place = if varies { to_world.to_cols_array().map(f64::to_bits) } else { [0; 16] };
        let area_light = glow.as_ref().and(attributes.area_light);
        let key = (SurfaceAttributes { area_light, ..attributes.clone() }, bits, place);
        if let Some(known) = self.materials.get(&key) {
            return Ok(*known);
        }
        let made = self.finished_material(piece, glow, to_world)?;
        let index = made.map(|spec| {
            self.maker.in_scene.push(spec);
            self.maker.in_scene.len() - 1
        });
        self.materials.insert(key, index);
        Ok(index)
    }

    fn finished_material(
        &mut self,
        piece: &Piece,
        glow: Option<Glow>,
        to_world: &DMat4,
    ) -> Result<Option<Spec>, FormatError> {
        let [inside, outside] = &piece.attributes.media;
        let medium = self.document.medium(inside, &piece.at)?;
        // Inside another shape that is filled with it, it counts there.
        self.document.medium(outside, &piece.at)?;
        let base = self.base_material(piece)?;
        if base.is_none() && glow.is_some() {
            self.maker.note("an interface material emits no light", || piece.at.clone());
        }
        let mut spec = match base {
            Some(spec) => spec,
            // Inside of a medium a boundary without one makes a hole.
            None if medium.is_clear() && outside.is_empty() => return Ok(None),
            None => Spec::new("interface", "interface"),
        };
        if !medium.is_clear() {
            let loader = self.maker.loader();
            fill(&mut spec, &medium, to_world, &piece.at, (loader.reading, &mut loader.diagnostics))?;
        }
        if let Some(glow) = glow.filter(|_| spec.kind != "interface") {
            spec = self.glowing(spec, glow, piece);
        }
        self.with_opacity_mask(spec, piece)
    }

    /// Adds emission to a material.
    fn glowing(&mut self, spec: Spec, glow: Glow, piece: &Piece) -> Spec {
        let row = MATERIALS.iter().find(|row| row.entry.name == spec.kind);
        let can = row.is_some_and(|row| row.entry.parameters.iter().any(|p| p.name == "emission"));
        let mut spec = if can {
            spec
        } else {
            let what = format!("a {} that emits light reflects none", spec.kind);
            self.maker.note(&what, || piece.at.clone());
            let dark = Spec::new(&spec.name, "diffuse").with("reflectance", 0.0f32);
            Spec { span: spec.span, ..dark }
        };
        match glow.radiance {
            TextureOrValue::Colour(colour) => spec.parameters.set("emission", colour.clamp(0.0, 1e12)),
            TextureOrValue::Picture(picture) => {
                let scale = picture.factor;
                let plain = Texture { factor: Rgb::WHITE, ..(*picture).clone() };
                let value = self.maker.textures.value(TextureOrValue::Picture(Arc::new(plain)));
                spec.parameters.set("emission", value);
                spec.parameters.set("emission_scale", scale.clamp(0.0, 1e12));
            }
        }
        let sides = if glow.both_sides { "both" } else { "front" };
        spec.parameters.set("emission_sides", sides);
        spec
    }

    /// Adds an opacity mask to a material if the shape has an alpha.
    fn with_opacity_mask(&mut self, mut spec: Spec, piece: &Piece) -> Result<Option<Spec>, FormatError> {
        let share = match &piece.attributes.alpha {
            Alpha::Whole => return Ok(Some(spec)),
            Alpha::Even(bits) => {
                let alpha = f32::from_bits(*bits).clamp(0.0, 1.0);
                if alpha == 0.0 && spec.parameters.find("emission").is_some() {
                    let what = "lights cannot be hidden: this one is visible";
                    self.maker.note(what, || piece.at.clone());
                    return Ok(Some(spec));
                }
                if alpha == 0.0 {
                    return Ok(None);
                }
                Value::from(alpha)
            }
            Alpha::Texture(name, line, column) => {
                let at = Span { file: piece.at.file.clone(), line: *line, column: *column };
                let textures = &mut self.maker.textures;
                let source = textures.texture(name, SpectrumType::Number, &at)?;
                textures.number_value(source, [0.0, 1.0])
            }
        };
        spec.parameters.set("opacity", share);
        Ok(Some(spec))
    }
}
