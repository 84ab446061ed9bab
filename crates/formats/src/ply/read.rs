//! Reads PLY.

use super::body::Body;
use super::direct::can_be;
use super::header::{Element, Property, Scalar, read_header};
use super::slots::{MEANINGS, Slots};
use super::strokes;
use crate::FormatError;
use crate::indexed_faces::{Corner, IndexedFaces, NONE, Run, assemble};
use crate::normals::{BY_ANGLE, FLAT, Smoothing};
use crate::reading::{Oddities, Reading, Source, Texels, plain_material};
use crate::text::Places;
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let places = Places::new(source.name, source.bytes);
    let header = read_header(source, &places)?;
    let mut reader = Ply {
        reading,
        source,
        places: &places,
        body: Body::new(source, &places, header.encoding, header.body),
        indexed: IndexedFaces::default(),
        vertices: Slots::default(),
        triangles: None,
        edges: Vec::new(),
        wedge_uvs: Vec::new(),
        wedges: HashMap::new(),
        smoothing: if header.is_flat { FLAT } else { BY_ANGLE },
        oddities: Oddities::default(),
    };
    // If vertices have normals and faces have only their list, faces become triangles directly.
    let first = |name: &str| header.elements.iter().position(|element| element.name == name);
    let are_in_order = first("vertex").is_some_and(|vertex| Some(vertex) < first("face"));
    let are_few =
        header.elements.iter().filter(|e| matches!(&*e.name, "vertex" | "face" | "tristrips")).count() == 2;
    for element in &header.elements {
        let is_plain = are_in_order && are_few && element.name == "face" && can_be(element);
        if is_plain && (reader.vertices.normals || reader.reading.crease_angle <= 0.0) {
            reader.body.check_claim(element)?;
            reader.triangles = Some(reader.triangles_of(element)?);
        } else {
            reader.element(element)?;
        }
    }
    let (texture, scene) = (header.texture, SceneBuilder::default());
    reader.finish(texture, scene)
}

pub(super) struct Ply<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) places: &'a Places<'a>,
    pub(super) body: Body<'a>,
    pub(super) indexed: IndexedFaces,
    /// All triangles, if nothing has to be welded.
    triangles: Option<Vec<[u32; 3]>>,
    /// Edges, as pairs of vertices.
    pub(super) edges: Vec<[u32; 2]>,
    vertices: Slots,
    /// Distinct texture coordinates of corners, as opposed to vertices.
    wedge_uvs: Vec<Vec2>,
    /// The index of each of these, by its bits.
    wedges: HashMap<[u32; 2], u32>,
    /// The smoothing of faces without normals.
    smoothing: Smoothing,
    pub(super) oddities: Oddities,
}

