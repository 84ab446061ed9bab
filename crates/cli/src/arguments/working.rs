//! The options of `bilux worker`.

use crate::arguments::help;
use crate::arguments::values::parse_duration;
use clap::Args;
use std::time::Duration;

/// Render a stream of jobs in one process that stays warm
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  \
    echo '{\"scene\": \"pot.glb\", \"output\": \"pot.webp\", \"spp\": 16}' | bilux worker\n  \
    bilux worker --timeout 20 --max-memory 2G --sandbox < jobs.jsonl > results.jsonl\n\n\
    Each line of standard input is a job: a JSON object with \"scene\", \"output\" and other options of `bilux render`, such \
    as \"time_limit\" for --time-limit. Each gives one line of JSON on standard output, in the order of the jobs, with its \
    \"id\", if it has one, \"status\", \"error\", \"warnings\", \"seconds\" and \"pictures\".\n\n\
    Exit status:\n  \
    0         The stream ended; each result has the status of its own job\n  \
    2         The command line is wrong\n  \
    130, 143  Ctrl-C or SIGTERM ended it; the job under way has a result")]
pub struct Worker {
    /// The longest that a job may take; a job may say less. What is rendered by then is saved (status 124)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_duration, help_heading = help::SPEED)]
    pub timeout: Option<Duration>,
    /// Do the jobs of another process of this program, which limits them
    #[arg(long, hide = true)]
    pub warm: bool,
}
