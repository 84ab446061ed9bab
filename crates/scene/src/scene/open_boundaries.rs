//! Boundaries of media that are open, such as the front of a room full of fog or the face of a lake: which side of them is inside.
//!
//! A path that has crossed such a boundary knows where it is. One that begins behind it may never meet it, so it asks from where it
//! begins: the side of the boundary that is seen from there decides, whatever the path's own direction.

use crate::geometry::placed::Placed;
use crate::materials::Material;
use bilux_math::{DVec3, Vec3};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A boundary is open if its areas, as vectors, add up to more than this part of their lengths: those of a closed one cancel.
const OPEN: f64 = 1.0 / 16.0;

/// So many of its points are looked at.
const POINTS: usize = 7;

/// The bodies that open boundaries have.
#[derive(Default)]
pub(super) struct OpenBoundaries {
    /// For each object the one that stands for its body: open sheets of one material, such as six quads around fog, bound one
    /// together. None at all where no sheet is open.
    bodies: Vec<u32>,
    /// The objects that stand for one.
    stand_in: HashSet<u32>,
    /// Bodies that are open as a whole.
    pub(super) open: Vec<OpenBoundary>,
}

/// A body that is open.
pub(super) struct OpenBoundary {
    pub(super) object: u32,
    /// Points of it, each in the space of an object.
    pub(super) points: Vec<(u32, Vec3)>,
}

/// A sheet in the world.
struct Sheet<'a> {
    object: u32,
    area: DVec3,
    placed: &'a Placed,
}

impl OpenBoundaries {
    pub(super) fn of(objects: &[Placed], materials: &[Arc<dyn Material>]) -> OpenBoundaries {
        let mut sheets: Vec<Vec<Sheet>> = Vec::new();
        let mut of_material: HashMap<u32, usize> = HashMap::new();
        for (index, placed) in objects.iter().enumerate() {
            let material = &materials[placed.material as usize];
            let medium = material.medium();
            if material.nested().is_none() && medium.is_none_or(|medium| medium.is_clear()) {
                continue;
            }
            let Some(sheet) = Sheet::of(index as u32, placed) else { continue };
            // A grid is in the space of its own object.
            let has_grid = medium.is_some_and(|medium| medium.density.is_some() || medium.glow.is_some());
            let known = of_material.get(&placed.material).copied().filter(|_| !has_grid);
            match known {
                Some(body) => sheets[body].push(sheet),
                None => {
                    of_material.insert(placed.material, sheets.len());
                    sheets.push(vec![sheet]);
                }
            }
        }
        if sheets.is_empty() {
            return OpenBoundaries::default();
        }
        let mut bodies: Vec<u32> = (0..objects.len() as u32).collect();
        for sheet in sheets.iter().flat_map(|body| body.iter().map(|sheet| (sheet, body[0].object))) {
            bodies[sheet.0.object as usize] = sheet.1;
        }
        let stand_in = sheets.iter().map(|body| body[0].object).collect();
        let open = sheets.iter().filter_map(|body| OpenBoundary::of(body)).collect();
        OpenBoundaries { bodies, stand_in, open }
    }

    /// The object that stands for the body of another.
    #[inline]
    pub(super) fn body(&self, object: u32) -> u32 {
        self.bodies.get(object as usize).copied().unwrap_or(object)
    }

    /// Whether an object stands for a body of open sheets.
    pub(super) fn is_body(&self, object: u32) -> bool {
        self.stand_in.contains(&object)
    }

    /// Whether the body that an object stands for is open.
    pub(super) fn is_open(&self, object: u32) -> bool {
        self.open.iter().any(|boundary| boundary.object == object)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.open.is_empty()
    }
}

impl<'a> Sheet<'a> {
    /// Sheet of an object, at time 0; `None` where it is closed or next to that.
    fn of(object: u32, placed: &'a Placed) -> Option<Sheet<'a>> {
        let to_world = placed.motion.at(0.0);
        let positions = &placed.mesh.positions;
        let normal = |[a, b, c]: [Vec3; 3]| (b - a).as_dvec3().cross((c - a).as_dvec3());
        let corners = |triangle: &[u32; 3]| triangle.map(|i| to_world.point(positions[i as usize]));
        let (mut area, mut all) = (DVec3::ZERO, 0.0);
        for triangle in &placed.mesh.triangles {
            let n = normal(corners(triangle));
            (area, all) = (area + n, all + n.length());
        }
        (area.length() > OPEN * all).then_some(Sheet { object, area, placed })
    }
}

impl OpenBoundary {
    /// Boundary of some sheets; `None` where they close each other. The points are spread over all triangles by their numbers.
    fn of(sheets: &[Sheet]) -> Option<OpenBoundary> {
        let area: DVec3 = sheets.iter().map(|sheet| sheet.area).sum();
        let all: f64 = sheets.iter().map(|sheet| sheet.area.length()).sum();
        if area.length() <= OPEN * all {
            return None;
        }
        let count: usize = sheets.iter().map(|sheet| sheet.placed.mesh.triangles.len()).sum();
        let point = |i: usize| {
            let mut number = (2 * i + 1) * count / (2 * POINTS);
            let sheet = sheets.iter().find(|sheet| {
                let has = number < sheet.placed.mesh.triangles.len();
                number -= if has { 0 } else { sheet.placed.mesh.triangles.len() };
                has
            })?;
            let mesh = &sheet.placed.mesh;
            let [a, b, c] = mesh.triangles[number].map(|i| mesh.positions[i as usize]);
            // Not in line with one another, where a few triangles have all of them.
            let u = (i as f32 * 0.618 + 0.3).fract();
            let v = (i as f32 * 0.414 + 0.2).fract();
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            Some((sheet.object, a + (b - a) * u + (c - a) * v))
        };
        Some(OpenBoundary { object: sheets[0].object, points: (0..POINTS).filter_map(point).collect() })
    }
}

/// Open boundaries behind which a point is, as far as they are known.
#[derive(Default)]
pub(super) struct Behind {
    /// The point and its time, in bits, if it is known.
    pub(super) at: Option<[u32; 4]>,
    /// The objects behind whose boundaries it is.
    pub(super) objects: Vec<u32>,
}
