//! Reads text STL.

use bilux_import::FormatError;
use bilux_import::bytes::float::{parse_f32, parse_relative};
use bilux_import::bytes::text::{Cursor, Places, is_comment, name_of, quoted};
use bilux_import::geometry::colours::{Greatest, Stored, UNCOLOURED, decoded};
use bilux_import::geometry::polygon::Triangulator;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut reader = Ascii {
        reading,
        source,
        cursor: Cursor::new(source.bytes),
        places: Places::new(source.name, source.bytes),
        scene: SceneBuilder::default(),
        diagnostics: Diagnostics::default(),
        mesh: Mesh::default(),
        corners: Vec::new(),
        colour: None,
        triangulator: Triangulator::default(),
    };
    reader.statements()?;
    let Ascii { mut scene, diagnostics, .. } = reader;
    decode_all(&mut scene);
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

struct Ascii<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    cursor: Cursor<'a>,
    places: Places<'a>,
    scene: SceneBuilder,
    diagnostics: Diagnostics,
    mesh: Mesh,
    /// The corners of the current loop.
    corners: Vec<Vec3>,
    /// The colour of the next facets, as stored.
    colour: Option<Rgb>,
    triangulator: Triangulator,
}

impl Ascii<'_, '_, '_> {
    fn statements(&mut self) -> Result<(), FormatError> {
        // The start of the current facet.
        let mut facet = None;
        while !self.cursor.is_done() {
            self.cursor.skip_blanks();
            let start = self.cursor.offset();
            let word = self.cursor.word();
            match word.to_ascii_lowercase().as_slice() {
                b"" => {}
                b"facet" => facet = Some(start),
                b"color" | b"colour" => self.colour(start),
                line if is_comment(line) => {
                    self.cursor.rest_of_line();
                }
                b"vertex" if facet.is_some() => self.vertex()?,
                b"endfacet" => {
                    self.end_facet(start)?;
                    facet = None;
                }
                b"outer" | b"endloop" | b"end" => {}
                // Some programs write the name without a blank.
                word if word.starts_with(b"solid") => {
                    self.cursor.seek(start + b"solid".len());
                    self.begin_solid()?;
                }
                word if word.starts_with(b"endsolid") => {}
                _ => {
                    let message = format!(
                        "{} is not expected here: a text STL has 'facet', 'outer loop', three times 'vertex x y z', \
                         'endloop', 'endfacet'",
                        quoted(word)
                    );
                    return Err(FormatError::malformed(message, self.places.at(start)));
                }
            }
            self.cursor.end_line();
        }
        if let Some(start) = facet {
            let message = "the file ends within this facet: it was cut off";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        self.end_solid()
    }

    /// `color r g b`, which some programs write for the facets that follow.
    fn colour(&mut self, start: usize) {
        let mut colour = [0.0; 3];
        for channel in &mut colour {
            let Some(number) = parse_f32(self.cursor.word()) else {
                let places = &self.places;
                self.diagnostics.note("a colour is not three numbers, and is ignored", || places.at(start));
                return;
            };
            *channel = number;
        }
        self.colour = Some(Rgb::from_array(colour));
    }

    fn begin_solid(&mut self) -> Result<(), FormatError> {
        self.end_solid()?;
        self.colour = None;
        self.mesh.name = name_of(self.cursor.rest_of_line());
        Ok(())
    }

    fn end_solid(&mut self) -> Result<(), FormatError> {
        let mesh = std::mem::take(&mut self.mesh);
        if mesh.triangles.is_empty() {
            return Ok(());
        }
        self.reading.budget.take::<(Object, Mesh)>(1, self.source.name)?;
        let name = if mesh.name.is_empty() { self.source.stem() } else { mesh.name.clone() };
        self.scene.objects.push(Object::new(&name, Arc::new(mesh), 0));
        Ok(())
    }

    fn vertex(&mut self) -> Result<(), FormatError> {
        let mut point = [0.0; 3];
        for (number, origin) in point.iter_mut().zip(self.reading.origin.to_array()) {
            let word = self.cursor.word();
            *number = parse_relative(word, origin).ok_or_else(|| {
                let at = self.places.at(self.cursor.offset() - word.len());
                let message = match word {
                    b"" => "a vertex has three numbers, but the line ends earlier".to_owned(),
                    word => format!("{} is not a number; a vertex has three", quoted(word)),
                };
                FormatError::malformed(message, at)
            })?;
        }
        let point = Vec3::from(point);
        if !point.is_finite() {
            let (places, offset) = (&self.places, self.cursor.offset());
            let what = "a vertex has numbers that are infinite or not numbers (NaN); it is kept";
            self.diagnostics.note(what, || places.at(offset));
        }
        self.reading.budget.take::<(Vec3, [u32; 3], Rgb)>(1, self.source.name)?;
        self.corners.push(point);
        Ok(())
    }

    /// A facet is a triangle; some exporters write more corners.
    fn end_facet(&mut self, start: usize) -> Result<(), FormatError> {
        let (corners, mesh) = (&self.corners, &mut self.mesh);
        if corners.len() < 3 {
            let message = format!("a facet with {} corners ends here: it needs three", corners.len());
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        let first = mesh.positions.len();
        if (first + corners.len()) as u64 >= u64::from(u32::MAX) {
            let message = "there are more than 4 billion corners: split the file";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        let triangles = &mut mesh.triangles;
        let whole = self
            .triangulator
            .triangulate(corners.iter().copied(), |t| triangles.push(t.map(|i| first as u32 + i)));
        mesh.positions.extend_from_slice(corners);
        if self.colour.is_some() || !mesh.vertex_kd.is_empty() {
            mesh.vertex_kd.resize(first, UNCOLOURED);
            mesh.vertex_kd.resize(mesh.positions.len(), self.colour.unwrap_or(UNCOLOURED));
        }
        self.corners.clear();
        if whole.is_none() {
            let places = &self.places;
            let what =
                "a concave polygon has too many corners to triangulate exactly and is treated as convex";
            self.diagnostics.note(what, || places.at(start));
        }
        Ok(())
    }
}

/// Replaces the stored colours of all solids by reflectances.
fn decode_all(scene: &mut SceneBuilder) {
    let mut greatest = Greatest::default();
    scene.objects.iter().flat_map(|object| &object.mesh.vertex_kd).for_each(|colour| greatest.see(*colour));
    let white = greatest.white(Stored::Numbers);
    for object in scene.objects.iter_mut().filter(|object| !object.mesh.vertex_kd.is_empty()) {
        let colours = &mut Arc::make_mut(&mut object.mesh).vertex_kd;
        colours.iter_mut().for_each(|colour| *colour = decoded(*colour, white));
    }
}
