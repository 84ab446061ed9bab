//! What is odd about a file, and what it has that the picture does not show, each said once.

use bilux_scene::{SceneBuilder, Span, Warning};

/// Counts oddities by kind, so that a file with a million of them gives one warning.
#[derive(Debug, Default)]
pub(crate) struct Oddities {
    kinds: Vec<Oddity>,
    /// What the file brings and the picture does not show: its name, the first place, and whether it would be seen.
    not_shown: Vec<(String, Span, bool)>,
}

#[derive(Debug)]
struct Oddity {
    /// The text that all of this kind share.
    what: String,
    /// The text about the first one, which precedes it in the message.
    first: String,
    count: u64,
    at: Span,
    /// Whether nothing is wrong with the file.
    is_note: bool,
}

/// The number of kinds that are distinguished: a file of garbage has thousands.
const MAX_KINDS: usize = 40;

/// The number of names in a message about what is not shown.
const LISTED: usize = 12;

impl Oddities {
    /// Merges the oddities of a later part of the file, which begins after this many lines.
    pub(crate) fn append(&mut self, part: Oddities, lines: u32) {
        for Oddity { what, first, count, mut at, is_note } in part.kinds {
            at.line = at.line.saturating_add(lines);
            self.note_first(&what, || first, || at);
            if let Some(known) = self.kinds.iter_mut().find(|kind| kind.what == what) {
                known.count += count - 1;
                known.is_note = is_note;
            }
        }
        for (what, mut at, is_seen) in part.not_shown {
            at.line = at.line.saturating_add(lines);
            self.add_not_shown(&what, || at, is_seen);
        }
    }

    /// Counts one of a kind; evaluates `at` only for the first.
    pub(crate) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.note_first(what, String::new, at);
    }

    /// Counts one of a kind that is no fault of the file and changes nothing in the picture.
    pub(crate) fn remark(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.note(what, at);
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.what == what) {
            kind.is_note = true;
        }
    }

    /// Names something that the file brings, that one would see, and that the picture does not show. All such things
    /// of a file become one warning.
    pub(crate) fn not_shown(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add_not_shown(what, at, true);
    }

    /// The same for data that nobody expects to see, which become one note.
    pub(crate) fn not_used(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add_not_shown(what, at, false);
    }

    fn add_not_shown(&mut self, what: &str, at: impl FnOnce() -> Span, is_seen: bool) {
        let is_known = self.not_shown.iter().any(|(known, ..)| known == what);
        if !is_known && self.not_shown.len() < MAX_KINDS {
            self.not_shown.push((what.to_owned(), at(), is_seen));
        }
    }

    /// The same with text about the first of the kind, which precedes the common text.
    pub(crate) fn note_first(
        &mut self,
        what: &str,
        first: impl FnOnce() -> String,
        at: impl FnOnce() -> Span,
    ) {
        let kinds = self.kinds.len();
        match self.kinds.iter_mut().find(|kind| kind.what == what) {
            Some(kind) => kind.count += 1,
            None if kinds > MAX_KINDS => {}
            None if kinds == MAX_KINDS => {
                let what = "further faults from here on are not listed".to_owned();
                let (first, at) = (String::new(), at());
                self.kinds.push(Oddity { what, first, count: 1, at, is_note: false });
            }
            None => {
                let (what, first, at) = (what.to_owned(), first(), at());
                self.kinds.push(Oddity { what, first, count: 1, at, is_note: false });
            }
        }
    }

    /// Converts them to warnings and notes, each with its count and the location of the first.
    pub(crate) fn into_warnings(mut self, scene: &mut SceneBuilder) {
        self.kinds.sort_by_key(|kind| (kind.at.line, kind.at.column));
        for is_seen in [true, false] {
            let all = self.not_shown.iter().filter(|(.., seen)| *seen == is_seen);
            let Some((_, at, _)) = all.clone().next() else { continue };
            let names: Vec<&str> = all.clone().take(LISTED).map(|(what, ..)| &**what).collect();
            let more = all.count() - names.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let message = format!("the file has more than the picture shows: {}{more}", names.join(", "));
            let warning = Warning { message, at: at.clone() };
            if is_seen { scene.warnings.push(warning) } else { scene.notes.push(warning) }
        }
        for Oddity { what, first, count, at, is_note } in self.kinds {
            let times =
                if count > 1 { format!(" ({count} times; this is the first)") } else { String::new() };
            let warning = Warning { message: format!("{first}{what}{times}"), at };
            if is_note { scene.notes.push(warning) } else { scene.warnings.push(warning) }
        }
    }
}
