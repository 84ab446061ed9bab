//! Reads `.asc`.

use bilux_import::FormatError;
use bilux_import::bytes::float::{parse_f32, parse_f64};
use bilux_import::bytes::text::{Cursor, Places, name_of, no_text, quoted};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source, plain_material};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Numbers of a plain vertex: position, normal and uv. The other strides add to these.
const PLAIN: usize = 8;
/// A plain vertex followed by an integer whose meaning is unknown.
const NINTH: usize = 9;
/// A plain vertex followed by kd and ks.
const COLOURED: usize = 14;
/// The maximum count of numbers on a line: three coloured vertices.
const MAX: usize = 3 * COLOURED;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut reader = Asc {
        reading,
        cursor: Cursor::new(source.bytes),
        places: Places::new(source.name, source.bytes),
        name: source.name.clone(),
        scene: SceneBuilder::default(),
        diagnostics: Diagnostics::default(),
        group: Group { name: source.stem(), ..Group::default() },
        materials: HashMap::new(),
    };
    reader.groups().map_err(|error| no_text(error, source.bytes))?;
    let Asc { mut scene, diagnostics, places, .. } = reader;
    if scene.objects.is_empty() {
        let message = "it contains no triangles: each is a line with a word, then three lines of 8 numbers \
                       (x y z, nx ny nz, u v)";
        return Err(FormatError::malformed(message, places.whole()));
    }
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

struct Asc<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    cursor: Cursor<'a>,
    places: Places<'a>,
    name: Arc<str>,
    scene: SceneBuilder,
    diagnostics: Diagnostics,
    group: Group,
    /// Index of each material, keyed by its values.
    materials: HashMap<String, usize>,
}

/// The triangles of one object, collected until the next `object` line.
#[derive(Default)]
struct Group {
    name: String,
    mesh: Mesh,
    config: Option<Spec>,
}

/// The words of a line, parsed as numbers.
struct Numbers {
    values: [f64; MAX],
    count: usize,
}

