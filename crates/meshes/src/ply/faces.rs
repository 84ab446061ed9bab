//! Faces and triangle strips, with what each face and each corner has of its own.

use super::header::{Element, Property, Scalar};
use super::reader::Ply;
use super::slots::{FaceSlots, lists_uvs, lists_vertices};
use bilux_import::FormatError;
use bilux_import::meshes::indexed_faces::{Corner, FaceColour, NONE};
use bilux_math::{Rgb, Vec2};

impl Ply<'_, '_, '_> {
    pub(super) fn faces(&mut self, element: &Element, strips: bool) -> Result<(), FormatError> {
        if !element.properties.iter().any(lists_vertices) {
            let message = format!("the element '{}' has no list 'vertex_indices'", element.name);
            return Err(FormatError::malformed(message, self.places.at(element.offset)));
        }
        let look = FaceSlots::of(element, strips);
        self.report_unused(element, |p| look.uses(p, &element.properties[p]));
        let mut corners = Vec::new();
        for _ in 0..element.count {
            let start = self.body.offset();
            let (mut wedges, mut colour, mut texture) = (None, [0.0; 3], None);
            for (p, property) in element.properties.iter().enumerate() {
                if lists_vertices(property) {
                    self.indices(property, strips, start, &mut corners)?;
                } else if lists_uvs(property) && !strips {
                    wedges = Some(self.wedges(property)?);
                } else if let Some(channel) = look.channel(p) {
                    colour[channel] = self.body.number(property.scalar)?;
                } else if look.texture == Some(p) {
                    texture = Some(self.body.integer(property.scalar)?);
                } else {
                    self.skip(property)?;
                }
            }
            if let Some(uvs) = wedges {
                self.set_wedges(&mut corners, uvs, start);
            }
            let faces = self.indexed.faces.len();
            self.end_face(&mut corners, start)?;
            if self.indexed.faces.len() > faces {
                self.dress_face(look.colour.is_some().then_some(colour), texture)?;
            }
            self.end_row(start);
        }
        self.face_colours = self.face_colours.or(look.stored);
        Ok(())
    }

    /// Sets the colour and the texture of the last face.
    fn dress_face(&mut self, colour: Option<[f32; 3]>, texture: Option<i64>) -> Result<(), FormatError> {
        let face = self.indexed.faces.len() - 1;
        if let Some(colour) = colour {
            self.reading.budget.take::<FaceColour>(1, self.source.name)?;
            self.indexed.face_colours.set(face, Rgb::from_array(colour));
        }
        if let Some(texture) = texture {
            // For the list, and for sorting by it.
            self.reading.budget.take::<[u64; 8]>(1, self.source.name)?;
            self.face_textures.resize(face, NONE);
            self.face_textures.push(u32::try_from(texture).unwrap_or(NONE));
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
            self.diagnostics.note(what, || places.at(start));
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
                self.diagnostics.note(what, || places.at(start));
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
}

/// Vertices may follow later in the file, with their normals and uvs, which are resolved at the end.
fn corner_of(vertex: u32) -> Corner {
    [vertex, NONE, NONE]
}
