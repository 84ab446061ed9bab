//! The options of renders that last, or that are watched.

use crate::arguments::help;
use crate::arguments::values::parse_duration;
use crate::preview::PreviewChoice;
use clap::Args;
use std::time::Duration;

/// How a render is kept, continued, repeated and shown.
#[derive(Args)]
pub struct Lasting {
    /// Save a checkpoint for --resume to OUT.checkpoint every SECONDS, and at Ctrl-C; off saves none [default: 60]
    #[arg(long, value_name = "SECONDS|off", allow_hyphen_values = true, value_parser = parse_checkpoint, help_heading = help::SPEED)]
    pub checkpoint: Option<Checkpoints>,
    /// Resume a render that was interrupted or killed; the picture has the same bytes as without the interruption
    #[arg(long, help_heading = help::SPEED)]
    pub resume: bool,
    /// Render again whenever the scene file, or a file that it refers to, changes; Ctrl-C ends this
    #[arg(long, conflicts_with_all = ["resume", "checkpoint", "frames", "turntable", "replay"], help_heading = help::OUTPUT)]
    pub watch: bool,
    /// Show the picture in the terminal while it renders, as coloured blocks or with the terminal's graphics protocol
    #[arg(long, value_name = "auto|blocks|kitty|iterm|sixel", num_args = 0..=1, default_missing_value = "auto",
        require_equals = true, value_parser = PreviewChoice::parse, help_heading = help::OUTPUT)]
    pub preview: Option<PreviewChoice>,
}

/// When checkpoints are saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checkpoints {
    /// Never.
    Off,
    /// Each time that this has passed.
    Every(Duration),
}

/// Checkpoints if nothing is said of them.
const DEFAULT: Checkpoints = Checkpoints::Every(Duration::from_secs(60));

impl Lasting {
    /// True if the command line speaks of checkpoints; otherwise they are only for a process that is killed, and for Ctrl-C.
    pub fn is_asked(&self) -> bool {
        self.resume || self.checkpoint.is_some()
    }

    /// When checkpoints are saved.
    pub fn checkpoints(&self) -> Checkpoints {
        if self.watch { Checkpoints::Off } else { self.checkpoint.unwrap_or(DEFAULT) }
    }
}

fn parse_checkpoint(text: &str) -> Result<Checkpoints, String> {
    if text == "off" {
        return Ok(Checkpoints::Off);
    }
    let advice = |_| "write a number of seconds above 0, such as 60, or off".to_owned();
    parse_duration(text).map(Checkpoints::Every).map_err(advice)
}
