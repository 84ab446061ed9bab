//! A picture whose parts are rendered elsewhere: which samples of which pixels are to be taken next, and the film of
//! those that came back.
//!
//! Parts are given out ahead of what is known: while some are being rendered, it is not yet decided whether the picture
//! needs those after them. They are added in the order of the passes, and the decision falls between passes, on the same
//! films as on one machine. So the picture is the same, to the bit, and parts beyond its end are not used.

use crate::film::Film;
use crate::film::error::{FilmError, RenderError};
use crate::film::window::{Coverage, Window};
use crate::schedule::Schedule;
use crate::schedule::rendered::Rendered;
use crate::schedule::settings::RenderSettings;
use bilux_accel::Counters;
use std::collections::{HashSet, VecDeque};
use std::ops::Range;
use std::time::{Duration, Instant};

/// Some samples of some pixels.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Part {
    /// The samples, of each of the pixels.
    pub samples: Range<u32>,
    /// The pixels.
    pub window: Window,
}

/// Division of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Division {
    /// Number of parts that are rendered at a time.
    pub workers: u32,
    /// Number of threads of each worker.
    pub threads: u32,
    /// Whether parts may be windows: not if light subpaths are traced, which takes all samples of the whole film for each
    /// window.
    pub may_crop: bool,
}

/// A pass over the whole film.
struct Pass {
    samples: Range<u32>,
    /// All of its parts.
    count: usize,
    /// The parts that are not given out.
    parts: VecDeque<Part>,
    /// The parts that are given out and have not come back.
    missing: HashSet<Part>,
    /// Film of the parts that came back.
    film: Option<Film>,
}

/// A picture in the making.
pub struct Gathering {
    settings: RenderSettings,
    division: Division,
    /// The passes that are complete.
    film: Film,
    /// Decides whether there are more passes; it is one pass ahead of the films that it has seen.
    schedule: Schedule,
    /// When it has to end.
    deadline: Option<Instant>,
    /// The passes that are not complete, in order. The first is certain.
    passes: VecDeque<Pass>,
    /// Plans passes that it may then turn out not to need.
    ahead: Schedule,
    /// The samples per pixel in complete passes.
    done: u32,
    is_done: bool,
    counters: Counters,
}

/// The maximum number of samples of all pixels in a part, for each thread of a worker: some seconds. Only then is
/// there progress, and no more than that is lost with a worker.
const MOST: usize = 1 << 21;
/// Minimum number of parts for each worker, if parts may be windows: with fewer, some work while others have nothing left
/// to do.
const PARTS: u32 = 16;
/// The minimum number of rows of a window.
const MIN_ROWS: u32 = 16;
/// Number of parts for each worker that are given out before it is known that they are needed.
const AHEAD: usize = 4;
/// More workers than anybody has; keeps numbers of parts small.
const MAX_WORKERS: u32 = 1 << 20;

impl Gathering {
    /// A picture that is to be divided in this way, with films of this fingerprint and scale ([`crate::scale_exponent`]).
    /// A limit of time begins now, `spent` ago.
    ///
    /// # Errors
    /// When the settings are wrong, ask for an interval or a crop, or memory is short.
    pub fn new(
        settings: &RenderSettings,
        scale_exponent: i32,
        fingerprint: &str,
        division: Division,
        spent: Duration,
    ) -> Result<Gathering, RenderError> {
        settings.check()?;
        if settings.interval || settings.crop.is_some() {
            return Err(RenderError::GatheringOfPart);
        }
        let (width, height) = (settings.width, settings.height);
        let mut film = Film::new(width, height, scale_exponent)?;
        fingerprint.clone_into(&mut film.fingerprint);
        let limit = settings.stop.time_limit;
        let mut gathering = Gathering {
            film,
            division,
            schedule: Schedule::without_clock(settings, true),
            ahead: Schedule::without_clock(settings, false),
            deadline: limit.map(|limit| Instant::now() + limit.saturating_sub(spent)),
            passes: VecDeque::new(),
            done: 0,
            is_done: false,
            counters: Counters::default(),
            settings: settings.clone(),
        };
        // The first pass is certain.
        gathering.schedule.next();
        gathering.plan_pass();
        Ok(gathering)
    }

    /// The next part to render; `None` if there is nothing to give out at present.
    pub fn next_part(&mut self) -> Option<Part> {
        if self.is_done() {
            return None;
        }
        // Late, only the first pass is still needed.
        let passes = if self.is_late() { 1 } else { usize::MAX };
        loop {
            let mut open = self.passes.iter_mut().take(passes);
            if let Some(pass) = open.find(|pass| !pass.parts.is_empty()) {
                let part = pass.parts.pop_front()?;
                pass.missing.insert(part.clone());
                return Some(part);
            }
            // What is beyond the end of the picture is wasted.
            let ahead: usize = self.passes.iter().map(|pass| pass.count).sum();
            if self.is_late() || ahead >= AHEAD * self.division.workers.max(1) as usize || !self.plan_pass() {
                return None;
            }
        }
    }

