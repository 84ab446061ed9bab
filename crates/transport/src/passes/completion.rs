//! Pictures that time ended within their first pass, in which some pixels have no sample: from those that have one, guided by the
//! surfaces that the camera sees.
//!
//! The samples of a first pass under a limit of time come lattice by lattice, so those that there are are spread evenly. Around each point of the finest
//! complete lattice the light over albedo is averaged, which makes a small picture without gaps, with features of its own: it is denoised
//! as any other. Where most points of the next finer lattice have a sample too, it is that lattice, and its other points are completed
//! from the coarser one first. Each pixel then interpolates between the points around it, those most whose albedo, normal and depth are like
//! its own, and gets its own albedo back: joint bilateral upsampling [Kopf 2007].

use crate::film::Film;
use crate::film::error::FilmError;
use crate::film::window::Window;
use crate::passes::features::Features;
use bilux_math::parallel::map;
use bilux_math::{Rgb, Vec3};

/// Light is divided by albedo of at least this much.
const DARKEST: f32 = 0.05;
/// The difference in albedo, in normal, and in depth as a fraction, at which a point counts a quarter.
const ALIKE: [f32; 3] = [0.1, 0.3, 0.1];
/// The least weight of what is not alike, so that something counts wherever nothing is.
const LEAST: f32 = 1e-4;
/// Points further away count too where those around a pixel are less alike than this in all.
const ENOUGH: f32 = 0.05;

/// A finer lattice is taken where this part of its points has a sample.
const MOST: f64 = 0.6;

/// A picture of the points of a lattice, from which all pixels of a film's window are completed.
#[derive(Clone, Debug)]
pub struct Completion<'a> {
    film: Window,
    spacing: u32,
    features: Option<&'a Features>,
    /// Columns and rows of points.
    pub size: [u32; 2],
    /// The light around each point, row by row.
    pub light: Vec<Rgb>,
    /// Features around each point, if there are any of the film's pixels.
    pub of_points: Option<Features>,
}

/// Sums over the pixels around a point.
#[derive(Clone, Copy, Default)]
struct Sums {
    pixels: f32,
    albedo: Rgb,
    normal: Vec3,
    depth: f32,
    seen: f32,
    haze: f32,
    coverage: f32,
    splatted: Rgb,
    samples: f32,
    /// Of light over albedo.
    light: Rgb,
}

