//! The graphics protocol of kitty, which some other terminals understand too: a PNG in pieces.

use super::protocol::Protocol;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bilux::pictures::formats::write_bytes;
use bilux::pictures::{Picture, WriteOptions};
use std::io::Write;

pub(super) const ENTRY: Protocol = Protocol {
    name: "kitty",
    cell: [8, 16],
    detect: |terminal| {
        terminal.has_kitty_window
            || terminal.term.contains("kitty")
            || terminal.term.contains("ghostty")
            || terminal.program.contains("ghostty")
    },
    draw,
};

/// The longest piece that the protocol allows.
const PIECE: usize = 4096;

fn draw(picture: &Picture, options: &WriteOptions, [columns, rows]: [u32; 2]) -> anyhow::Result<Vec<u8>> {
    let coded = STANDARD.encode(write_bytes("png", picture, options)?);
    let mut text = Vec::new();
    let pieces: Vec<&[u8]> = coded.as_bytes().chunks(PIECE).collect();
    for (i, piece) in pieces.iter().enumerate() {
        let more = u8::from(i + 1 < pieces.len());
        // The same image and placement again replace what is there; the cursor stays.
        let what =
            if i == 0 { format!("a=T,f=100,i=1,p=1,q=2,C=1,c={columns},r={rows},") } else { String::new() };
        write!(text, "\x1b_G{what}m={more};")?;
        text.extend_from_slice(piece);
        text.extend_from_slice(b"\x1b\\");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::Rgb;

    #[test]
    fn the_pieces_together_are_a_png() {
        let noise =
            (0..6400u64).map(|i| Rgb::grey(bilux::math::hash::hash_words([i]) as f32 / u64::MAX as f32));
        let picture = Picture::from_rgb(80, 80, noise.collect()).unwrap();
        let text = String::from_utf8(draw(&picture, &WriteOptions::default(), [10, 5]).unwrap()).unwrap();
        let pieces: Vec<(&str, &str)> =
            text.split("\x1b\\").filter_map(|piece| piece.strip_prefix("\x1b_G")?.split_once(';')).collect();
        assert!(pieces.len() > 1);
        assert!(pieces[0].0.contains("c=10,r=5,m=1"), "{}", pieces[0].0);
        assert_eq!(pieces.last().unwrap().0, "m=0");
        let coded: String = pieces.iter().map(|(_, piece)| *piece).collect();
        assert_eq!(
            STANDARD.decode(coded).unwrap(),
            write_bytes("png", &picture, &WriteOptions::default()).unwrap()
        );
    }
}
