//! Contract of every light: it emits what direct sampling of it finds, with the densities that it states.

use crate::chi_square::uniforms;
use crate::tally::Tally;
use bilux_math::{Vec2, Vec3};
use bilux_scene::{EmissionSample, Light, Scene, Tracer};
use std::sync::Arc;

/// A light in a scene at a given time.
pub struct LightCase {
    /// Name of the case.
    pub name: String,
    /// The scene; if the light has a surface, that is one of the objects.
    pub scene: Scene,
    /// The light.
    pub light: Arc<dyn Light>,
    /// The time of evaluation, in seconds.
    pub time: f32,
    /// Luminance of its power at that time, in W, where [`Light::power`] is for another time.
    pub power: Option<f64>,
}

/// The checks, by name.
pub const CHECKS: [(&str, Check); 8] = [
    ("samples are sound", samples_are_sound),
    ("densities match the samples", densities_are_as_stated),
    ("emitted samples add up to the power", emitted_flux_is_the_power),
    ("aimed rays hit their target", aimed_rays_go_where_they_should),
    ("rays aimed everywhere add up to the power", flux_aimed_everywhere_is_the_power),
    ("direct sampling finds the emitted light", direct_light_finds_what_was_sent),
    ("sampled points are hit with the same density", sampled_points_are_hit),
    ("flux through a plane agrees in both directions", flux_agrees_in_both_directions),
];

/// One check; an error describes what is wrong.
pub type Check = fn(&LightCase) -> Result<(), String>;

/// Number of rays for each mean.
const SAMPLES: u64 = 40_000;
/// Probability of a false alarm of each check.
const SIGNIFICANCE: f64 = 1e-5;
/// Cells along each side of the plane.
const CELLS: usize = 4;
/// The index that stands for all cells.
const ALL: usize = CELLS * CELLS;

impl LightCase {
    fn samples(&self, stream: u64, count: u64) -> impl Iterator<Item = Option<EmissionSample>> {
        let bounds = self.scene.bounds();
        (0..count).map(move |i| {
            let (u_point, u_direction) = (uniforms(stream, i).1, uniforms(stream + 1, i).1);
            self.light.sample_le(&bounds, self.time, u_point, u_direction)
        })
    }
}

/// Luminance that a ray carries, over its density: its share of the power.
fn power_of(sample: &EmissionSample) -> f64 {
    f64::from(sample.le.luminance() * sample.cos()) / f64::from(sample.pdf_emission)
}

/// Directions are unit vectors away from the light, and densities are positive; rays of infinite lights start outside
/// the scene and aim at it.
pub fn samples_are_sound(case: &LightCase) -> Result<(), String> {
    let bounds = case.scene.bounds();
    for sample in case.samples(0, 2000).flatten() {
        let unit = |v: Vec3| (v.length() - 1.0).abs() < 1e-5;
        let normal = sample.n_light == Vec3::ZERO
            || (unit(sample.n_light) && sample.n_light.dot(sample.direction) > 0.0);
        let positive = |pdf: f32| pdf.is_finite() && pdf > 0.0;
        let is_left_out = sample.pdf_direct == 0.0 && !case.light.samples_all_light();
        let densities = positive(sample.pdf_emission) && (is_left_out || positive(sample.pdf_direct));
        let numbers = densities && sample.le.is_finite();
        let from_centre = sample.p - bounds.centre();
        let along = -from_centre.dot(sample.direction);
        let aside = (from_centre + sample.direction * along).length();
        let outside = along > bounds.radius() && aside < bounds.radius() * (1.0 + 1e-5);
        let started = !case.light.is_infinite() || outside;
        if !(unit(sample.direction) && normal && numbers && started && sample.p_error.min_element() >= 0.0) {
            return Err(format!("{sample:?}"));
        }
    }
    Ok(())
}

