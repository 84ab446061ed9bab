//! Lights of `UsdLux`, whose units are those of radiance.

mod dome;
mod inputs;
mod shaping;

use crate::geometry::meshes::name_of;
use crate::stage::Stage;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_math::transcendental::{powf_f64, sin_cos_f64, sin_f64};
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::wavelength::black_body_of_peak_one;
use bilux_scene::{Mesh, Object, Spec};
use inputs::{colour, number};
use shaping::Shaping;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Vertices around a disc or a cylinder.
const AROUND: u32 = 64;

/// True for types of prims that are lights.
pub(crate) fn is_light(kind: &str) -> bool {
    KINDS.contains(&kind) || matches!(kind, "PortalLight" | "GeometryLight")
}

const KINDS: [&str; 7] =
    ["DistantLight", "SphereLight", "RectLight", "DiskLight", "CylinderLight", "DomeLight", "DomeLight_1"];

/// A light that is being read.
struct Light<'a> {
    stage: &'a Stage<'a>,
    prim: u32,
    name: &'a str,
    world: &'a DMat4,
    /// Radiance before it is divided by an area.
    radiance: Rgb,
    is_normalized: bool,
    /// Shaping, by which it emits less in some directions.
    shaping: Option<Shaping>,
}

/// Adds the light of a prim.
pub(crate) fn add(stage: &Stage, prim: u32, world: &DMat4, context: &mut Context) -> Result<(), FormatError> {
    let kind = stage.prim(prim).type_name.clone();
    if !KINDS.contains(&&*kind) {
        context.sink.diagnostics.not_shown(&format!("lights of type {kind}"), || stage.at(prim));
        return Ok(());
    }
    let unstated = if &*kind == "DistantLight" { 50_000.0 } else { 1.0 };
    let intensity = number(stage, prim, "intensity", unstated, context)?.max(0.0);
    let exposure = number(stage, prim, "exposure", 0.0, context)?.clamp(-100.0, 100.0);
    let mut radiance = colour(stage, prim, context)? * (intensity * powf_f64(2.0, exposure)) as f32;
    if number(stage, prim, "enableColorTemperature", 0.0, context)? != 0.0 {
        let kelvins = number(stage, prim, "colorTemperature", 6500.0, context)?.clamp(1000.0, 40_000.0);
        let body = black_body_of_peak_one(kelvins as f32);
        radiance = radiance * body * (1.0 / body.luminance().max(f32::MIN_POSITIVE));
    }
    let is_normalized = number(stage, prim, "normalize", 0.0, context)? != 0.0;
    if !stage.targets(prim, "light:filters").is_empty() {
        context.sink.diagnostics.not_shown("filters of lights", || stage.at(prim));
    }
    let links = ["lightLink", "shadowLink"].map(|link| format!("collection:{link}:"));
    let is_listed =
        |link: &String| ["includes", "excludes"].map(|list| stage.targets(prim, &format!("{link}{list}")));
    if links.iter().flat_map(is_listed).any(|paths| !paths.is_empty()) {
        context.sink.diagnostics.not_shown("which objects a light is for (light linking)", || stage.at(prim));
    }
    for part in ["diffuse", "specular"] {
        if number(stage, prim, part, 1.0, context)? != 1.0 {
            let what =
                "how much of a light diffuse or specular surfaces get (inputs:diffuse, inputs:specular)";
            context.sink.diagnostics.not_shown(what, || stage.at(prim));
        }
    }
    if radiance.is_black() {
        return Ok(());
    }
    let shaping = match &*kind {
        "DistantLight" | "DomeLight" | "DomeLight_1" => None,
        _ => Shaping::read(stage, prim, context)?,
    };
    let light = Light { stage, prim, name: name_of(stage, prim), world, radiance, is_normalized, shaping };
    if world.determinant() == 0.0 || !world.is_finite() {
        context.sink.diagnostics.note("a light has a scale of zero: left out", || stage.at(prim));
        return Ok(());
    }
    match &*kind {
        "DistantLight" => light.distant(context),
        "SphereLight" => light.sphere(context),
        "RectLight" => light.rect(context),
        "DiskLight" => light.disk(context),
        "CylinderLight" => light.cylinder(context),
        _ => light.dome(context),
    }
}

