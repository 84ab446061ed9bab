//! Colours of the vertices and faces of a PLY file, by the names that Mitsuba gives them. [Jakob 2022]

use std::ops::Range;

/// The endings of the three properties of an attribute, and its whole names if it is `color`.
const ENDINGS: [[&str; 3]; 4] =
    [["_0", "_1", "_2"], ["_r", "_g", "_b"], ["_x", "_y", "_z"], ["_1", "_2", "_3"]];
const COLOURS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// Renames properties in the header of a PLY file, so that those of an attribute such as `vertex_color` or `face_stress` are its
/// colours, and nothing else is. False if the file has no such attribute with three numbers.
pub(super) fn select(bytes: &mut [u8], attribute: &str) -> bool {
    let Some((element, name)) = attribute.split_once('_') else { return false };
    let properties = properties(bytes);
    let find = |wanted: &str| {
        let is_it =
            |p: &&(String, Range<usize>)| p.0 == element && bytes.get(p.1.clone()) == Some(wanted.as_bytes());
        properties.iter().find(is_it).map(|p| p.1.clone())
    };
    let whole = COLOURS.iter().filter(|_| name == "color").map(|names| names.map(str::to_owned));
    let ended = ENDINGS.iter().map(|endings| endings.map(|ending| format!("{name}{ending}")));
    let found = whole.chain(ended).find_map(|names| {
        let [r, g, b] = names.each_ref().map(|name| find(name));
        Some([r?, g?, b?])
    });
    let Some(found) = found else { return false };
    for (_, place) in &properties {
        let text = String::from_utf8_lossy(&bytes[place.clone()]).into_owned();
        if text.starts_with("diffuse_") || COLOURS.as_flattened().contains(&&*text) {
            bytes[place.clone()].fill(b'_');
        }
    }
    for (place, letter) in found.into_iter().zip(*b"rgb") {
        bytes[place.clone()].fill(b' ');
        bytes[place.start] = letter;
    }
    true
}

/// The properties in a header: of what element, and where their names are.
fn properties(bytes: &[u8]) -> Vec<(String, Range<usize>)> {
    const LONGEST: usize = 1 << 16;
    let (mut found, mut element, mut start) = (Vec::new(), String::new(), 0);
    while start < bytes.len().min(LONGEST) {
        let length = bytes[start..].iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len() - start);
        let line = String::from_utf8_lossy(&bytes[start..start + length]).into_owned();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match *words.as_slice() {
            ["end_header", ..] => break,
            ["element", name, ..] => name.clone_into(&mut element),
            ["property", _, name] if line.is_ascii() => {
                let at = start + line.trim_ascii_end().len() - name.len();
                found.push((element.clone(), at..at + name.len()));
            }
            _ => {}
        }
        start += length + 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_become_the_only_colours() {
        let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty uchar red\nproperty uchar green\n\
            property uchar blue\nproperty float heat_0\r\nproperty float heat_1\nproperty float heat_2\nelement face 1\n\
            property list uchar int vertex_indices\nproperty float color_0\nproperty float color_1\nproperty float color_2\nend_header\n";
        let after = |attribute: &str| {
            let mut bytes = header.as_bytes().to_vec();
            let found = select(&mut bytes, attribute);
            let text = String::from_utf8(bytes).unwrap();
            assert_eq!(text.len(), header.len());
            let names = text.lines().filter(|line| line.starts_with("property"));
            (
                found,
                names.map(|l| l.split_whitespace().last().unwrap().to_owned()).collect::<Vec<_>>().join(" "),
            )
        };
        assert_eq!(
            after("vertex_heat"),
            (true, "x ___ _____ ____ r g b vertex_indices color_0 color_1 color_2".into())
        );
        assert_eq!(
            after("face_color"),
            (true, "x ___ _____ ____ heat_0 heat_1 heat_2 vertex_indices r g b".into())
        );
        assert_eq!(
            after("vertex_color").1,
            "x r g b heat_0 heat_1 heat_2 vertex_indices color_0 color_1 color_2"
        );
        assert!(!after("vertex_cold").0 && !after("color").0);
    }
}
