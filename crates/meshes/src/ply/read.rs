//! Reads PLY.

use super::body::Body;
use super::direct::can_be;
use super::header::{Element, read_header};
use super::reader::Ply;
use super::slots::{MEANINGS, Slots};
use super::splats;
use super::strokes;
use bilux_import::FormatError;
use bilux_import::bytes::text::{Places, quoted};
use bilux_import::geometry::colours::decode;
use bilux_import::geometry::normals::{BY_ANGLE, FLAT};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::meshes::indexed_faces::{IndexedFaces, NONE, assemble};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::SceneBuilder;
use std::collections::HashMap;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let places = Places::new(source.name, source.bytes);
    let header = read_header(source, &places)?;
    let mut reader = Ply {
        reading,
        source,
        places: &places,
        body: Body::new(source, &places, header.encoding, header.body),
        indexed: IndexedFaces::default(),
        has_normals: false,
        has_uvs: false,
        triangles: None,
        edges: Vec::new(),
        splats: None,
        face_textures: Vec::new(),
        face_colours: None,
        wedge_uvs: Vec::new(),
        wedges: HashMap::new(),
        smoothing: if header.is_flat { FLAT } else { BY_ANGLE },
        diagnostics: Diagnostics::default(),
    };
    // If vertices have normals and faces have only their list, faces become triangles directly.
    let first = |name: &str| header.elements.iter().position(|element| element.name == name);
    let are_in_order = first("vertex").is_some_and(|vertex| Some(vertex) < first("face"));
    let are_few =
        header.elements.iter().filter(|e| matches!(&*e.name, "vertex" | "face" | "tristrips")).count() == 2;
    for element in &header.elements {
        let is_plain = are_in_order && are_few && element.name == "face" && can_be(element);
        if is_plain && (reader.has_normals || reader.reading.crease_angle <= 0.0) {
            reader.body.check_claim(element)?;
            reader.triangles = Some(reader.triangles_of(element)?);
        } else {
            reader.element(element)?;
        }
    }
    reader.finish(&header.textures, SceneBuilder::default())
}

impl Ply<'_, '_, '_> {
    fn element(&mut self, element: &Element) -> Result<(), FormatError> {
        if element.properties.is_empty() {
            // Its rows take no bytes, whatever their number.
            return Ok(());
        }
        self.body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" if splats::are_splats(element) => self.splats(element),
            "vertex" => self.vertices(element),
            "face" => self.faces(element, false),
            "tristrips" => self.faces(element, true),
            "edge" if strokes::has_both_ends(element) => self.edges(element),
            name => {
                let places = self.places;
                self.diagnostics.not_used(&quoted(name.as_bytes()), || places.at(element.offset));
                self.skip_element(element)
            }
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

    fn vertices(&mut self, element: &Element) -> Result<(), FormatError> {
        let slots = Slots::new(element);
        if !(0..3).all(|slot| slots.meaning.contains(&Some(slot))) {
            let is_packed = element.properties.iter().any(|p| p.name == "packed_position");
            let message = match is_packed {
                true => "these are compressed Gaussian splats, which cannot be read: save them uncompressed",
                false => "the element 'vertex' has no properties x, y and z",
            };
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        if element.count >= u64::from(NONE) {
            let message = "there are more than 4 billion vertices: split the file";
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        self.report_unused(element, |p| slots.meaning[p].is_some());
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
        (self.has_normals, self.has_uvs) = (slots.normals, slots.uvs);
        decode(&mut self.indexed.colours, slots.stored[0]);
        decode(&mut self.indexed.specular, slots.stored[1]);
        Ok(())
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
        // As stored: only when all are known is it known what white is.
        let colour = |first: usize| Rgb::new(values[first], values[first + 1], values[first + 2]);
        if slots.kd {
            indexed.colours.push(colour(8));
        }
        if slots.ks {
            indexed.specular.push(colour(11));
        }
        if values.iter().any(|x| !x.is_finite()) {
            let places = self.places;
            let what = "a vertex has numbers that are infinite or not numbers (NaN); it is kept";
            self.diagnostics.note(what, || places.at(start));
        }
    }

    fn finish(
        mut self,
        textures: &[(String, usize)],
        mut scene: SceneBuilder,
    ) -> Result<SceneBuilder, FormatError> {
        let triangles = self.triangles.take().unwrap_or_default();
        if triangles.is_empty() && self.indexed.faces.is_empty() {
            return self.finish_strokes(scene);
        }
        if !self.edges.is_empty() {
            let places = self.places;
            self.diagnostics.not_shown("edges, since there are faces", || places.whole());
        }
        if !triangles.is_empty() {
            return self.finish_triangles(textures, scene, triangles);
        }
        let (normals, uvs) = (self.has_normals, self.has_uvs);
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
        if let Some(stored) = self.face_colours {
            self.indexed.face_colours.decode(stored);
        }
        if !self.indexed.colours.is_empty() && !self.indexed.face_colours.is_empty() {
            let places = self.places;
            self.indexed.face_colours.clear();
            self.diagnostics.not_shown("colours of faces, since vertices have colours", || places.whole());
        }
        let materials = self.materials(textures, &mut scene)?;
        let Ply { reading, source, places, indexed, diagnostics, .. } = self;
        let place = |offset: u64| places.at(offset as usize);
        let mut sink = Sink { scene, diagnostics };
        assemble(reading, source, &place, indexed, materials, &mut sink)?;
        Ok(sink.finish())
    }
}
