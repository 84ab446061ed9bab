//! Vertices and triangles as nearly all programs write them, read from the bytes without the XML parser: it reads whatever is unusual here.

use super::attributes::digits;
use bilux_import::bytes::float::parse_f32;
use bilux_math::Vec3;

/// The attributes of a triangle.
#[derive(Default)]
pub(super) struct Triangle<'x> {
    pub(super) corners: [Option<u32>; 3],
    pub(super) group: Option<u32>,
    pub(super) properties: [Option<u32>; 3],
    pub(super) paint: &'x str,
}

impl Triangle<'_> {
    /// The place of an attribute that is a number.
    #[inline]
    pub(super) fn slot(&mut self, key: &[u8]) -> Option<&mut Option<u32>> {
        Some(match key {
            b"v1" => &mut self.corners[0],
            b"v2" => &mut self.corners[1],
            b"v3" => &mut self.corners[2],
            b"pid" => &mut self.group,
            b"p1" => &mut self.properties[0],
            b"p2" => &mut self.properties[1],
            b"p3" => &mut self.properties[2],
            _ => return None,
        })
    }

    /// The corners, if they are three vertices of as many as there are.
    #[inline]
    pub(super) fn sound_corners(&self, vertices: u32) -> Option<[u32; 3]> {
        let [Some(a), Some(b), Some(c)] = self.corners else { return None };
        (a != b && b != c && a != c && a.max(b).max(c) < vertices).then_some([a, b, c])
    }
}

/// A `vertex` with finite numbers at the beginning of the bytes, and the length of its element.
#[inline]
pub(super) fn vertex(bytes: &[u8]) -> Option<(Vec3, usize)> {
    let mut position = [None; 3];
    let length = element(bytes, b"<vertex", |key, value| {
        let axis = match key {
            b"x" => 0,
            b"y" => 1,
            b"z" => 2,
            _ => return None,
        };
        position[axis] = Some(parse_f32(value)?);
        Some(())
    })?;
    let [Some(x), Some(y), Some(z)] = position else { return None };
    Some((Vec3::new(x, y, z), length)).filter(|(position, _)| position.is_finite())
}

/// A `triangle` that is not painted at the beginning of the bytes, and the length of its element.
#[inline]
pub(super) fn triangle(bytes: &[u8]) -> Option<(Triangle<'static>, usize)> {
    let mut triangle = Triangle::default();
    let length = element(bytes, b"<triangle", |key, value| {
        *triangle.slot(key)? = Some(digits(value)?);
        Some(())
    })?;
    Some((triangle, length))
}

/// Passes the attributes of an element without content and without references to `take`; returns its length, with the blanks before it.
#[inline(always)]
fn element<'b>(
    bytes: &'b [u8],
    name: &[u8],
    mut take: impl FnMut(&'b [u8], &'b [u8]) -> Option<()>,
) -> Option<usize> {
    let blanks = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let mut at = blanks(0);
    if !bytes[at..].starts_with(name) {
        return None;
    }
    at += name.len();
    loop {
        let between = blanks(at);
        at += between;
        if bytes[at..].starts_with(b"/>") {
            return Some(at + 2);
        }
        if between == 0 {
            return None;
        }
        let key = at;
        while bytes.get(at)?.is_ascii_alphanumeric() {
            at += 1;
        }
        let key = &bytes[key..at];
        if !bytes[at..].starts_with(b"=\"") {
            return None;
        }
        let value = at + 2;
        let length = bytes[value..].iter().position(|&byte| byte == b'"')?;
        at = value + length + 1;
        take(key, &bytes[value..value + length])?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_usual_is_read_and_nothing_else() {
        let found = vertex(b"\r\n\t<vertex x=\"1\" y=\"-2.5e1\"\n z=\".5\" />  <").unwrap();
        assert_eq!(found, (Vec3::new(1.0, -25.0, 0.5), 38));
        let (found, length) =
            triangle(b"<triangle v1=\"0\" v2=\"12\" v3=\"7\" pid=\"3\" p1=\"4\"/>").unwrap();
        assert_eq!((found.sound_corners(13), found.sound_corners(12), length), (Some([0, 12, 7]), None, 48));
        assert_eq!((found.group, found.properties), (Some(3), [Some(4), None, None]));
        for unusual in [
            "<vertex x=\"1\" y=\"2\" z=\"3\">",
            "<vertex x=\"1\" y=\"2\" z=\"3\"",
            "<vertex x=\"1\" y=\"2\" z=\"3\" /",
            "<vertex x=\"1\" y=\"2\"z=\"3\"/>",
            "<vertex x='1' y='2' z='3'/>",
            "<vertex x=\"1\" y=\"2\"/>",
            "<vertex x=\"1\" y=\"2\" z=\"nan\"/>",
            "<vertex x=\"1\" y=\"2\" z=\"&#51;\"/>",
            "<vertex x=\"1\" y=\"2\" z=\"3\" w=\"4\"/>",
            "<vertexx=\"1\" y=\"2\" z=\"3\"/>",
            "<m:vertex x=\"1\" y=\"2\" z=\"3\"/>",
            "<!-- --><vertex x=\"1\" y=\"2\" z=\"3\"/>",
        ] {
            assert!(vertex(unusual.as_bytes()).is_none(), "{unusual}");
        }
        for unusual in
            ["v3=\"-1\"", "v3=\"1.0\"", "v3=\"\"", "v3=\"3000000000\"", "v3=\"1\" paint_color=\"4\""]
        {
            let text = format!("<triangle v1=\"1\" v2=\"2\" {unusual}/>");
            assert!(triangle(text.as_bytes()).is_none(), "{unusual}");
        }
    }
}
