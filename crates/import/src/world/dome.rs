//! Lights all around, for writers of formats that have nothing but one colour or a map.

use crate::FormatError;
use crate::output::values::{colour, number, texture};
use crate::output::writing::Writing;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Rgb, Vec3};
use bilux_pictures::{Picture, write_bytes};
use bilux_scene::lights::{BuiltLight, build};
use bilux_scene::{SceneBuilder, Spec};
use std::f64::consts::{PI, TAU};

/// Rows of a map of a sky that is a formula.
const ROWS: usize = 256;

/// The light of an environment.
pub enum Dome {
    Even(Rgb),
    /// A map of radiances by longitude and latitude, whose middle is so many degrees to the right of -z.
    Map {
        file: String,
        degrees: f32,
    },
}

impl Dome {
    /// The light of a spec of the kind `environment`, whose map is an EXR beside the scene; `None`, with a warning, for one
    /// that lights nothing.
    pub fn of(
        spec: &Spec,
        scene: &SceneBuilder,
        format: &str,
        writing: &mut Writing,
    ) -> Result<Option<Dome>, FormatError> {
        let BuiltLight::Light(built) = build(spec, &scene.textures)? else { return Ok(None) };
        if built.is_backdrop() {
            writing.warn(format!("{format} files cannot store backdrops, which light nothing: left out"));
            return Ok(None);
        }
        let map = texture(spec, "radiance").and_then(|i| scene.textures.get(i));
        let is_given = |key: &str| colour(spec, key).is_some_and(|colour| colour.r >= 0.0);
        let (width, height, degrees, texels): (_, _, _, Vec<Rgb>) = match map {
            Some(map) => {
                let scale = colour(spec, "scale").unwrap_or(Rgb::WHITE);
                let texels = map.texels().map(|texel| texel * scale).collect();
                (map.width(), map.height(), number(spec, "rotation").unwrap_or(0.0), texels)
            }
            None if ["zenith", "horizon", "ground"].iter().any(|key| is_given(key)) => {
                let texels = longitudes(ROWS).map(|towards| built.le(towards)).collect();
                (2 * ROWS, ROWS, 0.0, texels)
            }
            None => return Ok(Some(Dome::Even(built.le(Vec3::Y)))),
        };
        let picture = Picture::from_rgb(width, height, texels)?;
        let bytes = write_bytes("exr", &picture, &bilux_pictures::WriteOptions::default())?;
        Ok(Some(Dome::Map { file: writing.add_numbered("sky", 1, "exr", bytes), degrees }))
    }
}

/// The directions of the texels of a map of longitude and latitude with so many rows, whose middle is towards -z.
pub fn longitudes(rows: usize) -> impl Iterator<Item = Vec3> {
    (0..2 * rows * rows).map(move |i| {
        let (column, row) = (i % (2 * rows), i / (2 * rows));
        let (r, y) = sin_cos_f64(PI * (row as f64 + 0.5) / rows as f64);
        let (sin, cos) = sin_cos_f64(TAU * ((column as f64 + 0.5) / (2 * rows) as f64 - 0.5));
        Vec3::new((r * sin) as f32, y as f32, (-r * cos) as f32)
    })
}
