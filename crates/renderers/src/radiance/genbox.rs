//! `genbox`: a box, whose edges may be cut off or round. [Ward 1994]

use super::kinds::Kind;
use super::statement::{Primitive, Statement};
use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DVec3;
use bilux_scene::Span;
use std::rc::Rc;

/// Form of the edges.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edges {
    Sharp,
    /// Cut off at this distance on both sides.
    Bevelled(f64),
    /// With this radius.
    Round(f64),
}

struct Cuboid<'a> {
    material: &'a Rc<str>,
    name: &'a Rc<str>,
    size: DVec3,
    edges: Edges,
    inverts: bool,
    at: &'a Span,
}

/// Statements that `genbox` writes; `None` if it writes something that is not read here.
pub(super) fn generate(
    words: &[Rc<str>],
    at: &Span,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Vec<Statement>>, FormatError> {
    let [material, name, sizes @ ..] = words else { return usage(at) };
    let Some((sizes, options)) = sizes.split_first_chunk::<3>() else { return usage(at) };
    let [x, y, z] = sizes.each_ref().map(|word| length(word));
    let (Some(x), Some(y), Some(z)) = (x, y, z) else { return usage(at) };
    let size = DVec3::new(x, y, z);
    let mut made = Cuboid { material, name, size, edges: Edges::Sharp, inverts: false, at };
    let mut options = options.iter();
    while let Some(option) = options.next() {
        let mut amount = || options.next().and_then(|word| length(word));
        match &**option {
            "-i" => made.inverts = true,
            "-b" => made.edges = Edges::Bevelled(amount().map_or_else(|| usage(at), Ok)?),
            "-r" => made.edges = Edges::Round(amount().map_or_else(|| usage(at), Ok)?),
            // The number of facets of round edges, which have none here, and the normals of these.
            "-n" => _ = amount().map_or_else(|| usage(at), Ok)?,
            "-s" => {}
            "-o" => return Ok(None),
            _ => return usage(at),
        }
    }
    if made.inverts && matches!(made.edges, Edges::Round(_)) {
        diagnostics.note("the round edges of a box that is turned inside out are sharp here", || at.clone());
        made.edges = Edges::Sharp;
    }
    Ok(Some(made.statements()))
}

fn length(word: &str) -> Option<f64> {
    parse_f64(word.as_bytes()).filter(|length| *length > 0.0 && length.is_finite())
}

fn usage<T>(at: &Span) -> Result<T, FormatError> {
    let message =
        "genbox needs a material, a name and three sizes above 0, then -i, -b or -r with a size, -n or -s";
    Err(FormatError::malformed(message, at.clone()))
}

impl Cuboid<'_> {
    fn statements(&self) -> Vec<Statement> {
        let inset = match self.edges {
            Edges::Sharp => 0.0,
            Edges::Bevelled(size) | Edges::Round(size) => size,
        };
        let mut made = Vec::new();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for side in [false, true] {
                let corner = |u: bool, v: bool| {
                    let mut p = DVec3::ZERO;
                    p[axis] = self.end(axis, side, 0.0);
                    (p[b], p[c]) = (self.end(b, u, inset), self.end(c, v, inset));
                    p
                };
                let corners =
                    [corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
                made.push(self.polygon(corners.to_vec()));
            }
        }
        if self.edges != Edges::Sharp {
            self.edges(inset, &mut made);
        }
        made
    }

    /// A coordinate at the lower or the upper end of an axis, so far inside.
    fn end(&self, axis: usize, is_upper: bool, inset: f64) -> f64 {
        if is_upper { self.size[axis] - inset } else { inset }
    }

    fn edges(&self, inset: f64, made: &mut Vec<Statement>) {
        let at = |ends: [bool; 3], insets: [f64; 3]| {
            DVec3::from(std::array::from_fn::<_, 3, _>(|axis| self.end(axis, ends[axis], insets[axis])))
        };
        let is_round = matches!(self.edges, Edges::Round(_));
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for ends in 0..4u8 {
                // The edge along an axis, at these ends of the other two; on the face of each of them, or inside of both.
                let place = |is_upper: bool, outside: Option<usize>| {
                    let mut sides = [is_upper; 3];
                    (sides[b], sides[c]) = (ends & 1 == 1, ends & 2 == 2);
                    let mut insets = [inset; 3];
                    if let Some(outside) = outside {
                        insets[outside] = 0.0;
                    }
                    at(sides, insets)
                };
                if is_round {
                    let reals = [place(false, None), place(true, None)].map(|p| p.to_array()).concat();
                    made.push(self.surface(
                        Kind::Cylinder { inwards: false },
                        "cylinder",
                        [reals, vec![inset]].concat(),
                    ));
                } else {
                    let corners = [(false, b), (true, b), (true, c), (false, c)]
                        .map(|(end, face)| place(end, Some(face)));
                    made.push(self.polygon(corners.to_vec()));
                }
            }
        }
        for ends in 0..8u8 {
            let sides = [1, 2, 4].map(|bit| ends & bit != 0);
            if is_round {
                let reals = [at(sides, [inset; 3]).to_array().to_vec(), vec![inset]].concat();
                made.push(self.surface(Kind::Sphere { inwards: false }, "sphere", reals));
            } else {
                let corner = |face: usize| {
                    let mut insets = [inset; 3];
                    insets[face] = 0.0;
                    at(sides, insets)
                };
                made.push(self.polygon(vec![corner(0), corner(1), corner(2)]));
            }
        }
    }

    /// A polygon whose front is outside, or inside of a box that is turned inside out.
    fn polygon(&self, mut corners: Vec<DVec3>) -> Statement {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let is_outwards = normal.dot(corners[0] - self.size * 0.5) > 0.0;
        if is_outwards == self.inverts {
            corners.reverse();
        }
        self.surface(Kind::Polygon, "polygon", corners.iter().flat_map(|p| p.to_array()).collect())
    }

    fn surface(&self, kind: Kind, word: &'static str, reals: Vec<f64>) -> Statement {
        Statement::Primitive(Rc::new(Primitive {
            modifier: self.material.clone(),
            kind,
            word,
            name: self.name.clone(),
            strings: Vec::new(),
            reals,
            sky: None,
            at: self.at.clone(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygons(text: &str) -> Vec<Vec<DVec3>> {
        let words: Vec<Rc<str>> = text.split_whitespace().map(Rc::from).collect();
        let made = generate(&words, &Span::default(), &mut Diagnostics::default()).unwrap().unwrap();
        let of = |statement: Statement| match statement {
            Statement::Primitive(primitive) if primitive.kind == Kind::Polygon => {
                Some(primitive.reals.chunks(3).map(DVec3::from_slice).collect())
            }
            _ => None,
        };
        made.into_iter().filter_map(of).collect()
    }

    /// Six times the volume that outward faces enclose, by the divergence theorem.
    fn volume(text: &str) -> f64 {
        let fan = |p: &Vec<DVec3>| (2..p.len()).map(|i| p[0].dot(p[i - 1].cross(p[i]))).sum::<f64>();
        polygons(text).iter().map(fan).sum::<f64>() / 6.0
    }

    #[test]
    fn boxes_enclose_their_volume() {
        assert!((volume("m a 2 3 5") - 30.0).abs() < 1e-12);
        assert!((volume("m a 2 3 5 -i") + 30.0).abs() < 1e-12);
        // Cut off are prisms of b²/2 along the edges, and at each of 8 corners what three of them have in common counts once too often.
        let (b, edges) = (0.25, 4.0 * (1.5 + 2.5 + 4.5));
        let corners = 8.0 * (b * b * b - b * b * b / 6.0);
        let wanted = 30.0 - b * b / 2.0 * edges - corners;
        assert!((volume("m a 2 3 5 -b 0.25") - wanted).abs() < 1e-12, "{}", volume("m a 2 3 5 -b 0.25"));
        assert_eq!(polygons("m a 2 3 5 -r 0.25 -n 4 -s").len(), 6);
    }
}
