//! `ShapingAPI`: lights that emit less in some directions.

use super::inputs::number;
use crate::stage::Stage;
use crate::stage::context::Context;
use bilux_import::FormatError;
use bilux_math::DVec3;
use bilux_math::transcendental::{acos_f64, atan2_f64, powf_f64, sin_cos_f64};
use bilux_scene::{Goniometer, IntensityDistribution};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Rows of the intensities that a light gets, and samples of the soft edge of its cone.
const ROWS: usize = 360;
const EDGE: usize = 32;
/// Half planes about the axis, where they differ.
const COLUMNS: usize = 72;
/// The width of the edge of a hard cone, in degrees.
const HARD: f64 = 1e-3;

/// Shaping of a light.
pub(super) struct Shaping {
    /// The angles from the axis, in radians, at which the cone begins to fade and ends.
    cone: Option<[f64; 2]>,
    /// An exponent of the cosine.
    focus: f64,
    profile: Option<Profile>,
}

/// A measured lamp.
struct Profile {
    distribution: Arc<IntensityDistribution>,
    scale: f64,
    factor: f64,
}

impl Shaping {
    /// Shaping of a light; `None` if nothing shapes it.
    pub(super) fn read(
        stage: &Stage,
        prim: u32,
        context: &mut Context,
    ) -> Result<Option<Shaping>, FormatError> {
        let angle = number(stage, prim, "shaping:cone:angle", 180.0, context)?.clamp(0.0, 180.0);
        let softness = number(stage, prim, "shaping:cone:softness", 0.0, context)?.clamp(0.0, 1.0);
        let focus = number(stage, prim, "shaping:focus", 0.0, context)?.clamp(0.0, 1e4);
        let cone = (angle < 180.0).then(|| [angle * (1.0 - softness), angle].map(f64::to_radians));
        let profile = profile(stage, prim, context)?;
        let tint = stage.value(prim, "inputs:shaping:focusTint", &mut context.reading.budget)?;
        if focus > 0.0 && tint.and_then(|tint| tint.tuple::<3>()).is_some_and(|tint| tint != [0.0; 3]) {
            context.sink.diagnostics.not_shown("tints of focused lights", || stage.at(prim));
        }
        let shapes = cone.is_some() || focus > 0.0 || profile.is_some();
        Ok(shapes.then_some(Shaping { cone, focus, profile }))
    }

    /// True if it is a cone and nothing else.
    pub(super) fn is_cone(&self) -> bool {
        self.focus == 0.0 && self.profile.is_none()
    }

    /// The factor on the light that leaves in a direction in the space of the light, whose axis is -z. [OpenUSD, UsdLux]
    fn factor(&self, d: DVec3) -> f64 {
        let from_axis = acos_f64((-d.z).clamp(-1.0, 1.0));
        let mut factor = powf_f64(d.z.abs().max(f64::MIN_POSITIVE), self.focus);
        if let Some([start, end]) = self.cone {
            let part = if end > start { ((from_axis - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
            factor *= if from_axis > end { 0.0 } else { 1.0 - part * part * (3.0 - 2.0 * part) };
        }
        if let Some(Profile { distribution, scale, factor: by }) = &self.profile {
            let polar = match *scale {
                s if s > 0.0 => from_axis / s,
                s if s < 0.0 => (from_axis - PI) / -s + PI,
                _ => from_axis,
            };
            factor *= by * distribution.at(polar.to_degrees(), atan2_f64(d.y, d.x).to_degrees());
        }
        factor
    }

    /// The intensities of a light without extent that emits what this one does, given the projected area of its surface by direction,
    /// and their largest, which is 1 there. Azimuths run from +x to +y.
    pub(super) fn intensities(
        &self,
        name: &str,
        area: impl Fn(DVec3) -> f64,
    ) -> Option<(IntensityDistribution, f64)> {
        let mut polar: Vec<f64> = (0..=ROWS).map(|row| row as f64 * 180.0 / ROWS as f64).collect();
        if let Some([start, end]) = self.cone.map(|cone| cone.map(f64::to_degrees)) {
            polar.extend((0..=EDGE).map(|i| start + (end - start) * i as f64 / EDGE as f64));
            polar.push(end + HARD);
        }
        polar.retain(|angle| *angle <= 180.0);
        polar.sort_by(f64::total_cmp);
        polar.dedup_by(|a, b| *a - *b < 1e-6);
        let azimuths: Vec<f64> = (0..=COLUMNS).map(|i| i as f64 * 360.0 / COLUMNS as f64).collect();
        let intensity = |azimuth: f64, polar: f64| {
            let ((s, c), (sin, cos)) = (sin_cos_f64(azimuth / 360.0 * TAU), sin_cos_f64(polar.to_radians()));
            let d = DVec3::new(sin * c, sin * s, -cos);
            // Just beyond the edge of a cone, whatever rounding says.
            let is_out = self.cone.is_some_and(|[_, end]| polar > end.to_degrees() + 0.5 * HARD);
            if is_out { 0.0 } else { self.factor(d) * area(d).max(0.0) }
        };
        let all: Vec<f64> = azimuths
            .iter()
            .flat_map(|a| polar.iter().map(|p| intensity(*a, *p)).collect::<Vec<_>>())
            .collect();
        let peak = all.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        let relative = all.iter().map(|x| if peak > 0.0 { (x / peak).clamp(0.0, 1.0) as f32 } else { 0.0 });
        let relative = relative.collect();
        let made = IntensityDistribution::new(name, Goniometer::C, azimuths, polar, relative).ok()?;
        (made.lumens() > 0.0).then_some((made, peak))
    }
}

/// The profile that a light names.
fn profile(stage: &Stage, prim: u32, context: &mut Context) -> Result<Option<Profile>, FormatError> {
    let budget = &mut context.reading.budget;
    let found = match stage.found(prim, "inputs:shaping:ies:file", budget)? {
        Some(found) => Some(found),
        None => stage.found(prim, "shaping:ies:file", budget)?,
    };
    let file = found.as_ref().and_then(|found| Some((found.layer, found.value.text()?.clone())));
    let Some((layer, file)) = file.filter(|(_, file)| !file.is_empty()) else { return Ok(None) };
    let (folder, at) = (stage.layers[layer as usize].folder.clone(), stage.at(prim));
    let distribution = match context.reading.distribution(folder.as_deref(), &file, &at) {
        Ok(distribution) => distribution,
        Err(error @ FormatError::TooLarge { .. }) => return Err(error),
        Err(error) => {
            context.sink.diagnostics.note(&error.without_place(), || at);
            return Ok(None);
        }
    };
    let scale = number(stage, prim, "shaping:ies:angleScale", 0.0, context)?;
    let is_normalized = number(stage, prim, "shaping:ies:normalize", 0.0, context)? != 0.0;
    let factor = if is_normalized { 1.0 / distribution.lumens().max(f64::MIN_POSITIVE) } else { 1.0 };
    Ok(Some(Profile { distribution, scale, factor }))
}
