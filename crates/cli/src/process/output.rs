//! Output: results go to standard output, everything else to standard error.

use bilux::formats::FormatError;
use bilux::pictures::PictureError;
use bilux::transport::RenderError;
use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};

/// Why a result could not be printed.
#[derive(Debug)]
pub struct PrintError(pub io::Error);

impl std::fmt::Display for PrintError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "cannot write to standard output: {}", self.0)
    }
}

impl std::error::Error for PrintError {}

/// Prints a result and a newline.
///
/// # Errors
/// If not all of it could be written; see [`is_closed_pipe`].
pub fn print(text: impl Display) -> anyhow::Result<()> {
    print_bytes(format!("{}\n", harmless(&text.to_string())).as_bytes())
}

/// A text whose control characters are written out, all but the ends of lines and tabs: names in files of strangers may hold some that
/// change the title of a terminal, or what stands on it.
fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_harmful(c) { c.escape_unicode().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Writes bytes to standard output.
///
/// # Errors
/// As [`print()`].
pub fn print_bytes(bytes: &[u8]) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
    Ok(written.map_err(PrintError)?)
}

/// True if the reader of standard output has gone away, as `head` does. That is not an error that needs a message.
pub fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let print_error = error.chain().find_map(|cause| cause.downcast_ref::<PrintError>());
    print_error.is_some_and(|print_error| print_error.0.kind() == io::ErrorKind::BrokenPipe)
}

/// A number with its noun: `1 sample`, `2 samples`.
pub fn counted<N: Display + PartialEq + From<u8>>(number: N, one: &str, many: &str) -> String {
    let noun = if number == N::from(1) { one } else { many };
    format!("{number} {noun}")
}

/// Prints a line to standard error.
pub fn eprint(text: impl Display) {
    eprint_after("", text);
}

/// Prints a line to standard error after a word of our own, which may be in colour.
fn eprint_after(word: &str, text: impl Display) {
    // If standard error is closed, there is nowhere to report it.
    let _ = writeln!(io::stderr(), "{word}{}", harmless(&text.to_string()));
}

/// Prints a warning: something is odd, but the work goes on.
pub fn warning(text: impl Display) {
    eprint_after(&format!("{}: ", painted("warning", "33")), text);
}

/// Prints why the work failed.
pub fn error(error: &anyhow::Error) {
    eprint_after(&format!("{}: ", painted("error", "31")), message(error));
}

/// An error with its causes, each mentioned once: most libraries' messages already end with their cause's message.
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
    text + &error.chain().find_map(suggested_flag).unwrap_or_default()
}

/// An error of a library as text.
pub fn error_text(error: &dyn Display) -> String {
    without_error_numbers(&error.to_string())
}

/// Removes the error number that the standard library appends to the system's messages: `(os error 2)`.
fn without_error_numbers(text: &str) -> String {
    let mut parts = text.split(" (os error ");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        plain += part.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-').trim_start_matches(')');
    }
    plain
}

/// The flag that allows what the library refused.
fn suggested_flag(cause: &(dyn std::error::Error + 'static)) -> Option<String> {
    if let Some(needed) = cause.downcast_ref::<PictureError>().and_then(PictureError::bytes_needed) {
        return allowing(needed);
    }
    let error = cause.downcast_ref::<bilux::Error>()?;
    let is_too_large = matches!(
        error,
        bilux::Error::TooLarge { .. }
            | bilux::Error::Format(FormatError::TooLarge { .. })
            | bilux::Error::Render(RenderError::Threads { .. })
    );
    if let (true, Some(source)) = (is_too_large, crate::process::memory::tighter()) {
        return Some(format!(" ({source} is the limit)"));
    }
    if let Some(bytes) = error.memory_to_allow() {
        let whole = bytes.is_multiple_of(1 << 30);
        let amount = if whole { format!("{}G", bytes >> 30) } else { format!("{}M", bytes >> 20) };
        return Some(format!(" (--max-memory {amount})"));
    }
    Some(match error {
        bilux::Error::Format(FormatError::Outside { .. }) => " (--allow-outside)".to_owned(),
        _ => return None,
    })
}

/// The flag that allows so many bytes for a picture, whose limit may be a part of that of all.
fn allowing([needed, limit]: [u64; 2]) -> Option<String> {
    let parts = crate::process::memory::allowed().checked_div(limit)?.max(1);
    let bytes = needed.checked_mul(parts).filter(|bytes| *bytes < 1 << 44)?;
    Some(match bytes {
        0..0x4000_0000 => format!(" (--max-memory {}M)", bytes.div_ceil(1 << 20)),
        _ => format!(" (--max-memory {}G)", bytes.div_ceil(1 << 30)),
    })
}

/// True if standard error is a terminal that moves its cursor and has colours, which one that calls itself dumb does not.
pub fn is_capable_terminal() -> bool {
    io::stderr().is_terminal() && !calls_itself_dumb()
}

/// True if the terminal says that it knows no codes for colours.
pub fn calls_itself_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Bold and coloured on a terminal, unless `NO_COLOR` is set.
fn painted(word: &str, colour: &str) -> String {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty()) || !is_capable_terminal();
    if plain { word.to_owned() } else { format!("\x1b[1;{colour}m{word}\x1b[0m") }
}
