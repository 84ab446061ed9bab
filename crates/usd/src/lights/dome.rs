//! `DomeLight`: the surroundings.

use super::Light;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_import::input::reading::Texels;
use bilux_math::transcendental::{acos_f64, atan2_f64, sin_cos_f64};
use bilux_math::{DVec3, Rgb};
use bilux_scene::{Spec, Texture, Value};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Rows of an environment map that has to be turned.
const MAX_ROWS: usize = 2048;

impl Light<'_> {
    pub(super) fn dome(&self, context: &mut Context) -> Result<(), FormatError> {
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
                    let format =
                        stage.text(self.prim, "inputs:texture:format", &mut context.reading.budget)?;
                    if let Some(format) =
                        format.filter(|format| !matches!(&**format, "automatic" | "latlong"))
                    {
                        let what = format!(
                            "maps of domes in the format {format} as such (they are taken as latlong)"
                        );
                        context.sink.diagnostics.not_shown(&what, || stage.at(self.prim));
                    }
                    let turned = self.turned(&texture, context)?;
                    context.sink.scene.textures.push(Arc::new(turned));
                    radiance = Value::Texture(context.sink.scene.textures.len() - 1);
                    scale = self.radiance;
                }
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => context.sink.diagnostics.note(&error.without_place(), || at),
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
        let stands = self.stands(context)?;
        let mut texels = Vec::with_capacity(width * height);
        for row in 0..height {
            let (r, y) = sin_cos_f64(PI * (row as f64 + 0.5) / height as f64);
            for column in 0..width {
                let (sin, cos) = sin_cos_f64(TAU * ((column as f64 + 0.5) / width as f64 - 0.5));
                let d = to_light.transform_vector3(DVec3::new(r * sin, y, -r * cos)).normalize_or(DVec3::Z);
                // With z upwards, the middle of the map is towards -y.
                let [u, v] = place(if stands { DVec3::new(d.x, d.z, -d.y) } else { d });
                texels.push(looked_up(picture, u * across as f64 - 0.5, v * rows as f64 - 0.5));
            }
        }
        Ok(Texture::new(&picture.name, width, height, texels, true))
    }

    /// True if the pole of the map is along z: that of a `DomeLight` is always along y.
    fn stands(&self, context: &mut Context) -> Result<bool, FormatError> {
        let stage = self.stage;
        if &*stage.prim(self.prim).type_name != "DomeLight_1" {
            return Ok(false);
        }
        let axis = stage.text(self.prim, "poleAxis", &mut context.reading.budget)?;
        Ok(match axis.as_deref() {
            Some("Y") => false,
            Some("Z") => true,
            _ => stage.is_z_up(),
        })
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
