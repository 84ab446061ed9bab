//! `--preview`: the picture in the terminal while it is rendered.

mod blocks;
mod iterm;
mod kitty;
mod protocol;
mod sixel;

use crate::process::interrupt::Interrupt;
use crate::process::output;
use bilux::checkpoint::CheckpointWriter;
use bilux::math::Rgb;
use bilux::pictures::{Picture, WriteOptions};
use bilux::transport::{Film, Observer, Standing};
use bilux::{Job, Outcome};
use indicatif::ProgressBar;
use protocol::{Environment, Protocol};
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// All protocols; the first that is detected is taken. Blocks are last: every terminal has them.
static PROTOCOLS: &[Protocol] = &[kitty::ENTRY, iterm::ENTRY, sixel::ENTRY, blocks::ENTRY];

/// Protocol that `--preview` asks for.
#[derive(Clone, Copy)]
pub enum PreviewChoice {
    /// The protocol that the terminal understands.
    Auto,
    /// This protocol.
    Named(&'static Protocol),
}

impl PreviewChoice {
    pub fn parse(text: &str) -> Result<PreviewChoice, String> {
        if text == "auto" {
            return Ok(PreviewChoice::Auto);
        }
        let row = PROTOCOLS.iter().find(|row| row.name == text).map(PreviewChoice::Named);
        row.ok_or_else(|| "write auto, blocks, kitty, iterm or sixel".to_owned())
    }

    /// The protocol; `None` if there is no terminal.
    fn protocol(self, environment: &Environment, is_terminal: bool) -> Option<&'static Protocol> {
        match self {
            PreviewChoice::Named(protocol) => Some(protocol),
            PreviewChoice::Auto if !is_terminal => None,
            PreviewChoice::Auto if environment.is_multiplexer() => PROTOCOLS.last(),
            PreviewChoice::Auto => PROTOCOLS.iter().find(|row| (row.detect)(environment)),
        }
    }
}

/// The time between two pictures.
const EVERY: Duration = Duration::from_millis(500);
/// The size of a terminal that does not say it: columns and rows.
const USUAL: [u32; 2] = [80, 24];
/// The rows that are left for the progress bar and what was there before.
const SPARED: u32 = 3;
/// The maximum number of samples of a source pixel's rows and columns in a mean: the film must not be held for long.
const MOST: u32 = 3;

/// Shows the film of a render from time to time. A thread of its own draws, since terminals may be slow.
pub struct Preview {
    begun: Instant,
    next: AtomicU64,
    limits: [u32; 2],
    sender: Option<SyncSender<Picture>>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Preview {
    /// Begins to show the film of a job, above a bar if there is one; `None` if there is no terminal, which is said.
    pub fn begin(
        choice: PreviewChoice,
        job: &Job,
        bar: Option<ProgressBar>,
    ) -> anyhow::Result<Option<Preview>> {
        let is_terminal = output::is_capable_terminal();
        let Some(protocol) = choice.protocol(&Environment::read(), is_terminal) else {
            output::warning(
                "--preview: standard error is no terminal, so there is no preview: leave it out, or name a protocol, such \
                 as --preview=blocks",
            );
            return Ok(None);
        };
        let [columns, rows] = terminal_size();
        let cells = [columns, rows.saturating_sub(SPARED).max(1)];
        let limits = [cells[0] * protocol.cell[0], cells[1] * protocol.cell[1]];
        let options = job.write_options()?;
        let is_automatic = job.settings().auto_exposure;
        let (sender, receiver) = sync_channel::<Picture>(1);
        let thread = std::thread::Builder::new().name("preview".to_owned()).spawn(move || {
            let mut screen = Screen { protocol, bar, rows: None };
            while let Ok(picture) = receiver.recv() {
                let mut options = options;
                if is_automatic {
                    options.exposure += bilux::pictures::auto_exposure(&picture);
                }
                // A preview that fails must not end the render.
                if screen.draw(&picture, &options).is_err() {
                    return;
                }
            }
        })?;
        let (begun, next) = (Instant::now(), AtomicU64::new(0));
        Ok(Some(Preview { begun, next, limits, sender: Some(sender), thread: Mutex::new(Some(thread)) }))
    }

    /// Shows the film as it is in the end.
    pub fn finish(mut self, outcome: &Outcome) {
        if let (Some(sender), Some(picture)) = (self.sender.take(), self.shrunk(&outcome.rendered.film)) {
            // The thread ends when it has drawn this one.
            let _ = sender.send(picture);
        }
        if let Some(thread) = self.thread.lock().ok().and_then(|mut thread| thread.take()) {
            let _ = thread.join();
        }
    }

    /// The film's window, as large as the terminal allows, and never larger than it is.
    fn shrunk(&self, film: &Film) -> Option<Picture> {
        let window = film.window();
        let scale = (0..2).map(|i| self.limits[i] as f32 / [window.width, window.height][i] as f32);
        let scale = scale.fold(1.0, f32::min);
        let [width, height] =
            [window.width, window.height].map(|side| ((side as f32 * scale) as u32).clamp(1, side));
        let mut pixels = Vec::with_capacity((width * height) as usize);
        let places = |at: u32, sides: u32, side: u32| {
            let (from, to) = (at * side / sides, ((at + 1) * side / sides).max(at * side / sides + 1));
            (from..to).step_by((to - from).div_ceil(MOST) as usize)
        };
        for y in 0..height {
            for x in 0..width {
                // The first samples may be spread, with others between that come later.
                let (mut sum, mut count) = (Rgb::BLACK, 0.0);
                for row in places(y, height, window.height) {
                    for column in places(x, width, window.width) {
                        let (column, row) = (window.x + column, window.y + row);
                        if film.samples(column, row) == 0 {
                            continue;
                        }
                        let light = film.pixel(column, row);
                        sum += if light.is_finite() { light } else { Rgb::BLACK };
                        count += 1.0;
                    }
                }
                pixels.push(sum * (1.0 / f32::max(count, 1.0)));
            }
        }
        Picture::from_rgb(width as usize, height as usize, pixels).ok()
    }
}

/// Place of the picture in the terminal, and how it is drawn there.
struct Screen {
    protocol: &'static Protocol,
    bar: Option<ProgressBar>,
    /// The rows of the picture that is there, above the cursor.
    rows: Option<u32>,
}

impl Screen {
    fn draw(&mut self, picture: &Picture, options: &WriteOptions) -> anyhow::Result<()> {
        let (width, height) = (picture.width() as u32, picture.height() as u32);
        let [across, down] = self.protocol.cell;
        let (columns, rows) = (width.div_ceil(across), height.div_ceil(down));
        let drawn = (self.protocol.draw)(picture, options, [columns, rows])?;
        // Room is made below, and the cursor goes back up, so that the picture never scrolls while it is drawn.
        let mut text = Vec::new();
        match self.rows {
            Some(rows) => write!(text, "\x1b[{rows}A")?,
            None => write!(text, "{}\x1b[{rows}A", "\n".repeat(rows as usize))?,
        }
        text.extend_from_slice(b"\r\x1b7");
        text.extend_from_slice(&drawn);
        write!(text, "\x1b8\x1b[{rows}B\r")?;
        self.rows = Some(rows);
        let show = || {
            let mut terminal = std::io::stderr().lock();
            terminal.write_all(&text).and_then(|()| terminal.flush())
        };
        Ok(match &self.bar {
            Some(bar) => bar.suspend(show),
            None => show(),
        }?)
    }
}

/// Columns and rows of the terminal.
fn terminal_size() -> [u32; 2] {
    let of_terminal = terminal_size::terminal_size_of(std::io::stderr());
    let size = of_terminal.map(|(columns, rows)| [u32::from(columns.0), u32::from(rows.0)]);
    size.filter(|size| size.iter().all(|side| *side > 1)).unwrap_or(USUAL)
}

/// Observers of the film while it is rendered.
pub struct Observers<'a, 'j> {
    pub writer: Option<&'a CheckpointWriter<'j>>,
    pub preview: Option<&'a Preview>,
    /// The interrupt that may end the render, if it then leaves no checkpoint.
    pub ends: Option<&'a Interrupt>,
}

impl Observer for Observers<'_, '_> {
    fn wants_checkpoint(&self) -> bool {
        self.writer.is_some_and(CheckpointWriter::wants_checkpoint)
    }

