//! Commands in a file, as a shell would split them. None is ever run: what a few of them would write is made here.

use bilux_import::bytes::text::name_of;
use bilux_scene::Span;
use std::rc::Rc;

/// A line that begins with `!`.
#[derive(Clone, Debug)]
pub(super) struct Command {
    /// The programs, each of which reads what the one before it writes, with their arguments; `None` for a line that needs a
    /// shell for more than that.
    pub(super) programs: Option<Vec<Vec<Rc<str>>>>,
    /// The line as messages show it.
    pub(super) text: Rc<str>,
    pub(super) at: Span,
}

impl Command {
    /// Splits a line, without its `!`.
    pub(super) fn parse(line: &[u8], at: Span) -> Command {
        let text = name_of(line.trim_ascii());
        let shown: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(60).collect();
        Command { programs: programs(&text), text: shown.into(), at }
    }

    /// The name of its first program, for messages.
    pub(super) fn first_word(&self) -> &str {
        self.text.split_whitespace().next().unwrap_or_default()
    }
}

/// The programs of a line; `None` if it has variables, redirections, lists or patterns.
fn programs(text: &str) -> Option<Vec<Vec<Rc<str>>>> {
    let mut programs = vec![Vec::new()];
    let mut letters = text.chars().peekable();
    while let Some(&letter) = letters.peek() {
        match letter {
            c if c.is_whitespace() => _ = letters.next(),
            '#' => break,
            '|' => {
                letters.next();
                programs.push(Vec::new());
            }
            _ => {
                let word = word(&mut letters)?;
                programs.last_mut()?.push(word.into());
            }
        }
    }
    programs.iter().all(|words| !words.is_empty()).then_some(programs)
}

/// The next word, without its quotes.
fn word(letters: &mut std::iter::Peekable<std::str::Chars>) -> Option<String> {
    let mut word = String::new();
    let mut quote = None;
    while let Some(&letter) = letters.peek() {
        if quote.is_none() && (letter.is_whitespace() || letter == '|') {
            break;
        }
        letters.next();
        match (quote, letter) {
            (Some(open), c) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(letter),
            (None | Some('"'), '\\') => word.push(letters.next()?),
            (None | Some('"'), '$' | '`') => return None,
            (None, ';' | '&' | '<' | '>' | '(' | ')' | '*' | '?' | '{' | '}') => return None,
            _ => word.push(letter),
        }
    }
    quote.is_none().then_some(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(line: &str) -> Option<Vec<Vec<String>>> {
        let found = Command::parse(line.as_bytes(), Span::default()).programs?;
        Some(found.into_iter().map(|words| words.iter().map(|word| word.to_string()).collect()).collect())
    }

    #[test]
    fn words_are_those_of_a_shell() {
        let words = split(r#" genbox "a b" 'c|d' e\ f 1 | xform -t 1 2 3  "#).unwrap();
        assert_eq!(words, [vec!["genbox", "a b", "c|d", "e f", "1"], vec!["xform", "-t", "1", "2", "3"]]);
    }

    #[test]
    fn what_needs_a_shell_is_not_split() {
        for line in
            ["a > b", "a; b", "rm -rf $HOME", "a `b`", "\"a", "a | ", "", "cat *.rad", "a && b", "x \"$y\""]
        {
            assert_eq!(split(line), None, "{line}");
        }
    }
}
