//! Painter's algorithm of Newell, Newell and Sancha: before a polygon is painted, every polygon that it might hide is
//! shown to be behind it; polygons that overlap in a cycle are cut [Newell 1972].

use crate::canvas::{Canvas, NO_OWNER};
use crate::polygon::{Plane, clip, corners};
use crate::screen::{Footprint, Screen};
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, registry::Entry};

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "newell",
        summary: "Newell's painter's algorithm: pairwise depth tests; polygons that form a cycle are split",
        source: "Newell 1972",
        parameters: &[],
    },
    exact: true,
    run,
};

/// Comparisons and pieces per triangle after which the rest is left to depth comparison: both grow quadratically with
/// the number of triangles in the worst case.
const MAX_COMPARISONS: u64 = 8192;
const MAX_PIECES: usize = 16;

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    let mut painting = Painting::new(mesh, &screen);
    painting.sort();
    while let Some(next) = painting.next() {
        paint(next, &painting.pieces, screen.eye, &mut canvas);
    }
    canvas.counts.sort_comparisons = painting.comparisons;
    canvas.counts.splits = painting.splits;
    canvas.counts.pieces = painting.pieces.len() as u64;
    canvas.finish(0.0)
}

/// Part of a triangle.
struct Piece {
    triangle: u32,
    polygon: Vec<DVec3>,
    /// The triangle's plane, facing the eye.
    plane: Plane,
    /// Half the thickness of the plane: the triangle's hits are nearer to it by a radius.
    half: f64,
    footprint: Footprint,
    /// The planes that it was cut by, and the side of each on which it lies.
    cuts: Vec<(Plane, bool)>,
    /// True once it was moved ahead of one that is farther away.
    moved: bool,
    /// Triangles painted later whose order is right except for the thickness of planes, ascending.
    touching: Touching,
}

enum Touching {
    These(Vec<u32>),
    All,
}

/// Outcome of ordering a pair of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// The first hides nothing of the second.
    Clear,
    /// The first hides nothing of the second except for the thickness of planes: they touch.
    Touching,
    /// The first may hide the second.
    Unknown,
}

/// The list of polygons still to be painted.
struct Painting<'a> {
    screen: &'a Screen<'a>,
    pieces: Vec<Piece>,
    /// By maximum depth, nearest first, so that the farthest is popped.
    sorted: Vec<u32>,
    /// Pieces taken out of the list to be tried next; the last entry is first.
    next: Vec<u32>,
    triangles: usize,
    comparisons: u64,
    splits: u64,
}

