//! An environment map: an infinite light in latitude and longitude, its centre towards -z, with +y at the top.
//!
//! Directions are sampled in proportion to their light: first a row of cells, then a cell, then a uniform direction in
//! it. The probability of a cell comes from its light after bilinear filtering, as in look-ups.
//!
//! Direct lighting samples only directions that are brighter than the average: BSDF sampling finds the rest as well,
//! and the two strategies together do better than if each tried to find all of the light. [Karlík 2019]

use super::distant::{Across, disc_pdf_area, ray};
use super::{ClassicLighting, EmissionSample, Light, LightSample, LightTracing};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use crate::texture::Texture;
use bilux_math::transcendental::{acos, atan2, sin_cos, sin_cos_f64};
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// An environment map as a light.
pub(super) struct EnvironmentMap {
    texture: Arc<Texture>,
    scale: Rgb,
    /// The rotation of the map, as a fraction of a whole turn.
    turn: f32,
    is_backdrop: bool,
    /// Cells per row, and rows.
    columns: usize,
    rows: usize,
    /// Heights of the rows' edges on the unit sphere, from the top down.
    heights: Vec<f64>,
    /// The distribution for emission sampling.
    sent: Chances,
    /// The distribution for direct lighting.
    asked: Chances,
    /// Radiance averaged over all directions.
    mean: Rgb,
}

/// The probability of each cell; empty if there are no rows.
#[derive(Default)]
struct Chances {
    /// For each row, the fraction of all light in it and the rows above.
    row_cdf: Vec<f64>,
    /// For each cell, the fraction of its row's light in it and the cells to its left.
    cell_cdf: Vec<f64>,
}

/// The maximum number of cells on each side, however large the map.
const MAX: (usize, usize) = (2048, 1024);
/// The minimum number of rows of samples with which the light of a small map is summed.
const FINE: usize = 512;
/// Black parts of the map still get this fraction of a uniform sky's density.
const FLOOR: f64 = 1e-3;

impl EnvironmentMap {
    /// A map whose colours are multiplied by `scale`, rotated to the right by `rotation` in radians.
    pub(super) fn new(texture: Arc<Texture>, scale: Rgb, rotation: f32, is_backdrop: bool) -> EnvironmentMap {
        // Densities are defined per texel.
        let texture = texture.baked(false).map_or(texture, |(picture, _)| Arc::new(picture));
        let (columns, rows) = (texture.width().min(MAX.0), texture.height().min(MAX.1));
        let height = |row| sin_cos_f64(std::f64::consts::PI * row as f64 / rows.max(1) as f64).1;
        let mut map = EnvironmentMap {
            texture,
            scale,
            turn: rotation / TAU,
            is_backdrop,
            columns,
            rows,
            heights: (0..=rows).map(height).collect(),
            sent: Chances::default(),
            asked: Chances::default(),
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
            Chances::new(&rows.collect::<Vec<_>>(), self.columns)
        };
        let floor = FLOOR * if all > 0.0 { even } else { 1.0 };
        (self.sent, self.asked) = (over(floor), over(-even));
    }

