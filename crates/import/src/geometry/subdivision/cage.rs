//! The cage of a subdivision surface, and its refinement.

use super::edges::{Edge, Edges};
use super::rules::{Ring, Scheme, Value};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use std::collections::HashMap;

/// The polygons that control a subdivision surface.
#[derive(Clone, Debug)]
pub struct Cage {
    pub(super) scheme: Scheme,
    pub(super) values: Vec<Value>,
    pub(super) has_colours: bool,
    /// The point of each corner, polygon after polygon.
    pub(super) corners: Vec<u32>,
    /// The end of each polygon's corners.
    pub(super) ends: Vec<u32>,
    /// Texture coordinates of each corner, or none. They are not smoothed.
    pub(super) uvs: Vec<Vec2>,
    /// Values of corners that are smoothed between their own seams.
    pub(super) layers: Vec<Layer>,
    /// The group of each polygon, which the polygons made of it share.
    pub(super) groups: Vec<u32>,
    /// Number of levels for which an edge stays sharp, by the edge's points.
    creases: HashMap<[u32; 2], f64>,
    /// Number of levels for which a point stays sharp, by point.
    pub(super) corner_sharpness: HashMap<u32, f64>,
    /// True if a point of a single polygon is a corner.
    pub(super) sharp_corners: bool,
    /// The weight of each neighbour in where a point of a crease ends up.
    border_side: f64,
}

/// More are not kept for one cage.
pub(super) const LAYER_LIMIT: usize = 4;

/// Attribute of a mesh to which the values of a layer belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attribute {
    Uv,
    SecondUv,
    Colour,
    Opacity,
}

/// Values of the corners of a cage, which are the points of a cage of their own.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub(super) attribute: Attribute,
    pub(super) cage: Cage,
    /// True for the groups that have it.
    pub(super) groups: Vec<bool>,
}

impl Cage {
    /// A cage without polygons on these points.
    pub fn new(scheme: Scheme, positions: &[Vec3]) -> Cage {
        let value = |p: &Vec3| Value { position: p.as_dvec3(), ..Value::default() };
        Cage {
            scheme,
            values: positions.iter().map(value).collect(),
            has_colours: false,
            corners: Vec::new(),
            ends: Vec::new(),
            uvs: Vec::new(),
            layers: Vec::new(),
            groups: Vec::new(),
            creases: HashMap::new(),
            corner_sharpness: HashMap::new(),
            sharp_corners: true,
            border_side: 1.0 / 6.0,
        }
    }

    /// Sets a colour for each point.
    pub fn set_colours(&mut self, colours: &[Rgb]) {
        self.has_colours = colours.len() == self.values.len();
        for (value, colour) in self.values.iter_mut().zip(colours) {
            value.colour = DVec3::from_array(colour.to_array().map(f64::from));
        }
    }

    /// Adds a polygon of a group, by its points and the texture coordinates of its corners; either all polygons have some
    /// or none. For [`Scheme::Loop`] it becomes triangles.
    pub fn add_face(&mut self, points: &[u32], uvs: &[Vec2], group: u32) {
        let mut add = |corners: &[usize]| {
            self.corners.extend(corners.iter().map(|&i| points[i]));
            self.uvs.extend(corners.iter().filter_map(|&i| uvs.get(i)));
            self.ends.push(self.corners.len() as u32);
            self.groups.push(group);
        };
        if self.scheme == Scheme::Loop {
            (2..points.len()).for_each(|i| add(&[0, i - 1, i]));
        } else {
            add(&(0..points.len()).collect::<Vec<_>>());
        }
    }

    /// Makes an edge sharp for this many levels; infinity keeps it sharp.
    pub fn crease(&mut self, ends: [u32; 2], sharpness: f32) {
        if sharpness > 0.0 {
            self.creases.insert(Edge::key(ends[0], ends[1]), f64::from(sharpness));
        }
    }

    /// Makes a point sharp for this many levels; infinity keeps it sharp.
    pub fn sharpen(&mut self, point: u32, sharpness: f32) {
        if sharpness > 0.0 {
            self.corner_sharpness.insert(point, f64::from(sharpness));
        }
    }

    /// Rounds the corners of the border, which are points of a single polygon.
    pub fn round_corners(&mut self) {
        self.sharp_corners = false;
    }

    /// Rounds the corners of the border, and lets its points end up where pbrt puts them.
    pub fn round_borders_as_pbrt(&mut self) {
        self.sharp_corners = false;
        self.border_side = 0.2;
    }

