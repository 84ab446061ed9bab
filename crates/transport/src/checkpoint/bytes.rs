//! Checkpoints as bytes.

use super::{Begun, Checkpoint, OpenPass, Standing};
use crate::film::bytes::{Rest, put_counts, put_sums};
use crate::film::error::FilmError;
use crate::film::failures::PixelFailures;
use crate::film::interval::Interval;
use crate::film::limits::MAX_SIDE;
use crate::film::window::Tiling;
use crate::film::{Film, MAX_SAMPLES, zeroed};
use crate::sampling::splats::Iterations;
use crate::schedule::ScheduleMemory;
use bilux_accel::Counters;
use std::io::{self, Write};
use std::ops::Range;
use std::time::Duration;

/// First bytes of a checkpoint, with the version of its form.
const MAGIC: &[u8; 12] = b"bilux pass 1";

/// Beside the side of tiles: they are of lattices that are spread over the film.
const SPREAD: u32 = 1 << 31;

/// More passes are never open at a time, nor complete since the schedule has last looked.
const MAX_PASSES: usize = 1 << 20;

impl Standing<'_> {
    /// Writes a checkpoint. Nothing in these bytes shows whether they are damaged: that is for the caller to add.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Counters { rays, nodes, triangles, early_outs, culled_back_faces } = self.counters;
        let nanoseconds = u64::try_from(self.rendering.as_nanos()).unwrap_or(u64::MAX);
        let mut head = MAGIC.to_vec();
        for number in [nanoseconds, rays, nodes, triangles, early_outs, culled_back_faces] {
            head.extend_from_slice(&number.to_le_bytes());
        }
        section(out, &head)?;
        section(out, &self.film.to_bytes())?;
        section(out, &self.before.map(Film::to_bytes).unwrap_or_default())?;
        section(out, &written(|bytes| self.interval.iter().for_each(|interval| interval.put(bytes))))?;
        section(out, &written(|bytes| self.schedule.put(bytes)))?;
        section(out, &written(|bytes| self.begun.put(bytes)))
    }
}

impl Checkpoint {
    /// The checkpoint of these bytes.
    ///
    /// # Errors
    /// When they are not those of a checkpoint of this version, or state impossible values.
    pub fn from_bytes(bytes: &[u8]) -> Result<Checkpoint, FilmError> {
        let mut rest = Rest(bytes);
        let mut head = Rest(next_section(&mut rest)?);
        if head.take(MAGIC.len())? != MAGIC {
            return Err(damaged("it was not made by this version of Bilux"));
        }
        let mut numbers = [0; 6];
        for number in &mut numbers {
            let [low, high] = head.numbers()?;
            *number = u64::from(high) << 32 | u64::from(low);
        }
        let [nanoseconds, rays, nodes, triangles, early_outs, culled_back_faces] = numbers;
        let film = Film::from_bytes(next_section(&mut rest)?)?;
        let (window, pixels) = (film.window(), film.window().pixels());
        let before = Some(next_section(&mut rest)?).filter(|bytes| !bytes.is_empty());
        let before = before.map(Film::from_bytes).transpose()?;
        let interval = Some(next_section(&mut rest)?).filter(|bytes| !bytes.is_empty());
        let interval = interval.map(|bytes| Interval::read(&mut Rest(bytes), window)).transpose()?;
        let memory = ScheduleMemory::read(&mut Rest(next_section(&mut rest)?), pixels)?;
        let begun = Begun::read(&mut Rest(next_section(&mut rest)?), pixels)?;
        if !rest.0.is_empty() {
            return Err(damaged("more follows than belongs to it"));
        }
        let counters = Counters { rays, nodes, triangles, early_outs, culled_back_faces };
        let rendering = Duration::from_nanos(nanoseconds);
        Ok(Checkpoint { film, before, interval, begun, memory, counters, rendering })
    }
}

