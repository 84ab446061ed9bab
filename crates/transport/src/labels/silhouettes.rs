//! Amodal masks: all that a camera would see of an object if nothing hid it, and what it does see of it.

use super::surface::LabelRays;
use crate::film::error::{FilmError, RenderError};
use crate::film::limits::MAX_SIDE;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{install, map};
use bilux_scene::{Camera, Scene, Tracer};

/// The columns of pixels that are looked at before their runs are put together.
const COLUMNS: i64 = 128;

/// Some pixels of a picture with a margin around it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Run lengths: how many pixels, column by column from the upper left corner, are outside and inside of the mask in turn.
    // As COCO has it. [Lin 2014]
    pub runs: Vec<u32>,
    /// The number of pixels inside.
    pub pixels: u64,
    /// The smallest rectangle around them: column and row from the picture's upper left corner, which are negative in the margin,
    /// width and height.
    pub bounds: Option<[i64; 4]>,
}

/// Silhouette of a group of objects, as a camera sees it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Silhouette {
    /// All of it, as if nothing else were there.
    pub whole: Mask,
    /// Part that is visible in the picture.
    pub visible: Mask,
}

/// The silhouettes of groups of objects, of the same rays as other labels. `groups` has the group of each object of the scene,
/// if it is in one, counted from 0; `count` is their number, and `margin` the pixels on each side of the picture that are looked
/// at too. Memory grows with the outlines, not with the number of groups. `None` when it was cancelled.
///
/// # Errors
/// When the size is invalid, or there are no threads.
pub fn silhouettes(
    scene: &Scene,
    camera: &dyn Camera,
    settings: &RenderSettings,
    groups: &[Option<u32>],
    count: usize,
    margin: u32,
    progress: &dyn Progress,
) -> Result<Option<Vec<Silhouette>>, RenderError> {
    settings.check()?;
    let side = |side: u32| side.saturating_add(margin.saturating_mul(2));
    let (width, height) = (side(settings.width), side(settings.height));
    let fits = width <= MAX_SIDE && height <= MAX_SIDE && width.checked_mul(height).is_some();
    if !fits {
        return Err(FilmError::Size { width, height }.into());
    }
    let look =
        Look { rays: LabelRays { scene, camera, settings }, groups, margin: margin.into(), rows: height };
    let mut growing: Vec<[Growing; 2]> = vec![Default::default(); count];
    let pool = threads(settings)?;
    let mut first = 0;
    while first < i64::from(width) {
        let last = (first + COLUMNS).min(width.into());
        let of_column = |i| (!progress.is_cancelled()).then(|| look.column(first + i as i64));
        let columns = install(&pool, || map(0..(last - first) as usize, of_column));
        let Some(columns) = columns.into_iter().collect::<Option<Vec<Vec<Run>>>>() else { return Ok(None) };
        for (column, runs) in (first..).zip(columns) {
            for run in runs {
                if let Some(grown) = growing.get_mut(run.group as usize) {
                    grown[usize::from(run.is_visible)].add(column, &run, height);
                }
            }
        }
        first = last;
    }
    let pixels = u64::from(width) * u64::from(height);
    let finish = |[whole, visible]: [Growing; 2]| Silhouette {
        whole: whole.finished(pixels, look.margin),
        visible: visible.finished(pixels, look.margin),
    };
    Ok(Some(growing.into_iter().map(finish).collect()))
}

/// Pixels of one column, one below the other.
struct Run {
    group: u32,
    is_visible: bool,
    row: u32,
    length: u32,
}

/// Everything that stays the same while the pixels are looked at.
struct Look<'a> {
    rays: LabelRays<'a>,
    groups: &'a [Option<u32>],
    margin: i64,
    /// With those of the margin.
    rows: u32,
}

impl Look<'_> {
    /// The runs of a column, in which those of each group go downwards.
    fn column(&self, column: i64) -> Vec<Run> {
        let mut tracer = Tracer::new(self.rays.scene, false);
        let (mut runs, mut open): (Vec<Run>, Vec<Run>) = (Vec::new(), Vec::new());
        let mut seen = Vec::new();
        for row in 0..self.rows {
            self.groups_at(column - self.margin, i64::from(row) - self.margin, &mut tracer, &mut seen);
            let goes_on = |run: &mut Run| {
                let goes_on = seen.contains(&(run.group, run.is_visible));
                run.length += u32::from(goes_on);
                !goes_on
            };
            runs.extend(open.extract_if(.., goes_on));
            for &(group, is_visible) in &seen {
                if !open.iter().any(|run| (run.group, run.is_visible) == (group, is_visible)) {
                    open.push(Run { group, is_visible, row, length: 1 });
                }
            }
        }
        runs.extend(open);
        runs
    }

    /// The groups that the ray of a pixel meets, each once; and again, as visible, the one that it labels.
    fn groups_at(&self, x: i64, y: i64, tracer: &mut Tracer, seen: &mut Vec<(u32, bool)>) {
        seen.clear();
        let ray = self.rays.of_pixel(x, y);
        if ray.is_nowhere() {
            return;
        }
        let group_of = |object: u32| self.groups.get(object as usize).copied().flatten();
        let geometry = self.rays.scene.geometry();
        for hit in tracer.all_hits(&ray) {
            let met = group_of(geometry.object_of(&hit)).map(|group| (group, false));
            seen.extend(met.filter(|met| !seen.contains(met)));
        }
        let RenderSettings { width, height, .. } = *self.rays.settings;
        let is_in_picture = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
        if is_in_picture && !seen.is_empty() {
            let first = self.rays.first(&ray, tracer);
            seen.extend(first.and_then(|first| group_of(first.surface.object)).map(|group| (group, true)));
        }
    }
}

/// A mask that grows column by column.
#[derive(Clone, Default)]
struct Growing {
    runs: Vec<u32>,
    /// The pixels that the runs cover.
    covered: u64,
    pixels: u64,
    /// First and last column, first and last row.
    bounds: Option<[i64; 4]>,
}

impl Growing {
    fn add(&mut self, column: i64, run: &Run, rows: u32) {
        let start = column as u64 * u64::from(rows) + u64::from(run.row);
        match self.runs.last_mut() {
            Some(last) if start == self.covered => *last += run.length,
            _ => self.runs.extend([(start - self.covered) as u32, run.length]),
        }
        self.covered = start + u64::from(run.length);
        self.pixels += u64::from(run.length);
        let (top, bottom) = (i64::from(run.row), i64::from(run.row + run.length - 1));
        let [left, _, above, below] = self.bounds.unwrap_or([column, column, top, bottom]);
        self.bounds = Some([left, column, above.min(top), below.max(bottom)]);
    }

    fn finished(mut self, all: u64, margin: i64) -> Mask {
        if self.covered < all {
            self.runs.push((all - self.covered) as u32);
        }
        let bounds = self.bounds.map(|[left, right, top, bottom]| {
            [left - margin, top - margin, right - left + 1, bottom - top + 1]
        });
        Mask { runs: self.runs, pixels: self.pixels, bounds }
    }
}
