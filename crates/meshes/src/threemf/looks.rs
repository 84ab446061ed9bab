//! Looks of triangles: materials, made from properties once each.

use super::blend::Ink;
use super::colour::Colour;
use super::groups::{Appearance, Base, Display, GroupKind, TexturedAppearance};
use super::mesh_data::{NONE, TriangleProperties};
use super::model::{Model, Reference, Resource};
use super::pictures::Pictures;
use bilux_import::FormatError;
use bilux_import::appearance::as_metal::as_metal;
use bilux_import::input::reading::{Reading, plain_material};
use bilux_import::input::sink::Sink;
use bilux_math::Rgb;
use bilux_math::transcendental::exp;
use bilux_scene::texture::Channel;
use bilux_scene::{Spec, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Look of triangles that share a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Look {
    /// No property.
    Plain,
    /// Filament of an extruder, from 1 on; 0 stands for that of the part.
    Filament(u32),
    /// An entry of a group, the same all over a triangle.
    Solid { group: usize, index: u32 },
    /// Colours at corners.
    Colours { group: usize },
    /// A picture, with coordinates at corners.
    Picture { group: usize },
    /// Layers, with an entry that has the lowest of them.
    Layers { group: usize, entry: u32 },
}

impl Look {
    /// The look of a triangle.
    pub(super) fn of(model: &Model, properties: &TriangleProperties) -> Look {
        if properties.group == NONE {
            return Look::Plain;
        }
        let (group, first) = (properties.group as usize, properties.corners[0]);
        let known = &model.groups[group];
        match &known.kind {
            GroupKind::Bases(_) => Look::Solid { group, index: first },
            // What has display properties has no gradients. [3MF Materials 1.2, 7]
            GroupKind::Colours(_) | GroupKind::Mixtures(_) if known.display.is_some() => {
                Look::Solid { group, index: first }
            }
            GroupKind::Colours(_) | GroupKind::Mixtures(_) => Look::Colours { group },
            GroupKind::Coordinates { .. } => Look::Picture { group },
            GroupKind::Layers(layers) => {
                // Of entries that differ only in texture coordinates, the first stands for all.
                let is_flat = |layer: usize| {
                    !matches!(model.groups[layers.groups[layer]].kind, GroupKind::Coordinates { .. })
                };
                let flat = |entry: u32| {
                    let indices = layers.entry(entry);
                    (0..layers.groups.len())
                        .filter(|&layer| is_flat(layer))
                        .map(move |layer| indices.get(layer))
                };
                let has_pictures = layers.textured(model).is_some();
                let lowest = |entry: u32| layers.entry(entry).first();
                let is_same = |&entry: &u32| match has_pictures {
                    true => flat(entry).eq(flat(first)),
                    false => !model.groups[layers.groups[0]].is_material() || lowest(entry) == lowest(first),
                };
                // Hostile files have many entries; a few are compared.
                let entry = (0..first).take(MAX_COMPARED).find(is_same).unwrap_or(first);
                Look::Layers { group, entry }
            }
        }
    }

    /// True if vertices have colours or texture coordinates.
    pub(super) fn is_painted(self) -> bool {
        !matches!(self, Look::Plain | Look::Filament(_) | Look::Solid { .. })
    }
}

/// The entries that are compared with one.
const MAX_COMPARED: usize = 64;

/// The materials of looks, as far as they have been made.
pub(super) struct Looks {
    materials: HashMap<Look, usize>,
    pictures: Pictures,
    /// The colours of filaments.
    filaments: Vec<Option<Colour>>,
}

impl Looks {
    pub(super) fn with(pictures: Pictures, filaments: Vec<Option<Colour>>) -> Looks {
        Looks { materials: HashMap::new(), pictures, filaments }
    }

    /// The material of a look.
    pub(super) fn material(
        &mut self,
        look: Look,
        model: &Model,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<usize, FormatError> {
        if let Some(&known) = self.materials.get(&look) {
            return Ok(known);
        }
        let spec = match look {
            Look::Plain => plain_material(false, false),
            Look::Filament(number) => self.filament(number),
            Look::Solid { group, index } => solid(model, group, index, sink),
            Look::Colours { .. } => Spec::new("vertices", "principled").with("base_color", Rgb::WHITE),
            Look::Picture { group } => self.picture(model, group, reading, sink)?,
            Look::Layers { group, entry } => self.layers(model, group, entry, reading, sink)?,
        };
        reading.budget.take_bytes(size_of::<[Spec; 4]>() as u64, "materials")?;
        let index = sink.scene.add_material(spec);
        self.materials.insert(look, index);
        Ok(index)
    }

    fn filament(&self, number: u32) -> Spec {
        let colour = self.filaments.get(number.saturating_sub(1) as usize).copied().flatten();
        let spec = Spec::new(&format!("filament {number}"), "principled");
        match colour {
            Some(colour) => spec.with("base_color", colour.rgb),
            None => spec,
        }
    }

    fn picture(
        &mut self,
        model: &Model,
        group: usize,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Spec, FormatError> {
        let known = &model.groups[group];
        let GroupKind::Coordinates { picture, .. } = known.kind else {
            return Ok(plain_material(false, false));
        };
        let (texture, _) = self.pictures.texture(picture, model, reading, sink)?;
        let mut texture = (*texture).clone();
        let mut spec = Spec::new(&texture.name, "principled");
        let shown = known.display.and_then(|id| model.find(Reference { part: known.part, id }));
        if let Some(Resource::Display(display)) = shown
            && let Display::Textured(textured) = &model.displays[display]
        {
            match *textured {
                TexturedAppearance::Metallic { metalness, roughness, factors, base } => {
                    texture.factor = base;
                    let is_one = metalness == roughness;
                    for (key, picture, channel, factor) in [
                        (
                            "base_metalness",
                            metalness,
                            if is_one { Channel::G } else { Channel::R },
                            factors[0],
                        ),
                        ("specular_roughness", roughness, Channel::R, factors[1]),
                    ] {
                        let numbers =
                            self.pictures.numbers(picture, channel, factor, model, reading, sink)?;
                        let numbers = added(sink, numbers);
                        spec.parameters.set(key, numbers);
                    }
                }
                TexturedAppearance::Specular { base, .. } => {
                    texture.factor = base;
                    let at = model.pictures[picture].at.clone();
                    sink.diagnostics.not_shown("pictures of specular colours and glossiness", || at);
                }
            }
        }
        let value = added(sink, texture);
        spec.parameters.set("base_color", value);
        Ok(spec)
    }

    fn layers(
        &mut self,
        model: &Model,
        group: usize,
        entry: u32,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Spec, FormatError> {
        let GroupKind::Layers(layers) = &model.groups[group].kind else {
            return Ok(plain_material(false, false));
        };
        let lowest = layers.groups.first().zip(layers.entry(entry).first());
        let mut spec = match lowest {
            Some((&group, &index)) if model.groups[group].is_material() => solid(model, group, index, sink),
            _ => Spec::new("layers", "principled"),
        };
        if layers.textured(model).is_none() {
            spec.parameters.set("base_color", Rgb::WHITE);
            return Ok(spec);
        }
        let picture = |picture: usize| self.pictures.texture(picture, model, reading, sink);
        match layers.painted(model, entry, picture)? {
            Ink::Flat(colour) => spec.parameters.set("base_color", colour),
            Ink::Picture(texture) => {
                let value = added(sink, (*texture).clone());
                spec.parameters.set("base_color", value);
            }
        }
        Ok(spec)
    }
}

/// Adds a texture to the scene.
fn added(sink: &mut Sink, texture: Texture) -> Value {
    sink.scene.textures.push(Arc::new(texture));
    Value::Texture(sink.scene.textures.len() - 1)
}

/// The material of an entry of a group.
fn solid(model: &Model, group: usize, index: u32, sink: &mut Sink) -> Spec {
    let known = &model.groups[group];
    let base: Option<&Base> = match &known.kind {
        GroupKind::Bases(bases) => bases.get(index as usize),
        _ => None,
    };
    let name = base.map_or("", |base| &base.name);
    let mut spec = Spec::new(if name.is_empty() { "material" } else { name }, "principled");
    let colour = known.colour(index);
    if let Some(colour) = colour {
        spec.parameters.set("base_color", colour.rgb);
        // Nobody prints what cannot be seen: an alpha of 0 is that of programs that do not use it.
        if base.is_some() && colour.alpha > 0.0 && colour.alpha < 1.0 {
            spec.parameters.set("opacity", colour.alpha);
        }
    }
    let of_base = base.and_then(|base| base.display);
    let (id, entry) = match of_base {
        Some(id) => (Some(id), 0),
        None => (known.display, index as usize),
    };
    let Some(id) = id else { return spec };
    let found = match model.find(Reference { part: known.part, id }) {
        Some(Resource::Display(display)) => match &model.displays[display] {
            Display::Each(each) => each.get(entry).or(each.first()),
            Display::Textured(_) => None,
        },
        _ => None,
    };
    match found {
        Some(appearance) => show(&mut spec, *appearance, colour.map_or(Rgb::WHITE, |c| c.rgb), model.unit),
        None => {
            let what = format!("there are no display properties {id} for a material: its colour is shown");
            sink.diagnostics.note(&what, Default::default);
        }
    }
    spec
}

/// Sets how a material looks, beyond its colour.
fn show(spec: &mut Spec, appearance: Appearance, colour: Rgb, unit: f64) {
    let set = &mut spec.parameters;
    match appearance {
        Appearance::Metallic { metalness, roughness } => {
            set.set("base_metalness", metalness);
            set.set("specular_roughness", roughness);
        }
        Appearance::Specular { colour: specular, roughness } => {
            let (base, metalness) = as_metal(colour, specular);
            set.set("base_color", base);
            set.set("base_metalness", metalness);
            set.set("specular_roughness", roughness);
        }
        Appearance::Translucent { attenuation, ior, roughness } => {
            set.set("transmission_weight", 1.0);
            set.set("specular_ior", ior.clamp(1.0, 3.0));
            set.set("specular_roughness", roughness);
            // Attenuation is per metre; the depth is a unit of the file.
            set.set("transmission_color", attenuation.map(|a| exp(-a * unit as f32)));
            set.set("transmission_depth", Value::Number(1.0));
        }
    }
}