/// `emission_pdf` for a sample's own values is the density that the sample states.
pub fn densities_are_as_stated(case: &LightCase) -> Result<(), String> {
    let bounds = case.scene.bounds();
    for sample in case.samples(2, 2000).flatten() {
        let EmissionSample { pdf_emission, pdf_direct, direction, .. } = sample;
        let said = case.light.emission_pdf(&bounds, pdf_direct, direction, sample.cos());
        if said != pdf_emission {
            return Err(format!("emission_pdf {said} of {sample:?}"));
        }
    }
    Ok(())
}

/// All rays together carry the power.
pub fn emitted_flux_is_the_power(case: &LightCase) -> Result<(), String> {
    let mut sent = Tally::default();
    case.samples(4, SAMPLES).for_each(|sample| sent.add(sample.as_ref().map_or(0.0, power_of)));
    let power = case.power.unwrap_or_else(|| f64::from(case.light.power(&case.scene.bounds())));
    let p = sent.p_value_of(power);
    if p < SIGNIFICANCE {
        return Err(format!("sends {}, power {power}, p = {p:.2e}", sent.mean()));
    }
    Ok(())
}

impl LightCase {
    /// Aims, each with its ray.
    fn aimed(&self, stream: u64, count: u64) -> impl Iterator<Item = (Vec2, Option<EmissionSample>)> {
        let bounds = self.scene.bounds();
        (0..count).map(move |i| {
            let (aim, u) = (uniforms(stream, i).1, uniforms(stream + 1, i).1);
            (aim, self.light.sample_le_aimed(&bounds, self.time, u, aim))
        })
    }
}

/// A ray passes through the point that it is aimed at, and the rest of its density is what `unaimed_pdf` states.
pub fn aimed_rays_go_where_they_should(case: &LightCase) -> Result<(), String> {
    let bounds = case.scene.bounds();
    for (aim, sample) in case.aimed(16, 2000) {
        let Some(sample) = sample else { continue };
        let passed = case.light.aim(&bounds, sample.p + sample.direction, sample.direction);
        let said = case.light.unaimed_pdf(&bounds, sample.pdf_direct, sample.direction, sample.cos());
        if passed.distance(aim) > 1e-4 || !near(said, sample.pdf_emission, 1e-5) {
            return Err(format!("aimed at {aim}, passes {passed}; unaimed_pdf {said} of {sample:?}"));
        }
    }
    Ok(())
}

/// Uniformly aimed rays carry the power; for an infinite light, those that pass through the scene's sphere.
pub fn flux_aimed_everywhere_is_the_power(case: &LightCase) -> Result<(), String> {
    let bounds = case.scene.bounds();
    let aim_pdf = f64::from(case.light.aim_pdf(&bounds));
    let passes = |aim: Vec2| !case.light.is_infinite() || (aim * 2.0 - Vec2::ONE).length() < 1.0;
    let mut sent = Tally::default();
    for (aim, sample) in case.aimed(18, SAMPLES) {
        sent.add(sample.filter(|_| passes(aim)).map_or(0.0, |sample| power_of(&sample) / aim_pdf));
    }
    let power = case.power.unwrap_or_else(|| f64::from(case.light.power(&bounds)));
    let p = sent.p_value_of(power);
    if p < SIGNIFICANCE {
        return Err(format!("aims {}, power {power}, p = {p:.2e}", sent.mean()));
    }
    Ok(())
}

/// A receiver on the ray that looks back finds the light where the ray started, with the same density and strength.
pub fn direct_light_finds_what_was_sent(case: &LightCase) -> Result<(), String> {
    let mut tracer = Tracer::new(&case.scene, false);
    let (mut asked, mut missed) = (0, 0);
    let peak = case.samples(6, 2000).flatten().map(|s| s.le.luminance()).fold(0.0, f32::max);
    for sample in case.samples(6, 2000).flatten() {
        let found = if sample.pdf_direct == 1.0 && case.light.is_delta() {
            found_of_delta(case, &sample, peak)
        } else if case.light.is_infinite() {
            found_far(case, &sample)
        } else {
            match found_on_surface(case, &mut tracer, &sample) {
                Some(found) => found,
                // Another triangle may be hit where two touch, or the next wall may be too near for a receiver in
                // between.
                None => {
                    missed += 1;
                    Ok(())
                }
            }
        };
        asked += 1;
        found.map_err(|wrong| format!("{wrong}: {sample:?}"))?;
    }
    if missed * 50 > asked {
        Err(format!("{missed} of {asked} are not found where they start"))
    } else {
        Ok(())
    }
}

