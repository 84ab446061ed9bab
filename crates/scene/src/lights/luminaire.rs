//! `luminaire`: light from a point with a measured intensity distribution, as files of lamps give it.

use super::distribution_2d::Distribution2d;
use super::{
    Beam, BuiltLight, CLASSIC, ClassicLighting, EmissionSample, GROUP, Light, LightEntry, LightExtent,
    LightSample, LightTracing, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::parameters::intensity_distribution::{Band, Goniometer, IntensityDistribution};
use crate::surface::Surface;
use bilux_math::photometry::LUMENS_PER_WATT;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{Aabb, DVec3, Rgb, Vec2, Vec3, warp};
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "luminaire",
        summary: "lamp with a measured intensity distribution, from an IES or EULUMDAT file",
        source: "IES LM-63",
        parameters: &[
            vector("position", "position", "0 5 0"),
            vector(
                "direction",
                "direction of its axis, from which γ is measured: down for a lamp that hangs",
                "0 -1 0",
            ),
            vector("c0", "direction of the half plane C 0, which is made perpendicular to the axis", "1 0 0"),
            Parameter {
                name: "distribution",
                summary: "intensity over direction: a file (.ies, .ldt); none is the same in all directions, 1000 lm",
                unit: "",
                kind: ParameterKind::Distribution,
                default: "none",
            },
            Parameter {
                name: "flux",
                summary: "what it emits in all directions together; -1 takes the lumens of the file, 683 of which are 1 W",
                unit: "W",
                kind: ParameterKind::Colour { min: -1.0, max: 1e12 },
                default: "-1",
            },
            super::colour("scale", "factor on its light, such as its colour", "", "1"),
            CLASSIC,
            GROUP,
        ],
    },
    surrounds: false,
    flux_per_intensity: super::NO_INTENSITY,
    build,
};

fn build(reader: &Reader, _: &[Arc<crate::texture::Texture>]) -> Result<BuiltLight, SceneError> {
    let none = || Arc::new(IntensityDistribution::isotropic(1000.0 / (4.0 * std::f32::consts::PI)));
    let distribution = reader.distribution("distribution").unwrap_or_else(none);
    let lumens = distribution.lumens();
    if lumens <= 0.0 {
        let message = format!("the distribution '{}' emits nothing", distribution.name());
        return Err(SceneError::invalid(message, reader.span("distribution")));
    }
    let flux = reader.colour("flux");
    let flux = if flux.r < 0.0 { Rgb::grey((lumens / f64::from(LUMENS_PER_WATT)) as f32) } else { flux };
    let axes = axes(reader, distribution.goniometer())?;
    Ok(BuiltLight::Light(Arc::new(Luminaire {
        position: reader.vector("position"),
        axes,
        cells: cells(&distribution),
        per_candela: flux * reader.colour("scale") / lumens as f32,
        lumens,
        beam: beam(&distribution, axes),
        distribution,
        classic: given_classic(reader),
    })))
}

/// The pole, the direction of azimuth 0 and that of azimuth 90.
fn axes(reader: &Reader, goniometer: Goniometer) -> Result<[DVec3; 3], SceneError> {
    let wrong = |message: &str, key: &str| SceneError::invalid(message, reader.span(key));
    let axis = reader.vector("direction").as_dvec3().try_normalize();
    let axis = axis.ok_or_else(|| wrong("the axis of a luminaire must not be 0", "direction"))?;
    let given = reader.vector("c0").as_dvec3();
    let across =
        |c0: DVec3| (c0 - axis * c0.dot(axis)).try_normalize().filter(|v| v.dot(c0) > 1e-6 * c0.length());
    let other = if axis.x.abs() < 0.5 { DVec3::X } else { DVec3::Z };
    let c0 = match across(given) {
        Some(c0) => c0,
        None if !reader.is_given("c0") => across(other).unwrap_or(DVec3::Y),
        None => return Err(wrong("C 0 must not be along the axis of the luminaire", "c0")),
    };
    let c90 = c0.cross(axis);
    Ok(match goniometer {
        Goniometer::C => [axis, c0, c90],
        Goniometer::B => [c90, axis, c0],
        Goniometer::A => [-c0, axis, -c90],
    })
}

