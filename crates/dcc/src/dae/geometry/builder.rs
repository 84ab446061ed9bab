//! A mesh under construction: corners with what they have, primitive after primitive.

use super::channel::{Channel, Range};
use crate::dae::data::{Input, input};
use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{Layer, Mapping, PolygonMesh, Polygons, Workshop, reflectances};
use bilux_math::{Rgb, Vec2, Vec3};

/// A symbol, to which nodes bind a material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::dae) struct Symbol<'d> {
    pub(in crate::dae) name: Option<&'d str>,
    /// The numbers of the sets of texture coordinates, the first one first.
    pub(in crate::dae) sets: Vec<u32>,
}

/// The inputs of texture coordinates, of each set once.
fn texture_sets<'a, 'd>(inputs: &'a [Input<'d>]) -> impl Iterator<Item = &'a Input<'d>> {
    let is_uv = |input: &Input| input.semantic == "TEXCOORD";
    inputs
        .iter()
        .enumerate()
        .filter(move |(i, input)| {
            is_uv(input) && !inputs[..*i].iter().any(|other| is_uv(other) && other.set == input.set)
        })
        .map(|(_, input)| input)
}

/// A mesh under construction.
pub(super) struct Builder {
    positions: Channel<Vec3>,
    polygons: Polygons,
    normals: Option<Channel<Vec3>>,
    uvs: [Option<Channel<Vec2>>; 2],
    colours: Option<Channel<Rgb>>,
    materials: Vec<i32>,
    /// Ranges of the current primitive.
    ranges: Ranges,
    material: i32,
}

/// The ranges of values to which the vertices of a primitive refer.
#[derive(Default)]
struct Ranges {
    position: Option<Range>,
    normal: Option<Range>,
    uvs: [Option<Range>; 2],
    colour: Option<Range>,
}

fn vec3(row: &[f32]) -> Vec3 {
    let at = |i: usize| row.get(i).copied().unwrap_or(0.0);
    Vec3::new(at(0), at(1), at(2))
}

fn vec2(row: &[f32]) -> Vec2 {
    vec3(row).truncate()
}

fn rgb(row: &[f32]) -> Rgb {
    Rgb::from_array(vec3(row).to_array())
}

impl Builder {
    /// An empty mesh for primitives with these inputs.
    pub(super) fn for_inputs<'a, 'd: 'a>(all: impl Iterator<Item = &'a [Input<'d>]> + Clone) -> Builder {
        let has = |semantic: &str| all.clone().any(|inputs| input(inputs, semantic).is_some());
        let has_second = all.clone().any(|inputs| texture_sets(inputs).count() > 1);
        Builder {
            positions: Channel::new(),
            polygons: Polygons::default(),
            normals: has("NORMAL").then(Channel::new),
            uvs: [has("TEXCOORD").then(Channel::new), has_second.then(Channel::new)],
            colours: has("COLOR").then(Channel::new),
            materials: Vec::new(),
            ranges: Ranges::default(),
            material: 0,
        }
    }

    /// True if the current primitive has positions.
    pub(super) fn has_positions(&self) -> bool {
        self.ranges.position.is_some()
    }

    /// Begins a primitive.
    pub(super) fn begin<'d>(
        &mut self,
        element: Element<'d>,
        inputs: &[Input<'d>],
        symbols: &mut Vec<Symbol<'d>>,
        document: &Document<'d>,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        let budget = &mut *workshop.budget;
        let named = |semantic: &str| inputs.iter().find(|input| input.semantic == semantic);
        let mut ranges = Ranges::default();
        if let Some(input) = named("POSITION") {
            ranges.position =
                Some(self.positions.range(input.source, input.offset, vec3, document, budget)?);
        }
        if let (Some(input), Some(channel)) = (named("NORMAL"), &mut self.normals) {
            ranges.normal = Some(channel.range(input.source, input.offset, vec3, document, budget)?);
        }
        if let (Some(input), Some(channel)) = (named("COLOR"), &mut self.colours) {
            ranges.colour = Some(channel.range(input.source, input.offset, rgb, document, budget)?);
        }
        let sets = texture_sets(inputs);
        for ((range, channel), input) in ranges.uvs.iter_mut().zip(&mut self.uvs).zip(sets) {
            if let Some(channel) = channel {
                *range = Some(channel.range(input.source, input.offset, vec2, document, budget)?);
            }
        }
        if texture_sets(inputs).count() > 2 {
            let what = "sets of texture coordinates after the second";
            workshop.diagnostics.not_used(what, || element.at());
        }
        let sets = texture_sets(inputs).map(|input| input.set.unwrap_or(0)).collect();
        let symbol = Symbol { name: element.attribute("material"), sets };
        let known = symbols.iter().position(|known| *known == symbol);
        self.material = known.unwrap_or_else(|| {
            symbols.push(symbol);
            symbols.len() - 1
        }) as i32;
        self.ranges = ranges;
        Ok(())
    }

    /// The position of a vertex of the current primitive.
    pub(super) fn position(&self, vertex: &[i32]) -> Option<Vec3> {
        let place = self.ranges.position?.place(vertex)?;
        self.positions.values().get(place as usize).copied()
    }

    /// Adds a polygon of these vertices, each with its indices.
    pub(super) fn polygon<'v>(
        &mut self,
        vertices: impl Iterator<Item = &'v [i32]>,
        list: Element,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        let Some(position) = self.ranges.position else { return Ok(()) };
        let start = self.polygons.corners.len();
        let mut is_whole = true;
        for vertex in vertices {
            workshop.budget.take::<[u32; 5]>(1, list.file())?;
            let place = position.place(vertex);
            is_whole &= place.is_some();
            self.polygons.corners.push(place.unwrap_or(0));
            if let Some(channel) = &mut self.normals {
                channel.push(self.ranges.normal, vertex);
            }
            for (channel, range) in self.uvs.iter_mut().zip(self.ranges.uvs) {
                if let Some(channel) = channel {
                    channel.push(range, vertex);
                }
            }
            if let Some(channel) = &mut self.colours {
                channel.push(self.ranges.colour, vertex);
            }
        }
        self.materials.push(self.material);
        workshop.budget.take::<[u32; 2]>(1, list.file())?;
        self.polygons.end(start, is_whole, || list.at(), workshop, list.file())
    }

    /// The mesh; `None` if it has no polygons.
    pub(super) fn finish(self, geometry: Element, workshop: &mut Workshop) -> Option<PolygonMesh> {
        if self.polygons.is_empty() || self.positions.values().is_empty() {
            return None;
        }
        if self.positions.values().iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
            workshop.diagnostics.note(what, || geometry.at());
        }
        let colours = self.colours.map(Channel::into_layer).unwrap_or_default();
        Some(PolygonMesh {
            name: geometry.label(),
            positions: self.positions.into_values(),
            polygons: self.polygons,
            normals: self.normals.map(Channel::into_layer).unwrap_or_default(),
            uvs: self.uvs.map(|channel| channel.map(Channel::into_layer).unwrap_or_default()),
            colours: reflectances(colours, workshop, || geometry.at()),
            materials: Layer::indexed(self.materials, Vec::new(), Mapping::ByPolygon),
            smoothing: Layer::default(),
            is_mirrored: false,
        })
    }
}
