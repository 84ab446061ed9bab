//! Places shapes in the scene, with the materials that their properties make.

use super::bsdfs::black;
use super::emitters::{Emission, emission};
use super::maker::{MAX_LIGHT, Maker};
use super::media::medium;
use super::plugin::Plugin;
use super::shapes::{FLAT, LOST_MOTION, Piece, ShapeCache, ShapeMaker, pieces};
use bilux_import::FormatError;
use bilux_import::appearance::emissive::{fronted, uniform_scale};
use bilux_import::appearance::filling::{Medium, fill};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::transcendental::{ln, powf};
use bilux_math::{DMat4, Rgb};
use bilux_scene::{Mesh, Object, Spec};
use std::collections::HashMap;
use std::f32::consts::LN_2;
use std::rc::Rc;
use std::sync::Arc;

/// Key of a material: the shape's material, emission and medium, the matrix of a shape that is filled from a grid, and the size of
/// one that has bumps.
type MaterialKey = ([Option<*const Plugin>; 3], [u64; 16], [u32; 2]);

/// Places shapes one by one.
pub(super) struct Placer<'p, 'o> {
    pub(super) maker: Maker<'p, 'o>,
    pub(super) shapes: ShapeCache,
    /// Materials without what shapes add, built once.
    base: HashMap<(*const Plugin, [u32; 2]), Option<Spec>>,
    emissions: HashMap<*const Plugin, Option<Emission>>,
    media: HashMap<*const Plugin, Medium>,
    /// The indices of materials.
    materials: HashMap<MaterialKey, Option<usize>>,
    /// Emissive meshes by address: the original, and the same with corners that agree with its normals.
    fronted: HashMap<*const Mesh, [Arc<Mesh>; 2]>,
    pub(super) objects: Vec<Object>,
    pub(super) lights: Vec<Spec>,
}

/// Properties of a shape besides its geometry.
struct Attributes {
    bsdf: Option<Rc<Plugin>>,
    emitter: Option<Rc<Plugin>>,
    interior: Option<Rc<Plugin>>,
    /// True if there is a medium around it.
    has_exterior: bool,
}

impl<'p, 'o> Placer<'p, 'o> {
    pub(super) fn new(maker: Maker<'p, 'o>) -> Placer<'p, 'o> {
        Placer {
            maker,
            shapes: ShapeCache::default(),
            base: HashMap::new(),
            emissions: HashMap::new(),
            media: HashMap::new(),
            materials: HashMap::new(),
            fronted: HashMap::new(),
            objects: Vec::new(),
            lights: Vec::new(),
        }
    }

    /// Adds a shape.
    pub(super) fn place(&mut self, plugin: &Rc<Plugin>) -> Result<(), FormatError> {
        let mut shape_maker = ShapeMaker { maker: &mut self.maker, cache: &mut self.shapes, pieces };
        for piece in pieces(&mut shape_maker, plugin)? {
            self.place_piece(&piece, plugin)?;
        }
        Ok(())
    }

    fn attributes(&self, plugin: &Plugin) -> Result<Attributes, FormatError> {
        let document = self.maker.document;
        let media = document.parts_of(plugin, "medium")?;
        let named = |name: &str| media.iter().find(|(known, _)| known == name).map(|(_, part)| part.clone());
        Ok(Attributes {
            bsdf: document.part_of(plugin, "bsdf")?,
            emitter: document.part_of(plugin, "emitter")?,
            interior: named("interior"),
            has_exterior: named("exterior").is_some(),
        })
    }