    fn keep(&self, standing: &Standing) {
        if let (Some(writer), false) = (self.writer, self.ends.is_some_and(Interrupt::is_terminated)) {
            writer.keep(standing);
        }
    }

    fn wants_film(&self) -> bool {
        let is_due = |preview: &Preview| {
            preview.begun.elapsed().as_nanos() >= u128::from(preview.next.load(Ordering::Relaxed))
        };
        self.preview.is_some_and(is_due)
    }

    fn show(&self, film: &Film) {
        let Some(preview) = self.preview else { return };
        let next = preview.begun.elapsed() + EVERY;
        preview.next.store(u64::try_from(next.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
        let (Some(sender), Some(picture)) = (&preview.sender, preview.shrunk(film)) else { return };
        // A terminal that is slower than this sees fewer pictures.
        if let Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) = sender.try_send(picture) {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment(term: &str, program: &str) -> Environment {
        Environment { term: term.to_owned(), program: program.to_owned(), has_kitty_window: false }
    }

    #[test]
    fn the_protocol_is_that_of_the_terminal() {
        let found = |term: &str, program: &str| {
            PreviewChoice::Auto.protocol(&environment(term, program), true).map(|row| row.name)
        };
        assert_eq!(found("xterm-kitty", ""), Some("kitty"));
        assert_eq!(found("xterm-256color", "ghostty"), Some("kitty"));
        assert_eq!(found("xterm-256color", "iTerm.app"), Some("iterm"));
        assert_eq!(found("foot", ""), Some("sixel"));
        assert_eq!(found("xterm-256color", ""), Some("blocks"));
        assert_eq!(found("tmux-256color", "iTerm.app"), Some("blocks"), "a multiplexer passes on text only");
        let nowhere = environment("dumb", "");
        assert!(PreviewChoice::Auto.protocol(&nowhere, false).is_none());
        let named = PreviewChoice::parse("sixel").unwrap().protocol(&nowhere, false);
        assert_eq!(named.map(|row| row.name), Some("sixel"));
        assert!(PreviewChoice::parse("sixels").is_err());
    }

    #[test]
    fn every_protocol_draws_every_size() {
        for protocol in PROTOCOLS {
            for (width, height) in [(1, 1), (2, 3), (7, 13), (16, 12)] {
                let pixels = (0..width * height).map(|i| Rgb::grey(i as f32 / 50.0)).collect();
                let picture = Picture::from_rgb(width, height, pixels).unwrap();
                let drawn = (protocol.draw)(&picture, &WriteOptions::default(), [2, 2]).unwrap();
                assert!(drawn.contains(&0x1b), "{}", protocol.name);
            }
        }
    }
}