    /// The solid angle of each cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        (self.heights[row] - self.heights[row + 1]) * std::f64::consts::TAU / self.columns as f64
    }

    /// The map at a position in texels, filtered bilinearly, wrapped around and clamped at the poles.
    fn texel(&self, at: Vec2) -> Rgb {
        let (width, height) = (self.texture.width(), self.texture.height());
        let (x, y) = (at.x - 0.5, at.y - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |x: f32| (x as i64).rem_euclid(width as i64) as usize;
        let row = |y: f32| (y.max(0.0) as usize).min(height - 1);
        let (x0, x1) = (column(x.floor()), column(x.floor() + 1.0));
        let (y0, y1) = (row(y.floor()), row(y.floor() + 1.0));
        let texel = |x: usize, y: usize| self.texture.texel(x, y);
        texel(x0, y0).lerp(texel(x1, y0), fx).lerp(texel(x0, y1).lerp(texel(x1, y1), fx), fy)
    }

    /// The position of a direction in the map, 0..=1 from the left and from the top.
    fn place(&self, direction: Vec3) -> Vec2 {
        let u = 0.5 + atan2(direction.x, -direction.z) / TAU - self.turn;
        Vec2::new(u - u.floor(), acos(direction.y.clamp(-1.0, 1.0)) / PI)
    }

    /// Density over solid angle; zero where there is no map.
    fn pdf(&self, chances: &Chances, direction: Vec3) -> f32 {
        if self.is_backdrop || chances.row_cdf.is_empty() {
            return 0.0;
        }
        let place = self.place(direction);
        let row = ((place.y * self.rows as f32) as usize).min(self.rows - 1);
        let column = ((place.x * self.columns as f32) as usize).min(self.columns - 1);
        let share = share(&chances.row_cdf, row) * share(chances.cells_of(row), column);
        (share / self.solid_angle(row)) as f32
    }

    /// Samples a direction towards the map, with its density.
    fn sample(&self, chances: &Chances, u: Vec2) -> Option<(Vec3, f32)> {
        if self.is_backdrop || chances.row_cdf.is_empty() {
            return None;
        }
        let (row, down) = choose(&chances.row_cdf, u.y);
        let (column, right) = choose(chances.cells_of(row), u.x);
        let (top, bottom) = (self.heights[row], self.heights[row + 1]);
        let y = top + (bottom - top) * down;
        let turned = (column as f64 + right) / self.columns as f64;
        let (sin, cos) = sin_cos((turned as f32 + self.turn - 0.5) * TAU);
        let r = (1.0 - y * y).max(0.0).sqrt() as f32;
        let direction = Vec3::new(r * sin, y as f32, -r * cos).normalize();
        let pdf = self.pdf(chances, direction);
        (pdf > 0.0).then_some((direction, pdf))
    }
}

impl Chances {
    /// Probabilities in proportion to the cells' values; empty if all of them are zero.
    fn new(cells: &[f64], columns: usize) -> Chances {
        let mut chances = Chances::default();
        let mut row_sum = 0.0;
        for cells in cells.chunks_exact(columns) {
            let begin = chances.cell_cdf.len();
            let mut sum = 0.0;
            for cell in cells {
                sum += cell;
                chances.cell_cdf.push(sum);
            }
            if sum > 0.0 {
                chances.cell_cdf[begin..].iter_mut().for_each(|c| *c /= sum);
            }
            row_sum += sum;
            chances.row_cdf.push(row_sum);
        }
        if row_sum <= 0.0 {
            return Chances::default();
        }
        chances.row_cdf.iter_mut().for_each(|r| *r /= row_sum);
        chances
    }

    fn cells_of(&self, row: usize) -> &[f64] {
        let columns = self.cell_cdf.len() / self.row_cdf.len();
        &self.cell_cdf[row * columns..(row + 1) * columns]
    }
}

fn share(cdf: &[f64], i: usize) -> f64 {
    cdf[i] - if i == 0 { 0.0 } else { cdf[i - 1] }
}

/// The interval that a number picks, and the number's position within it.
fn choose(cdf: &[f64], u: f32) -> (usize, f64) {
    let u = f64::from(u);
    let i = cdf.partition_point(|&c| c <= u).min(cdf.len() - 1);
    let (share, end) = (share(cdf, i), cdf[i]);
    (i, if share > 0.0 { (1.0 - (end - u) / share).clamp(0.0, 1.0) } else { 0.5 })
}

impl Light for EnvironmentMap {
    fn sample_li(&self, _from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        let (wi, pdf_solid_angle) = self.sample(&self.asked, u)?;
        let (li, n_light) = (self.le(wi), Vec3::ZERO);
        Some(LightSample { wi, li, point: None, n_light, pdf_solid_angle, clearance: 0.0 })
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
        let (width, height) = (self.texture.width() as f32, self.texture.height() as f32);
        self.texel(self.place(direction) * Vec2::new(width, height)) * self.scale
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
        let (towards, _) = self.sample(&self.sent, u_direction)?;
        let pdf_direct = self.pdf(&self.asked, towards);
        let pdf_emission = self.emission_pdf(bounds, pdf_direct, -towards, 1.0);
        ray(bounds, Across::Anywhere(u_point), -towards, self.le(towards), (pdf_emission, pdf_direct))
    }

    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let (towards, pdf) = self.sample(&self.sent, u)?;
        ray(bounds, Across::At(aim), -towards, self.le(towards), (pdf, self.pdf(&self.asked, towards)))
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_direct: f32, direction: Vec3, _cos: f32) -> f32 {
        self.pdf(&self.sent, -direction)
    }

    fn emission_pdf(&self, bounds: &Aabb, _pdf_direct: f32, direction: Vec3, _cos: f32) -> f32 {
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
