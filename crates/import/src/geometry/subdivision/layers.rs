//! Layers: values of corners that go their own way over the surface, such as texture coordinates, with seams between them.
//! [OpenSubdiv, Face-Varying Interpolation Rules]

use super::cage::{Attribute, Cage, LAYER_LIMIT, Layer};
use super::edges::Edges;
use super::rules::Scheme;
use bilux_math::Vec3;
use std::collections::{HashMap, HashSet};

/// Places where values are linear rather than smooth. Each rule adds to the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Linear {
    /// Seams and borders are smooth curves.
    None,
    /// Points of a single polygon stay where they are.
    Corners,
    /// Also points where three and more parts meet.
    Junctions,
    /// Also ends of seams, and points where one of two parts has a corner.
    Darts,
    /// Along all seams and borders.
    Borders,
    /// Everywhere.
    All,
}

impl Cage {
    /// Adds values; faces, creases and corners have to be there. `of_corner` is a value and its number: corners of a point
    /// are joined where their numbers are the same.
    pub fn add_layer(
        &mut self,
        attribute: Attribute,
        linear: Linear,
        groups: Vec<bool>,
        of_corner: impl Fn(usize) -> (u32, Vec3),
    ) {
        if self.layers.len() >= LAYER_LIMIT {
            return;
        }
        let (mut known, mut positions) = (HashMap::new(), Vec::new());
        let corners = self.corners.iter().enumerate().map(|(corner, &point)| {
            let (number, value) = of_corner(corner);
            *known.entry((point, number)).or_insert_with(|| {
                positions.push(value);
                positions.len() as u32 - 1
            })
        });
        let corners: Vec<u32> = corners.collect();
        let mut cage =
            Cage::new(if linear == Linear::All { Scheme::Bilinear } else { self.scheme }, &positions);
        (cage.corners, cage.ends, cage.groups) = (corners, self.ends.clone(), self.groups.clone());
        if linear == Linear::None {
            cage.round_corners();
        }
        let edges = self.edges();
        self.sharpen_as_here(&mut cage, &edges);
        self.sharpen_seams(&mut cage, &edges, linear);
        self.layers.push(Layer { attribute, cage, groups });
    }

    /// Adds values of points, which are smooth as the surface is, or linear.
    pub fn add_layer_of_points(
        &mut self,
        attribute: Attribute,
        is_linear: bool,
        groups: Vec<bool>,
        of_corner: impl Fn(usize) -> Vec3,
    ) {
        let linear = match is_linear {
            true => Linear::All,
            false if self.sharp_corners => Linear::Corners,
            false => Linear::None,
        };
        self.add_layer(attribute, linear, groups, |corner| (0, of_corner(corner)));
    }

    /// Makes sharp in a layer what is sharp in the surface.
    fn sharpen_as_here(&self, layer: &mut Cage, edges: &Edges) {
        for (corner, &edge) in edges.of_corner.iter().enumerate() {
            let edge = &edges.all[edge as usize];
            if edge.polygons == 2 && self.sharpness(edge) > 0.0 {
                let ends = [layer.corners[corner], layer.corners[edges.next[corner] as usize]];
                layer.crease(ends, self.sharpness(edge) as f32);
            }
        }
        for (corner, point) in self.corners.iter().enumerate() {
            if let Some(sharpness) = self.corner_sharpness.get(point) {
                layer.sharpen(layer.corners[corner], *sharpness as f32);
            }
        }
    }