impl<'a> Painting<'a> {
    fn new(mesh: &TriangleMesh, screen: &'a Screen) -> Painting<'a> {
        let triangles = mesh.triangles().iter().enumerate();
        let pieces: Vec<Piece> = triangles
            .filter_map(|(index, triangle)| Piece::whole(index as u32, &corners(triangle)?, screen))
            .collect();
        let triangles = pieces.len();
        Painting {
            screen,
            pieces,
            sorted: Vec::new(),
            next: Vec::new(),
            triangles,
            comparisons: 0,
            splits: 0,
        }
    }

    fn sort(&mut self) {
        let mut sorted: Vec<u32> = (0..self.pieces.len() as u32).collect();
        sorted.sort_by(|&a, &b| {
            self.comparisons += 1;
            let farthest = |i: u32| self.pieces[i as usize].footprint.depth.1;
            farthest(a).total_cmp(&farthest(b))
        });
        self.sorted = sorted;
    }

    /// The next piece to paint, with its `touching` known.
    fn next(&mut self) -> Option<u32> {
        loop {
            let first = self.next.pop().or_else(|| self.sorted.pop())?;
            if let Some(touching) = self.try_first(first) {
                self.pieces[first as usize].touching = touching;
                for &waiting in &self.next {
                    self.pieces[waiting as usize].moved = false;
                }
                return Some(first);
            }
        }
    }

    /// Shows that a piece hides none of the others and returns those that it touches; or else changes the list so
    /// that another attempt gets farther, and returns `None`.
    fn try_first(&mut self, first: u32) -> Option<Touching> {
        if self.is_spent() {
            return Some(Touching::All);
        }
        let mut touching = Vec::new();
        let nearest = self.pieces[first as usize].footprint.depth.0 - 2.0 * self.screen.slack.radius;
        let slots = (0..self.next.len()).rev().map(Slot::Next);
        for slot in slots.chain((0..self.sorted.len()).rev().map(Slot::Sorted)) {
            let other = match slot {
                Slot::Next(place) => self.next[place],
                Slot::Sorted(place) => self.sorted[place],
            };
            let piece = &self.pieces[other as usize];
            let triangle = piece.triangle;
            // The list is sorted by maximum depth: no piece from here on reaches back to this one.
            if matches!(slot, Slot::Sorted(_)) && piece.footprint.depth.1 < nearest {
                break;
            }
            self.comparisons += 1;
            match self.order(first, other) {
                Order::Clear => {}
                Order::Unknown if self.resolve(first, other, slot) => return None,
                Order::Touching | Order::Unknown => touching.push(triangle),
            }
        }
        touching.sort_unstable();
        touching.dedup();
        Some(Touching::These(touching))
    }

    /// The tests of the paper, cheapest first; the last two are repeated without the thickness of planes.
    fn order(&self, first: u32, second: u32) -> Order {
        let (first, second) = (&self.pieces[first as usize], &self.pieces[second as usize]);
        let (far, near) = (&first.footprint, &second.footprint);
        if far.depth.0 - 2.0 * self.screen.slack.radius > near.depth.1 || !far.rect.overlaps(&near.rect) {
            return Order::Clear;
        }
        let (low, high) = second.plane.range(&first.polygon);
        let (least, most) = first.plane.range(&second.polygon);
        let (sided, second_half) = (second.is_sided(self.screen.eye), second.half);
        let (first_sided, half) = (first.is_sided(self.screen.eye), first.half);
        if (sided && high < -second_half) || (first_sided && least > half) {
            return Order::Clear;
        }
        if let (Some(a), Some(b)) = (&far.outline, &near.outline)
            && a.is_apart_from(b)
        {
            return Order::Clear;
        }
        // Planes through the eye separate outlines, not depths.
        let behind = high <= second_half || (!sided && low >= -second_half);
        let in_front = least >= -half || (!first_sided && most <= half);
        if behind || in_front { Order::Touching } else { Order::Unknown }
    }

    /// Called when the first of a pair cannot be painted before the other: tries the other first, or cuts one of
    /// them. Returns false when nothing helps, and only depth can decide.
    fn resolve(&mut self, first: u32, other: u32, slot: Slot) -> bool {
        if !self.pieces[other as usize].moved {
            self.comparisons += 1;
            if self.order(other, first) != Order::Unknown {
                self.take(slot);
                self.pieces[other as usize].moved = true;
                self.next.extend([first, other]);
                return true;
            }
        }
        if let Some(parts) = self.cut(first, other) {
            self.insert(parts);
            return true;
        }
        if let Some(parts) = self.cut(other, first) {
            self.take(slot);
            self.next.push(first);
            self.insert(parts);
            return true;
        }
        false
    }

    fn take(&mut self, slot: Slot) {
        match slot {
            Slot::Next(place) => self.next.remove(place),
            Slot::Sorted(place) => self.sorted.remove(place),
        };
    }

    fn insert(&mut self, parts: [Option<Piece>; 2]) {
        self.splits += 1;
        for part in parts.into_iter().flatten() {
            let depth = part.footprint.depth.1;
            let place = self.sorted.partition_point(|&i| self.pieces[i as usize].footprint.depth.1 < depth);
            self.sorted.insert(place, self.pieces.len() as u32);
            self.pieces.push(part);
        }
    }

    /// Cuts a piece by the plane of another; failing that by its outline, a plane through the eye and an edge,
    /// because three can overlap in a cycle although no plane of theirs cuts any.
    fn cut(&self, piece: u32, by: u32) -> Option<[Option<Piece>; 2]> {
        let (piece, by) = (&self.pieces[piece as usize], &self.pieces[by as usize]);
        let outline = by.outline_planes(self.screen).map(|plane| (plane, 2.0 * self.screen.slack.radius));
        let planes = std::iter::once((by.plane, by.half)).chain(outline);
        planes
            .filter(|(plane, half)| {
                let (low, high) = plane.range(&piece.polygon);
                low < -half && high > *half
            })
            .map(|(plane, _)| [piece.part(plane, true, self.screen), piece.part(plane, false, self.screen)])
            .next()
    }

    fn is_spent(&self) -> bool {
        self.comparisons > MAX_COMPARISONS * self.triangles as u64
            || self.pieces.len() > MAX_PIECES * self.triangles + 1024
    }
}

/// The position of a waiting piece.
#[derive(Clone, Copy, Debug)]
enum Slot {
    Next(usize),
    Sorted(usize),
}

impl Piece {
    fn whole(triangle: u32, corners: &[DVec3; 3], screen: &Screen) -> Option<Piece> {
        let plane = Plane::of_triangle(corners);
        let (low, high) = plane.range(corners);
        let polygon = screen.visible(corners)?.into_owned();
        Some(Piece {
            triangle,
            plane: if plane.side(screen.eye) < 0.0 { plane.flipped() } else { plane },
            half: high.max(-low) + 2.0 * screen.slack.radius,
            footprint: screen.footprint(&polygon)?,
            polygon,
            cuts: Vec::new(),
            moved: false,
            touching: Touching::All,
        })
    }