/// The cells between the measured angles, in proportion to their flux.
fn cells(distribution: &IntensityDistribution) -> Distribution2d {
    let columns = distribution.azimuths().len() - 1;
    let rows = distribution.polar_angles().len() - 1;
    let flux = |i: usize| distribution.flux_of_cell(i / columns, i % columns);
    Distribution2d::new(&(0..rows * columns).map(flux).collect::<Vec<_>>(), columns)
}

/// The fraction of the flux in a beam, and the widest one, in degrees: beyond it a cone says little.
const IN_BEAM: f64 = 0.9;
const WIDEST: f64 = 60.0;

/// The cone about the mean direction that most of the flux goes into.
fn beam(distribution: &IntensityDistribution, axes: [DVec3; 3]) -> Option<Beam> {
    let (azimuths, polar) = (distribution.azimuths(), distribution.polar_angles());
    let [pole, zero, quarter] = axes;
    let along = |polar: f64, azimuth: f64| {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) =
            (sin_cos_f64(polar.to_radians()), sin_cos_f64(azimuth.to_radians()));
        pole * cos_theta + (zero * cos_phi + quarter * sin_phi) * sin_theta
    };
    // In pieces of cells: lamps that are the same all around have a single cell from plane to plane.
    let mut pieces = Vec::new();
    for (row, column) in (0..polar.len() - 1).flat_map(|row| (0..azimuths.len() - 1).map(move |c| (row, c))) {
        let flux = distribution.flux_of_cell(row, column);
        let [from, to] = [azimuths[column], azimuths[column + 1]];
        let count = ((to - from) / WIDEST * 4.0).ceil().max(1.0) as usize;
        for i in 0..count {
            let azimuth = from + (to - from) * (i as f64 + 0.5) / count as f64;
            let corner = |end: usize| along(polar[row + end], azimuth);
            pieces.push((
                along(0.5 * (polar[row] + polar[row + 1]), azimuth),
                [corner(0), corner(1)],
                flux / count as f64,
            ));
        }
    }
    let all: f64 = pieces.iter().map(|(.., flux)| flux).sum();
    let axis = pieces.iter().map(|(middle, _, flux)| *middle * *flux).sum::<DVec3>().try_normalize()?;
    // Each piece is in the cone if all of it is.
    let cosine = |[a, b]: &[DVec3; 2]| a.dot(axis).min(b.dot(axis));
    let mut by_cosine: Vec<_> = pieces.iter().map(|(_, ends, flux)| (cosine(ends), *flux)).collect();
    by_cosine.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut sum = 0.0;
    let edge = by_cosine.into_iter().find(|(_, flux)| {
        sum += flux;
        sum >= IN_BEAM * all
    });
    let cos = edge?.0 as f32;
    let (_, widest) = sin_cos_f64(WIDEST.to_radians());
    (f64::from(cos) > widest && cos < 1.0).then_some(Beam {
        axis: axis.as_vec3(),
        cos,
        share: IN_BEAM as f32,
    })
}

struct Luminaire {
    position: Vec3,
    /// The pole, the direction of azimuth 0 and that of azimuth 90.
    axes: [DVec3; 3],
    distribution: Arc<IntensityDistribution>,
    cells: Distribution2d,
    /// W/sr for each candela of the distribution.
    per_candela: Rgb,
    /// The flux of the distribution.
    lumens: f64,
    beam: Option<Beam>,
    classic: Option<Rgb>,
}

impl Luminaire {
    /// The candela of the distribution along a unit vector away from the light.
    fn candela(&self, direction: Vec3) -> f64 {
        let along = self.axes.map(|axis| axis.dot(direction.as_dvec3()));
        let across = (along[1] * along[1] + along[2] * along[2]).sqrt();
        let polar = atan2_f64(across, along[0]).to_degrees();
        self.distribution.at(polar, atan2_f64(along[2], along[1]).to_degrees())
    }

