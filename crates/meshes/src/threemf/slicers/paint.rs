//! Triangles that are painted in parts: a code of hexadecimal digits, which PrusaSlicer introduced and others took over.
//!
//! The last digit comes first. Its lower two bits are the number of sides that are halved; 0 is a leaf, whose upper two
//! bits are its filament, and 3 of these means that the next digit is the filament minus 3. Otherwise the upper two bits
//! are the corner from which the sides are counted, and the children follow, the last one first.

use bilux_math::Vec3;

/// A part of a triangle, by the barycentric coordinates of its corners, and the number of its filament; 0 is that of
/// the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::threemf) struct Leaf {
    pub(in crate::threemf) corners: [Vec3; 3],
    pub(in crate::threemf) filament: u32,
}

impl Leaf {
    /// The whole triangle.
    pub(in crate::threemf) fn whole(filament: u32) -> Leaf {
        Leaf { corners: [Vec3::X, Vec3::Y, Vec3::Z], filament }
    }
}

/// The parts of a triangle with a code; `None` if it is no code. There are no more of them than digits.
pub(in crate::threemf) fn leaves(code: &str) -> Option<Vec<Leaf>> {
    let mut digits = code.bytes().rev().map(|digit| char::from(digit).to_digit(16));
    let mut next = || digits.next().flatten();
    let (mut open, mut leaves) = (vec![Leaf::whole(0).corners], Vec::new());
    while let Some(corners) = open.pop() {
        let digit = next()?;
        let (sides, upper) = (digit & 3, digit >> 2);
        if sides == 0 {
            let mut filament = upper;
            if upper == 3 {
                loop {
                    let more = next()?;
                    filament = filament.checked_add(more)?;
                    if more < 15 {
                        break;
                    }
                }
            }
            leaves.push(Leaf { corners, filament });
            continue;
        }
        let first = upper as usize;
        let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
        let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
        match sides {
            1 => open.extend([[a, b, bc], [bc, c, a]]),
            2 => open.extend([[a, ab, ca], [ab, b, ca], [b, c, ca]]),
            _ => open.extend([[a, ab, ca], [ab, b, bc], [bc, c, ca], [ab, bc, ca]]),
        }
    }
    Some(leaves)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area([a, b, c]: [Vec3; 3]) -> f32 {
        // Of the whole triangle, whose corners are the unit vectors.
        (b - a).cross(c - a).length() / 3f32.sqrt()
    }

    #[test]
    fn codes_cut_a_triangle_into_parts_that_fill_it() {
        let filaments = |code: &str| -> Option<Vec<u32>> {
            Some(leaves(code)?.into_iter().map(|leaf| leaf.filament).collect())
        };
        assert_eq!(filaments("4"), Some(vec![1]));
        assert_eq!(filaments("8"), Some(vec![2]));
        assert_eq!(filaments("0C"), Some(vec![3]), "the digit after the first is added to 3");
        assert_eq!(filaments("1C"), Some(vec![4]));
        assert_eq!(filaments("2FC"), Some(vec![20]));
        for (code, count) in [("841", 2), ("0845", 3), ("48406", 3), ("08443", 4), ("0844347", 7)] {
            let Some(all) = leaves(code) else { continue };
            let total: f32 = all.iter().map(|leaf| area(leaf.corners)).sum();
            assert!((total - 1.0).abs() < 1e-6 && all.len() <= count, "{code} {total}");
        }
        // Four parts; the last child, in the middle, comes first.
        let all = leaves("00043").unwrap();
        assert_eq!((all.len(), all[0].filament), (4, 1));
        assert_eq!(all[0].corners[0], Vec3::new(0.5, 0.5, 0.0));
        for broken in ["", "3", "1", "C", "g", "443"] {
            assert_eq!(leaves(broken), None, "{broken}");
        }
    }
}
