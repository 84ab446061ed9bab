//! Texts of Part 21. [ISO 10303-21, 6.4.3]

/// A text as people write it: `''` is an apostrophe, `\X2\00E4\X0\` and `\X\E4` are letters by their numbers, `\S\d` is `d` with the
/// highest bit set, and `\\` a backslash. Programs also write UTF-8 and Latin-1 as it is.
pub(super) fn decoded(bytes: &[u8]) -> String {
    let mut out: Vec<u8> = Vec::with_capacity(bytes.len());
    let push = |letter: char, out: &mut Vec<u8>| {
        out.extend(letter.encode_utf8(&mut [0; 4]).bytes());
    };
    let mut rest = bytes;
    while let [first, tail @ ..] = rest {
        rest = tail;
        match (first, tail) {
            (b'\'', [b'\'', tail @ ..]) => {
                out.push(b'\'');
                rest = tail;
            }
            (b'\\', [b'\\', tail @ ..]) => {
                out.push(b'\\');
                rest = tail;
            }
            (b'\\', [b'S', b'\\', letter, tail @ ..]) => {
                push(char::from(letter | 0x80), &mut out);
                rest = tail;
            }
            (b'\\', [b'P', _, b'\\', tail @ ..]) => rest = tail,
            (b'\\', [b'X', b'\\', high, low, tail @ ..]) => {
                if let Some(code) = hexadecimal(&[*high, *low]) {
                    push(char::from(code as u8), &mut out);
                }
                rest = tail;
            }
            (b'\\', [b'X', b'2', b'\\', tail @ ..]) => rest = wide(tail, 4, &mut out),
            (b'\\', [b'X', b'4', b'\\', tail @ ..]) => rest = wide(tail, 8, &mut out),
            // Lines may be broken anywhere.
            (b'\r' | b'\n', _) => {}
            _ => out.push(*first),
        }
    }
    match String::from_utf8(out) {
        Ok(text) => text,
        Err(error) => error.into_bytes().into_iter().map(char::from).collect(),
    }
}

/// Adds letters by their numbers, each of so many digits, up to `\X0\`; returns what follows.
fn wide<'a>(mut text: &'a [u8], digits: usize, out: &mut Vec<u8>) -> &'a [u8] {
    let mut units = Vec::new();
    while let Some(code) = text.get(..digits).and_then(hexadecimal) {
        units.push(code);
        text = &text[digits..];
    }
    let letters: String = match digits {
        4 => char::decode_utf16(units.iter().map(|&unit| unit as u16))
            .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect(),
        _ => units.iter().map(|&code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)).collect(),
    };
    out.extend(letters.bytes());
    text.strip_prefix(br"\X0\").unwrap_or(text)
}

fn hexadecimal(digits: &[u8]) -> Option<u32> {
    let text = std::str::from_utf8(digits).ok().filter(|text| text.bytes().all(|b| b.is_ascii_hexdigit()))?;
    u32::from_str_radix(text, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn every_way_of_writing_a_letter_is_that_letter() {
        for (text, letters) in [
            (&b"it''s"[..], "it's"),
            (br"M\X2\00FC\X0\tze", "Mütze"),
            (br"M\X\FCtze", "Mütze"),
            (br"M\S\|tze", "Mütze"),
            ("Mütze".as_bytes(), "Mütze"),
            (b"M\xfctze", "Mütze"),
            (br"\X2\D83DDE00\X0\!", "😀!"),
            (br"\X4\0001F600\X0\!", "😀!"),
            (br"a\\b\", r"a\b\"),
            (br"\X2\00", "00"),
            (b"bro\r\nken", "broken"),
        ] {
            assert_eq!(decoded(text), letters);
        }
    }
}
