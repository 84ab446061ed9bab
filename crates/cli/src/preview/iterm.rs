//! The inline images of iTerm2, which WezTerm and others understand too: a whole PNG.

use super::protocol::Protocol;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bilux::pictures::formats::write_bytes;
use bilux::pictures::{Picture, WriteOptions};

pub(super) const ENTRY: Protocol = Protocol {
    name: "iterm",
    cell: [8, 16],
    detect: |terminal| ["iTerm", "WezTerm", "mintty"].iter().any(|name| terminal.program.contains(name)),
    draw,
};

fn draw(picture: &Picture, options: &WriteOptions, [columns, rows]: [u32; 2]) -> anyhow::Result<Vec<u8>> {
    let png = write_bytes("png", picture, options)?;
    let head = format!(
        "\x1b]1337;File=inline=1;size={};width={columns};height={rows};preserveAspectRatio=1;doNotMoveCursor=1:",
        png.len()
    );
    Ok([head.as_bytes(), STANDARD.encode(png).as_bytes(), b"\x07"].concat())
}
