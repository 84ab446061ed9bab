//! Reads text STL.

use crate::FormatError;
use crate::float::parse_f32;
use crate::polygon::Triangulator;
use crate::reading::{Oddities, Reading, Source};
use crate::text::{Cursor, Places, name_of, quoted};
use bilux_math::Vec3;
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut reader = Ascii {
        reading,
        source,
        cursor: Cursor::new(source.bytes),
        places: Places::new(source.name, source.bytes),
        scene: SceneBuilder::default(),
        oddities: Oddities::default(),
        mesh: Mesh::default(),
        corners: Vec::new(),
        triangulator: Triangulator::default(),
    };
    reader.statements()?;
    let Ascii { mut scene, oddities, .. } = reader;
    oddities.into_warnings(&mut scene);
    Ok(scene)
}

struct Ascii<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    cursor: Cursor<'a>,
    places: Places<'a>,
    scene: SceneBuilder,
    oddities: Oddities,
    mesh: Mesh,
    /// The corners of the current loop.
    corners: Vec<Vec3>,
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
                b"solid" => self.begin_solid()?,
                b"facet" => facet = Some(start),
                b"vertex" if facet.is_some() => self.vertex()?,
                b"endfacet" => {
                    self.end_facet(start)?;
                    facet = None;
                }
                b"endsolid" | b"outer" | b"endloop" | b"end" => {}
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

    fn begin_solid(&mut self) -> Result<(), FormatError> {
        self.end_solid()?;
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
        for number in &mut point {
            let word = self.cursor.word();
            *number = parse_f32(word).ok_or_else(|| {
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
            self.oddities.note(what, || places.at(offset));
        }
        self.reading.budget.take::<(Vec3, [u32; 3])>(1, self.source.name)?;
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
        self.corners.clear();
        if whole.is_none() {
            let places = &self.places;
            let what =
                "a concave polygon has too many corners to triangulate exactly and is treated as convex";
            self.oddities.note(what, || places.at(start));
        }
        Ok(())
    }
}