fn near(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

fn check(holds: bool, wrong: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(wrong()) }
}

fn found_of_delta(case: &LightCase, sample: &EmissionSample, peak: f32) -> Result<(), String> {
    let distance = 2.5;
    let receiver = sample.p + sample.direction * distance;
    let found = case.light.sample_li(receiver, case.time, Vec2::splat(0.5)).ok_or("dark")?;
    let spread = if case.light.is_infinite() { 1.0 } else { distance * distance };
    let (li, le) = (found.li.luminance() * spread, sample.le.luminance());
    // The soft edge of a cone is steep compared with the rounding of its cosine.
    check((li - le).abs() < 1e-3 * peak && found.wi.dot(-sample.direction) > 1.0 - 1e-5, || {
        format!("finds {found:?}")
    })
}

fn found_far(case: &LightCase, sample: &EmissionSample) -> Result<(), String> {
    let pdf = case.light.li_pdf_solid_angle(case.scene.bounds().centre(), -sample.direction, None);
    let le = case.light.le(-sample.direction);
    check(pdf == sample.pdf_direct && le == sample.le, || format!("density {pdf}, radiance {le:?}"))
}

fn found_on_surface(
    case: &LightCase,
    tracer: &mut Tracer,
    sample: &EmissionSample,
) -> Option<Result<(), String>> {
    let ray = sample.spawn(case.time);
    let distance = tracer.closest(&ray).map_or(1.0, |hit| 0.5 * hit.t.min(2.0));
    if distance < 5e-3 {
        return None;
    }
    let receiver = Vec3::from(ray.at(distance));
    let mut back = bilux_scene::Ray::new(receiver.to_array(), (-sample.direction).to_array());
    back.time = case.time;
    let hit = tracer.closest(&back).filter(|hit| hit.primitive == sample.primitive)?;
    let area = case.light.pdf_area(receiver, &hit);
    let wanted = case.light.direct_pdf(sample, receiver);
    let pdf = case.light.li_pdf_solid_angle(receiver, -sample.direction, Some(&hit));
    let converted = wanted * hit.p.distance_squared(receiver) / sample.cos();
    // Where the density depends on the cosine, it is as uncertain as the position of a grazing hit on something small.
    let rough = 1e-4 / (sample.cos() * sample.cos());
    let tolerance = if wanted == sample.pdf_direct { 1e-5 } else { rough };
    let exact = near(area, wanted, tolerance) && near(pdf, converted, tolerance.max(1e-3));
    let there = hit.p.distance(sample.p) < 1e-4 * (1.0 + sample.p.length()) / sample.cos();
    let start = case.light.pdf_start(area, &hit);
    let sent = case.light.emission_pdf(&case.scene.bounds(), start, sample.direction, sample.cos());
    let begins = near(sent, sample.pdf_emission, 1e-4);
    Some(check(exact && there && begins, || {
        format!("over area {area} for {wanted}, over solid angle {pdf} for {converted}; emission_pdf {sent}")
    }))
}

