//! Splits a text into blocks of whole lines, so that only the part of a large file that is being read is in
//! memory.

use std::io::{self, Read};

/// Splits a text into blocks.
pub struct Blocks<'r> {
    from: &'r mut dyn Read,
    /// Bytes read beyond the end of the last block.
    rest: Vec<u8>,
    size: usize,
    ended: bool,
    /// Buffers of finished blocks, for reuse.
    spare: Vec<Vec<u8>>,
}

impl<'r> Blocks<'r> {
    /// Creates blocks of about `size` bytes, or longer if a line is longer.
    pub fn new(from: &'r mut dyn Read, size: usize) -> Blocks<'r> {
        Blocks { from, rest: Vec::new(), size: size.max(1), ended: false, spare: Vec::new() }
    }

    /// The next block; `None` at the end.
    ///
    /// Each block ends at the end of a line, except the last one and one of more than `most` bytes, which is cut
    /// there: the caller refuses it anyway.
    pub fn next(&mut self, most: u64) -> io::Result<Option<Vec<u8>>> {
        let mut block = self.spare.pop().unwrap_or_default();
        block.clear();
        block.append(&mut self.rest);
        let mut searched = 0;
        loop {
            // Doubles the read while a line does not end, so that the search stays proportional to the input.
            let wanted = self.size.max(searched);
            self.ended =
                self.ended || (&mut *self.from).take(wanted as u64).read_to_end(&mut block)? < wanted;
            if self.ended {
                return Ok((!block.is_empty()).then_some(block));
            }
            if let Some(end) = last_end(&block, searched) {
                self.rest.extend_from_slice(&block[end..]);
                block.truncate(end);
                return Ok(Some(block));
            }
            if block.len() as u64 > most {
                return Ok(Some(block));
            }
            // The last byte is searched again once the byte after it is known.
            searched = block.len().saturating_sub(1);
        }
    }

    /// Returns a finished block for reuse.
    pub fn recycle(&mut self, block: Vec<u8>) {
        self.spare.push(block);
    }
}

/// The end of the last whole line at or after `from`.
///
/// A line end does not count after a backslash, which continues the line, nor after a final CR, which a LF may
/// follow.
fn last_end(block: &[u8], from: usize) -> Option<usize> {
    (from..block.len().saturating_sub(1)).rev().find_map(|i| {
        let before = match block[i] {
            b'\n' if i > 0 && block[i - 1] == b'\r' => i - 1,
            b'\n' => i,
            b'\r' if block[i + 1] != b'\n' => i,
            _ => return None,
        };
        (!block[..before].ends_with(b"\\")).then_some(i + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn blocks(text: &str, size: usize) -> Vec<String> {
        let mut bytes = text.as_bytes();
        let mut blocks = Blocks::new(&mut bytes, size);
        let mut all = Vec::new();
        while let Some(block) = blocks.next(u64::MAX).unwrap() {
            all.push(String::from_utf8(block.clone()).unwrap());
            blocks.recycle(block);
        }
        all
    }

    #[test]
    fn lines_stay_whole_and_so_do_those_that_are_continued() {
        for end in ["\n", "\r", "\r\n"] {
            let text = format!("ab{end}c \\{end}d{end}efghijkl");
            let expected = [format!("ab{end}"), format!("c \\{end}d{end}"), "efghijkl".to_owned()];
            assert_eq!(blocks(&text, 1), expected, "{end:?}");
            assert_eq!(blocks(&text, 100).concat(), text);
        }
        assert!(blocks("", 5).is_empty());
    }

    #[test]
    fn a_line_longer_than_what_is_allowed_is_given_up() {
        let text = "x".repeat(1000);
        let mut bytes = text.as_bytes();
        let block = Blocks::new(&mut bytes, 10).next(100).unwrap().unwrap();
        assert!((101..=200).contains(&block.len()), "{}", block.len());
    }

    proptest! {
        #[test]
        fn nothing_is_lost_and_no_line_end_is_cut(text in "[a\r\n\\\\]{0,60}", size in 1usize..20) {
            let all = blocks(&text, size);
            prop_assert_eq!(all.concat(), text);
            for pair in all.windows(2) {
                prop_assert!(pair[0].ends_with(['\r', '\n']), "{:?}", all);
                prop_assert!(!(pair[0].ends_with('\r') && pair[1].starts_with('\n')), "{:?}", all);
            }
        }
    }
}