    fn place_piece(&mut self, piece: &Piece, shape: &Rc<Plugin>) -> Result<(), FormatError> {
        let mut attributes = self.attributes(&piece.plugin)?;
        let at = &piece.plugin.at;
        if !piece.instances.is_empty() && attributes.emitter.take().is_some() {
            self.maker.note("surfaces of instances emit no light, as in Mitsuba", at);
        }
        for part in ["subsurface", "sensor"] {
            if let Some(part) = self.maker.document.part_of(&piece.plugin, part)? {
                self.maker.not_shown(&part);
            }
        }
        let emission = self.emission_of(&attributes)?;
        self.maker.extent = [1.0; 2];
        if let Some(bsdf) = &attributes.bsdf
            && self.maker.document.within(bsdf, "bumpmap")?.is_some()
        {
            self.maker.extent = extent(&piece.mesh, &piece.to_world.start());
        }
        if self.place_sphere_light(piece, &attributes, emission.as_ref())? {
            return Ok(());
        }
        let (own, is_lost) = piece.to_world.motion();
        if is_lost {
            self.maker.note(LOST_MOTION, at);
        }
        let Some(own) = own else {
            self.maker.note(FLAT, at);
            return Ok(());
        };
        let motion = piece.instances.iter().fold(own, |motion, next| motion.then(next));
        let to_world = motion.at(0.0).matrix().as_dmat4();
        let Some(material) = self.material(&attributes, emission.as_ref(), &to_world, &piece.plugin)? else {
            return Ok(());
        };
        let mesh = match emission {
            Some(_) => {
                let both = self.fronted.entry(Arc::as_ptr(&piece.mesh));
                both.or_insert_with(|| [piece.mesh.clone(), fronted(&piece.mesh)])[1].clone()
            }
            None => piece.mesh.clone(),
        };
        let name = if shape.id.is_empty() { &piece.plugin.id } else { &shape.id };
        let bytes = size_of::<[Object; 2]>() + name.len() + motion.heap_bytes();
        self.maker.reading.budget.take_bytes(bytes as u64, &at.file)?;
        self.objects.push(Object { motion, ..Object::new(name, mesh, material) });
        Ok(())
    }

    /// Emission of a shape.
    fn emission_of(&mut self, attributes: &Attributes) -> Result<Option<Emission>, FormatError> {
        let Some(emitter) = &attributes.emitter else { return Ok(None) };
        if let Some(known) = self.emissions.get(&Rc::as_ptr(emitter)) {
            return Ok(known.clone());
        }
        let made = emission(&mut self.maker, emitter)?;
        self.emissions.insert(Rc::as_ptr(emitter), made.clone());
        Ok(made)
    }

    /// Adds a sphere that emits light and reflects none as a sphere light, which is round at any size.
    fn place_sphere_light(
        &mut self,
        piece: &Piece,
        attributes: &Attributes,
        emission: Option<&Emission>,
    ) -> Result<bool, FormatError> {
        let Some(Emission(TextureOrValue::Colour(radiance))) = emission else { return Ok(false) };
        let matrix = piece.to_world.start();
        let is_still = piece.to_world.0.len() == 1 && piece.instances.is_empty();
        let is_plain = attributes.interior.is_none() && !attributes.has_exterior && !radiance.is_black();
        let Some(radius) = uniform_scale(&matrix).filter(|_| piece.is_sphere && is_still && is_plain) else {
            return Ok(false);
        };
        let base = self.base_material(attributes.bsdf.as_ref(), true)?;
        let is_black = base.is_some_and(|spec| {
            let reflectance = spec.parameters.find("reflectance").map(|(value, _)| value.clone());
            spec.kind == "diffuse" && reflectance == Some(Rgb::BLACK.into())
        });
        if !is_black || !((radius * radius) as f32).is_normal() {
            return Ok(false);
        }
        let spec = Spec::new(&piece.plugin.id, "sphere")
            .with("position", matrix.w_axis.truncate().as_vec3())
            .with("radius", radius as f32)
            .with("radiance", radiance.clamp(0.0, MAX_LIGHT));
        self.lights.push(Spec { span: piece.plugin.at.clone(), ..spec });
        Ok(true)
    }

    /// The material without what a shape adds, built once; shapes without one are grey, or black if they emit.
    fn base_material(&mut self, bsdf: Option<&Rc<Plugin>>, emits: bool) -> Result<Option<Spec>, FormatError> {
        let Some(bsdf) = bsdf else {
            let grey = Spec::new("default", "diffuse").with("reflectance", 0.5f32);
            return Ok(Some(if emits { black() } else { grey }));
        };
        let key = (Rc::as_ptr(bsdf), self.maker.extent.map(f32::to_bits));
        if let Some(known) = self.base.get(&key) {
            return Ok(known.clone());
        }
        let made = self.maker.material(bsdf)?;
        self.base.insert(key, made.clone());
        Ok(made)
    }

