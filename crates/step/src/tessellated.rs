//! Shapes that are triangles already, as AP242 has them. [ISO 10303-42, tessellated shapes]

use super::part21::{Table, Values};
use super::structure::styles::{Style, Styles};
use super::tessellation::Patch;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::DVec3;
use std::collections::HashSet;

/// Shapes of shapes end here.
const MAX_DEPTH: usize = 8;

/// Triangles with their looks.
pub(super) type Styled = Vec<(Option<Style>, Patch)>;

/// The triangles of a tessellated shape, with their looks; `None` if the shape is of another kind.
pub(super) fn triangles(
    reading: &mut Reading,
    table: &Table,
    styles: &Styles,
    shape: u64,
) -> Result<Option<Styled>, FormatError> {
    let is_tessellated = [&b"TESSELLATED"[..], b"TRIANGULATED", b"COMPLEX_TRIANGULATED"]
        .iter()
        .any(|word| table.kind(shape).starts_with(word));
    if !is_tessellated {
        return Ok(None);
    }
    let mut found = Vec::new();
    let mut known = HashSet::new();
    let mut rest = vec![(shape, None, 0)];
    while let Some((id, style, depth)) = rest.pop() {
        if !known.insert(id) {
            continue;
        }
        reading.budget.take::<(u64, Option<Style>, usize)>(1, &table.file())?;
        let style = styles.of(id).or(style);
        let Some(values) = table.simple(id) else { continue };
        let patch = match table.kind(id) {
            b"TESSELLATED_SOLID" | b"TESSELLATED_SHELL" | b"TESSELLATED_GEOMETRIC_SET"
                if depth < MAX_DEPTH =>
            {
                let below: Vec<u64> = values.references_at(1).collect();
                rest.extend(below.into_iter().rev().map(|id| (id, style, depth + 1)));
                continue;
            }
            // A face has the surface that it stands for between its normals and its points.
            b"TRIANGULATED_FACE" => set(table, values, 5, false),
            b"COMPLEX_TRIANGULATED_FACE" => set(table, values, 5, true),
            b"TRIANGULATED_SURFACE_SET" => set(table, values, 4, false),
            b"COMPLEX_TRIANGULATED_SURFACE_SET" => set(table, values, 4, true),
            _ => continue,
        };
        if let Some(patch) = patch {
            let bytes = 48 * patch.positions.len() + 12 * patch.triangles.len();
            reading.budget.take_bytes(4 * bytes as u64, &table.file())?;
            found.push((style, patch));
        }
    }
    Ok(Some(found))
}

/// The triangles of a set whose indices of points are at an index; strips and fans follow, or triples.
fn set(table: &Table, values: Values, at: usize, is_complex: bool) -> Option<Patch> {
    let list = table.part(values.reference(1)?, "COORDINATES_LIST")?;
    let list = list.list(2)?;
    let all: Option<Vec<DVec3>> = (0..list.len()).map(|i| triple(list.list(i)?)).collect();
    let all = all?;
    let normals: Vec<DVec3> = values.list(3).map_or_else(Vec::new, |normals| {
        (0..normals.len()).filter_map(|i| triple(normals.list(i)?)).collect()
    });
    // Without indices, the points count themselves.
    let indices = values.list(at)?.counts()?;
    let point = |i: usize| match indices.is_empty() {
        true => all.get(i.checked_sub(1)?).copied(),
        false => all.get(indices.get(i.checked_sub(1)?)?.checked_sub(1)?).copied(),
    };
    let mut corners: Vec<[usize; 3]> = Vec::new();
    let list_at = |index: usize| values.list(index);
    if is_complex {
        for (kind, lists) in [list_at(at + 1), list_at(at + 2)].into_iter().enumerate() {
            let Some(lists) = lists else { continue };
            for i in 0..lists.len() {
                let line = lists.list(i)?.counts()?;
                for (j, three) in line.windows(3).enumerate() {
                    corners.push(match kind {
                        // Every other triangle of a strip is turned.
                        0 if j % 2 == 1 => [three[1], three[0], three[2]],
                        0 => [three[0], three[1], three[2]],
                        _ => [line[0], three[1], three[2]],
                    });
                }
            }
        }
    } else {
        let lists = list_at(at + 1)?;
        for i in 0..lists.len() {
            if let [a, b, c] = lists.list(i)?.counts()?[..] {
                corners.push([a, b, c]);
            }
        }
    }
    let mut patch = Patch::default();
    for three in corners {
        let [Some(a), Some(b), Some(c)] = three.map(point) else { return None };
        let flat = (b - a).cross(c - a);
        // A degenerate triangle has no side.
        if flat == DVec3::ZERO {
            continue;
        }
        let first = patch.positions.len() as u32;
        patch.positions.extend([a, b, c]);
        patch.normals.extend(three.map(|i| match &normals[..] {
            [] => flat.normalize_or_zero(),
            [one] => *one,
            many => many.get(i - 1).copied().unwrap_or_else(|| flat.normalize_or_zero()),
        }));
        patch.triangles.push([first, first + 1, first + 2]);
    }
    (!patch.triangles.is_empty()).then_some(patch)
}

fn triple(values: Values) -> Option<DVec3> {
    Some(DVec3::new(values.number(0)?, values.number(1)?, values.number(2)?))
}
