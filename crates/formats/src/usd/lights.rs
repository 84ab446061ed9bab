//! Lights of `UsdLux`, whose units are those of radiance.

use super::context::Context;
use super::meshes::name_of;
use super::stage::Stage;
use crate::FormatError;
use crate::reading::Texels;
use bilux_math::transcendental::{acos_f64, atan2_f64, powf_f64, sin_cos_f64, sin_f64};
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::wavelength::black_body_of_peak_one;
use bilux_scene::{Mesh, Object, Spec, Texture, Value};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Vertices around a disc or a cylinder.
const AROUND: u32 = 64;
/// Rows of an environment map that has to be turned.
const MAX_ROWS: usize = 2048;

/// True for types of prims that are lights.
pub(super) fn is_light(kind: &str) -> bool {
    KINDS.contains(&kind) || matches!(kind, "PortalLight" | "GeometryLight")
}

const KINDS: [&str; 7] =
    ["DistantLight", "SphereLight", "RectLight", "DiskLight", "CylinderLight", "DomeLight", "DomeLight_1"];

/// A light that is being read.
struct Light<'a> {
    stage: &'a Stage,
    prim: u32,
    name: &'a str,
    world: &'a DMat4,
    /// Radiance before it is divided by an area.
    radiance: Rgb,
    is_normalized: bool,
}

