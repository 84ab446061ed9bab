//! What is printed: results on standard output, everything else on standard error.

use bilux::formats::FormatError;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};

/// Why a result could not be printed.
#[derive(Debug)]
pub struct Unprinted(pub io::Error);

impl std::fmt::Display for Unprinted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "standard output: cannot write to it: {}", self.0)
    }
}

impl std::error::Error for Unprinted {}

/// Prints a result and the end of its line.
///
/// # Errors
/// When not all of it could be written; see [`is_closed_pipe`].
pub fn print(text: impl Display) -> anyhow::Result<()> {
    print_bytes(format!("{text}\n").as_bytes())
}

/// Writes bytes to standard output.
///
/// # Errors
/// As [`print()`].
pub fn print_bytes(bytes: &[u8]) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
    Ok(written.map_err(Unprinted)?)
}

/// True when whoever reads standard output has gone away, as `head` does: no fault that anybody has to hear of.
pub fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let unprinted = error.chain().find_map(|cause| cause.downcast_ref::<Unprinted>());
    unprinted.is_some_and(|unprinted| unprinted.0.kind() == io::ErrorKind::BrokenPipe)
}

/// Says something on standard error.
pub fn say(text: impl Display) {
    // Where standard error is closed there is nobody to tell.
    let _ = writeln!(io::stderr(), "{text}");
}

/// Says what is odd, but does not stop the work.
pub fn warning(text: impl Display) {
    say(format_args!("{}: {text}", painted("warning", "33")));
}

/// Says why the work failed.
pub fn error(error: &anyhow::Error) {
    say(format_args!("{}: {}", painted("error", "31"), message(error)));
}

/// An error with its causes, each said once: libraries' messages mostly end with their cause's already.
pub fn message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in
        error.chain().map(|cause| without_error_numbers(&cause.to_string())).filter(|cause| !cause.is_empty())
    {
        match text.as_str() {
            "" => text = cause,
            said if said.ends_with(&cause) => {}
            _ => text += &format!(": {cause}"),
        }
    }
    text + &error.chain().find_map(flag_that_helps).unwrap_or_default()
}

/// Leaves out the number that the standard library puts behind what the system says: `(os error 2)`.
fn without_error_numbers(text: &str) -> String {
    let mut parts = text.split(" (os error ");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        plain += part.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-').trim_start_matches(')');
    }
    plain
}

/// The flag by which to allow what the library says has to be allowed.
fn flag_that_helps(cause: &(dyn std::error::Error + 'static)) -> Option<String> {
    Some(match cause.downcast_ref::<bilux::Error>()? {
        bilux::Error::TooLarge { needed, .. } => {
            format!(" (--max-memory {}G)", needed.total().div_ceil(1 << 30))
        }
        bilux::Error::Format(FormatError::TooLarge { .. }) => " (--max-memory 16G)".to_owned(),
        bilux::Error::Format(FormatError::Outside { .. }) => " (--allow-outside)".to_owned(),
        _ => return None,
    })
}

/// Bold and coloured on a terminal, unless `NO_COLOR` is set.
fn painted(word: &str, colour: &str) -> String {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty()) || !io::stderr().is_terminal();
    if plain { word.to_owned() } else { format!("\x1b[1;{colour}m{word}\x1b[0m") }
}