    /// A direction in proportion to the distribution.
    fn direction(&self, u: Vec2) -> Vec3 {
        let cell = self.cells.choose(u);
        let (azimuths, polar) = (self.distribution.azimuths(), self.distribution.polar_angles());
        let [top, bottom] = [cell.row, cell.row + 1].map(|row| self.distribution.edge(row, cell.column));
        let degrees = [polar[cell.row], polar[cell.row + 1]];
        let theta = Band::new(degrees, [0.5 * (top[0] + top[1]), 0.5 * (bottom[0] + bottom[1])])
            .angle_of_share(cell.down);
        let down = (theta.to_degrees() - degrees[0]) / (degrees[1] - degrees[0]);
        // Across the cell the intensity is linear.
        let [left, right] = [0, 1].map(|side| top[side] + (bottom[side] - top[side]) * down);
        let root = (left * left + cell.right * (right * right - left * left)).max(0.0).sqrt();
        let across = if left + root > 0.0 { cell.right * (left + right) / (left + root) } else { cell.right };
        let begin = azimuths[cell.column];
        let phi = (begin + (azimuths[cell.column + 1] - begin) * across.clamp(0.0, 1.0)).to_radians();
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (sin_cos_f64(theta), sin_cos_f64(phi));
        let [pole, zero, quarter] = self.axes;
        (pole * cos_theta + (zero * cos_phi + quarter * sin_phi) * sin_theta).as_vec3().normalize()
    }
}

impl Light for Luminaire {
    fn sample_li(&self, from: Vec3, _time: f32, _u: Vec2) -> Option<LightSample> {
        let to_light = self.position - from;
        let distance2 = to_light.length_squared();
        let wi = to_light.try_normalize()?;
        let candela = self.candela(-wi) as f32;
        (candela > 0.0).then(|| LightSample {
            wi,
            li: self.per_candela * (candela / distance2),
            point: Some(self.position),
            n_light: Vec3::ZERO,
            pdf_solid_angle: 1.0,
            clearance: 0.0,
            pdf_start: None,
        })
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, _wi: Vec3, _hit: Option<&Surface>) -> f32 {
        0.0
    }

    fn middle_and_reach(&self) -> Option<(Vec3, f32)> {
        Some((self.position, 0.0))
    }

    fn beam(&self) -> Option<Beam> {
        self.beam
    }

    fn extent(&self, _shutter: [f32; 2]) -> Option<LightExtent> {
        Some(LightExtent::all_around(Aabb::of_points([self.position])))
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        self.per_candela.luminance() * self.lumens as f32
    }
}

impl LightTracing for Luminaire {
    fn sample_le(&self, bounds: &Aabb, _: f32, _u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let direction = self.direction(u_direction);
        let le = self.per_candela * self.candela(direction) as f32;
        super::point::ray(self.position, direction, le, self.emission_pdf(bounds, 1.0, direction, 1.0))
    }

    fn sample_le_aimed(&self, _: &Aabb, _time: f32, _u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let direction = warp::square_to_sphere(aim).normalize();
        let candela = self.candela(direction) as f32;
        let shines = if candela > 0.0 { 1.0 } else { 0.0 };
        super::point::ray(self.position, direction, self.per_candela * candela, shines)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_start: f32, direction: Vec3, _cos: f32) -> f32 {
        pdf_start * (self.candela(direction) / self.lumens) as f32
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for Luminaire {
    fn classic(&self, from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        let wi = (self.position - from).try_normalize()?;
        let strength = self.candela(-wi) as f32 / self.distribution.peak();
        (strength > 0.0).then_some(ClassicLight {
            wi,
            position: Some(self.position),
            strength,
            clearance: 0.0,
        })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        let peak = self.per_candela * self.distribution.peak();
        self.classic.unwrap_or_else(|| super::classic_colour_of(peak, self.position, bounds))
    }
}
