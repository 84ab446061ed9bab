//! An environment map: an infinite light in latitude and longitude, its centre towards -z, with +y at the top.
//!
//! Directions are sampled in proportion to their light: first a row of cells, then a cell, then a uniform direction in
//! it. The probability of a cell comes from its light after bilinear filtering, as in look-ups.
//!
//! Direct lighting samples only directions that are brighter than the average: BSDF sampling finds the rest as well,
//! and the two strategies together do better than if each tried to find all of the light. [Karlík 2019]

use super::distant::{Across, disc_pdf_area, ray};
use super::distribution_2d::{Cell, Distribution2d, MANY};
use super::{ClassicLighting, EmissionSample, Light, LightSample, LightTracing, Receiver};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use crate::texture::{Texels, Texture};
use bilux_math::transcendental::{acos_without_branch, sin_cos_f64, sin_cos_of_turns, turns_of_point};
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// An environment map as a light.
pub(super) struct EnvironmentMap {
    texture: Arc<Texture>,
    /// The texels are used as they are stored.
    is_plain: bool,
    scale: Rgb,
    /// The rotation of the map, as a fraction of a whole turn, 0..1.
    turn: f32,
    is_backdrop: bool,
    /// Cells per row, and rows.
    columns: usize,
    rows: usize,
    /// Heights of the rows' edges on the unit sphere, from the top down.
    heights: Vec<f64>,
    /// The distribution for emission sampling.
    sent: Distribution2d,
    /// The distribution for direct lighting.
    asked: Distribution2d,
    /// Radiance averaged over all directions.
    mean: Rgb,
}

/// The maximum number of cells on each side, however large the map.
const MAX: (usize, usize) = (2048, 1024);
/// The minimum number of rows of samples with which the light of a small map is summed.
const FINE: usize = 512;
/// Black parts of the map still get this fraction of a uniform sky's density.
const FLOOR: f64 = 1e-3;

/// Larger maps are not decoded: they would take three times the memory.
const MAX_DECODED: usize = 1 << 23;

/// True when the texels are stored as the colours that they stand for.
fn has_plain_floats(texture: &Texture) -> bool {
    let is_plain = texture.factor == Rgb::WHITE && texture.channel.is_none() && texture.threshold.is_none();
    is_plain && matches!(texture.image.texels, Texels::Floats { .. })
}

/// Map with decoded texels, if it is not too large.
fn decoded(texture: Arc<Texture>) -> Arc<Texture> {
    let (width, height) = (texture.width(), texture.height());
    if !texture.image.is_whole() || width.saturating_mul(height) > MAX_DECODED {
        return texture;
    }
    Arc::new(Texture::new(&texture.name, width, height, texture.texels().collect(), texture.is_data))
}

/// An angle in whole turns, without its whole part.
fn within_turn(turns: f32) -> f32 {
    let rest = turns - turns.floor();
    if rest < 1.0 { rest } else { 0.0 }
}

impl EnvironmentMap {
    /// A map whose colours are multiplied by `scale`, rotated to the right by `rotation` in radians.
    pub(super) fn new(texture: Arc<Texture>, scale: Rgb, rotation: f32, is_backdrop: bool) -> EnvironmentMap {
        // Densities are defined per texel.
        let texture = texture.baked(false).map_or(texture, |(picture, _)| Arc::new(picture));
        let texture = if has_plain_floats(&texture) { texture } else { decoded(texture) };
        let (columns, rows) = (texture.width().min(MAX.0), texture.height().min(MAX.1));
        let height = |row| sin_cos_f64(std::f64::consts::PI * row as f64 / rows.max(1) as f64).1;
        let mut map = EnvironmentMap {
            is_plain: has_plain_floats(&texture),
            texture,
            scale,
            turn: within_turn(rotation / TAU),
            is_backdrop,
            columns,
            rows,
            heights: (0..=rows).map(height).collect(),
            sent: Distribution2d::default(),
            asked: Distribution2d::default(),
            mean: Rgb::BLACK,
        };
        map.add_up();
        map
    }