impl Asc<'_, '_, '_> {
    fn groups(&mut self) -> Result<(), FormatError> {
        // Start of the previous line, if that was a keyword line.
        let mut keyword = None;
        loop {
            self.skip_empty_lines();
            self.cursor.skip_blanks();
            if self.cursor.is_done() {
                break;
            }
            let start = self.cursor.offset();
            let first = self.cursor.peek_word();
            if keyword.is_some() && parse_f32(first).is_some() {
                self.triangle()?;
                keyword = None;
                continue;
            }
            self.cursor.word();
            if let Some(before) = keyword.replace(start) {
                self.note_line_without_triangle(before);
            }
            match first {
                b"object" => self.begin_group()?,
                b"config" if self.next_is_number() => {
                    self.config(start)?;
                    keyword = None;
                }
                _ => self.after_keyword(start)?,
            }
        }
        if let Some(start) =
            keyword.filter(|_| !self.scene.objects.is_empty() || !self.group.mesh.triangles.is_empty())
        {
            let message = "the file ends after this line, where a triangle should follow: it was cut off";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        self.finish_group()
    }

    /// Ordinary files have no such lines except `object`, `config` and comments.
    fn note_line_without_triangle(&mut self, start: usize) {
        let mut line = Cursor::new(&self.places.bytes()[start..]);
        let word = line.word();
        if word != b"object" && !word.starts_with(b"#") && !word.starts_with(b"//") {
            let places = &self.places;
            self.diagnostics.note("a line is not followed by a triangle and is ignored", || places.at(start));
        }
    }

    fn next_is_number(&self) -> bool {
        parse_f32(self.cursor.peek_word()).is_some()
    }

    /// Reads the rest of a keyword line: arbitrary text, or the numbers of the triangle after the keyword.
    fn after_keyword(&mut self, start: usize) -> Result<(), FormatError> {
        let mut ahead = self.cursor.clone();
        let mut count = 0;
        while parse_f32(ahead.word()).is_some() {
            count += 1;
        }
        let is_number = parse_f32(&self.places.bytes()[start..self.cursor.offset()]).is_some();
        if is_number && count > 0 {
            let message = "a triangle begins with a line of one word, but this is a line of numbers: are there \
                           three vertices to each triangle?";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        if stride_of(count).is_none() {
            self.cursor.end_line();
        }
        Ok(())
    }

    /// `object NAME`: starts a new object. A name that begins with `-` is a comment.
    fn begin_group(&mut self) -> Result<(), FormatError> {
        self.finish_group()?;
        let name = self.cursor.rest_of_line();
        self.cursor.end_line();
        self.group.name = if name.starts_with(b"-") { String::new() } else { name_of(name) };
        Ok(())
    }

    /// `config ks.r ks.g ks.b kd.r kd.g kd.b reflectivity`.
    fn config(&mut self, start: usize) -> Result<(), FormatError> {
        let numbers = self.line_of_numbers()?;
        if numbers.count != 7 {
            let message = format!(
                "'config' takes 7 numbers (ks red, green, blue, kd red, green, blue, reflectivity), not {}",
                numbers.count
            );
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        if !self.group.mesh.triangles.is_empty() {
            self.finish_group()?;
        }
        let [ks_r, ks_g, ks_b, kd_r, kd_g, kd_b, reflectivity, ..] = numbers.values;
        let span = self.places.at(start);
        let mut spec = Spec { span: span.clone(), ..Spec::new("", "phong") };
        let triple = |c: [f64; 3]| Value::triple(c.map(|c| c as f32));
        let values = [
            ("kd", triple([kd_r, kd_g, kd_b])),
            ("ks", triple([ks_r, ks_g, ks_b])),
            ("reflectivity", (reflectivity as f32).into()),
        ];
        for (key, value) in values {
            spec.parameters.set_at(key, value, span.clone());
        }
        self.group.config = Some(spec);
        Ok(())
    }

    /// Reads three vertices. The first line determines how many numbers each has; later lines may be broken
    /// anywhere.
    fn triangle(&mut self) -> Result<(), FormatError> {
        let start = self.cursor.offset();
        let mut numbers = self.line_of_numbers()?;
        let broken = numbers.count < PLAIN;
        let Some(stride) = stride_of(numbers.count).or(broken.then_some(PLAIN)) else {
            let found = numbers.count;
            let message =
                format!("a vertex has 8 numbers (x y z, nx ny nz, u v), or 14 with kd and ks, not {found}");
            return Err(FormatError::malformed(message, self.places.at(start)));
        };
        let needed = 3 * stride;
        while numbers.count < needed {
            self.skip_empty_lines();
            let line = self.cursor.offset();
            let count = numbers.count;
            if self.cursor.is_done() {
                let message =
                    format!("the file ends after {count} of a triangle's {needed} numbers: it was cut off");
                return Err(FormatError::malformed(message, self.places.at(line)));
            }
            let more = self.line_of_numbers()?;
            let fits = if broken { count + more.count <= needed } else { more.count == stride };
            if !fits {
                let cut_off = if self.cursor.is_done() { ": the file was cut off here" } else { "" };
                let count = more.count;
                let message = format!("this vertex has {count} numbers, but {stride} were expected{cut_off}");
                return Err(FormatError::malformed(message, self.places.at(line)));
            }
            numbers.values[count..count + more.count].copy_from_slice(&more.values[..more.count]);
            numbers.count += more.count;
        }
        if numbers.values[..numbers.count].iter().any(|x| !x.is_finite()) {
            let places = &self.places;
            self.diagnostics
                .note("a triangle has numbers that are infinite or not numbers (NaN); it is kept", || {
                    places.at(start)
                });
        }
        if stride == NINTH {
            let places = &self.places;
            self.diagnostics.note("a ninth number per vertex is ignored", || places.at(start));
        }
        self.push(&numbers.values, stride)
    }

    fn skip_empty_lines(&mut self) {
        while self.cursor.peek_word().is_empty() && !self.cursor.is_done() {
            self.cursor.end_line();
        }
    }

    /// Parses all words up to the end of the line as numbers.
    fn line_of_numbers(&mut self) -> Result<Numbers, FormatError> {
        let is_far = self.reading.origin != DVec3::ZERO;
        let mut numbers = Numbers { values: [0.0; MAX], count: 0 };
        loop {
            self.cursor.skip_blanks();
            let at = self.cursor.offset();
            let word = self.cursor.word();
            if word.is_empty() {
                break;
            }
            let value = if is_far { parse_f64(word) } else { parse_f32(word).map(f64::from) };
            let Some(value) = value else {
                let message =
                    format!("{} is not a number; a number of a vertex should be here", quoted(word));
                return Err(FormatError::malformed(message, self.places.at(at)));
            };
            let Some(slot) = numbers.values.get_mut(numbers.count) else {
                let message = format!("there are more than {MAX} numbers on this line: a vertex has 8");
                return Err(FormatError::malformed(message, self.places.at(at)));
            };
            *slot = value;
            numbers.count += 1;
        }
        self.cursor.end_line();
        Ok(numbers)
    }

    fn push(&mut self, values: &[f64], stride: usize) -> Result<(), FormatError> {
        let mesh = &self.group.mesh;
        if !mesh.positions.is_empty() && mesh.vertex_kd.is_empty() == (stride == COLOURED) {
            // Either all vertices of a mesh have kd and ks, or none: the rest becomes an object of its own.
            let (name, config) = (self.group.name.clone(), self.group.config.clone());
            self.finish_group()?;
            (self.group.name, self.group.config) = (name, config);
        }
        self.reading.budget.take::<([f32; COLOURED], u32)>(3, &self.name)?;
        let (origin, mesh) = (self.reading.origin, &mut self.group.mesh);
        let Ok(first) = u32::try_from(mesh.positions.len() + 3).map(|end| end - 3) else {
            let message = "an object has more than 4 billion vertices: split it with 'object' lines";
            return Err(FormatError::malformed(message, self.places.whole()));
        };
        for vertex in values[..3 * stride].chunks_exact(stride) {
            mesh.positions.push((DVec3::from_slice(vertex) - origin).as_vec3());
            let vertex: [f32; COLOURED] =
                std::array::from_fn(|i| vertex.get(i).map_or(0.0, |number| *number as f32));
            mesh.normals.push(Vec3::from_slice(&vertex[3..6]));
            mesh.uvs.push(Vec2::from_slice(&vertex[6..8]));
            if stride == COLOURED {
                let [.., r, g, b, sr, sg, sb] = vertex;
                mesh.vertex_kd.push(Rgb::new(r, g, b));
                mesh.vertex_ks.push(Rgb::new(sr, sg, sb));
            }
        }
        mesh.triangles.push([first, first + 1, first + 2]);
        Ok(())
    }

    /// Makes an object of the collected triangles, if there are any.
    fn finish_group(&mut self) -> Result<(), FormatError> {
        let Group { name, mut mesh, config } = std::mem::take(&mut self.group);
        if mesh.triangles.is_empty() {
            return Ok(());
        }
        self.reading.budget.take::<(Object, Spec, Mesh)>(2, &self.name)?;
        let material = self.material(config, !mesh.vertex_kd.is_empty());
        mesh.name.clone_from(&name);
        self.scene.objects.push(Object::new(&name, Arc::new(mesh), material));
        Ok(())
    }

    /// The index of a group's material.
    fn material(&mut self, config: Option<Spec>, coloured: bool) -> usize {
        let spec = config.unwrap_or_else(|| plain_material(coloured, coloured));
        let key = format!("{:?}", spec.parameters.0.iter().map(|(_, value, _)| value).collect::<Vec<_>>());
        let scene = &mut self.scene;
        *self.materials.entry(key).or_insert_with(|| scene.add_material(spec))
    }
}

/// The count of numbers per vertex of a line that holds a whole vertex or a whole triangle.
fn stride_of(count: usize) -> Option<usize> {
    let strides = [PLAIN, NINTH, COLOURED];
    strides.into_iter().find(|&stride| count == stride || count == 3 * stride)
}