    /// The index of a shape's material with all that it adds; `None` if it is invisible.
    fn material(
        &mut self,
        attributes: &Attributes,
        emission: Option<&Emission>,
        to_world: &DMat4,
        plugin: &Plugin,
    ) -> Result<Option<usize>, FormatError> {
        let medium = match &attributes.interior {
            Some(interior) => self.medium_of(interior)?,
            None => Medium::default(),
        };
        let place =
            if medium.density.is_some() { to_world.to_cols_array().map(f64::to_bits) } else { [0; 16] };
        let emitter = attributes.emitter.as_ref().filter(|_| emission.is_some());
        let parts = [attributes.bsdf.as_ref(), emitter, attributes.interior.as_ref()];
        // Outside a medium a boundary without one is nothing; inside it makes a hole.
        let key = (parts.map(|part| part.map(Rc::as_ptr)), place, self.maker.extent.map(f32::to_bits));
        if let Some(known) = self.materials.get(&key) {
            return Ok(*known);
        }
        let base = self.base_material(attributes.bsdf.as_ref(), emission.is_some())?;
        let mut spec = match base {
            Some(spec) => spec,
            None if medium.is_clear() && !attributes.has_exterior && emission.is_none() => return Ok(None),
            None if emission.is_some() => black(),
            None => Spec::new("interface", "interface"),
        };
        if !medium.is_clear() && spec.kind == "dielectric" && spec.parameters.find("thin").is_some() {
            self.maker.note("thin walls around a medium reflect nothing here", &plugin.at);
            spec = Spec { span: spec.span, ..Spec::new(&spec.name, "interface") };
        }
        if !medium.is_clear() {
            let (reading, diagnostics) = (&mut *self.maker.reading, &mut self.maker.diagnostics);
            fill(&mut spec, &medium, to_world, &plugin.at, (reading, diagnostics))?;
        }
        if let Some(emission) = emission {
            spec = emission.on(spec, &mut self.maker, plugin);
        }
        self.maker.materials.push(spec);
        let index = self.maker.materials.len() - 1;
        self.materials.insert(key, Some(index));
        Ok(Some(index))
    }

    fn medium_of(&mut self, plugin: &Rc<Plugin>) -> Result<Medium, FormatError> {
        if let Some(known) = self.media.get(&Rc::as_ptr(plugin)) {
            return Ok(known.clone());
        }
        let made = medium(&mut self.maker, plugin)?;
        self.media.insert(Rc::as_ptr(plugin), made.clone());
        Ok(made)
    }
}

/// Length of one unit of each texture coordinate on a mesh in place, in the mean of some of its triangles; rounded, so that shapes
/// of about the same size share a material.
fn extent(mesh: &Mesh, to_world: &DMat4) -> [f32; 2] {
    const MOST: usize = 1000;
    let (mut sums, mut area) = ([0.0; 2], 0.0);
    for t in mesh.triangles.iter().step_by(mesh.triangles.len() / MOST + 1) {
        let corner = |i: usize| {
            let p = to_world.transform_point3(mesh.positions[t[i] as usize].as_dvec3());
            Some((p, mesh.uvs.get(t[i] as usize)?.as_dvec2()))
        };
        let Some([(a, ta), (b, tb), (c, tc)]) =
            corner(0).zip(corner(1)).zip(corner(2)).map(|((a, b), c)| [a, b, c])
        else {
            return [1.0; 2];
        };
        let (p, q, s, t) = (b - a, c - a, tb - ta, tc - ta);
        let (weight, turn) = (p.cross(q).length(), s.perp_dot(t));
        if turn.abs() < 1e-12 || !weight.is_finite() {
            continue;
        }
        // The derivatives of the position.
        let both = [(p * t.y - q * s.y) / turn, (q * s.x - p * t.x) / turn];
        (0..2).for_each(|i| sums[i] += both[i].length() * weight);
        area += weight;
    }
    sums.map(|sum: f64| {
        let mean = (sum / area) as f32;
        if mean.is_normal() { powf(2.0, (ln(mean) * 4.0 / LN_2).round() / 4.0) } else { 1.0 }
    })
}
