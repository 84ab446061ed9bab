//! The resources of a part: objects, and the properties that they refer to. [3MF Materials 1.2]

use super::colour::Colour;
use super::groups::{
    Appearance, Base, Display, Group, GroupKind, Layers, Method, Picture, TexturedAppearance,
};
use super::model::Resource;
use super::namespaces::Namespace;
use super::part::{PartReader, undeclared};
use super::xml::{Element, Level};
use bilux_import::FormatError;
use bilux_import::bytes::text::quoted;
use bilux_math::{Rgb, Vec2};
use bilux_scene::texture::{Filter, Wrap};

impl PartReader<'_, '_> {
    pub(super) fn resources(&mut self, level: Level) -> Result<(), FormatError> {
        while let Some(child) = self.xml.child(level)? {
            match (child.namespace, child.name) {
                (Namespace::Core, "object") => self.object()?,
                (Namespace::Core, "basematerials") => self.group(Self::bases)?,
                (Namespace::Materials, "colorgroup") => self.group(Self::colours)?,
                (Namespace::Materials, "texture2dgroup") => self.group(Self::coordinates)?,
                (Namespace::Materials, "compositematerials") => self.group(Self::composites)?,
                (Namespace::Materials, "multiproperties") => self.group(Self::layers)?,
                (Namespace::Materials, "texture2d") => {
                    let picture = picture(&child)?;
                    let id = child.need_index("id")?;
                    let resource = Resource::Picture(self.model.pictures.len());
                    Self::register(self.reading, self.model, &child, self.part, id, resource)?;
                    self.reading.budget.take_bytes(256, &self.file)?;
                    self.model.pictures.push(picture);
                }
                (Namespace::Materials, name) if name.ends_with("displayproperties") => self.display()?,
                (Namespace::Slices, "slicestack") => {
                    let (id, at) = (child.need_index("id")?, child.at());
                    Self::register(self.reading, self.model, &child, self.part, id, Resource::Other)?;
                    self.diagnostics.not_shown("slices (the mesh is shown)", || at);
                }
                (Namespace::Named(what), _) => {
                    let at = child.at();
                    self.diagnostics.not_shown(what, || at);
                }
                (Namespace::Undeclared, name) => return Err(undeclared(&child, name)),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads the group of properties that has just been opened, whose entries `read` reads.
    fn group(
        &mut self,
        read: fn(&mut Self, Level) -> Result<GroupKind, FormatError>,
    ) -> Result<(), FormatError> {
        let id = self.id()?;
        let Some(element) = self.xml.current() else { return Ok(()) };
        let display = element.index("displaypropertiesid")?;
        let resource = Resource::Group(self.model.groups.len());
        Self::register(self.reading, self.model, &element, self.part, id, resource)?;
        let inside = element.inside;
        self.reading.budget.take::<Group>(1, &self.file)?;
        let kind = read(self, inside)?;
        self.model.groups.push(Group { kind, display, part: self.part });
        Ok(())
    }

    fn bases(&mut self, level: Level) -> Result<GroupKind, FormatError> {
        let (mut bases, file) = (Vec::new(), self.file.clone());
        while let Some(element) = self.xml.child(level)? {
            if element.name != "base" {
                continue;
            }
            let (name, colour) = (element.words("name").into_owned(), element.colour("displaycolor")?);
            self.reading.budget.take_bytes((2 * size_of::<Base>() + name.len()) as u64, &file)?;
            bases.push(Base { name, colour, display: element.index("displaypropertiesid")? });
        }
        Ok(GroupKind::Bases(bases))
    }

    fn colours(&mut self, level: Level) -> Result<GroupKind, FormatError> {
        let (mut colours, file) = (Vec::new(), self.file.clone());
        while let Some(element) = self.xml.child(level)? {
            if element.name == "color" {
                self.reading.budget.take::<Colour>(1, &file)?;
                colours.push(element.need_colour("color")?);
            }
        }
        Ok(GroupKind::Colours(colours))
    }

    fn coordinates(&mut self, level: Level) -> Result<GroupKind, FormatError> {
        let file = self.file.clone();
        let Some(element) = self.xml.current() else { return Ok(GroupKind::Colours(Vec::new())) };
        let id = element.need_index("texid")?;
        let Some(&Resource::Picture(picture)) = self.model.resources.get(&(self.part, id)) else {
            return Err(element.error(format!("no texture2d with the id {id} comes before this group")));
        };
        let mut uvs = Vec::new();
        while let Some(element) = self.xml.child(level)? {
            if element.name == "tex2coord" {
                self.reading.budget.take::<Vec2>(1, &file)?;
                uvs.push(Vec2::new(element.need_number("u")?, element.need_number("v")?));
            }
        }
        Ok(GroupKind::Coordinates { picture, uvs })
    }

    /// Mixtures of base materials, as colours in the same proportions.
    fn composites(&mut self, level: Level) -> Result<GroupKind, FormatError> {
        let file = self.file.clone();
        let Some(element) = self.xml.current() else { return Ok(GroupKind::Colours(Vec::new())) };
        let (id, indices) = (element.need_index("matid")?, element.indices("matindices")?);
        let group = match self.model.resources.get(&(self.part, id)) {
            // It is registered itself already, but not in the list yet.
            Some(&Resource::Group(group)) => self.model.groups.get(group).map(|group| &group.kind),
            _ => None,
        };
        let Some(GroupKind::Bases(bases)) = group else {
            let message =
                format!("composites mix base materials, but no basematerials with the id {id} come before");
            return Err(element.error(message));
        };
        let mut parts = Vec::new();
        for index in indices {
            let Some(base) = bases.get(index as usize) else {
                let message = format!("there is no base material {index}: the group has {}", bases.len());
                return Err(element.error(message));
            };
            self.reading.budget.take::<Colour>(1, &file)?;
            parts.push(base.colour.unwrap_or(Colour::WHITE));
        }
        let mut mixed = Vec::new();
        while let Some(element) = self.xml.child(level)? {
            if element.name == "composite" {
                self.reading.budget.take::<Colour>(1, &file)?;
                mixed.push(super::blend::mixture(&parts, &element.numbers("values")?));
            }
        }
        Ok(GroupKind::Mixtures(mixed))
    }

    fn layers(&mut self, level: Level) -> Result<GroupKind, FormatError> {
        let file = self.file.clone();
        let Some(element) = self.xml.current() else { return Ok(GroupKind::Colours(Vec::new())) };
        let (mut groups, mut has_material, mut has_colours) = (Vec::new(), false, false);
        // The places in pids of the layers that are shown.
        let mut places = Vec::new();
        for (place, id) in element.indices("pids")?.into_iter().enumerate() {
            let group = match self.model.resources.get(&(self.part, id)) {
                Some(&Resource::Group(group)) => group,
                Some(Resource::Picture(_)) => {
                    let at = element.at();
                    let what = "a layer names a texture2d instead of a texture2dgroup, and is left out";
                    self.diagnostics.note(what, || at);
                    continue;
                }
                _ => {
                    let message =
                        format!("pids names {id}, but no group of properties with this id comes before");
                    return Err(element.error(message));
                }
            };
            // Itself is registered already, but not in the list yet.
            let Some(known) = self.model.groups.get(group) else {
                return Err(element.error("multiproperties cannot be layers of multiproperties"));
            };
            let is_twice = match &known.kind {
                GroupKind::Layers(_) => {
                    return Err(element.error("multiproperties cannot be layers of multiproperties"));
                }
                GroupKind::Bases(_) | GroupKind::Mixtures(_) => std::mem::replace(&mut has_material, true),
                GroupKind::Colours(_) => std::mem::replace(&mut has_colours, true),
                GroupKind::Coordinates { .. } => false,
            };
            if is_twice {
                let message = "pids names two groups of base or composite materials, or two of colours: one of each is allowed";
                return Err(element.error(message));
            }
            self.reading.budget.take::<[usize; 2]>(1, &file)?;
            groups.push(group);
            places.push(place);
        }
        if groups.is_empty() {
            return Err(element.error("multiproperties need groups of properties in pids"));
        }
        let methods = methods(&element, groups.len())?;
        let mut indices = Vec::new();
        while let Some(element) = self.xml.child(level)? {
            if element.name != "multi" {
                continue;
            }
            self.reading.budget.take::<u32>(groups.len(), &file)?;
            let given = element.indices("pindices")?;
            for (&layer, &group) in places.iter().zip(&groups) {
                let (index, count) = (given.get(layer).copied().unwrap_or(0), self.model.groups[group].len());
                if count == 0 {
                    return Err(element.error(format!("layer {layer} of multiproperties is empty")));
                }
                let is_there = (index as usize) < count;
                if !is_there {
                    let what = "pindices names an entry that its layer does not have; it has the first one";
                    self.diagnostics.note(what, || element.at());
                }
                indices.push(if is_there { index } else { 0 });
            }
        }
        Ok(GroupKind::Layers(Layers { groups, methods, indices }))
    }

    /// Reads the display properties that have just been opened.
    fn display(&mut self) -> Result<(), FormatError> {
        let Some(element) = self.xml.current() else { return Ok(()) };
        let (id, inside, file) = (element.need_index("id")?, element.inside, self.file.clone());
        let resource = Resource::Display(self.model.displays.len());
        let picture =
            |name: &str| -> Result<usize, FormatError> {
                let id = element.need_index(name)?;
                match self.model.resources.get(&(self.part, id)) {
                    Some(&Resource::Picture(picture)) => Ok(picture),
                    _ => Err(element
                        .error(format!("{name} names {id}, but no texture2d with this id comes before"))),
                }
            };
        let factor = |name| element.number(name).map(|x| x.unwrap_or(1.0));
        let tint = |name| element.colour(name).map(|colour| colour.map_or(Rgb::WHITE, |colour| colour.rgb));
        let textured = match element.name {
            "pbmetallictexturedisplayproperties" => Some(TexturedAppearance::Metallic {
                metalness: picture("metallictextureid")?,
                roughness: picture("roughnesstextureid")?,
                factors: [factor("metallicfactor")?, factor("roughnessfactor")?],
                base: tint("basecolorfactor")?,
            }),
            "pbspeculartexturedisplayproperties" => Some(TexturedAppearance::Specular {
                colour: picture("speculartextureid")?,
                glossiness: picture("glossinesstextureid")?,
                factor: tint("specularfactor")?,
                glossiness_factor: factor("glossinessfactor")?,
                base: tint("diffusefactor")?,
            }),
            _ => None,
        };
        Self::register(self.reading, self.model, &element, self.part, id, resource)?;
        self.reading.budget.take::<Display>(1, &file)?;
        let display = match textured {
            Some(textured) => Display::Textured(textured),
            None => {
                let mut each = Vec::new();
                while let Some(element) = self.xml.child(inside)? {
                    if let Some(appearance) = appearance(&element)? {
                        self.reading.budget.take::<Appearance>(1, &file)?;
                        each.push(appearance);
                    }
                }
                Display::Each(each)
            }
        };
        self.model.displays.push(display);
        Ok(())
    }
}

/// Appearance of a material, from an element of display properties.
fn appearance(element: &Element) -> Result<Option<Appearance>, FormatError> {
    let part = |name, default: f32| element.number(name).map(|x| x.unwrap_or(default).clamp(0.0, 1.0));
    let triple = |name: &str| -> Result<[f32; 3], FormatError> {
        let numbers = element.numbers(name)?;
        <[f32; 3]>::try_from(numbers)
            .map_err(|_| element.wrong(name, element.get(name).unwrap_or_default(), "three numbers"))
    };
    Ok(match element.name {
        "pbmetallic" => Some(Appearance::Metallic {
            metalness: part("metallicness", 0.0)?,
            roughness: part("roughness", 1.0)?,
        }),
        "pbspecular" => Some(Appearance::Specular {
            colour: element.colour("specularcolor")?.map_or(Rgb::grey(0.04), |colour| colour.rgb),
            roughness: 1.0 - part("glossiness", 0.0)?,
        }),
        "translucent" => {
            let [r, g, b] = triple("attenuation")?.map(|x| x.max(0.0));
            let ior =
                if element.get("refractiveindex").is_some() { triple("refractiveindex")?[1] } else { 1.0 };
            Some(Appearance::Translucent {
                attenuation: Rgb::new(r, g, b),
                ior,
                roughness: part("roughness", 0.0)?,
            })
        }
        _ => None,
    })
}

/// Blend of each layer but the first with those below.
fn methods(element: &Element, layers: usize) -> Result<Vec<Method>, FormatError> {
    let mut methods = Vec::new();
    for word in element.get("blendmethods").unwrap_or_default().split_ascii_whitespace() {
        methods.push(match word {
            "mix" => Method::Mix,
            "multiply" => Method::Multiply,
            other => {
                return Err(element.wrong(
                    "blendmethods",
                    other,
                    "mix or multiply for each layer but the first",
                ));
            }
        });
    }
    methods.truncate(layers.saturating_sub(1));
    methods.resize(layers.saturating_sub(1), Method::Mix);
    Ok(methods)
}

fn picture(element: &Element) -> Result<Picture, FormatError> {
    let (path, kind) = (element.need("path")?, element.need("contenttype")?);
    if !matches!(kind, "image/png" | "image/jpeg") {
        let message = format!(
            "a texture has the content type image/png or image/jpeg, not {}",
            quoted(kind.as_bytes())
        );
        return Err(element.error(message));
    }
    let wrap = |name: &str| -> Result<Wrap, FormatError> {
        Ok(match element.get(name) {
            None | Some("wrap") => Wrap::Repeat,
            Some("mirror") => Wrap::Mirror,
            Some("clamp" | "none") => Wrap::Clamp,
            Some(other) => return Err(element.wrong(name, other, "wrap, mirror, clamp or none")),
        })
    };
    let filter = if element.get("filter") == Some("nearest") { Filter::Nearest } else { Filter::Linear };
    let path = super::attributes::unescaped(path).into_owned();
    Ok(Picture { path, wrap: [wrap("tilestyleu")?, wrap("tilestylev")?], filter, at: element.at() })
}