    /// The number of polygons.
    pub fn faces(&self) -> usize {
        self.ends.len()
    }

    /// The points.
    pub fn positions(&self) -> impl Iterator<Item = Vec3> {
        self.values.iter().map(|value| value.position.as_vec3())
    }

    /// The length of the longest edge.
    pub fn longest_edge(&self) -> f64 {
        let mut start = 0;
        let mut longest = 0.0f64;
        for &end in &self.ends {
            let face = &self.corners[start..end as usize];
            for (i, &from) in face.iter().enumerate() {
                let to = face[(i + 1) % face.len()];
                let [a, b] = [from, to].map(|point| self.values[point as usize].position);
                longest = longest.max(a.distance(b));
            }
            start = end as usize;
        }
        longest
    }

    /// The memory that the next level takes in bytes, with what is needed to make it.
    pub fn bytes_of_next(&self) -> u64 {
        // Four corners for each corner: a point, a colour, an edge in a hash table, texture coordinates.
        self.corners.len() as u64 * 4 * 120 * (1 + self.layers.len() as u64)
    }

    pub(super) fn edges(&self) -> Edges {
        Edges::new(&self.corners, &self.ends)
    }

    /// Number of levels for which an edge stays sharp.
    pub(super) fn sharpness(&self, edge: &Edge) -> f64 {
        if edge.polygons != 2 {
            return f64::INFINITY;
        }
        if self.creases.is_empty() {
            return 0.0;
        }
        self.creases.get(&Edge::key(edge.ends[0], edge.ends[1])).copied().unwrap_or(0.0)
    }

