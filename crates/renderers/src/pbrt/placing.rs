//! Places shapes in the scene.

use super::document::{Alpha, ObjectInstance, Piece, ShapeGeometry};
use super::light_maker::AreaEmission;
use super::motion::motion_within;
use super::shapes::{ShapeCache, unit_sphere};
use super::state::Matrices;
use super::surfaces::{Glow, Surfaces};
use bilux_import::FormatError;
use bilux_import::appearance::emissive::{fronted, uniform_scale};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::{Mesh, Object, Spec};
use std::collections::HashMap;
use std::sync::Arc;

/// Places shapes one by one.
pub(super) struct Placer<'d, 'o, 'r> {
    pub(super) surfaces: Surfaces<'d, 'o, 'r>,
    pub(super) shapes: ShapeCache,
    /// The times of the two matrices, in seconds.
    times: [f64; 2],
    /// Emissive meshes by address: the original, and the same with corners that agree with its normals.
    fronted: HashMap<*const Mesh, [Arc<Mesh>; 2]>,
    /// The objects of the scene.
    pub(super) objects: Vec<Object>,
    /// Lights of the scene, first those that are no shapes.
    pub(super) lights: Vec<Spec>,
}

impl<'d, 'o, 'r> Placer<'d, 'o, 'r> {
    pub(super) fn new(
        surfaces: Surfaces<'d, 'o, 'r>,
        shapes: ShapeCache,
        times: [f64; 2],
        lights: Vec<Spec>,
    ) -> Placer<'d, 'o, 'r> {
        Placer { surfaces, shapes, times, fronted: HashMap::new(), objects: Vec::new(), lights }
    }

    /// Adds a shape, or that of an object at an instance.
    pub(super) fn place(&mut self, piece: &Piece, used: Option<&ObjectInstance>) -> Result<(), FormatError> {
        let (at, name) = match used {
            Some(used) => (&used.at, used.object.as_str()),
            None => (&piece.at, ""),
        };
        let glow = self.surfaces.area_emission_of(piece, used)?;
        if self.place_sphere_light(piece, glow.as_ref(), &piece.matrices)? {
            return Ok(());
        }
        let (mesh, matrices) = match &piece.form {
            ShapeGeometry::Mesh(mesh) => (mesh.clone(), piece.matrices),
            ShapeGeometry::Sphere { radius, reversed } => {
                let grown = DMat4::from_scale(DVec3::splat(f64::from(*radius)));
                (unit_sphere(*reversed, &mut self.shapes), piece.matrices.map(|m| m * grown))
            }
        };
        let is_light = glow.is_some();
        let glow = glow.map(|glow| Glow {
            radiance: glow.radiance_of(area(&mesh, &matrices[0]) / f64::from(piece.shapes)),
            both_sides: glow.both_sides,
        });
        let to_world = used.map_or(matrices[0], |used| used.matrices[0] * matrices[0]);
        let material = self.surfaces.modified_material(piece, glow, &to_world)?;
        let Some(material) = material else {
            return Ok(());
        };
        let loader = self.surfaces.maker.loader();
        let motion = motion_within(used, &matrices, self.times, at, &mut loader.diagnostics);
        let Some(motion) = motion else { return Ok(()) };
        let mesh = if is_light {
            let both = self.fronted.entry(Arc::as_ptr(&mesh));
            both.or_insert_with(|| [mesh.clone(), fronted(&mesh)])[1].clone()
        } else {
            mesh
        };
        let bytes = size_of::<[Object; 2]>() + name.len() + motion.heap_bytes();
        loader.reading.budget.take_bytes(bytes as u64, &at.file)?;
        self.objects.push(Object { motion, ..Object::new(name, mesh, material) });
        Ok(())
    }

    /// Adds a sphere that emits outwards and reflects nothing as a sphere light, which is round at any size.
    fn place_sphere_light(
        &mut self,
        piece: &Piece,
        glow: Option<&AreaEmission>,
        matrices: &Matrices,
    ) -> Result<bool, FormatError> {
        let (ShapeGeometry::Sphere { radius, reversed: false }, Some(glow)) = (&piece.form, glow) else {
            return Ok(false);
        };
        let Some(scale) = uniform_scale(&matrices[0]).filter(|_| matrices[0] == matrices[1]) else {
            return Ok(false);
        };
        let radius = f64::from(*radius) * scale;
        let area = 4.0 * std::f64::consts::PI * radius * radius;
        let TextureOrValue::Colour(radiance) = glow.radiance_of(area) else { return Ok(false) };
        if glow.both_sides || piece.attributes.alpha != Alpha::Whole || radiance.is_black() {
            return Ok(false);
        }
        let material = self.surfaces.base_material(piece)?;
        let is_black = material.is_some_and(|spec| {
            let reflectance = spec.parameters.find("reflectance").map(|(value, _)| value.clone());
            spec.kind == "diffuse" && reflectance == Some(Rgb::BLACK.into())
        });
        if !is_black || !(radius * radius).is_finite() || !((radius * radius) as f32).is_normal() {
            return Ok(false);
        }
        let position = matrices[0].w_axis.truncate().as_vec3();
        let spec = Spec::new("", "sphere").with("position", position).with("radius", radius as f32);
        let spec = spec.with("radiance", radiance.clamp(0.0, 1e12));
        self.lights.push(Spec { span: piece.at.clone(), ..spec });
        Ok(true)
    }
}

/// The area of a mesh in world space.
fn area(mesh: &Mesh, matrix: &DMat4) -> f64 {
    let corner = |i: u32| matrix.transform_point3(mesh.positions[i as usize].as_dvec3());
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(one).filter(|area| area.is_finite()).sum()
}
