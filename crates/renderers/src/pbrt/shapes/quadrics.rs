//! `sphere`, `disk` and `cylinder`, around the z axis.

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeCache, ShapeMaker, reversed};
use bilux_import::FormatError;
use bilux_import::geometry::tessellation::grid;
use bilux_import::geometry::tessellation::sphere::{AROUND, part_of_sphere};
use bilux_math::glam::DVec3;
use bilux_math::transcendental::{acos_f64, sin_cos_f64};
use bilux_scene::Mesh;
use std::f64::consts::PI;
use std::sync::Arc;

/// The fraction of a whole turn that a shape covers, and its number of quads.
fn turn(list: &ParameterList) -> Result<(f64, u32), FormatError> {
    let turn = f64::from(list.finite("phimax", 360.0)?.clamp(0.0, 360.0)) / 360.0;
    Ok((turn, ((f64::from(AROUND) * turn).ceil() as u32).max(1)))
}

/// A radius above 0; `None`, with a warning, if it is zero.
fn radius(
    maker: &mut ShapeMaker,
    list: &ParameterList,
    name: &'static str,
) -> Result<Option<f32>, FormatError> {
    let radius = list.finite(name, 1.0)?;
    if radius.abs() > 0.0 {
        return Ok(Some(radius.abs()));
    }
    maker.loader.note("a shape of zero size is left out", || list.place(name));
    Ok(None)
}

fn key(maker: &ShapeMaker, shape: u32, numbers: &[f64]) -> Vec<u32> {
    let bits = numbers.iter().map(|n| (*n as f32).to_bits());
    [shape, u32::from(maker.reverses)].into_iter().chain(bits).collect()
}

pub(super) fn sphere(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let Some(radius) = radius(maker, list, "radius")? else { return Ok(None) };
    let (bottom, top) = (list.finite("zmin", -radius)?, list.finite("zmax", radius)?);
    let (bottom, top) = (bottom.min(top).max(-radius), bottom.max(top).min(radius));
    let (turn, around) = turn(list)?;
    if turn == 1.0 && bottom == -radius && top == radius {
        return Ok(Some(ShapeGeometry::Sphere { radius, reversed: maker.reverses }));
    }
    let radius = f64::from(radius);
    let angle = |z: f32| acos_f64((f64::from(z) / radius).clamp(-1.0, 1.0));
    let (from, to) = (angle(bottom), angle(top));
    maker.round(list, key(maker, 0, &[radius, from, to, turn]), || {
        part_of_sphere(radius, [from, to], turn, around)
    })
}

/// The sphere of radius 1.
pub(in super::super) fn unit_sphere(is_reversed: bool, cache: &mut ShapeCache) -> Arc<Mesh> {
    let slot = &mut cache.unit_spheres[usize::from(is_reversed)];
    let make = || {
        let mesh = part_of_sphere(1.0, [PI, 0.0], 1.0, AROUND);
        Arc::new(if is_reversed { reversed(mesh) } else { mesh })
    };
    slot.get_or_insert_with(make).clone()
}

pub(super) fn disk(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let Some(radius) = radius(maker, list, "radius")? else { return Ok(None) };
    let radius = f64::from(radius);
    let inner = f64::from(list.finite("innerradius", 0.0)?).clamp(0.0, radius);
    let height = f64::from(list.finite("height", 0.0)?);
    let (turn, around) = turn(list)?;
    maker.round(list, key(maker, 1, &[radius, inner, height, turn]), || {
        let mut mesh = Mesh { name: "disk".to_owned(), ..Mesh::default() };
        grid::add(&mut mesh, around, 1, turn == 1.0, &|u, v| {
            let (sin, cos) = sin_cos_f64(2.0 * PI * turn * u);
            let r = if v == 0.0 { radius } else { inner };
            (DVec3::new(r * cos, r * sin, height), DVec3::Z)
        });
        mesh
    })
}

pub(super) fn cylinder(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let Some(radius) = radius(maker, list, "radius")? else { return Ok(None) };
    let radius = f64::from(radius);
    let (a, b) = (list.finite("zmin", -1.0)?, list.finite("zmax", 1.0)?);
    let (bottom, top) = (f64::from(a.min(b)), f64::from(a.max(b)));
    let (turn, around) = turn(list)?;
    maker.round(list, key(maker, 2, &[radius, bottom, top, turn]), || {
        let mut mesh = Mesh { name: "cylinder".to_owned(), ..Mesh::default() };
        grid::add(&mut mesh, around, 1, turn == 1.0, &|u, v| {
            let (sin, cos) = sin_cos_f64(2.0 * PI * turn * u);
            (DVec3::new(radius * cos, radius * sin, bottom + (top - bottom) * v), DVec3::new(cos, sin, 0.0))
        });
        mesh
    })
}