    /// The polygons one after the other, each with the range of its corners.
    fn polygons(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|&end| end as usize));
        starts.zip(&self.ends).map(|(start, &end)| start..end as usize)
    }

    /// The mean of the points of each polygon.
    fn middles(&self) -> Vec<Value> {
        let middle = |face: std::ops::Range<usize>| {
            let share = 1.0 / face.len() as f64;
            self.corners[face].iter().fold(Value::default(), |sum, &p| sum + self.values[p as usize] * share)
        };
        self.polygons().map(middle).collect()
    }

    /// Ring of neighbours around each point.
    fn rings(&self, edges: &Edges, middles: &[Value]) -> Vec<Ring> {
        let mut rings = vec![Ring::default(); self.values.len()];
        for edge in &edges.all {
            let sharpness = self.sharpness(edge);
            for [at, other] in [edge.ends, [edge.ends[1], edge.ends[0]]] {
                let (ring, value) = (&mut rings[at as usize], self.values[other as usize]);
                ring.edges.add(value);
                if sharpness > 0.0 {
                    ring.sharp.add(value);
                }
                if sharpness > 1.0 {
                    ring.sharper.add(value);
                } else if sharpness > 0.0 {
                    ring.fading = (ring.fading.0 + sharpness, ring.fading.1 + 1.0);
                }
            }
        }
        for (face, &middle) in self.polygons().zip(middles) {
            let points = &self.corners[face];
            for (i, &point) in points.iter().enumerate() {
                let ring = &mut rings[point as usize];
                ring.faces.add(middle);
                if points.len() == 4 {
                    ring.opposite.add(self.values[points[(i + 2) % 4] as usize]);
                }
            }
        }
        for ring in rings.iter_mut().filter(|ring| self.sharp_corners && ring.faces.count == 1.0) {
            ring.sharpness = f64::INFINITY;
        }
        for (&point, &sharpness) in &self.corner_sharpness {
            if let Some(ring) = rings.get_mut(point as usize) {
                ring.sharpness = ring.sharpness.max(sharpness);
            }
        }
        rings
    }

    /// Cage of the same surface with about four times as many polygons.
    pub fn refined(&self) -> Cage {
        self.refined_by(&self.edges(), self.scheme)
    }

    /// Refined cage, from the edges of this one, whose polygons are divided as those of the scheme `division`.
    fn refined_by(&self, edges: &Edges, division: Scheme) -> Cage {
        let middles = self.middles();
        let rings = self.rings(edges, &middles);
        let mut values: Vec<Value> =
            self.values.iter().zip(&rings).map(|(&own, ring)| ring.moved(self.scheme, own)).collect();
        let first_edge = values.len() as u32;
        values.extend(edges.all.iter().map(|edge| self.edge_point(edge, edges, &middles)));
        let first_face = values.len() as u32;
        if division != Scheme::Loop {
            values.extend_from_slice(&middles);
        }
        let mut next = Cage {
            values,
            corners: Vec::with_capacity(self.corners.len() * 4),
            ends: Vec::with_capacity(self.corners.len()),
            uvs: Vec::with_capacity(self.uvs.len() * 4),
            layers: self.layers.iter().map(|layer| layer.refined_by(edges, division)).collect(),
            groups: Vec::with_capacity(self.corners.len()),
            creases: HashMap::new(),
            corner_sharpness: less(&self.corner_sharpness),
            ..*self
        };
        for (number, face) in self.polygons().enumerate() {
            let part = Part { cage: self, edges, face, group: self.groups[number], first_edge };
            match division {
                Scheme::Loop => part.into_triangles(&mut next),
                _ => part.into_squares(first_face + number as u32, &mut next),
            }
        }
        for (number, edge) in edges.all.iter().enumerate().filter(|(_, edge)| edge.polygons == 2) {
            let sharpness = self.sharpness(edge) - 1.0;
            if sharpness > 0.0 {
                let middle = first_edge + number as u32;
                next.creases.extend(edge.ends.map(|end| (Edge::key(end, middle), sharpness)));
            }
        }
        next
    }

    /// The point that an edge becomes.
    fn edge_point(&self, edge: &Edge, edges: &Edges, middles: &[Value]) -> Value {
        let [a, b] = edge.ends.map(|end| self.values[end as usize]);
        let middle = (a + b) * 0.5;
        let sharpness = self.sharpness(edge);
        if sharpness >= 1.0 || self.scheme == Scheme::Bilinear {
            return middle;
        }
        let smooth = if self.scheme == Scheme::Loop {
            let opposite = edge.corners.map(|corner| {
                let third = edges.next[edges.next[corner as usize] as usize];
                self.values[self.corners[third as usize] as usize]
            });
            (a + b) * 0.375 + (opposite[0] + opposite[1]) * 0.125
        } else {
            let faces = edge.corners.map(|corner| middles[self.face_of(corner)]);
            (a + b + faces[0] + faces[1]) * 0.25
        };
        middle * sharpness + smooth * (1.0 - sharpness)
    }

    fn face_of(&self, corner: u32) -> usize {
        self.ends.partition_point(|&end| end <= corner)
    }

    /// The places of all points on the surface itself. Polygons other than squares have to be refined first; until then
    /// their points stay where they are.
    pub(super) fn limit(&self) -> Vec<Value> {
        self.limit_by(&self.edges())
    }

    /// Places of all points on the surface itself as in `limit`, from the edges of its polygons.
    fn limit_by(&self, edges: &Edges) -> Vec<Value> {
        if self.scheme == Scheme::CatmullClark && self.polygons().any(|face| face.len() != 4) {
            return self.values.clone();
        }
        let rings = self.rings(edges, &self.middles());
        self.values
            .iter()
            .zip(&rings)
            .map(|(&own, ring)| ring.limit(self.scheme, own, self.border_side))
            .collect()
    }
}

impl Layer {
    fn refined_by(&self, edges: &Edges, division: Scheme) -> Layer {
        let cage = self.cage.refined_by(&edges.of_layer(&self.cage.corners), division);
        Layer { cage, groups: self.groups.clone(), attribute: self.attribute }
    }

    /// Values of the layer on the surface, from the edges of the surface.
    pub(super) fn limit(&self, edges: &Edges) -> Vec<Value> {
        self.cage.limit_by(&edges.of_layer(&self.cage.corners))
    }
}

/// The sharpness at the next level.
fn less(sharpness: &HashMap<u32, f64>) -> HashMap<u32, f64> {
    sharpness.iter().map(|(&point, &s)| (point, s - 1.0)).filter(|(_, s)| *s > 0.0).collect()
}

/// A polygon that is divided.
struct Part<'a> {
    cage: &'a Cage,
    edges: &'a Edges,
    face: std::ops::Range<usize>,
    group: u32,
    /// The number of the first point that was an edge.
    first_edge: u32,
}