impl Light<'_> {
    fn number(&self, name: &str, unstated: f64, context: &mut Context) -> Result<f64, FormatError> {
        Ok(number(self.stage, self.prim, name, unstated, context)?.max(0.0))
    }

    fn axis(&self, axis: DVec3) -> DVec3 {
        self.world.transform_vector3(axis)
    }

    /// Lengths along x and y whose cross product is along -z, where the light goes, also in a space that is mirrored.
    fn across(&self, width: f64, height: f64) -> [DVec3; 2] {
        let [u, v] = [self.axis(DVec3::X) * width, self.axis(DVec3::NEG_Y) * height];
        if self.world.determinant() < 0.0 { [v, u] } else { [u, v] }
    }

    fn divided(&self, area: f64) -> Rgb {
        if self.is_normalized && area > 0.0 { self.radiance * (1.0 / area) as f32 } else { self.radiance }
    }

    fn push(&self, spec: Spec, context: &mut Context) {
        context.sink.scene.lights.push(Spec { span: self.stage.at(self.prim), ..spec });
    }

    /// Adds it as a light without extent if something shapes it, given the projected area by direction; false if nothing does.
    fn shaped(&self, radiance: Rgb, area: impl Fn(DVec3) -> f64, context: &mut Context) -> bool {
        let Some(shaping) = &self.shaping else { return false };
        let what = "the extent of lights that are shaped (cones, focus, profiles): they are points";
        context.sink.diagnostics.not_shown(what, || self.stage.at(self.prim));
        let Some((distribution, peak)) = shaping.intensities(self.name, area) else { return true };
        let spec = Spec::new(self.name, "luminaire")
            .with("position", self.world.w_axis.truncate().as_vec3())
            .with("direction", self.axis(DVec3::NEG_Z).normalize().as_vec3())
            .with("c0", self.axis(DVec3::X).normalize().as_vec3())
            .with("flux", Rgb::grey(distribution.lumens() as f32))
            .with("scale", radiance * peak as f32)
            .with("distribution", Arc::new(distribution));
        self.push(spec, context);
        true
    }

    /// The radiance of a disc in the sky.
    fn distant(&self, context: &mut Context) -> Result<(), FormatError> {
        let angle = self.number("angle", 0.53, context)?.min(180.0);
        let sin = sin_f64(0.5 * angle.to_radians());
        // Without an extent, or normalized, it is the irradiance.
        let solid = if self.is_normalized || angle == 0.0 { 1.0 } else { PI * sin * sin };
        let spec = Spec::new(self.name, "directional")
            .with("direction", self.axis(DVec3::NEG_Z).normalize().as_vec3())
            .with("irradiance", self.radiance * solid as f32)
            .with("diameter", angle as f32);
        self.push(spec, context);
        Ok(())
    }

    fn sphere(&self, context: &mut Context) -> Result<(), FormatError> {
        let scale = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.axis(axis).length());
        let scale = powf_f64(scale[0] * scale[1] * scale[2], 1.0 / 3.0);
        let radius = self.number("radius", 0.5, context)? * scale;
        let is_point = self.number("treatAsPoint", 0.0, context)? != 0.0;
        let centre = self.world.w_axis.truncate().as_vec3();
        let radiance = self.divided(4.0 * PI * radius * radius);
        let is_spot = (radius <= 0.0 || is_point) && self.shaping.as_ref().is_none_or(Shaping::is_cone);
        if !is_spot
            && self.shaped(radiance, |_| if radius > 0.0 { PI * radius * radius } else { 1.0 }, context)
        {
            return Ok(());
        }
        if radius <= 0.0 || is_point {
            let area = if radius > 0.0 { PI * radius * radius } else { 1.0 };
            let intensity = radiance * area as f32;
            let cone = self.number("shaping:cone:angle", 180.0, context)?;
            let kind = if cone < 180.0 { "spot" } else { "point" };
            let mut spec = Spec::new(self.name, kind).with("position", centre).with("intensity", intensity);
            if cone < 180.0 {
                let softness = self.number("shaping:cone:softness", 0.0, context)?.min(1.0);
                let ahead = self.axis(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z).as_vec3();
                spec = spec.with("look_at", centre + ahead * (1.0 + 1e-4 * centre.abs().max_element()));
                spec = spec.with("angle", cone as f32).with("inner_angle", (cone * (1.0 - softness)) as f32);
            }
            self.push(spec, context);
            return Ok(());
        }
        let spec = Spec::new(self.name, "sphere")
            .with("position", centre)
            .with("radius", radius as f32)
            .with("radiance", radiance);
        self.push(spec, context);
        Ok(())
    }

    fn rect(&self, context: &mut Context) -> Result<(), FormatError> {
        let (width, height) = (self.number("width", 1.0, context)?, self.number("height", 1.0, context)?);
        let [u, v] = self.across(width, height);
        let area = u.cross(v).length();
        if area <= 0.0 {
            return Ok(());
        }
        self.note_texture(context)?;
        if self.shaped(self.divided(area), |d| area * -d.z, context) {
            return Ok(());
        }
        let spec = Spec::new(self.name, "rect")
            .with("position", self.world.w_axis.truncate().as_vec3())
            .with("edge_u", u.as_vec3())
            .with("edge_v", v.as_vec3())
            .with("radiance", self.divided(area))
            .with("sides", "front");
        self.push(spec, context);
        Ok(())
    }

    fn note_texture(&self, context: &mut Context) -> Result<(), FormatError> {
        let file = self.stage.text(self.prim, "inputs:texture:file", &mut context.reading.budget)?;
        if file.is_some_and(|file| !file.is_empty()) {
            context.sink.diagnostics.not_shown("textures of rectangular lights", || self.stage.at(self.prim));
        }
        Ok(())
    }

    /// A disc that emits along -z.
    fn disk(&self, context: &mut Context) -> Result<(), FormatError> {
        let radius = self.number("radius", 0.5, context)?;
        let [u, v] = self.across(radius, radius);
        let area = PI * u.cross(v).length();
        if area > 0.0 && self.shaped(self.divided(area), |d| area * -d.z, context) {
            return Ok(());
        }
        let middle = self.world.w_axis.truncate();
        let rim = |i: u32| {
            let (sin, cos) = sin_cos_f64(f64::from(i) / f64::from(AROUND) * TAU);
            (middle + u * cos + v * sin).as_vec3()
        };
        let mesh = Mesh {
            positions: std::iter::once(middle.as_vec3()).chain((0..AROUND).map(rim)).collect(),
            triangles: (0..AROUND).map(|i| [0, 1 + i, 1 + (i + 1) % AROUND]).collect(),
            ..Mesh::default()
        };
        self.emitter(mesh, area, context);
        Ok(())
    }

    /// A tube along x that emits outwards.
    fn cylinder(&self, context: &mut Context) -> Result<(), FormatError> {
        let radius = self.number("radius", 0.5, context)?;
        let half = 0.5 * self.number("length", 1.0, context)?;
        let (around, along) =
            (self.axis(DVec3::Y).length() * radius * TAU, self.axis(DVec3::X).length() * 2.0 * half);
        let area = around * along;
        // What is seen of it from the side is a rectangle.
        let seen = |d: DVec3| area / PI * (1.0 - d.x * d.x).max(0.0).sqrt();
        if area > 0.0 && self.shaped(self.divided(area), seen, context) {
            return Ok(());
        }
        let mut mesh = Mesh::default();
        for i in 0..AROUND {
            let (sin, cos) = sin_cos_f64(f64::from(i) / f64::from(AROUND) * TAU);
            for x in [-half, half] {
                let p = DVec3::new(x, radius * cos, radius * sin);
                mesh.positions.push(self.world.transform_point3(p).as_vec3());
            }
            let (a, b) = (2 * i, 2 * ((i + 1) % AROUND));
            let sides = [[a, a + 1, b + 1], [a, b + 1, b]];
            let is_mirrored = self.world.determinant() < 0.0;
            mesh.triangles.extend(sides.map(|[a, b, c]| if is_mirrored { [a, b, c] } else { [a, c, b] }));
        }
        self.emitter(mesh, area, context);
        Ok(())
    }

    /// A mesh in the world that emits from its front and reflects nothing.
    fn emitter(&self, mesh: Mesh, area: f64, context: &mut Context) {
        if area <= 0.0 {
            return;
        }
        context.has_lamps = true;
        let scene = &mut context.sink.scene;
        let black = Spec::new(self.name, "diffuse").with("reflectance", 0.0f32);
        let material = black.with("emission", self.divided(area)).with("emission_sides", "front");
        let material = scene.add_material(material);
        let mesh = Mesh { name: self.name.to_owned(), ..mesh };
        scene.objects.push(Object::new(self.name, Arc::new(mesh), material));
    }
}
