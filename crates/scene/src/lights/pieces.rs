//! Triangles cut into equal pieces, so that a picture on a large triangle can be sampled where it is bright.

use super::light_triangle::blend;
use bilux_math::{Vec2, Vec3};

/// Pieces of each triangle of a mesh: `side` times `side`, which are similar to it. They have one number each, triangle by triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces {
    side: usize,
}

/// A piece of a triangle: where it begins there, and how long its edges are, as barycentric weights of the second and the third corner. Every
/// other piece is turned by half a circle, and has a scale below 0.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// First corner of the piece.
    pub begin: Vec2,
    /// The length of its edges, over that of the triangle's.
    pub scale: f32,
}

impl Piece {
    /// All of the triangle.
    pub const WHOLE: Piece = Piece { begin: Vec2::ZERO, scale: 1.0 };

    /// The weights in the triangle of a point with these weights in the piece.
    #[inline(always)]
    pub fn weights(self, [_, second, third]: [f32; 3]) -> [f32; 3] {
        let (second, third) = (self.begin.x + self.scale * second, self.begin.y + self.scale * third);
        [1.0 - second - third, second, third]
    }

    /// Corners of the piece in a triangle.
    pub(super) fn corners(self, triangle: &[Vec3; 3]) -> [Vec3; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|corner| blend(triangle, self.weights(corner)))
    }
}

/// Pieces are no finer.
const MAX_SIDE: usize = 64;

impl Pieces {
    /// Each triangle is one.
    pub(super) const WHOLE: Pieces = Pieces { side: 1 };

    /// As fine as gives up to `most` pieces of so many triangles, or each triangle whole.
    pub(super) fn up_to(most: usize, triangles: usize) -> Pieces {
        let fits = |side: &usize| side * side * triangles <= most;
        Pieces { side: (1..=MAX_SIDE).take_while(fits).last().unwrap_or(1) }
    }

    /// Number of pieces of each triangle.
    #[inline]
    pub(super) fn of_each(self) -> usize {
        self.side * self.side
    }

    /// The triangle of a piece.
    #[inline]
    pub(super) fn triangle(self, piece: usize) -> usize {
        if self.side == 1 { piece } else { piece / self.of_each() }
    }

    /// A piece by its number.
    #[inline]
    pub(super) fn piece(self, piece: usize) -> Piece {
        if self.side == 1 {
            return Piece::WHOLE;
        }
        let (side, within) = (self.side, piece % self.of_each());
        let (i, j) = (within / side, within % side);
        let scale = 1.0 / side as f32;
        if i + j < side {
            Piece { begin: Vec2::new(i as f32, j as f32) * scale, scale }
        } else {
            // The other half of the square, turned onto the triangle: these are upside down.
            Piece { begin: Vec2::new((side - i) as f32, (side - j) as f32) * scale, scale: -scale }
        }
    }

    /// The number of the piece of a triangle in which a point lies, by the weights of the second and the third corner.
    #[inline]
    pub(super) fn at(self, triangle: usize, weights: Vec2) -> usize {
        if self.side == 1 {
            return triangle;
        }
        let side = self.side;
        let place = weights * side as f32;
        let i = (place.x as usize).min(side - 1);
        let j = (place.y as usize).min(side - 1 - i);
        let is_upside_down = place.x - i as f32 + (place.y - j as f32) > 1.0 && i + j + 2 <= side;
        let (i, j) = if is_upside_down { (side - 1 - i, side - 1 - j) } else { (i, j) };
        triangle * self.of_each() + i * side + j
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::barycentric;
    use bilux_math::hash::{hash_words, unit_f32};

    #[test]
    fn points_of_all_pieces_fill_the_triangle_evenly_and_are_found_again() {
        for side in [1, 2, 3, 7, 64] {
            let pieces = Pieces { side };
            let mut found = [0u32; 16];
            let quarters = Pieces { side: 4 };
            let each = 64_000 / pieces.of_each();
            for number in 0..pieces.of_each() {
                let piece = 5 * pieces.of_each() + number;
                assert_eq!(pieces.triangle(piece), 5);
                for k in 0..each {
                    let u = |axis| unit_f32(hash_words([side as u64, piece as u64, k as u64, axis]) as u32);
                    // Not so close to an edge that rounding decides.
                    let weights = barycentric(Vec2::new(u(0), u(1))).map(|w| 1e-4 + (1.0 - 3e-4) * w);
                    let [first, second, third] = pieces.piece(piece).weights(weights);
                    assert!(first >= 0.0 && second >= 0.0 && third >= 0.0, "{first} {second} {third}");
                    assert_eq!(pieces.at(5, Vec2::new(second, third)), piece, "{side}");
                    found[quarters.at(0, Vec2::new(second, third))] += 1;
                }
            }
            let wanted = (each * pieces.of_each()) as f32 / 16.0;
            assert!(
                found.iter().all(|&f| (f as f32 - wanted).abs() < 6.0 * wanted.sqrt()),
                "{side}: {found:?}"
            );
        }
    }

    #[test]
    fn there_are_no_more_pieces_than_asked_for() {
        assert_eq!(Pieces::up_to(1024, 2).of_each(), 22 * 22);
        assert_eq!(Pieces::up_to(1024, 5000).of_each(), 1);
        assert_eq!(Pieces::up_to(1 << 20, 1).of_each(), MAX_SIDE * MAX_SIDE);
    }
}
