//! Finishes a scene after all files are read: resolves names and adds everything to the scene.

use super::lights::AreaEmission;
use super::reader::{Alpha, ObjectInstance, Pbrt, Piece, ShapeGeometry, SurfaceAttributes};
use super::state::Matrices;
use super::texture_or_value::TextureOrValue;
use super::unknown;
use crate::FormatError;
use crate::sharing::share_trees;
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::{DMat4, DVec3, Rgb, Transform, Vec3};
use bilux_scene::{MATERIALS, Mesh, Object, Span, Spec, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Results that pieces with the same attributes share.
#[derive(Default)]
pub(super) struct ResolvedAttributes {
    /// Keyed by the surface attributes, the bits of a radiance that depends on the shape, and those of its matrix if it is filled
    /// from a grid, which has a place of its own.
    materials: HashMap<(SurfaceAttributes, [u32; 3], [u64; 16]), Option<usize>>,
    glows: HashMap<usize, AreaEmission>,
    /// Emissive meshes by address: the original, and the same with corners that agree with its normals.
    fronted: HashMap<*const Mesh, [Arc<Mesh>; 2]>,
}

impl Pbrt<'_, '_> {
    pub(super) fn finish(&mut self) -> Result<(), FormatError> {
        self.settings()?;
        self.place_camera()?;
        self.place_lights()?;
        let mut resolved_attributes = ResolvedAttributes::default();
        for piece in std::mem::take(&mut self.pieces) {
            self.place(&piece, None, &mut resolved_attributes)?;
        }
        for used in std::mem::take(&mut self.uses) {
            let Some(pieces) = self.definitions.get(&used.object).cloned() else {
                let names = self.definitions.keys().map(String::as_str);
                return Err(unknown("object", &used.object, names, &used.at));
            };
            for piece in &*pieces {
                self.place(piece, Some(&used), &mut resolved_attributes)?;
            }
        }
        share_trees(&mut self.scene);
        self.set_shutter();
        if self.scene.objects.is_empty() && self.scene.lights.is_empty() && self.in_world {
            self.oddities.note("there is nothing to render in this file", Span::default);
        }
        Ok(())
    }

    fn place(
        &mut self,
        piece: &Piece,
        used: Option<&ObjectInstance>,
        resolved_attributes: &mut ResolvedAttributes,
    ) -> Result<(), FormatError> {
        let (at, name) = match used {
            Some(used) => (&used.at, used.object.as_str()),
            None => (&piece.at, ""),
        };
        let glow = self.area_emission_of(piece, used, resolved_attributes)?;
        if self.place_sphere_light(piece, glow.as_ref(), &piece.matrices)? {
            return Ok(());
        }
        let (mesh, matrices) = match &piece.form {
            ShapeGeometry::Mesh(mesh) => (mesh.clone(), piece.matrices),
            ShapeGeometry::Sphere { radius, reversed } => {
                let grown = DMat4::from_scale(DVec3::splat(f64::from(*radius)));
                (self.unit_sphere(*reversed), piece.matrices.map(|m| m * grown))
            }
        };
        let radiance =
            glow.as_ref().map(|glow| glow.radiance_of(area(&mesh, &matrices[0]) / f64::from(piece.shapes)));
        let to_world = used.map_or(matrices[0], |used| used.matrices[0] * matrices[0]);
        let glow_and_radiance = (glow.as_ref(), radiance);
        let material = self.modified_material(piece, glow_and_radiance, &to_world, resolved_attributes)?;
        let Some(material) = material else {
            return Ok(());
        };
        let Some(motion) = self.motion_within(used, &matrices, at) else { return Ok(()) };
        let mesh = if glow.is_some() {
            let both = resolved_attributes.fronted.entry(Arc::as_ptr(&mesh));
            both.or_insert_with(|| [mesh.clone(), fronted(&mesh)])[1].clone()
        } else {
            mesh
        };
        let bytes = size_of::<[Object; 2]>() + name.len() + motion.heap_bytes();
        self.reading.budget.take_bytes(bytes as u64, &at.file)?;
        self.scene.objects.push(Object { motion, ..Object::new(name, mesh, material) });
        Ok(())
    }

    /// The emission of a piece; pieces of object instances have none.
    fn area_emission_of(
        &mut self,
        piece: &Piece,
        used: Option<&ObjectInstance>,
        resolved_attributes: &mut ResolvedAttributes,
    ) -> Result<Option<AreaEmission>, FormatError> {
        let Some(index) = piece.attributes.area_light else { return Ok(None) };
        if used.is_some() {
            self.oddities.note("surfaces of object instances emit no light, as in pbrt", || piece.at.clone());
            return Ok(None);
        }
        if let Some(glow) = resolved_attributes.glows.get(&index) {
            return Ok(Some(glow.clone()));
        }
        let entity = self.area_lights[index].clone();
        let glow = self.glow(&entity)?;
        resolved_attributes.glows.insert(index, glow.clone());
        Ok(Some(glow))
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
        let material = self.base_material(piece)?;
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
        self.scene.lights.push(Spec { span: piece.at.clone(), ..spec });
        Ok(true)
    }

    /// The material without attributes, built once.
    fn base_material(&mut self, piece: &Piece) -> Result<Option<Spec>, FormatError> {
        if let Some(known) = self.made_materials.get(&piece.attributes.material) {
            return Ok(known.clone());
        }
        let made = self.material(&piece.attributes.material, &piece.at)?;
        self.made_materials.insert(piece.attributes.material.clone(), made.clone());
        Ok(made)
    }

    /// The index of a piece's material with all of its attributes; `None` for an interface that is invisible.
    fn modified_material(
        &mut self,
        piece: &Piece,
        (glow, radiance): (Option<&AreaEmission>, Option<TextureOrValue>),
        to_world: &DMat4,
        resolved_attributes: &mut ResolvedAttributes,
    ) -> Result<Option<usize>, FormatError> {
        let attributes = &piece.attributes;
        let bits = match &radiance {
            Some(TextureOrValue::Colour(colour)) => colour.to_array().map(f32::to_bits),
            Some(TextureOrValue::Picture(picture)) => picture.factor.to_array().map(f32::to_bits),
            None => [0; 3],
        };
        // In an object instance nothing emits, so its material differs.
        let medium = self.medium_of(&attributes.media[0], &piece.at)?;
        let varies = medium.density.is_some() || medium.emission_grid.is_some();
        let place = if varies { to_world.to_cols_array().map(f64::to_bits) } else { [0; 16] };
        let area_light = glow.and(attributes.area_light);
        let key = (SurfaceAttributes { area_light, ..attributes.clone() }, bits, place);
        if let Some(known) = resolved_attributes.materials.get(&key) {
            return Ok(*known);
        }
        let made = self.finished_material(piece, glow, radiance, to_world)?;
        let index = made.map(|spec| self.scene.add_material(spec));
        resolved_attributes.materials.insert(key, index);
        Ok(index)
    }

    fn finished_material(
        &mut self,
        piece: &Piece,
        glow: Option<&AreaEmission>,
        radiance: Option<TextureOrValue>,
        to_world: &DMat4,
    ) -> Result<Option<Spec>, FormatError> {
        let [inside, outside] = &piece.attributes.media;
        let medium = self.medium_of(inside, &piece.at)?;
        // Inside another shape that is filled with it, it counts there.
        self.medium_of(outside, &piece.at)?;
        let base = self.base_material(piece)?;
        if base.is_none() && radiance.is_some() {
            self.oddities.note("an interface material emits no light", || piece.at.clone());
        }
        let mut spec = match base {
            Some(spec) => spec,
            // Inside of a medium a boundary without one makes a hole.
            None if medium.is_clear() && outside.is_empty() => return Ok(None),
            None => Spec::new("interface", "interface"),
        };
        if !medium.is_clear() {
            self.fill(&mut spec, &medium, to_world, piece)?;
        }
        if let (Some(glow), Some(radiance)) = (glow, radiance)
            && spec.kind != "interface"
        {
            spec = self.glowing(spec, glow, radiance, piece);
        }
        self.with_opacity_mask(spec, piece)
    }

    /// Adds emission to a material.
    fn glowing(&mut self, spec: Spec, glow: &AreaEmission, radiance: TextureOrValue, piece: &Piece) -> Spec {
        let row = MATERIALS.iter().find(|row| row.entry.name == spec.kind);
        let can = row.is_some_and(|row| row.entry.parameters.iter().any(|p| p.name == "emission"));
        let mut spec = if can {
            spec
        } else {
            let what = format!("a {} that emits light reflects none", spec.kind);
            self.oddities.note(&what, || piece.at.clone());
            let dark = Spec::new(&spec.name, "diffuse").with("reflectance", 0.0f32);
            Spec { span: spec.span, ..dark }
        };
        match radiance {
            TextureOrValue::Colour(colour) => spec.parameters.set("emission", colour.clamp(0.0, 1e12)),
            TextureOrValue::Picture(picture) => {
                let scale = picture.factor;
                let plain = bilux_scene::Texture { factor: Rgb::WHITE, ..(*picture).clone() };
                let value = self.value(TextureOrValue::Picture(Arc::new(plain)));
                spec.parameters.set("emission", value);
                spec.parameters.set("emission_scale", scale.clamp(0.0, 1e12));
            }
        }
        let sides = if glow.both_sides { "both" } else { "front" };
        spec.parameters.set("emission_sides", sides);
        spec
    }

    /// Adds an opacity mask to a material if the shape has an alpha.
    fn with_opacity_mask(&mut self, mut spec: Spec, piece: &Piece) -> Result<Option<Spec>, FormatError> {
        let share = match &piece.attributes.alpha {
            Alpha::Whole => return Ok(Some(spec)),
            Alpha::Even(bits) => {
                let alpha = f32::from_bits(*bits).clamp(0.0, 1.0);
                if alpha == 0.0 && spec.parameters.find("emission").is_some() {
                    let what = "lights cannot be hidden: this one is visible";
                    self.oddities.note(what, || piece.at.clone());
                    return Ok(Some(spec));
                }
                if alpha == 0.0 {
                    return Ok(None);
                }
                Value::from(alpha)
            }
            Alpha::Texture(name, line, column) => {
                let at = Span { file: piece.at.file.clone(), line: *line, column: *column };
                let source = self.texture(name, super::texture_or_value::SpectrumType::Number, &at)?;
                self.number_value(source, [0.0, 1.0])
            }
        };
        spec.parameters.set("opacity", share);
        Ok(Some(spec))
    }

    /// The motion of a shape with these matrices, in an object instance if there is one.
    ///
    /// The shape's own matrices and those of the instance are each interpolated on their own, as in pbrt: a shape moves along
    /// an arc about the origin of an instance that turns.
    fn motion_within(&mut self, used: Option<&ObjectInstance>, own: &Matrices, at: &Span) -> Option<Motion> {
        let Some(used) = used else { return self.motion(own, at) };
        if own[0] == own[1] && used.matrices[0] == used.matrices[1] {
            let both = used.matrices[0] * own[0];
            return self.motion(&[both, both], at);
        }
        Some(self.motion(own, at)?.then(&self.motion(&used.matrices, at)?))
    }

    /// Converts two matrices to a motion; `None`, with a warning, for a degenerate matrix.
    fn motion(&mut self, matrices: &Matrices, at: &Span) -> Option<Motion> {
        let Some(start) = Transform::from_matrix(matrices[0]) else {
            self.oddities.note("objects with a scale of zero are not rendered", || at.clone());
            return None;
        };
        if matrices[0] == matrices[1] {
            return Some(Motion::still(start));
        }
        let key = |i: usize| {
            let (scale, rotation, translation) = matrices[i].to_scale_rotation_translation();
            let again = DMat4::from_scale_rotation_translation(scale, rotation, translation);
            let size = matrices[i].to_cols_array().iter().fold(0f64, |m, x| m.max(x.abs()));
            again.abs_diff_eq(matrices[i], 1e-4 * size).then(|| MotionKey {
                time_seconds: self.options.times[i] as f32,
                translation: translation.as_vec3(),
                rotation: rotation.as_quat(),
                scale: scale.as_vec3(),
            })
        };
        let motion = key(0).zip(key(1)).and_then(|(a, b)| Motion::from_keys(vec![a, b]));
        if motion.is_none() {
            let what = "a motion that is not made of translations, rotations and scales is not supported: the start \
                        is shown";
            self.oddities.note(what, || at.clone());
        }
        Some(motion.unwrap_or(Motion::still(start)))
    }

    /// Sets the shutter of the camera if anything moves.
    fn set_shutter(&mut self) {
        let moves = self.scene.objects.iter().any(|object| !object.motion.is_still())
            || self.scene.cameras.iter().any(|camera| !camera.keyframes.is_empty());
        if moves {
            let [open, close] = self.options.shutter;
            self.scene.settings.set("time", open);
            self.scene.settings.set("shutter", (close - open).max(0.0));
        }
    }
}

/// The scale of a matrix, if it is uniform.
fn uniform_scale(matrix: &DMat4) -> Option<f64> {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
    let scale = x.length();
    let off = [
        x.dot(y),
        y.dot(z),
        z.dot(x),
        x.length_squared() - y.length_squared(),
        x.length_squared() - z.length_squared(),
    ];
    (scale > 0.0 && off.iter().all(|o| o.abs() < 1e-5 * scale * scale)).then_some(scale)
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

/// A copy of a mesh whose triangles are counter-clockwise as seen from the side of their normals, from which it
/// emits.
fn fronted(mesh: &Arc<Mesh>) -> Arc<Mesh> {
    if mesh.normals.is_empty() {
        return mesh.clone();
    }
    let turned = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal: Vec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
        (b - a).cross(c - a).dot(normal) < 0.0
    };
    if !mesh.triangles.iter().any(turned) {
        return mesh.clone();
    }
    let mut front = (**mesh).clone();
    for t in &mut front.triangles {
        if turned(t) {
            t.swap(1, 2);
        }
    }
    Arc::new(front)
}