impl Part<'_> {
    fn count(&self) -> usize {
        self.face.len()
    }

    fn point(&self, i: usize) -> u32 {
        self.cage.corners[self.face.start + i % self.count()]
    }

    fn edge(&self, i: usize) -> u32 {
        self.first_edge + self.edges.of_corner[self.face.start + i % self.count()]
    }

    /// The texture coordinates of a corner, if there are any.
    fn uv(&self, i: usize) -> Option<Vec2> {
        self.cage.uvs.get(self.face.start + i % self.count()).copied()
    }

    fn uv_between(&self, i: usize) -> Option<Vec2> {
        Some((self.uv(i)? + self.uv(i + 1)?) * 0.5)
    }

    fn add(&self, next: &mut Cage, points: &[u32], uvs: &[Option<Vec2>]) {
        next.corners.extend_from_slice(points);
        next.uvs.extend(uvs.iter().flatten());
        next.ends.push(next.corners.len() as u32);
        next.groups.push(self.group);
    }

    /// A square at each corner, between the middles of two edges and of the polygon.
    fn into_squares(self, middle: u32, next: &mut Cage) {
        let n = self.count();
        let sum = (0..n).try_fold(Vec2::ZERO, |sum, i| Some(sum + self.uv(i)?));
        let uv = sum.map(|sum| sum / n as f32);
        for i in 0..n {
            let before = i + n - 1;
            self.add(
                next,
                &[self.point(i), self.edge(i), middle, self.edge(before)],
                &[self.uv(i), self.uv_between(i), uv, self.uv_between(before)],
            );
        }
    }

    /// A triangle at each corner, and one between them.
    fn into_triangles(self, next: &mut Cage) {
        for i in 0..3 {
            let points = [self.point(i), self.edge(i), self.edge(i + 2)];
            self.add(next, &points, &[self.uv(i), self.uv_between(i), self.uv_between(i + 2)]);
        }
        let points = [0, 1, 2].map(|i| self.edge(i));
        self.add(next, &points, &[0, 1, 2].map(|i| self.uv_between(i)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A net of squares with a height at each point.
    fn net(scheme: Scheme, n: usize, height: impl Fn(usize, usize) -> f64) -> Cage {
        let at = |x: usize, y: usize| Vec3::new(x as f32, y as f32, height(x, y) as f32);
        let points: Vec<Vec3> = (0..n * n).map(|i| at(i % n, i / n)).collect();
        let mut cage = Cage::new(scheme, &points);
        for (x, y) in (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| (x, y))) {
            let [a, b, c, d] =
                [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(|[x, y]| (y * n + x) as u32);
            cage.add_face(&[a, b, c, d], &[], 0);
        }
        cage
    }

    /// The uniform cubic B-spline of four numbers, at a parameter from 0 to 1. [Farin 2002, section 8.2]
    fn spline(p: [f64; 4], t: f64) -> f64 {
        let s = 1.0 - t;
        let weights =
            [s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0, 3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t];
        weights.iter().zip(p).map(|(w, p)| w * p).sum::<f64>() / 6.0
    }

    fn bumps(x: usize, y: usize) -> f64 {
        ((x * 7 + y * 3) % 5) as f64 + if x == 3 { 2.0 } else { 0.0 }
    }

    /// The heights of the limit in the net's middle square, at the points of some level.
    fn middle(cage: &Cage, levels: u32) -> Vec<(f64, f64, f64)> {
        let fine = (0..levels).fold(cage.clone(), |cage, _| cage.refined());
        let inner = |v: &DVec3| (2.0..=3.0).contains(&v.x) && (2.0..=3.0).contains(&v.y);
        let places = fine.limit().into_iter().map(|v| v.position).filter(inner);
        places.map(|p| (p.x - 2.0, p.y - 2.0, p.z)).collect()
    }

    #[test]
    fn a_regular_net_is_a_bicubic_spline() {
        let cage = net(Scheme::CatmullClark, 6, bumps);
        for levels in 0..4 {
            let points = middle(&cage, levels);
            assert_eq!(points.len(), ((1 << levels) + 1usize).pow(2));
            for (u, v, height) in points {
                let row = |y: usize| spline([1, 2, 3, 4].map(|x| bumps(x, y)), u);
                let wanted = spline([1, 2, 3, 4].map(row), v);
                assert!((height - wanted).abs() < 1e-9, "level {levels} at {u} {v}: {height}, not {wanted}");
            }
        }
    }

    #[test]
    fn a_sharp_edge_is_a_cubic_spline_and_stays_where_it_is_from_level_to_level() {
        let mut cage = net(Scheme::CatmullClark, 6, bumps);
        for y in 0..5 {
            cage.crease([y * 6 + 2, y * 6 + 8], f32::INFINITY);
        }
        for levels in 0..4 {
            for (u, v, height) in middle(&cage, levels).into_iter().filter(|(u, ..)| *u == 0.0) {
                let wanted = spline([1, 2, 3, 4].map(|y| bumps(2, y)), v);
                assert!((height - wanted).abs() < 1e-9, "level {levels} at {u} {v}: {height}, not {wanted}");
            }
        }
    }

    /// With a sharpness of 1, an edge is as if it were sharp for one level and smooth afterwards. [DeRose 1998]
    #[test]
    fn a_sharpness_of_one_is_a_level_of_sharpness_and_half_of_it_lies_between() {
        let at = |sharpness: f32| {
            let mut cage = net(Scheme::CatmullClark, 6, bumps);
            (0..5).for_each(|y| cage.crease([y * 6 + 2, y * 6 + 8], sharpness));
            cage.refined()
        };
        let [smooth, half, one, sharp] = [0.0, 0.5, 1.0, f32::INFINITY].map(at);
        assert!(one.creases.is_empty() && !sharp.creases.is_empty());
        for i in 0..smooth.values.len() {
            let [a, b, c, d] = [&smooth, &half, &one, &sharp].map(|cage| cage.values[i].position.z);
            assert!(c == d && (b - 0.5 * (a + c)).abs() < 1e-12, "{i}: {a} {b} {c} {d}");
        }
    }

    /// The corner of a cube ends at (9 + 4 - 1) / 24 of itself.
    #[test]
    fn a_cube_becomes_round_and_keeps_its_limit_from_level_to_level() {
        let points: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - Vec3::ONE)
            .collect();
        let mut cage = Cage::new(Scheme::CatmullClark, &points);
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            cage.add_face(&face, &[], 0);
        }
        let mut fine = cage.clone();
        for _ in 0..4 {
            let limit = fine.limit();
            for (corner, end) in points.iter().zip(&limit) {
                assert!(
                    (end.position - 0.5 * corner.as_dvec3()).length() < 1e-12,
                    "{corner} {}",
                    end.position
                );
            }
            fine = fine.refined();
        }
        let mesh = fine.meshes(1).pop().unwrap();
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2 * 6 * 256, 6 * 256 + 2));
        let outward = |(p, n): (&Vec3, &Vec3)| p.normalize().dot(*n);
        assert!(mesh.positions.iter().zip(&mesh.normals).map(outward).all(|cosine| cosine > 0.95));
        // With all edges sharp it stays a cube.
        for face in cage.corners.clone().chunks(4) {
            (0..4).for_each(|i| cage.crease([face[i], face[(i + 1) % 4]], f32::INFINITY));
        }
        let mesh = cage.refined().refined().meshes(1).pop().unwrap();
        assert!(mesh.positions.iter().all(|p| p.abs().max_element() == 1.0));
        assert!(
            mesh.normals.iter().all(|n| n.abs().max_element() > 0.999),
            "normals are split at sharp edges"
        );
    }

    #[test]
    fn an_octahedron_of_triangles_becomes_round_and_stays_closed() {
        let points = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let mut cage = Cage::new(Scheme::Loop, &points);
        for face in [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]] {
            cage.add_face(&face, &[], 0);
        }
        let first = cage.limit();
        let fine = cage.refined().refined().refined();
        assert_eq!((fine.faces(), fine.values.len()), (8 * 64, 2 + 8 * 64 / 2));
        let limit = fine.limit();
        assert!(first.iter().zip(&limit).all(|(a, b)| (a.position - b.position).length() < 1e-12));
        let lengths: Vec<f64> = limit.iter().map(|p| p.position.length()).collect();
        let (least, most) = lengths.iter().fold((f64::MAX, 0f64), |(a, b), &l| (a.min(l), b.max(l)));
        assert!(least > 0.4 && most < 0.75 && most / least < 1.3, "{least} {most}");
        assert!(fine.edges().all.iter().all(|edge| edge.polygons == 2));
    }

    #[test]
    fn borders_end_where_their_corners_are_or_are_rounded() {
        let mut cage = net(Scheme::CatmullClark, 2, |_, _| 0.0);
        let extent =
            |cage: &Cage| cage.refined().refined().limit().iter().fold(0.0f64, |m, v| m.max(v.position.x));
        assert_eq!(extent(&cage), 1.0);
        cage.round_corners();
        assert!(extent(&cage) < 0.99);
        let flat = net(Scheme::Loop, 2, |_, _| 0.0).refined().refined();
        assert!(flat.limit().iter().all(|v| v.position.z == 0.0 && (0.0..=1.0).contains(&v.position.x)));
    }
}