impl Begun {
    fn put(&self, bytes: &mut Vec<u8>) {
        let side = match self.tiling {
            Tiling::Squares(side) => side,
            Tiling::Spread(side) => side | SPREAD,
        };
        let lengths = [side, self.complete.len() as u32, self.open.len() as u32];
        put_counts(bytes, &lengths);
        self.complete.iter().for_each(|samples| put_counts(bytes, &[samples.start, samples.end]));
        for OpenPass { samples, done, splats } in &self.open {
            let has_splats = u32::from(splats.is_some());
            put_counts(bytes, &[samples.start, samples.end, done.len() as u32, has_splats]);
            bytes.extend(done.iter().map(|&done| u8::from(done)));
            if let Some(Iterations { sums, failures, .. }) = splats {
                put_sums(bytes, sums);
                put_failures(bytes, failures);
            }
        }
        put_counts(bytes, &[u32::from(self.splatted.is_some())]);
        self.splatted.iter().for_each(|failures| put_failures(bytes, failures));
    }

    fn read(rest: &mut Rest, pixels: usize) -> Result<Begun, FilmError> {
        let [side, complete, open] = rest.numbers()?;
        let is_spread = side & SPREAD > 0;
        let side = side & !SPREAD;
        let tiling = if is_spread { Tiling::Spread(side) } else { Tiling::Squares(side) };
        if !(1..=MAX_SIDE).contains(&side) || (complete as usize).max(open as usize) > MAX_PASSES {
            return Err(damaged("its passes are invalid"));
        }
        let range = |[start, end]: [u32; 2]| match start < end && end <= MAX_SAMPLES {
            true => Ok(start..end),
            false => Err(damaged("its passes are invalid")),
        };
        let complete =
            (0..complete).map(|_| range(rest.numbers()?)).collect::<Result<Vec<Range<u32>>, _>>()?;
        let mut passes = Vec::new();
        for _ in 0..open {
            let [start, end, tiles, has_splats] = rest.numbers()?;
            let done: Vec<bool> = rest.take(tiles as usize)?.iter().map(|&byte| byte == 1).collect();
            let splats = match has_splats {
                1 => {
                    let mut sums = zeroed(pixels)?;
                    rest.sums(&mut sums)?;
                    let tiles_left = done.iter().filter(|done| !**done).count();
                    Some(Iterations { sums, failures: read_failures(rest)?, tiles_left })
                }
                _ => None,
            };
            passes.push(OpenPass { samples: range([start, end])?, done, splats });
        }
        let [is_splatted] = rest.numbers()?;
        let splatted = (is_splatted == 1).then(|| read_failures(rest)).transpose()?;
        Ok(Begun { tiling, complete, open: passes, splatted })
    }
}

fn put_failures(bytes: &mut Vec<u8>, failures: &[(u32, PixelFailures)]) {
    put_counts(bytes, &[failures.len() as u32]);
    for (index, failures) in failures {
        put_counts(bytes, &[*index]);
        put_counts(bytes, &failures.to_array());
    }
}

fn read_failures(rest: &mut Rest) -> Result<Vec<(u32, PixelFailures)>, FilmError> {
    let [count] = rest.numbers()?;
    let one = |rest: &mut Rest| {
        let [index] = rest.numbers()?;
        Ok((index, PixelFailures::from_array(rest.numbers()?)))
    };
    (0..count).map(|_| one(rest)).collect()
}

fn written(put: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = Vec::new();
    put(&mut bytes);
    bytes
}

/// Writes bytes after their number.
fn section(out: &mut dyn Write, bytes: &[u8]) -> io::Result<()> {
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(bytes)
}

fn next_section<'a>(rest: &mut Rest<'a>) -> Result<&'a [u8], FilmError> {
    let [low, high] = rest.numbers()?;
    let length = u64::from(high) << 32 | u64::from(low);
    rest.take(usize::try_from(length).unwrap_or(usize::MAX))
}

fn damaged(what: &str) -> FilmError {
    FilmError::NotAFilm { what: what.to_owned() }
}
