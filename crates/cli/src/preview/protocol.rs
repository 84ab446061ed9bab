//! A way of showing pictures in a terminal, and what terminals say of themselves.

use anyhow::bail;
use bilux::pictures::formats::{BitDepth, write_bytes};
use bilux::pictures::{Picture, WriteOptions};

/// A way of showing pictures in a terminal.
pub struct Protocol {
    pub name: &'static str,
    /// Pixels across and down in one character cell, as far as the protocol is concerned.
    pub(super) cell: [u32; 2],
    /// True if the environment says that the terminal understands it.
    pub(super) detect: fn(&Environment) -> bool,
    /// Bytes that show a picture in so many columns and rows, from the place of the cursor on, which may end anywhere.
    pub(super) draw: fn(&Picture, &WriteOptions, [u32; 2]) -> anyhow::Result<Vec<u8>>,
}

/// Variables by which terminals say what they are.
pub(super) struct Environment {
    pub(super) term: String,
    pub(super) program: String,
    pub(super) has_kitty_window: bool,
}

impl Environment {
    pub(super) fn read() -> Environment {
        let text = |name: &str| std::env::var(name).unwrap_or_default();
        let program = [text("TERM_PROGRAM"), text("LC_TERMINAL")].join(" ");
        let has_kitty_window = std::env::var_os("KITTY_WINDOW_ID").is_some();
        Environment { term: text("TERM"), program, has_kitty_window }
    }

    /// Multiplexers pass on text only.
    pub(super) fn is_multiplexer(&self) -> bool {
        ["tmux", "screen"].iter().any(|name| self.term.starts_with(name) || self.program.contains(name))
    }
}

/// The colours of a picture as a display shows them, three bytes a pixel, row by row.
pub(super) fn display_bytes(picture: &Picture, options: &WriteOptions) -> anyhow::Result<Vec<u8>> {
    let options = WriteOptions { bit_depth: BitDepth::Eight, ..*options };
    let file = write_bytes("ppm", picture, &options)?;
    let Some(start) = file.len().checked_sub(3 * picture.width() * picture.height()) else {
        bail!("a preview could not be made");
    };
    Ok(file[start..].to_vec())
}