    /// Makes points of seams sharp.
    fn sharpen_seams(&self, layer: &mut Cage, edges: &Edges, linear: Linear) {
        if linear <= Linear::Corners || linear == Linear::All {
            return;
        }
        let own = edges.of_layer(&layer.corners);
        // For each point of the layer its polygons, and for each point of the surface those of the layer.
        let mut polygons = vec![0u32; layer.values.len()];
        let mut parts: HashMap<u32, HashSet<u32>> = HashMap::new();
        for (&point, &part) in self.corners.iter().zip(&layer.corners) {
            polygons[part as usize] += 1;
            parts.entry(point).or_default().insert(part);
        }
        let mut sharp: Vec<u32> = Vec::new();
        for parts in parts.values() {
            let has_corner = parts.len() == 2 && parts.iter().any(|part| polygons[*part as usize] == 1);
            if parts.len() > 2 || linear >= Linear::Darts && has_corner {
                sharp.extend(parts);
            }
        }
        // Edges that are whole in the surface and not in the layer.
        let mut seams = vec![0u32; layer.values.len()];
        for (corner, &edge) in own.of_corner.iter().enumerate() {
            let edge = &own.all[edge as usize];
            if edge.polygons == 2 {
                continue;
            }
            let is_seam = edges.all[edges.of_corner[corner] as usize].polygons == 2;
            for end in edge.ends {
                seams[end as usize] += u32::from(is_seam);
                if linear == Linear::Borders {
                    sharp.push(end);
                }
            }
        }
        if linear >= Linear::Darts {
            // The end of a seam is one point, and both sides of the seam begin there.
            let is_dart = |part: &u32| seams[*part as usize] == 2;
            let single = parts.values().filter(|parts| parts.len() == 1);
            sharp.extend(single.flatten().copied().filter(is_dart));
        }
        sharp.into_iter().for_each(|part| layer.sharpen(part, f32::INFINITY));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four squares around a point, with coordinates that are their places, each corner with the number of its part.
    fn net(linear: Linear, part: impl Fn(usize) -> u32) -> Vec<Vec3> {
        let at = |i: usize| Vec3::new((i % 3) as f32, (i / 3) as f32, 0.0);
        let mut cage = Cage::new(Scheme::CatmullClark, &(0..9).map(at).collect::<Vec<_>>());
        let faces = [[0u32, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]];
        faces.iter().for_each(|face| cage.add_face(face, &[], 0));
        let points = faces.concat();
        // Stretched, so that what is smooth moves.
        let uv = |corner: usize| {
            let p = at(points[corner] as usize);
            (part(corner / 4), Vec3::new(p.x * p.x, p.y * p.y, 0.0))
        };
        cage.add_layer(Attribute::Uv, linear, vec![true], uv);
        let fine = cage.refined();
        fine.layers[0].cage.values.iter().map(|value| value.position.as_vec3()).collect()
    }

    /// The middle of the net is at 1; smooth it goes towards the mean of its neighbours, 5/4 by rules of cubic splines.
    #[test]
    fn values_are_smooth_without_seams_and_keep_junctions() {
        let whole = net(Linear::Junctions, |_| 0);
        assert!((whole[2] - Vec3::new(1.25, 1.25, 0.0)).length() < 1e-6, "{whole:?}");
        assert_eq!(whole[0], Vec3::ZERO, "corners stay");
        assert!(net(Linear::None, |_| 0)[0].length() > 0.1, "without the rule they do not");
        let linear = net(Linear::All, |_| 0);
        assert_eq!(linear[2], Vec3::new(1.0, 1.0, 0.0));
        // Two halves: the middle is on a seam along y, a cubic spline there and in its place across.
        let halves = net(Linear::Junctions, |face| face as u32 % 2);
        assert!(halves.iter().any(|p| (*p - Vec3::new(1.0, 1.25, 0.0)).length() < 1e-6), "{halves:?}");
        assert!(net(Linear::Borders, |face| face as u32 % 2).contains(&Vec3::new(1.0, 1.0, 0.0)));
        // Three parts meet.
        let three = net(Linear::Junctions, |face| (face as u32).min(2));
        let moved = net(Linear::Corners, |face| (face as u32).min(2));
        let stays = |list: &[Vec3]| list.iter().filter(|p| **p == Vec3::new(1.0, 1.0, 0.0)).count();
        assert_eq!((stays(&three), stays(&moved)), (3, 2));
    }
}