/// A ray in a sampled direction hits the light there, with the density with which it was sampled.
pub fn sampled_points_are_hit(case: &LightCase) -> Result<(), String> {
    if case.light.is_delta() {
        return Ok(());
    }
    let mut tracer = Tracer::new(&case.scene, false);
    let (mut asked, mut missed) = (0, 0);
    for i in 0..2000 {
        let ((up, place), u) = (uniforms(12, i), uniforms(13, i).1);
        let from = Vec3::new(4.0 * place.x - 2.0, 1.2 + 1.2 * up, 4.0 * place.y - 2.0);
        let Some(sample) = case.light.sample_li(from, case.time, u) else { continue };
        let mut ray = bilux_scene::Ray::new(from.to_array(), sample.wi.to_array());
        ray.time = case.time;
        let hit = tracer.closest(&ray).filter(|hit| case.scene.light_of(hit.object).is_some());
        // Not where the block is in the way, or the light itself.
        let distance = sample.point.map(|point| point.distance(from));
        let is_there = match (&hit, distance) {
            (Some(hit), Some(distance)) => {
                near(hit.t, distance, 1e-3) && hit.n_geom.dot(sample.n_light).abs() > 0.999
            }
            (hit, distance) => hit.is_none() && distance.is_none(),
        };
        asked += 1;
        if !is_there {
            missed += 1;
            continue;
        }
        let pdf = case.light.li_pdf_solid_angle(from, sample.wi, hit.as_ref());
        let tolerance = 2e-2 / sample.cos().max(1e-2);
        check(near(pdf, sample.pdf_solid_angle, tolerance), || format!("{pdf} for {sample:?}"))?;
        let Some(hit) = hit else { continue };
        // As a connection states it, and as a hit does.
        let area = case.light.pdf_area(from, &hit);
        let [connected, found] = [sample.pdf_start.unwrap_or(area), case.light.pdf_start(area, &hit)]
            .map(|start| case.light.emission_pdf(&case.scene.bounds(), start, -sample.wi, sample.cos()));
        check(near(connected, found, 1e-5), || {
            format!("emission_pdf {found} for {connected} of {sample:?}")
        })?;
    }
    check(missed * 4 <= 3 * asked, || format!("{missed} of {asked} are not hit"))
}

/// A square in the scene receives as much in each of its cells from rays that the light emits as from points that
/// sample the light. Occlusion is ignored, and so is light that this light leaves to other techniques.
pub fn flux_agrees_in_both_directions(case: &LightCase) -> Result<(), String> {
    let corner = Vec3::new(-0.8, 0.25, -1.0);
    let (side_u, side_v) = (Vec3::new(1.6, 0.3, 0.0), Vec3::new(0.0, 0.2, 2.0));
    let across = side_u.cross(side_v);
    let cell = |u: f32, v: f32| {
        let index = |x: f32| (x * CELLS as f32) as usize;
        ((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v)).then(|| index(u) * CELLS + index(v))
    };
    let mut sent = [Tally::default(); ALL + 1];
    for sample in case.samples(8, 2 * SAMPLES) {
        let crossing = sample.filter(|s| s.pdf_direct > 0.0).and_then(|s| {
            let t = (corner - s.p).dot(across) / s.direction.dot(across);
            let at = s.p + s.direction * t - corner;
            let u = at.cross(side_v).dot(across) / across.length_squared();
            let v = side_u.cross(at).dot(across) / across.length_squared();
            if t > 0.0 { Some((cell(u, v)?, power_of(&s))) } else { None }
        });
        for (i, tally) in sent.iter_mut().enumerate() {
            tally.add(crossing.filter(|(c, _)| *c == i || i == ALL).map_or(0.0, |(_, power)| power));
        }
    }
    let mut asked = sent.map(|_| Tally::default());
    for i in 0..SAMPLES {
        let (place, u) = (uniforms(10, i).1, uniforms(11, i).1);
        let from = corner + side_u * place.x + side_v * place.y;
        let crossing = case.light.sample_li(from, case.time, u).map(|s| {
            let flux = s.li.luminance() * s.wi.dot(across).abs() / s.pdf_solid_angle;
            (cell(place.x, place.y), f64::from(flux))
        });
        for (i, tally) in asked.iter_mut().enumerate() {
            tally.add(crossing.filter(|(c, _)| *c == Some(i) || i == ALL).map_or(0.0, |(_, flux)| flux));
        }
    }
    for (i, (sent, asked)) in sent.iter().zip(&asked).enumerate() {
        let p = sent.p_value(asked);
        let sparse = i != ALL && (sent.is_sparse() || asked.is_sparse());
        if !sparse && p < SIGNIFICANCE / (ALL + 1) as f64 {
            let (a, b) = (sent.mean(), asked.mean());
            return Err(format!("cell {i}: {a:.5} sent, {b:.5} asked for, p = {p:.2e}"));
        }
    }
    Ok(())
}