    fn add_up(&mut self) {
        let (width, height) = (self.texture.width(), self.texture.height());
        if !self.texture.image.is_whole() {
            (self.columns, self.rows) = (0, 0);
            return;
        }
        let fine = FINE.div_ceil(height).max(2);
        let mut cells = vec![0.0f64; self.columns * self.rows];
        let (mut sum, mut total) = ([0.0f64; 3], 0.0f64);
        for y in 0..height * fine {
            let at = |y: usize| std::f64::consts::PI * y as f64 / (height * fine) as f64;
            let solid_angle = sin_cos_f64(0.5 * (at(y) + at(y + 1))).0;
            let row = (y / fine * self.rows / height) * self.columns;
            for x in 0..width * fine {
                let at = Vec2::new((x as f32 + 0.5) / fine as f32, (y as f32 + 0.5) / fine as f32);
                let colour =
                    (self.texel(at) * self.scale).map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
                cells[row + x / fine * self.columns / width] += f64::from(colour.luminance()) * solid_angle;
                (0..3).for_each(|c| sum[c] += f64::from(colour[c]) * solid_angle);
                total += solid_angle;
            }
        }
        self.mean = Rgb::from_array(sum.map(|c| (c / total) as f32));
        let all: f64 = cells.iter().sum();
        let even = all / (4.0 * std::f64::consts::PI);
        let over = |add: f64| {
            let of_row = |(row, cells): (usize, &[f64])| {
                let even = add * self.solid_angle(row);
                cells.iter().map(|cell| (cell + even).max(0.0)).collect::<Vec<_>>()
            };
            let rows = cells.chunks_exact(self.columns).enumerate().flat_map(of_row);
            Distribution2d::new(&rows.collect::<Vec<_>>(), self.columns)
        };
        let floor = FLOOR * if all > 0.0 { even } else { 1.0 };
        (self.sent, self.asked) = (over(floor), over(-even));
    }