impl Ply<'_, '_, '_> {
    fn element(&mut self, element: &Element) -> Result<(), FormatError> {
        if element.properties.is_empty() {
            // Its rows take no bytes, whatever their number.
            return Ok(());
        }
        self.body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => self.vertices(element),
            "face" => self.faces(element, false),
            "tristrips" => self.faces(element, true),
            "edge" if strokes::has_both_ends(element) => self.edges(element),
            _ => self.skip_element(element),
        }
    }

    fn skip_element(&mut self, element: &Element) -> Result<(), FormatError> {
        for _ in 0..element.count {
            for property in &element.properties {
                self.skip(property)?;
            }
            self.body.end_row();
        }
        Ok(())
    }

    pub(super) fn skip(&mut self, property: &Property) -> Result<(), FormatError> {
        let count = match property.count {
            Some(scalar) => self.body.integer(scalar)?,
            None => 1,
        };
        self.body.skip(property.scalar, count)
    }

    fn vertices(&mut self, element: &Element) -> Result<(), FormatError> {
        let slots = Slots::new(element);
        if !(0..3).all(|slot| slots.meaning.contains(&Some(slot))) {
            let message = "the element 'vertex' has no properties x, y and z";
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        if element.count >= u64::from(NONE) {
            let message = "there are more than 4 billion vertices: split the file";
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        let floats = 3 * (1 + usize::from(slots.normals) + usize::from(slots.kd) + usize::from(slots.ks))
            + 2 * usize::from(slots.uvs);
        // The count has been checked against the remaining bytes, so the memory is reserved at once.
        self.reading.budget.take_bytes(element.count * 4 * floats as u64, self.source.name)?;
        self.reserve(&slots, element.count as usize);
        let origin = self.reading.origin;
        let is_far = origin != DVec3::ZERO;
        let plain = slots.offsets(element).filter(|_| self.body.is_little() && !is_far);
        for _ in 0..element.count {
            let start = self.body.offset();
            let mut values = [0f32; MEANINGS.len()];
            if let Some((offsets, stride)) = &plain
                && let Some(row) = self.body.rest().get(..*stride)
            {
                for (slot, at) in offsets {
                    let bytes = row[*at..].first_chunk::<4>().copied().unwrap_or_default();
                    values[*slot] = f32::from_le_bytes(bytes);
                }
                self.body.pass(*stride);
                self.push_vertex(&values, &slots, start);
                continue;
            }
            for (property, meaning) in element.properties.iter().zip(&slots.meaning) {
                match meaning {
                    Some(slot @ 0..3) if is_far => {
                        values[*slot] = (self.body.wide_number(property.scalar)? - origin[*slot]) as f32;
                    }
                    Some(slot) => values[*slot] = self.body.number(property.scalar)?,
                    None => self.skip(property)?,
                }
            }
            self.end_row(start);
            self.push_vertex(&values, &slots, start);
        }
        self.vertices = slots;
        Ok(())
    }

    pub(super) fn end_row(&mut self, start: usize) {
        if self.body.end_row() {
            let places = self.places;
            self.oddities.note("a line has more values than the header declares", || places.at(start));
        }
    }

    fn reserve(&mut self, slots: &Slots, count: usize) {
        let indexed = &mut self.indexed;
        let additional = |wanted: bool| if wanted { count } else { 0 };
        indexed.positions.reserve_exact(count);
        indexed.normals.reserve_exact(additional(slots.normals));
        indexed.uvs.reserve_exact(additional(slots.uvs));
        indexed.colours.reserve_exact(additional(slots.kd));
        indexed.specular.reserve_exact(additional(slots.ks));
    }

    fn push_vertex(&mut self, values: &[f32; MEANINGS.len()], slots: &Slots, start: usize) {
        let indexed = &mut self.indexed;
        indexed.positions.push(Vec3::from_slice(&values[0..3]));
        if slots.normals {
            indexed.normals.push(Vec3::from_slice(&values[3..6]));
        }
        if slots.uvs {
            indexed.uvs.push(Vec2::from_slice(&values[6..8]));
        }
        let colour = |first: usize, scale: Option<f32>| {
            let stored = Rgb::new(values[first], values[first + 1], values[first + 2]);
            scale.map_or(stored, |one| stored.map(|c| srgb_decode(c / one)))
        };
        if slots.kd {
            indexed.colours.push(colour(8, slots.colour[0]));
        }
        if slots.ks {
            indexed.specular.push(colour(11, slots.colour[1]));
        }
        if values.iter().any(|x| !x.is_finite()) {
            let places = self.places;
            let what = "a vertex has numbers that are infinite or not numbers (NaN); it is kept";
            self.oddities.note(what, || places.at(start));
        }
    }

    fn faces(&mut self, element: &Element, strips: bool) -> Result<(), FormatError> {
        let is = |p: &Property, names: &[&str]| p.count.is_some() && names.contains(&p.name.as_str());
        if !element.properties.iter().any(|p| is(p, &["vertex_indices", "vertex_index"])) {
            let message = format!("the element '{}' has no list 'vertex_indices'", element.name);
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        let mut corners = Vec::new();
        for _ in 0..element.count {
            let start = self.body.offset();
            let mut wedges = None;
            for property in &element.properties {
                if is(property, &["vertex_indices", "vertex_index"]) {
                    self.indices(property, strips, start, &mut corners)?;
                } else if is(property, &["texcoord"]) && !strips {
                    wedges = Some(self.wedges(property)?);
                } else {
                    self.skip(property)?;
                }
            }
            if let Some(uvs) = wedges {
                self.set_wedges(&mut corners, uvs, start);
            }
            self.end_face(&mut corners, start)?;
            self.end_row(start);
        }
        Ok(())
    }

    /// Reads the corners of a face, or of a triangle strip, in which -1 starts a new strip.
    fn indices(
        &mut self,
        property: &Property,
        strips: bool,
        start: usize,
        corners: &mut Vec<Corner>,
    ) -> Result<(), FormatError> {
        let count = self.body.integer(property.count.unwrap_or(property.scalar))?;
        self.end_face(corners, start)?;
        let mut strip: [u32; 2] = [NONE; 2];
        let mut turned = false;
        for _ in 0..count {
            let index = self.body.integer(property.scalar)?;
            let vertex = u32::try_from(index).ok().filter(|&i| i != NONE);
            match vertex {
                None if strips && index == -1 => (strip, turned) = ([NONE; 2], false),
                None => {
                    let message = format!("this face refers to vertex {index}: vertices are counted from 0");
                    return Err(FormatError::malformed(message, self.places.at(start)));
                }
                Some(vertex) if strips => {
                    let [a, b] = strip;
                    if a != NONE {
                        let triangle = if turned { [b, a, vertex] } else { [a, b, vertex] };
                        corners.extend(triangle.map(corner_of));
                        self.end_face(corners, start)?;
                        turned = !turned;
                    }
                    strip = [b, vertex];
                }
                Some(vertex) => corners.push(corner_of(vertex)),
            }
        }
        if !strips && corners.len() < 3 {
            corners.clear();
            let places = self.places;
            let what = "a face has fewer than 3 corners and is left out";
            self.oddities.note(what, || places.at(start));
        }
        Ok(())
    }

    /// Adds the collected corners as a face, if there are any.
    fn end_face(&mut self, corners: &mut Vec<Corner>, start: usize) -> Result<(), FormatError> {
        if corners.is_empty() {
            return Ok(());
        }
        let indexed = &mut self.indexed;
        self.reading.budget.take::<Corner>(corners.len(), self.source.name)?;
        self.reading.budget.take::<[usize; 2]>(1, self.source.name)?;
        if (indexed.faces.corner_count() + corners.len()) as u64 >= u64::from(NONE) {
            let message = "there are more than 4 billion corners: split the file";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        indexed.smooth(self.smoothing);
        indexed.faces.push(corners);
        indexed.places.push(start as u64);
        corners.clear();
        Ok(())
    }

    /// The texture coordinates of each corner of a face, in order.
    fn wedges(&mut self, property: &Property) -> Result<Vec<Vec2>, FormatError> {
        let count = self.body.integer(property.count.unwrap_or(Scalar::U8))?;
        let mut uvs = Vec::new();
        for _ in 0..count / 2 {
            self.reading.budget.take::<[Vec2; 4]>(1, self.source.name)?;
            uvs.push(Vec2::new(self.body.number(property.scalar)?, self.body.number(property.scalar)?));
        }
        self.body.skip(property.scalar, count % 2)?;
        Ok(uvs)
    }

    fn set_wedges(&mut self, corners: &mut [Corner], uvs: Vec<Vec2>, start: usize) {
        if uvs.len() != corners.len() {
            if !uvs.is_empty() && !corners.is_empty() {
                let places = self.places;
                let what = "a face has different numbers of corners and of texture coordinates";
                self.oddities.note(what, || places.at(start));
            }
            return;
        }
        for (corner, uv) in corners.iter_mut().zip(uvs) {
            let all = &mut self.wedge_uvs;
            let next = all.len() as u32;
            corner[1] = *self.wedges.entry(uv.to_array().map(f32::to_bits)).or_insert(next);
            if corner[1] == next {
                all.push(uv);
            }
        }
    }

    fn finish(
        mut self,
        texture: Option<(String, usize)>,
        mut scene: SceneBuilder,
    ) -> Result<SceneBuilder, FormatError> {
        if let Some(triangles) = self.triangles.take().filter(|triangles| !triangles.is_empty()) {
            return self.finish_triangles(texture, scene, triangles);
        }
        if self.indexed.faces.is_empty() {
            return self.finish_strokes(scene);
        }
        if !self.edges.is_empty() {
            let places = self.places;
            self.oddities.note("edges are not rendered if there are faces", || places.whole());
        }
        let (normals, uvs) = (self.vertices.normals, self.vertices.uvs);
        let wedges = std::mem::take(&mut self.wedge_uvs);
        let uvs = uvs && wedges.is_empty();
        if !wedges.is_empty() {
            self.indexed.uvs = wedges;
        }
        for (_, corner) in self.indexed.faces.corners_mut() {
            let of_vertex = |given: bool| if given { corner[0] } else { NONE };
            *corner =
                [corner[0], if corner[1] == NONE { of_vertex(uvs) } else { corner[1] }, of_vertex(normals)];
        }
        self.indexed.runs.push(Run { first_face: 0, name: self.source.stem(), material: None });
        let mut materials = HashMap::new();
        if let Some((file, offset)) = texture {
            self.texture(&file, offset, &mut scene, &mut materials)?;
        }
        let Ply { reading, source, places, indexed, mut oddities, .. } = self;
        let place = |offset: u64| places.at(offset as usize);
        assemble(reading, source, &place, indexed, materials, &mut scene, &mut oddities)?;
        oddities.into_warnings(&mut scene);
        Ok(scene)
    }

    /// Adds the texture of the whole mesh, which MeshLab names in a comment.
    pub(super) fn texture(
        &mut self,
        file: &str,
        offset: usize,
        scene: &mut SceneBuilder,
        materials: &mut HashMap<String, usize>,
    ) -> Result<(), FormatError> {
        let at = self.places.at(offset);
        let texture = match self.reading.texture(self.source.folder, file, Texels::Colours, &at) {
            Ok(texture) => texture,
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let reason = error.without_place();
                scene.warn(format!("a texture is replaced by a magenta checker: {reason}"), at.clone());
                Arc::new(Texture::missing(file))
            }
        };
        let mut spec = plain_material(false, !self.indexed.specular.is_empty());
        spec.parameters.set_at("kd", Value::Texture(scene.textures.len()), at);
        scene.textures.push(texture);
        let index = scene.add_material(spec);
        materials.insert(String::new(), index);
        Ok(())
    }
}

/// Vertices may follow later in the file, with their normals and uvs, which are resolved at the end.
fn corner_of(vertex: u32) -> Corner {
    [vertex, NONE, NONE]
}
