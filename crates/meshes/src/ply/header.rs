//! The header: the elements, their counts and their properties.

use bilux_import::FormatError;
use bilux_import::bytes::text::{Cursor, Places, name_of, quoted};
use bilux_import::geometry::colours::Stored;
use bilux_import::input::reading::Source;

/// The encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Scalar> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Size in a binary body, in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// Stored form of colours of this type.
    pub(super) fn stored(self) -> Stored {
        match self {
            Scalar::I8 | Scalar::U8 => Stored::Bytes,
            Scalar::F32 | Scalar::F64 => Stored::Numbers,
            _ => Stored::Integers,
        }
    }
}

/// A property of an element; a list if it has a count type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    pub(super) count: Option<Scalar>,
}

/// A list of rows with the same properties.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The offset of its declaration.
    pub(super) offset: usize,
}

impl Element {
    /// The minimum number of bytes of a row.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> u64 {
        let of = |p: &Property| match encoding {
            // A digit and a space.
            Encoding::Ascii => 2,
            _ => p.count.unwrap_or(p.scalar).size() as u64,
        };
        self.properties.iter().map(of).sum()
    }
}

/// A parsed header.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The file of each `comment TextureFile` line, and the offset of the line.
    pub(super) textures: Vec<(String, usize)>,
    /// True if a comment states that faces without normals are flat.
    pub(super) is_flat: bool,
    /// The offset of the body.
    pub(super) body: usize,
}

/// More than any real file has; each costs far more memory than its few bytes.
const MAX_PROPERTIES: usize = 10_000;

pub(super) fn read_header(source: &Source, places: &Places) -> Result<Header, FormatError> {
    let mut cursor = Cursor::new(source.bytes);
    let fail = |message: String, offset: usize| Err(FormatError::malformed(message, places.at(offset)));
    if cursor.word() != b"ply" {
        return fail("a PLY file begins with the line 'ply'".to_owned(), 0);
    }
    cursor.end_line();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut textures, mut is_flat, mut properties) = (Vec::new(), false, 0);
    while !cursor.is_done() {
        cursor.skip_blanks();
        let start = cursor.offset();
        match cursor.word() {
            b"format" => encoding = Some(read_encoding(&mut cursor, places)?),
            b"comment" | b"obj_info" => match cursor.word() {
                b"TextureFile" => textures.push((name_of(cursor.rest_of_line()), start)),
                b"shading" => is_flat |= cursor.rest_of_line() == b"flat",
                _ => {
                    cursor.rest_of_line();
                }
            },
            b"element" => elements.push(read_element(&mut cursor, places, start)?),
            b"property" => {
                properties += 1;
                if properties > MAX_PROPERTIES {
                    return fail(format!("there are more than {MAX_PROPERTIES} properties"), start);
                }
                let Some(element) = elements.last_mut() else {
                    return fail(
                        "a property belongs to an element: declare the element first".to_owned(),
                        start,
                    );
                };
                element.properties.push(read_property(&mut cursor, places)?);
            }
            b"end_header" => {
                cursor.end_line_as_in(source.bytes);
                let Some(encoding) = encoding else {
                    return fail("the header has no 'format' line".to_owned(), start);
                };
                return Ok(Header { encoding, elements, textures, is_flat, body: cursor.offset() });
            }
            b"" => {}
            word => {
                let message = format!(
                    "{} is not a keyword of a PLY header: use format, comment, obj_info, element, property or \
                     end_header",
                    quoted(word)
                );
                return fail(message, start);
            }
        }
        cursor.end_line();
    }
    fail("the file ends within its header: there is no 'end_header'".to_owned(), source.bytes.len())
}

fn read_encoding(cursor: &mut Cursor, places: &Places) -> Result<Encoding, FormatError> {
    let word = cursor.word();
    let encoding = match word {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::Little,
        b"binary_big_endian" => Encoding::Big,
        _ => {
            let message = format!(
                "{} is not a PLY format: use ascii, binary_little_endian or binary_big_endian",
                quoted(word)
            );
            return Err(FormatError::malformed(message, places.at(cursor.offset() - word.len())));
        }
    };
    cursor.rest_of_line();
    Ok(encoding)
}

fn read_element(cursor: &mut Cursor, places: &Places, offset: usize) -> Result<Element, FormatError> {
    let name = name_of(cursor.word());
    let word = cursor.word();
    let count = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    let Some(count) = count.filter(|_| !name.is_empty()) else {
        let message = "an element has a name and a count, as in 'element vertex 8'";
        return Err(FormatError::malformed(message, places.at(offset)));
    };
    Ok(Element { name, count, properties: Vec::new(), offset })
}

fn read_property(cursor: &mut Cursor, places: &Places) -> Result<Property, FormatError> {
    let scalar = |cursor: &mut Cursor| {
        let word = cursor.word();
        Scalar::from_name(word).ok_or_else(|| {
            let message = format!(
                "{} is not a PLY type: use char, uchar, short, ushort, int, uint, float or double",
                quoted(word)
            );
            FormatError::malformed(message, places.at(cursor.offset() - word.len()))
        })
    };
    let is_list = cursor.peek_word() == b"list";
    let count = if is_list {
        cursor.word();
        Some(scalar(cursor)?)
    } else {
        None
    };
    let scalar = scalar(cursor)?;
    let name = name_of(cursor.word());
    if name.is_empty() {
        let message = "a property has a type and a name, as in 'property float x'";
        return Err(FormatError::malformed(message, places.at(cursor.offset())));
    }
    Ok(Property { name, scalar, count })
}