    /// The solid angle of each cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        (self.heights[row] - self.heights[row + 1]) * std::f64::consts::TAU / self.columns as f64
    }

    /// The map at a position in texels, filtered bilinearly, wrapped around and clamped at the poles.
    #[inline]
    fn texel(&self, at: Vec2) -> Rgb {
        let (width, height) = (self.texture.width(), self.texture.height());
        // Positions are at least 0, and so these at least -1/2.
        let (x, y) = (at.x - 0.5, at.y - 0.5);
        let floor = |x: f32| if x < 0.0 { -1.0 } else { (x as usize) as f32 };
        let (fx, fy) = (x - floor(x), y - floor(y));
        let left = (floor(x) + 1.0) as usize;
        let column = |x: usize| if x < width { x } else { x % width };
        let (x0, x1) = (column(left + width - 1), column(left));
        let row = |y: f32| (y.max(0.0) as usize).min(height - 1);
        let (y0, y1) = (row(floor(y)) * width, row(floor(y) + 1.0) * width);
        let four = [y0 + x0, y0 + x1, y1 + x0, y1 + x1];
        let [a, b, c, d] = match &self.texture.image.texels {
            Texels::Floats { colours, .. } if self.is_plain => four.map(|i| colours[i]),
            _ => four.map(|i| self.texture.texel(i % width, i / width)),
        };
        a.lerp(b, fx).lerp(c.lerp(d, fx), fy)
    }

    /// The position of a direction in the map, 0..=1 from the left and from the top.
    #[inline(always)]
    fn place(&self, direction: Vec3) -> Vec2 {
        let u = 0.5 + turns_of_point(-direction.z, direction.x) - self.turn;
        let down = acos_without_branch(direction.y.clamp(-1.0, 1.0)) * FRAC_1_PI;
        Vec2::new(if u < 0.0 { u + 1.0 } else { u }, down)
    }

    /// [`EnvironmentMap::place`] for up to [`MANY`] directions, in a loop that the compiler vectorises.
    fn places(&self, directions: &[[f32; MANY]; 3], places: &mut [[f32; MANY]; 2]) {
        for i in 0..MANY {
            let [x, y, z] = [directions[0][i], directions[1][i], directions[2][i]];
            let place = self.place(Vec3::new(x, y, z));
            (places[0][i], places[1][i]) = (place.x, place.y);
        }
    }

    /// Density over solid angle; zero where there is no map.
    fn pdf(&self, cells: &Distribution2d, direction: Vec3) -> f32 {
        if self.is_backdrop || cells.is_empty() { 0.0 } else { self.pdf_at(cells, self.place(direction)) }
    }

    #[inline]
    fn pdf_at(&self, cells: &Distribution2d, place: Vec2) -> f32 {
        let row = ((place.y * self.rows as f32) as usize).min(self.rows - 1);
        let column = ((place.x * self.columns as f32) as usize).min(self.columns - 1);
        (cells.probability(row, column) / self.solid_angle(row)) as f32
    }

    #[inline]
    fn le_at(&self, place: Vec2) -> Rgb {
        let (width, height) = (self.texture.width() as f32, self.texture.height() as f32);
        self.texel(place * Vec2::new(width, height)) * self.scale
    }

    /// Samples a direction towards the map, with its place and its density.
    fn sample(&self, cells: &Distribution2d, u: Vec2) -> Option<(Vec3, Vec2, f32)> {
        if self.is_backdrop || cells.is_empty() {
            return None;
        }
        self.sample_in(cells, cells.choose(u))
    }

    /// [`EnvironmentMap::sample`] in a cell.
    fn sample_in(&self, cells: &Distribution2d, cell: Cell) -> Option<(Vec3, Vec2, f32)> {
        let direction = self.direction_in(cell);
        let place = self.place(direction);
        let pdf = self.pdf_at(cells, place);
        (pdf > 0.0).then_some((direction, place, pdf))
    }

    /// The direction to a point of a cell.
    #[inline(always)]
    fn direction_in(&self, Cell { row, column, right, down }: Cell) -> Vec3 {
        let (top, bottom) = (self.heights[row], self.heights[row + 1]);
        let y = top + (bottom - top) * down;
        let turned = ((column as f64 + right) / self.columns as f64) as f32 + self.turn;
        let turned = if turned > 1.0 { turned - 1.0 } else { turned };
        // The middle of the map, half a turn from its edge, is at -z.
        let (sin, cos) = sin_cos_of_turns(turned);
        let r = (1.0 - y * y).max(0.0).sqrt() as f32;
        Vec3::new(-r * sin, y as f32, r * cos).normalize()
    }
}

impl Light for EnvironmentMap {
    fn sample_li(&self, _from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        let (wi, place, pdf_solid_angle) = self.sample(&self.asked, u)?;
        let (li, n_light) = (self.le_at(place), Vec3::ZERO);
        Some(LightSample { wi, li, point: None, n_light, pdf_solid_angle, clearance: 0.0, pdf_start: None })
    }

    fn sample_li_each(&self, receivers: &[Receiver], samples: &mut Vec<Option<LightSample>>) {
        samples.clear();
        if self.is_backdrop || self.asked.is_empty() {
            return samples.resize(receivers.len(), None);
        }
        let (mut cells, mut points) = ([Cell::default(); MANY], [Vec2::ZERO; MANY]);
        let (mut directions, mut places) = ([[0.0; MANY]; 3], [[0.0; MANY]; 2]);
        for receivers in receivers.chunks(MANY) {
            points.iter_mut().zip(receivers).for_each(|(point, receiver)| *point = receiver.u);
            self.asked.choose_each(&points[..receivers.len()], &mut cells);
            for (i, cell) in cells[..receivers.len()].iter().enumerate() {
                let [x, y, z] = self.direction_in(*cell).to_array();
                (directions[0][i], directions[1][i], directions[2][i]) = (x, y, z);
            }
            self.places(&directions, &mut places);
            let begin = samples.len();
            let place = |i: usize| Vec2::new(places[0][i], places[1][i]);
            samples.extend((0..receivers.len()).map(|i| {
                let wi = Vec3::new(directions[0][i], directions[1][i], directions[2][i]);
                let pdf_solid_angle = self.pdf_at(&self.asked, place(i));
                let (li, n_light) = (Rgb::BLACK, Vec3::ZERO);
                let sample = LightSample {
                    wi,
                    li,
                    point: None,
                    n_light,
                    pdf_solid_angle,
                    clearance: 0.0,
                    pdf_start: None,
                };
                (pdf_solid_angle > 0.0).then_some(sample)
            }));
            for (i, sample) in samples[begin..].iter_mut().enumerate() {
                if let Some(sample) = sample {
                    sample.li = self.le_at(place(i));
                }
            }
        }
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        if hit.is_some() { 0.0 } else { self.pdf(&self.asked, wi) }
    }

