//! The lines of standard input, read by a thread so that a signal is noticed while there is none.

use super::signals::Signals;
use std::io::{BufRead, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// The longest line of a job, in bytes.
pub const LONGEST: usize = 1 << 20;

/// Interval at which a signal is looked for.
const EVERY: Duration = Duration::from_millis(50);

/// One line.
#[derive(Debug, PartialEq, Eq)]
pub enum Line {
    /// The text of a line, without its end.
    Text(String),
    /// A line that is no UTF-8.
    NoText,
    /// A line of more than [`LONGEST`] bytes.
    TooLong,
}

/// Lines as they come, numbered from 1; empty ones are left out.
pub struct Lines(Receiver<(u64, Line)>);

impl Lines {
    /// Begins to read standard input, one line ahead.
    pub fn of_stdin() -> Lines {
        let (send, receive) = sync_channel(1);
        std::thread::spawn(move || {
            let mut input = std::io::stdin().lock();
            let mut number = 0;
            while let Some(line) = read(&mut input) {
                number += 1;
                let is_empty = matches!(&line, Line::Text(text) if text.trim().is_empty());
                if !is_empty && send.send((number, line)).is_err() {
                    return;
                }
            }
        });
        Lines(receive)
    }

    /// The next line; `None` at the end, or after a signal.
    pub fn next(&self, signals: &Signals) -> Option<(u64, Line)> {
        loop {
            match self.0.recv_timeout(EVERY) {
                Ok(line) => return Some(line),
                Err(RecvTimeoutError::Timeout) if signals.status().is_none() => {}
                Err(_) => return None,
            }
        }
    }
}

/// A line of the input; `None` at its end.
fn read(input: &mut impl BufRead) -> Option<Line> {
    let mut bytes = Vec::new();
    let length = input.by_ref().take(LONGEST as u64 + 1).read_until(b'\n', &mut bytes).ok()?;
    if length == 0 {
        return None;
    }
    if length > LONGEST && bytes.last() != Some(&b'\n') {
        skip_line(input);
        return Some(Line::TooLong);
    }
    Some(String::from_utf8(bytes).map_or(Line::NoText, |text| Line::Text(text.trim_end().to_owned())))
}

/// Skips the rest of a line.
fn skip_line(input: &mut impl BufRead) {
    while let Ok(buffer) = input.fill_buf() {
        let end = buffer.iter().position(|&byte| byte == b'\n');
        let length = end.map_or(buffer.len(), |end| end + 1);
        if length == 0 {
            return;
        }
        input.consume(length);
        if end.is_some() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_and_one_that_is_no_text_spoil_no_other() {
        let mut input = vec![b'x'; LONGEST + 100_000];
        input.extend(b"\nsecond\r\n\xff\xfe\nlast");
        let mut input = &input[..];
        let lines: Vec<Line> = std::iter::from_fn(|| read(&mut input)).collect();
        let text = |text: &str| Line::Text(text.to_owned());
        assert_eq!(lines, [Line::TooLong, text("second"), Line::NoText, text("last")]);
        let mut exact = vec![b'x'; LONGEST];
        exact.push(b'\n');
        assert_eq!(read(&mut &exact[..]), Some(text(&"x".repeat(LONGEST))), "the longest that is allowed");
    }
}