/// Adds the light of a prim.
pub(super) fn add(stage: &Stage, prim: u32, world: &DMat4, context: &mut Context) -> Result<(), FormatError> {
    let kind = stage.prim(prim).type_name.clone();
    if !KINDS.contains(&&*kind) {
        context.sink.oddities.not_shown(&format!("lights of type {kind}"), || stage.at(prim));
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
    let cone = number(stage, prim, "shaping:cone:angle", 180.0, context)?;
    let is_point = number(stage, prim, "treatAsPoint", 0.0, context)? != 0.0;
    if cone < 90.0 && !(&*kind == "SphereLight" && is_point) {
        context.sink.oddities.not_shown("cones of lights (shaping)", || stage.at(prim));
    }
    let profile = stage.text(prim, "inputs:shaping:ies:file", &mut context.reading.budget)?;
    if profile.is_some_and(|file| !file.is_empty()) {
        context.sink.oddities.not_shown("IES profiles of lights", || stage.at(prim));
    }
    if !stage.targets(prim, "light:filters").is_empty() {
        context.sink.oddities.not_shown("filters of lights", || stage.at(prim));
    }
    let links = ["lightLink", "shadowLink"].map(|link| format!("collection:{link}:"));
    let is_listed =
        |link: &String| ["includes", "excludes"].map(|list| stage.targets(prim, &format!("{link}{list}")));
    if links.iter().flat_map(is_listed).any(|paths| !paths.is_empty()) {
        context.sink.oddities.not_shown("which objects a light is for (light linking)", || stage.at(prim));
    }
    if radiance.is_black() {
        return Ok(());
    }
    let light = Light { stage, prim, name: name_of(stage, prim), world, radiance, is_normalized };
    if world.determinant() == 0.0 || !world.is_finite() {
        context.sink.oddities.note("a light has a scale of zero: left out", || stage.at(prim));
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

/// A number of a light, by its name now or by that in older files.
fn number(
    stage: &Stage,
    prim: u32,
    name: &str,
    unstated: f64,
    context: &mut Context,
) -> Result<f64, FormatError> {
    let budget = &mut context.reading.budget;
    let found = match stage.number(prim, &format!("inputs:{name}"), budget)? {
        Some(found) => Some(found),
        None => stage.number(prim, name, budget)?,
    };
    Ok(found.unwrap_or(unstated))
}

fn colour(stage: &Stage, prim: u32, context: &mut Context) -> Result<Rgb, FormatError> {
    let budget = &mut context.reading.budget;
    let found = match stage.value(prim, "inputs:color", budget)? {
        Some(found) => Some(found),
        None => stage.value(prim, "color", budget)?,
    };
    let rgb = found.and_then(|value| value.tuple::<3>()).unwrap_or([1.0; 3]);
    Ok(Rgb::from_array(rgb.map(|c| if c.is_finite() { c.max(0.0) as f32 } else { 0.0 })))
}

impl Light<'_> {
    fn number(&self, name: &str, unstated: f64, context: &mut Context) -> Result<f64, FormatError> {
        Ok(number(self.stage, self.prim, name, unstated, context)?.max(0.0))
    }

    fn axis(&self, axis: DVec3) -> DVec3 {
        self.world.transform_vector3(axis)
    }

    fn divided(&self, area: f64) -> Rgb {
        if self.is_normalized && area > 0.0 { self.radiance * (1.0 / area) as f32 } else { self.radiance }
    }

    fn push(&self, spec: Spec, context: &mut Context) {
        context.sink.scene.lights.push(Spec { span: self.stage.at(self.prim), ..spec });
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
        let (u, v) = (self.axis(DVec3::X) * width, self.axis(DVec3::NEG_Y) * height);
        let area = u.cross(v).length();
        if area <= 0.0 {
            return Ok(());
        }
        self.note_texture(context)?;
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
            context.sink.oddities.not_shown("textures of rectangular lights", || self.stage.at(self.prim));
        }
        Ok(())
    }

    /// A disc that emits along -z.
    fn disk(&self, context: &mut Context) -> Result<(), FormatError> {
        let radius = self.number("radius", 0.5, context)?;
        let (u, v) = (self.axis(DVec3::X) * radius, self.axis(DVec3::NEG_Y) * radius);
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
        self.emitter(mesh, PI * u.cross(v).length(), context);
        Ok(())
    }

    /// A tube along x that emits outwards.
    fn cylinder(&self, context: &mut Context) -> Result<(), FormatError> {
        let radius = self.number("radius", 0.5, context)?;
        let half = 0.5 * self.number("length", 1.0, context)?;
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
        let around = self.axis(DVec3::Y).length() * radius * TAU;
        self.emitter(mesh, around * self.axis(DVec3::X).length() * 2.0 * half, context);
        Ok(())
    }

    /// A mesh in the world that emits from its front and reflects nothing.
    fn emitter(&self, mesh: Mesh, area: f64, context: &mut Context) {
        if area <= 0.0 {
            return;
        }
        let scene = &mut context.sink.scene;
        let black = Spec::new(self.name, "diffuse").with("reflectance", 0.0f32);
        let material = black.with("emission", self.divided(area)).with("emission_sides", "front");
        let material = scene.add_material(material);
        let mesh = Mesh { name: self.name.to_owned(), ..mesh };
        scene.objects.push(Object::new(self.name, Arc::new(mesh), material));
    }

    fn dome(&self, context: &mut Context) -> Result<(), FormatError> {
        let stage = self.stage;
        let budget = &mut context.reading.budget;
        let found = match stage.found(self.prim, "inputs:texture:file", budget)? {
            Some(found) => Some(found),
            None => stage.found(self.prim, "texture:file", budget)?,
        };
        let file = found.as_ref().and_then(|found| Some((found.layer, found.value.text()?.clone())));
        let mut radiance = Value::from(self.radiance);
        let mut scale = Rgb::WHITE;
        if let Some((layer, name)) = file.filter(|(_, name)| !name.is_empty()) {
            let folder = stage.layers[layer as usize].folder.clone();
            let at = stage.at(self.prim);
            match context.reading.texture(folder.as_deref(), &name, Texels::Colours, &at) {
                Ok(texture) => {
                    let turned = self.turned(&texture, context)?;
                    context.sink.scene.textures.push(Arc::new(turned));
                    radiance = Value::Texture(context.sink.scene.textures.len() - 1);
                    scale = self.radiance;
                }
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => context.sink.oddities.note(&error.without_place(), || at),
            }
        }
        let spec =
            Spec::new(self.name, "environment").with("radiance", radiance).with("scale", Value::from(scale));
        self.push(spec, context);
        Ok(())
    }

    /// The map as Bilux has it, with its middle towards -z: that of a dome is towards its +z.
    fn turned(&self, picture: &Texture, context: &mut Context) -> Result<Texture, FormatError> {
        if !picture.image.is_whole() {
            return Ok(picture.clone());
        }
        let (across, rows) = (picture.width(), picture.height());
        let height = rows.clamp(16, MAX_ROWS);
        let width = 2 * height;
        context.reading.budget.take_bytes((width * height * size_of::<Rgb>()) as u64, &picture.name)?;
        let to_light = self.world.inverse();
        let mut texels = Vec::with_capacity(width * height);
        for row in 0..height {
            let (r, y) = sin_cos_f64(PI * (row as f64 + 0.5) / height as f64);
            for column in 0..width {
                let (sin, cos) = sin_cos_f64(TAU * ((column as f64 + 0.5) / width as f64 - 0.5));
                let d = to_light.transform_vector3(DVec3::new(r * sin, y, -r * cos)).normalize_or(DVec3::Z);
                let [u, v] = place(d);
                texels.push(looked_up(picture, u * across as f64 - 0.5, v * rows as f64 - 0.5));
            }
        }
        Ok(Texture::new(&picture.name, width, height, texels, true))
    }
}

/// The place of a direction on a map of latitudes: the middle is +z, a quarter from the left +x, the upper edge +y. [OpenUSD]
fn place(d: DVec3) -> [f64; 2] {
    let u = (atan2_f64(d.z, d.x) + 0.5 * PI) / TAU;
    [u - u.floor(), acos_f64(d.y.clamp(-1.0, 1.0)) / PI]
}

fn looked_up(picture: &Texture, x: f64, y: f64) -> Rgb {
    let (width, height) = (picture.width() as i64, picture.height() as i64);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = ((x - x0) as f32, (y - y0) as f32);
    let texel = |dx: i64, dy: i64| {
        let (x, y) = ((x0 as i64 + dx).rem_euclid(width), (y0 as i64 + dy).clamp(0, height - 1));
        picture.texel(x as usize, y as usize)
    };
    texel(0, 0).lerp(texel(1, 0), fx).lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_map_is_towards_z_and_x_is_left_of_it() {
        assert_eq!(place(DVec3::Z), [0.5, 0.5]);
        assert_eq!(place(DVec3::X), [0.25, 0.5]);
        assert_eq!(place(DVec3::Y)[1], 0.0);
    }
}
