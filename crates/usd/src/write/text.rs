//! Prims and their attributes as text.

use bilux_import::bytes::float::push_f32;
use bilux_math::Rgb;
use std::fmt::Write as _;
use std::io::Write as _;

/// A part of a layer under construction.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) out: Vec<u8>,
    pub(super) depth: usize,
}

impl Text {
    /// Prims that lie this deep below the root of the layer.
    pub(super) fn at_depth(depth: usize) -> Text {
        Text { out: Vec::new(), depth }
    }

    pub(super) fn line(&mut self, line: &str) {
        self.indent();
        self.out.extend_from_slice(line.as_bytes());
        self.out.push(b'\n');
    }

    fn indent(&mut self) {
        self.out.resize(self.out.len() + 4 * self.depth, b' ');
    }

    /// Begins a prim with this head (`def Mesh "name"`) and these metadata, up to [`Text::close`].
    pub(super) fn open(&mut self, head: &str, metadata: &[String]) {
        if metadata.is_empty() {
            self.line(head);
        } else {
            self.line(&format!("{head} ("));
            for each in metadata {
                self.line(&format!("    {each}"));
            }
            self.line(")");
        }
        self.line("{");
        self.depth += 1;
    }

    pub(super) fn close(&mut self) {
        self.depth -= 1;
        self.line("}");
    }

    /// An attribute whose value is a list; `more` follows the value.
    pub(super) fn list<T>(
        &mut self,
        attribute: &str,
        items: impl IntoIterator<Item = T>,
        mut item: impl FnMut(&mut Vec<u8>, T),
        more: &str,
    ) {
        self.indent();
        // Writing to a Vec cannot fail.
        let _ = write!(self.out, "{attribute} = [");
        for (i, each) in items.into_iter().enumerate() {
            if i > 0 {
                self.out.extend_from_slice(b", ");
            }
            item(&mut self.out, each);
        }
        let _ = writeln!(self.out, "]{more}");
    }

    /// A list of tuples of numbers.
    pub(super) fn tuples<const N: usize>(
        &mut self,
        attribute: &str,
        tuples: impl IntoIterator<Item = [f32; N]>,
        more: &str,
    ) {
        self.list(attribute, tuples, |out, numbers| push_tuple(out, &numbers), more);
    }

    /// A list of whole numbers.
    pub(super) fn integers(&mut self, attribute: &str, numbers: impl IntoIterator<Item = u32>) {
        let push = |out: &mut Vec<u8>, number: u32| out.extend_from_slice(number.to_string().as_bytes());
        self.list(attribute, numbers, push, "");
    }
}

fn push_tuple(out: &mut Vec<u8>, numbers: &[f32]) {
    out.push(b'(');
    for (i, &number) in numbers.iter().enumerate() {
        if i > 0 {
            out.extend_from_slice(b", ");
        }
        push_number(out, number);
    }
    out.push(b')');
}

/// Appends a number.
pub(super) fn push_number(out: &mut Vec<u8>, number: f32) {
    if number.is_nan() {
        out.extend_from_slice(b"nan");
    } else {
        push_f32(out, number);
    }
}

/// A tuple of numbers.
pub(super) fn tuple(numbers: &[f32]) -> String {
    let mut out = Vec::new();
    push_tuple(&mut out, numbers);
    String::from_utf8(out).unwrap_or_default()
}

pub(super) fn rgb(colour: Rgb) -> String {
    tuple(&colour.to_array())
}

/// A matrix for column vectors, as rows for row vectors.
pub(super) fn matrix(columns: [f32; 16]) -> String {
    let rows: Vec<String> = columns.chunks(4).map(tuple).collect();
    format!("({})", rows.join(", "))
}

/// Quoted text.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\x{:02x}", (c as u32) & 0xff);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The path of a file, relative to the layer.
pub(super) fn asset(name: &str) -> String {
    match name.contains('@') {
        true => format!("@@@./{name}@@@"),
        false => format!("@./{name}@"),
    }
}