    /// The part of a piece on one side of a plane, as far as it can be visible.
    fn part(&self, plane: Plane, front: bool, screen: &Screen) -> Option<Piece> {
        let towards = if front { plane } else { plane.flipped() };
        let polygon = clip(&self.polygon, &towards, -screen.slack.radius);
        let mut cuts = self.cuts.clone();
        cuts.push((plane, front));
        Some(Piece {
            triangle: self.triangle,
            plane: self.plane,
            half: self.half,
            footprint: screen.footprint(&polygon)?,
            polygon,
            cuts,
            moved: false,
            touching: Touching::All,
        })
    }

    /// True when the eye is not within the plane's thickness.
    fn is_sided(&self, eye: DVec3) -> bool {
        self.plane.side(eye) > self.half
    }

    /// Planes through the eye and each edge.
    fn outline_planes(&self, screen: &Screen) -> impl Iterator<Item = Plane> {
        let eye = screen.eye;
        let edges = self.polygon.iter().zip(self.polygon.iter().cycle().skip(1));
        edges.filter_map(move |(&p, &q)| Some(Plane::through(eye, (p - eye).cross(q - eye).try_normalize()?)))
    }

    /// True when a hit is in this part of its triangle.
    fn owns(&self, t: f32, pixel: usize, eye: DVec3, canvas: &mut Canvas) -> bool {
        let direction = canvas.direction(pixel);
        canvas.counts.side_tests += self.cuts.len() as u64;
        self.cuts.iter().all(|(plane, front)| {
            (plane.side(eye) + f64::from(t) * plane.normal.dot(direction) >= 0.0) == *front
        })
    }

    fn touches(&self, triangle: u32) -> bool {
        match &self.touching {
            Touching::These(triangles) => triangles.binary_search(&triangle).is_ok(),
            Touching::All => true,
        }
    }
}

/// Paints over everything that is certainly behind; where pieces touch, depth decides.
fn paint(index: u32, pieces: &[Piece], eye: DVec3, canvas: &mut Canvas) {
    let piece = &pieces[index as usize];
    canvas.each_pixel(piece.footprint.rect, |canvas, pixel| {
        let Some(hit) = canvas.hit(pixel, piece.triangle) else { return };
        if !piece.owns(hit.t, pixel, eye, canvas) {
            return;
        }
        let below = canvas.owner(pixel);
        if below != NO_OWNER && pieces[below as usize].touches(piece.triangle) {
            canvas.put_if_nearer(hit, index);
        } else {
            canvas.put(hit, index);
        }
    });
}