impl<'a> Completion<'a> {
    /// The completion of a film of which all pixels have a sample whose column and row are multiples of `spacing`, and of the others some
    /// ([`crate::Rendered::spacing`]), with features of its pixels.
    pub fn new(film: &Film, spacing: u32, features: Option<&'a Features>) -> Completion<'a> {
        let coarse = Completion::of_lattice(film, spacing.max(1), features);
        let finer = coarse.spacing / 2;
        let sampled = film.counts().iter().filter(|count| **count > 0).count() as f64;
        let points = film.window().pixels() as f64 / f64::from(finer.max(1) * finer.max(1));
        if finer == 0 || sampled < MOST * points {
            return coarse;
        }
        let mut fine = Completion::of_lattice(film, finer, features);
        let width = fine.size[0];
        for (i, light) in fine.light.iter_mut().enumerate().filter(|(_, light)| !light.is_finite()) {
            let [x, y] = [i as u32 % width, i as u32 / width].map(|point| point * finer);
            *light = coarse.interpolated(&coarse.light, x, y);
        }
        fine
    }

    fn of_lattice(film: &Film, spacing: u32, features: Option<&'a Features>) -> Completion<'a> {
        let window = film.window();
        let features = features.filter(|features| features.window == window);
        let size = [window.width.div_ceil(spacing), window.height.div_ceil(spacing)];
        let mut completion =
            Completion { film: window, spacing, features, size, light: Vec::new(), of_points: None };
        let rows =
            map(0..size[1], |row| (0..size[0]).map(|x| completion.around(film, x, row)).collect::<Vec<_>>());
        let sums: Vec<Sums> = rows.concat();
        completion.light = sums.iter().map(Sums::mean_light).collect();
        completion.of_points = features.map(|features| {
            let mean =
                |of: fn(&Sums) -> f32| sums.iter().map(|sums| of(sums) / sums.pixels.max(1.0)).collect();
            Features {
                window: Window::whole(size[0], size[1]),
                albedo: sums.iter().map(|sums| sums.albedo / sums.pixels.max(1.0)).collect(),
                mean_normal: sums.iter().map(|sums| sums.normal / sums.pixels.max(1.0)).collect(),
                mean_depth: sums.iter().map(Sums::mean_depth).collect(),
                haze: if features.haze.is_empty() { Vec::new() } else { mean(|sums| sums.haze) },
                coverage: mean(|sums| sums.coverage),
            }
        });
        completion
    }

    /// The pixels that are nearest to a point along one axis, by their place in the window.
    fn near(&self, point: u32, axis: usize) -> std::ops::Range<u32> {
        let half = self.spacing / 2;
        let length = [self.film.width, self.film.height][axis];
        let is_last = point + 1 == self.size[axis];
        let end = if is_last { length } else { (point + 1) * self.spacing - half };
        (point * self.spacing).saturating_sub(half)..end
    }

    /// The point that is nearest to a pixel along one axis, by its place in the window.
    fn nearest(&self, pixel: u32, axis: usize) -> u32 {
        ((pixel + self.spacing / 2) / self.spacing).min(self.size[axis] - 1)
    }

    fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.film.width as usize + column as usize
    }

    fn albedo(&self, i: usize) -> Rgb {
        self.features.map_or(Rgb::WHITE, |features| features.albedo[i].clamp(DARKEST, 1.0))
    }

    fn around(&self, film: &Film, column: u32, row: u32) -> Sums {
        let mut sums = Sums::default();
        for dy in self.near(row, 1) {
            for dx in self.near(column, 0) {
                let (i, x, y) = (self.index(dx, dy), self.film.x + dx, self.film.y + dy);
                sums.pixels += 1.0;
                sums.splatted += film.splatted(x, y);
                let light = film.sampled(x, y);
                if film.samples(x, y) > 0 && light.is_finite() {
                    sums.samples += 1.0;
                    sums.light += light / self.albedo(i);
                }
                let Some(features) = self.features else {
                    sums.albedo += Rgb::WHITE;
                    continue;
                };
                sums.albedo += features.albedo[i];
                sums.normal += features.mean_normal[i];
                let depth = features.mean_depth[i];
                if depth.is_finite() {
                    sums.depth += depth;
                    sums.seen += 1.0;
                }
                sums.haze += features.haze.get(i).copied().unwrap_or(0.0);
                sums.coverage += features.coverage[i];
            }
        }
        sums
    }

    /// The share of each pixel of the window in the mean of the point that is nearest to it, for what has a value for each pixel.
    pub fn means(&self, values: &[f32]) -> Vec<f32> {
        let mean = |(column, row): (u32, u32)| {
            let pixels = self.near(row, 1).flat_map(|y| self.near(column, 0).map(move |x| (x, y)));
            let (sum, count) = pixels
                .filter_map(|(x, y)| values.get(self.index(x, y)))
                .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0f32));
            sum / count.max(1.0)
        };
        (0..self.size[1])
            .flat_map(|row| (0..self.size[0]).map(move |column| (column, row)))
            .map(mean)
            .collect()
    }

    /// The light of all pixels of the window, row by row, from that of the points.
    ///
    /// # Errors
    /// When it is not the light of as many points.
    pub fn completed(&self, of_points: &[Rgb]) -> Result<Vec<Rgb>, FilmError> {
        if of_points.len() != self.light.len() {
            return Err(FilmError::NoRoom { pixels: of_points.len() as u64 });
        }
        let row =
            |y: u32| (0..self.film.width).map(|x| self.interpolated(of_points, x, y)).collect::<Vec<_>>();
        Ok(map(0..self.film.height, row).concat())
    }

    fn interpolated(&self, of_points: &[Rgb], x: u32, y: u32) -> Rgb {
        let here = self.index(x, y);
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        // The points around, and a wider square of points where none of these is like the pixel.
        for reach in [1.0, 2.0] {
            (sum, weights) = (Rgb::BLACK, 0.0);
            let first = |pixel: u32| (pixel / self.spacing).saturating_sub(reach as u32 - 1);
            for row in first(y)..(y / self.spacing + reach as u32 + 1).min(self.size[1]) {
                for column in first(x)..(x / self.spacing + reach as u32 + 1).min(self.size[0]) {
                    let point = row as usize * self.size[0] as usize + column as usize;
                    let light = of_points[point];
                    let apart = |point: u32, pixel: u32| {
                        (f64::from(point * self.spacing) - f64::from(pixel)).abs() as f32
                            / self.spacing as f32
                    };
                    let near = [apart(column, x), apart(row, y)].map(|apart| (reach - apart).max(0.0));
                    if !light.is_finite() {
                        continue;
                    }
                    let alike = match (self.features, &self.of_points) {
                        (Some(features), Some(of_points)) => likeness((features, here), (of_points, point)),
                        _ => 1.0,
                    };
                    let weight = near[0] * near[1] * (alike + LEAST);
                    sum += light / self.albedo_of(point) * weight;
                    weights += weight;
                }
            }
            if weights > ENOUGH {
                break;
            }
        }
        if weights > 0.0 {
            return sum * self.albedo(here) / weights;
        }
        of_points[self.nearest(y, 1) as usize * self.size[0] as usize + self.nearest(x, 0) as usize]
    }

    fn albedo_of(&self, point: usize) -> Rgb {
        self.of_points.as_ref().map_or(Rgb::WHITE, |features| features.albedo[point].clamp(DARKEST, 1.0))
    }
}

impl Sums {
    /// NaN where all samples were bad: other points have to do.
    fn mean_light(&self) -> Rgb {
        if self.samples == 0.0 {
            return Rgb::grey(f32::NAN);
        }
        let pixels = self.pixels.max(1.0);
        let albedo = (self.albedo / pixels).clamp(DARKEST, 1.0);
        self.light * albedo / self.samples + self.splatted / pixels
    }

    /// Infinite where most pixels see nothing.
    fn mean_depth(&self) -> f32 {
        if 2.0 * self.seen >= self.pixels.max(1.0) { self.depth / self.seen } else { f32::INFINITY }
    }
}

/// The likeness of the surfaces of two pixels, 0..=1.
fn likeness((a, i): (&Features, usize), (b, k): (&Features, usize)) -> f32 {
    let colour = (a.albedo[i] - b.albedo[k]).to_array();
    let normal = a.mean_normal[i] - b.mean_normal[k];
    let depths = [a.mean_depth[i], b.mean_depth[k]];
    let [near, far] = [depths[0].min(depths[1]), depths[0].max(depths[1])];
    let depth = if near == far { 0.0 } else { 1.0 - near / far };
    let apart = [colour.iter().map(|c| c * c).sum::<f32>(), normal.length_squared(), depth * depth];
    let apart: f32 = apart.iter().zip(ALIKE).map(|(square, alike)| square / (alike * alike)).sum();
    1.0 / ((1.0 + apart) * (1.0 + apart))
}
