//! Spheres, cubes and the like. Texture coordinates are those of Mitsuba, with v upwards as here.

use super::maker::{Piece, ShapeMaker};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::geometry::tessellation::grid;
use bilux_import::geometry::tessellation::sphere::{AROUND, part_of_sphere};
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat4, DVec3, Vec2, Vec3};
use bilux_scene::Mesh;
use std::f64::consts::{PI, TAU};
use std::rc::Rc;

pub(super) fn sphere(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let centre = plugin.vector("center")?.unwrap_or_default();
    let radius = plugin.number_or("radius", 1.0)?;
    let mesh = maker.solid(plugin, "sphere", || part_of_sphere(1.0, [PI, 0.0], 1.0, AROUND))?;
    let first = DMat4::from_translation(centre) * DMat4::from_scale(DVec3::splat(radius));
    let mut pieces = maker.placed(plugin, vec![mesh], &first)?;
    let flips = plugin.flag("flip_normals", false)?;
    pieces.iter_mut().for_each(|piece| piece.is_sphere = !flips);
    Ok(pieces)
}

/// From -1 to 1 in x and y; it faces +z.
pub(super) fn rectangle(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let mesh = maker.solid(plugin, "rectangle", || {
        let quad = Mesh::quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
        upwards(quad)
    })?;
    maker.placed(plugin, vec![mesh], &DMat4::IDENTITY)
}

/// Mesh with v upwards, from one where v has pointed downwards.
pub(super) fn upwards(mut mesh: Mesh) -> Mesh {
    mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    mesh
}

/// The faces of a cube: where they face, where u points to, and where v points to, downwards.
const FACES: [[[i8; 3]; 3]; 6] = [
    [[1, 0, 0], [0, 1, 0], [0, 0, -1]],
    [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0, 1, 0], [-1, 0, 0], [0, 0, -1]],
    [[0, -1, 0], [0, 0, 1], [1, 0, 0]],
    [[0, 0, 1], [0, 1, 0], [1, 0, 0]],
    [[0, 0, -1], [0, -1, 0], [1, 0, 0]],
];

/// From -1 to 1 on all axes.
pub(super) fn cube(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let mesh = maker.solid(plugin, "cube", || {
        let mut mesh = Mesh { name: "cube".to_owned(), ..Mesh::default() };
        for face in FACES {
            let [normal, u, v] = face.map(|axis| Vec3::from(axis.map(f32::from)));
            let first = mesh.positions.len() as u32;
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                mesh.positions.push(normal + u * (2.0 * s - 1.0) + v * (2.0 * t - 1.0));
                mesh.normals.push(normal);
                mesh.uvs.push(Vec2::new(s, 1.0 - t));
            }
            let faces_out = u.cross(v).dot(normal) > 0.0;
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                let [b, c] = if faces_out { [b, c] } else { [c, b] };
                mesh.triangles.push([first + a, first + b, first + c]);
            }
        }
        mesh
    })?;
    maker.placed(plugin, vec![mesh], &DMat4::IDENTITY)
}

/// Of radius 1 around the origin; it faces +z. u is the radius, v the angle.
pub(super) fn disk(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let mesh = maker.solid(plugin, "disk", || {
        let mut mesh = Mesh { name: "disk".to_owned(), ..Mesh::default() };
        grid::add(&mut mesh, AROUND, 1, true, &|u, v| {
            let (sin, cos) = sin_cos_f64(TAU * u);
            (DVec3::new((1.0 - v) * cos, (1.0 - v) * sin, 0.0), DVec3::Z)
        });
        mesh.uvs.iter_mut().for_each(|uv| *uv = Vec2::new(1.0 - uv.y, 1.0 - uv.x));
        mesh
    })?;
    maker.placed(plugin, vec![mesh], &DMat4::IDENTITY)
}

/// From one point to another, without ends; it faces outwards.
pub(super) fn cylinder(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let (from, to) = (plugin.vector("p0")?.unwrap_or_default(), plugin.vector("p1")?.unwrap_or(DVec3::Z));
    let radius = plugin.number_or("radius", 1.0)?;
    let mesh = maker.solid(plugin, "cylinder", || {
        let mut mesh = Mesh { name: "cylinder".to_owned(), ..Mesh::default() };
        grid::add(&mut mesh, AROUND, 1, true, &|u, v| {
            let (sin, cos) = sin_cos_f64(TAU * u);
            (DVec3::new(cos, sin, v), DVec3::new(cos, sin, 0.0))
        });
        upwards(mesh)
    })?;
    let along = to - from;
    let axis = along.try_normalize().unwrap_or(DVec3::Z);
    let (side, across) = if axis == DVec3::Z { (DVec3::X, DVec3::Y) } else { axis.any_orthonormal_pair() };
    let column = |v: DVec3| v.extend(0.0);
    let first =
        DMat4::from_cols(column(side * radius), column(across * radius), column(along), from.extend(1.0));
    maker.placed(plugin, vec![mesh], &first)
}