    /// Adds a part that was given out, and the number of rays that it took. A part that comes back twice is ignored, and
    /// one that turned out not to be needed.
    ///
    /// # Errors
    /// When the film is not that part, or comes from another scene or other settings.
    pub fn add(&mut self, part: &Part, film: Film, rays: u64) -> Result<(), FilmError> {
        let Some(pass) = self.passes.iter_mut().find(|pass| pass.missing.contains(part)) else {
            return Ok(());
        };
        let mut covered = Coverage::default();
        covered.insert(part.window, part.samples.clone());
        if film.coverage() != &covered {
            let Range { start, end } = part.samples;
            let what = format!("it should hold the samples {start}..{end} of the pixels {}", part.window);
            return Err(FilmError::NotAFilm { what });
        }
        let kind = |film: &Film| (film.width(), film.height(), film.scale_exponent());
        if film.fingerprint != self.film.fingerprint || kind(&film) != kind(&self.film) {
            return Err(FilmError::OtherPicture);
        }
        match &mut pass.film {
            Some(before) => before.merge(&film)?,
            none => *none = Some(film),
        }
        pass.missing.remove(part);
        self.counters.rays += rays;
        self.complete_passes()
    }

    /// True when there is nothing to wait for.
    pub fn is_done(&self) -> bool {
        self.is_done || self.done > 0 && self.is_late()
    }

    /// The probable number of samples per pixel.
    pub fn expected(&self) -> u32 {
        self.schedule.expected().unwrap_or(self.settings.samples.len() as u32)
    }

    /// All samples so far. The coverage of the film says which.
    ///
    /// # Errors
    /// When memory is short.
    pub fn so_far(&self) -> Result<Film, FilmError> {
        let mut film = self.film.clone();
        self.passes.iter().filter_map(|pass| pass.film.as_ref()).try_for_each(|more| film.merge(more))?;
        Ok(film)
    }

    /// The picture; if it is not done, with all samples so far.
    ///
    /// # Errors
    /// When memory is short.
    pub fn finish(mut self) -> Result<Rendered, FilmError> {
        let cancelled = !self.is_done();
        let mut film = self.so_far()?;
        if !cancelled {
            film.fingerprint.clear();
        }
        if !cancelled && !self.is_done {
            // Late, with parts of further passes. Each is a range of samples of the whole film.
            let all: u32 = film.coverage().pieces().iter().map(|(_, samples)| samples.len() as u32).sum();
            if all > self.done {
                self.schedule.look(&film, &(self.done..all));
            }
        }
        let (reached, batch_means) = self.schedule.end(Some(&film).filter(|_| !cancelled));
        let counters = self.counters;
        Ok(Rendered {
            film,
            counters,
            cancelled,
            cut_short: false,
            spacing: None,
            planning: Duration::ZERO,
            choice: None,
            reached,
            interval: None,
            batch_means,
        })
    }

    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Plans one more pass, if there may be one.
    fn plan_pass(&mut self) -> bool {
        let Some(samples) = self.ahead.next() else { return false };
        self.ahead.assume(&samples);
        let parts = self.divide(&samples);
        let count = parts.len();
        self.passes.push_back(Pass { samples, count, parts, missing: HashSet::new(), film: None });
        true
    }

    /// Looks at the passes that are complete, and decides whether there are more.
    fn complete_passes(&mut self) -> Result<(), FilmError> {
        let is_complete = |pass: &mut Pass| pass.parts.is_empty() && pass.missing.is_empty();
        while let Some(pass) = self.passes.pop_front_if(is_complete) {
            if let Some(film) = pass.film {
                self.film.merge(&film)?;
            }
            self.done = pass.samples.end;
            self.schedule.look(&self.film, &pass.samples);
            if self.schedule.next().is_none() {
                self.is_done = true;
                self.passes.clear();
            } else if self.passes.is_empty() {
                self.plan_pass();
            }
        }
        Ok(())
    }

    /// Divides a pass. If it is the only one, each part is a share of what is left, so that the last ones are small and
    /// all workers end at about the same time [Polychronopoulos 1987]. If there are few samples, parts are windows too.
    fn divide(&self, samples: &Range<u32>) -> VecDeque<Part> {
        let workers = self.division.workers.clamp(1, MAX_WORKERS);
        let is_single = self.schedule.is_single_pass();
        let count = samples.len() as u32;
        let whole = Window::whole(self.settings.width, self.settings.height);
        let may_crop = is_single && self.division.may_crop;
        let bands = if may_crop { (PARTS * workers).div_ceil(count) } else { 1 };
        let rows = whole.height.div_ceil(bands.clamp(1, (whole.height / MIN_ROWS).max(1)));
        let windows: Vec<Window> = (0..whole.height.div_ceil(rows))
            .map(|band| Window { y: band * rows, height: rows.min(whole.height - band * rows), ..whole })
            .collect();
        let most = MOST.saturating_mul(self.division.threads.max(1) as usize) / windows[0].pixels().max(1);
        let most = u32::try_from(most).unwrap_or(u32::MAX).max(1);
        let mut parts = VecDeque::new();
        let mut start = samples.start;
        while start < samples.end {
            let share = match is_single {
                // The first parts are small, so that there is soon a picture to look at.
                true => (samples.end - start).div_ceil(2 * workers).min((start - samples.start).max(1)),
                false => count.div_ceil(workers),
            };
            let samples = start..(start + share.min(most)).min(samples.end);
            start = samples.end;
            parts.extend(windows.iter().map(|&window| Part { samples: samples.clone(), window }));
        }
        parts
    }
}
