//! What is said: results on standard output, everything else on standard error.

use bilux::formats::FormatError;
use std::fmt::Display;
use std::io::{IsTerminal, Write};

/// Prints a result and a line's end. A reader that has gone away ends the program quietly.
pub fn print(text: impl Display) {
    if writeln!(std::io::stdout(), "{text}").is_err() {
        std::process::exit(0);
    }
}

/// Writes bytes to standard output, under the same rule.
pub fn print_bytes(bytes: &[u8]) {
    let mut stdout = std::io::stdout().lock();
    if stdout.write_all(bytes).and_then(|()| stdout.flush()).is_err() {
        std::process::exit(0);
    }
}

/// Says something on standard error.
pub fn say(text: impl Display) {
    // Where standard error is closed there is nobody to tell.
    let _ = writeln!(std::io::stderr(), "{text}");
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
    for cause in error.chain().map(ToString::to_string).filter(|cause| !cause.is_empty()) {
        match text.as_str() {
            "" => text = cause,
            said if said.ends_with(&cause) => {}
            _ => text += &format!(": {cause}"),
        }
    }
    text + &error.chain().find_map(flag_that_helps).unwrap_or_default()
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
    let plain =
        std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty()) || !std::io::stderr().is_terminal();
    if plain { word.to_owned() } else { format!("\x1b[1;{colour}m{word}\x1b[0m") }
}
