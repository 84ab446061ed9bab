//! Finds the meaning of the numbers on a line.

use bilux_import::bytes::text::Cursor;

/// The maximum count of numbers that are used on a line.
pub(super) const MAX: usize = 16;

/// The columns of a point's parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Columns {
    pub(super) position: [usize; 3],
    pub(super) colour: Option<[usize; 3]>,
    pub(super) intensity: Option<usize>,
}

/// Column names in a header line, in lower case.
const NAMES: [&[&str]; 7] = [
    &["x", "east", "easting", "x_coord"],
    &["y", "north", "northing", "y_coord"],
    &["z", "height", "elevation", "z_coord"],
    &["r", "red", "rf"],
    &["g", "green", "gf"],
    &["b", "blue", "bf"],
    &["intensity", "i", "scalar_intensity", "reflectance"],
];

impl Columns {
    /// From the names in a header line; `None` if it does not name x, y and z.
    pub(super) fn from_header(names: &[String]) -> Option<Columns> {
        let column = |meaning: usize| {
            names.iter().take(MAX).position(|name| {
                let name = name.trim_matches(['"', '/', '#']).to_lowercase();
                NAMES[meaning].contains(&name.as_str())
            })
        };
        let three = |first: usize| Some([column(first)?, column(first + 1)?, column(first + 2)?]);
        Some(Columns { position: three(0)?, colour: three(3), intensity: column(6) })
    }

    /// From the count of numbers and the first points, following common exporters.
    ///
    /// `x y z`, then an intensity, a colour, a normal, an intensity and a colour, or a colour and a normal in
    /// either order.
    pub(super) fn guessed(count: usize, rows: &[[f64; MAX]]) -> Columns {
        let plain = Columns { position: [0, 1, 2], colour: None, intensity: None };
        let colour_at = |at: usize| Columns { colour: Some([at, at + 1, at + 2]), ..plain };
        let normals_at = |at: usize| {
            let is_unit = |row: &[f64; MAX]| {
                let n = &row[at..at + 3];
                (n.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 0.02
            };
            !rows.is_empty() && rows.iter().all(is_unit)
        };
        match count {
            0..=3 => plain,
            4 | 5 => Columns { intensity: Some(3), ..plain },
            6 if normals_at(3) => plain,
            6 => colour_at(3),
            7 | 8 => Columns { intensity: Some(3), ..colour_at(4) },
            _ if normals_at(3) => colour_at(6),
            _ => colour_at(3),
        }
    }

    /// True if the picture shows the numbers in this column: intensities only where there are no colours.
    pub(super) fn shows(&self, column: usize) -> bool {
        let beside = self.colour.map_or(self.intensity == Some(column), |colour| colour.contains(&column));
        self.position.contains(&column) || beside
    }
}

/// True if the first lines are numbers, at least three on each except for a leading count.
pub(super) fn looks_like_points(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    let mut cursor = Cursor::new(head);
    let comma = Comma::of_text(head);
    let mut lines = 0;
    while !cursor.is_done() && lines < 4 {
        let line = cursor.rest_of_line();
        cursor.end_line();
        let words = words_of(line, comma);
        if words.is_empty() || line.starts_with(b"#") || line.starts_with(b"//") {
            continue;
        }
        if !words.iter().all(|word| bilux_import::bytes::float::parse_f32(word).is_some()) {
            return false;
        }
        let is_count = lines == 0 && words.len() == 1;
        // The last line may be cut off.
        if !is_count && words.len() < 3 && !(cursor.is_done() && lines > 0) {
            return false;
        }
        lines += 1;
    }
    lines > 1
}

/// Meaning of a comma between numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comma {
    Separates,
    /// The decimal point of some languages: 1,5 is one and a half.
    IsPoint,
}

impl Comma {
    /// Meaning of the commas of a line; `None` if it has none.
    ///
    /// They are decimal where blanks or semicolons make words of at most one comma each, with digits on both sides,
    /// three or more in all.
    pub(super) fn of(line: &[u8]) -> Option<Comma> {
        if !line.contains(&b',') {
            return None;
        }
        let words = words_of(line, Comma::IsPoint);
        let is_number = |word: &&[u8]| bilux_import::bytes::float::parse_f32(word).is_some();
        let is_point = words.len() >= 3 && words.iter().all(is_number);
        Some(if is_point { Comma::IsPoint } else { Comma::Separates })
    }

    /// Meaning of the commas of the first line that has any.
    pub(super) fn of_text(text: &[u8]) -> Comma {
        if !text.contains(&b',') {
            return Comma::Separates;
        }
        let lines = text.split(|b| matches!(b, b'\n' | b'\r')).filter(|line| is_data(line));
        let lines = lines.filter_map(|line| line.split(|&b| b == b'#').next());
        lines.filter_map(Comma::of).next().unwrap_or(Comma::Separates)
    }
}

/// True for a line that begins with a number.
fn is_data(line: &[u8]) -> bool {
    let first = line.trim_ascii_start().first();
    first.is_some_and(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
}

/// The words of a line.
pub(super) fn words_of(line: &[u8], comma: Comma) -> Vec<&[u8]> {
    let is_separator = |b: u8| b == b';' || (b == b',' && comma == Comma::Separates);
    let is_between = |b: &u8| b.is_ascii_whitespace() || is_separator(*b) || matches!(*b, 0 | 0x1a);
    line.split(is_between).filter(|word| !word.is_empty()).take(MAX).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_are_points_where_every_word_is_a_number_with_one() {
        use Comma::{IsPoint, Separates};
        for (line, comma) in [
            ("1,5 2,5 3,5", IsPoint),
            ("1,5;2,5;3,5;255;0;0", IsPoint),
            ("1,5\t2\t-3,25e1", IsPoint),
            ("1,2,3", Separates),
            ("1, 2, 3", Separates),
            ("1 ,2 ,3", Separates),
            ("1.5,2.5,3.5", Separates),
            ("1,2,3 255,0,0", Separates),
            ("1,2 3,4", Separates),
        ] {
            assert_eq!(Comma::of(line.as_bytes()), Some(comma), "{line}");
        }
        assert_eq!(Comma::of(b"1 2 3"), None);
        assert_eq!(Comma::of_text(b"X,Y,Z\n0 0 0\n0,5 0 1\n"), IsPoint);
        assert_eq!(Comma::of_text(b"// a, b\n0;0;0\n"), Separates);
    }
}