    fn samples_all_light(&self) -> bool {
        false
    }

    fn le(&self, direction: Vec3) -> Rgb {
        if self.rows == 0 {
            return Rgb::BLACK;
        }
        self.le_at(self.place(direction))
    }

    fn le_and_pdf(&self, _from: Vec3, direction: Vec3) -> (Rgb, f32) {
        if self.rows == 0 {
            return (Rgb::BLACK, 0.0);
        }
        let place = self.place(direction);
        let is_sampled = !self.is_backdrop && !self.asked.is_empty();
        (self.le_at(place), if is_sampled { self.pdf_at(&self.asked, place) } else { 0.0 })
    }

    fn le_and_pdf_each(&self, rays: &[(Option<Vec3>, Vec3)], found: &mut Vec<(Rgb, f32)>) {
        found.clear();
        if self.rows == 0 {
            return found.resize(rays.len(), (Rgb::BLACK, 0.0));
        }
        let is_sampled = !self.is_backdrop && !self.asked.is_empty();
        let (mut directions, mut places) = ([[0.0; MANY]; 3], [[0.0; MANY]; 2]);
        for rays in rays.chunks(MANY) {
            for (i, ray) in rays.iter().enumerate() {
                (directions[0][i], directions[1][i], directions[2][i]) = ray.1.into();
            }
            self.places(&directions, &mut places);
            let begin = found.len();
            let place = |i: usize| Vec2::new(places[0][i], places[1][i]);
            found.extend((0..rays.len()).map(|i| (self.le_at(place(i)), 0.0)));
            for (i, (found, ray)) in found[begin..].iter_mut().zip(rays).enumerate() {
                if is_sampled && ray.0.is_some() {
                    found.1 = self.pdf_at(&self.asked, place(i));
                }
            }
        }
    }

    fn is_backdrop(&self) -> bool {
        self.is_backdrop
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn power(&self, bounds: &Aabb) -> f32 {
        let radius = bounds.radius();
        if self.is_backdrop { 0.0 } else { self.mean.luminance() * 4.0 * PI * PI * radius * radius }
    }
}

impl LightTracing for EnvironmentMap {
    fn sample_le(&self, bounds: &Aabb, _: f32, u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let (towards, place, _) = self.sample(&self.sent, u_direction)?;
        let pdf_direct = self.pdf(&self.asked, towards);
        let pdf_emission = self.emission_pdf(bounds, pdf_direct, -towards, 1.0);
        ray(bounds, Across::Anywhere(u_point), -towards, self.le_at(place), pdf_emission, pdf_direct)
    }

    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let (towards, place, pdf) = self.sample(&self.sent, u)?;
        ray(bounds, Across::At(aim), -towards, self.le_at(place), pdf, self.pdf(&self.asked, towards))
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_start: f32, direction: Vec3, _cos: f32) -> f32 {
        self.pdf(&self.sent, -direction)
    }

    fn emission_pdf(&self, bounds: &Aabb, _pdf_start: f32, direction: Vec3, _cos: f32) -> f32 {
        self.pdf(&self.sent, -direction) * disc_pdf_area(bounds)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

impl ClassicLighting for EnvironmentMap {
    fn classic(&self, _from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        None
    }

    fn classic_colour(&self, _bounds: &Aabb) -> Rgb {
        Rgb::BLACK
    }

    fn classic_ambient(&self) -> Rgb {
        if self.is_backdrop { Rgb::BLACK } else { self.mean }
    }
}
