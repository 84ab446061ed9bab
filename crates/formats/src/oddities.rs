//! What is odd about a file, and what it has that the picture does not show, each said once.

use bilux_scene::{SceneBuilder, Span, Warning};

/// Counts oddities by kind, so that a file with a million of them gives one warning.
#[derive(Debug, Default)]
pub(crate) struct Oddities {
    kinds: Vec<Oddity>,
}

#[derive(Debug)]
struct Oddity {
    grade: Grade,
    /// The text that all of this kind share.
    what: String,
    /// The text about the first one, which precedes it in the message.
    first: String,
    count: u64,
    at: Span,
}

/// How an oddity is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grade {
    /// By a warning.
    Fault,
    /// By a note.
    Remark,
    /// In one warning for all of this grade.
    NotShown,
    /// In one note for all of this grade.
    NotUsed,
}

/// The number of kinds that are distinguished: a file of garbage has thousands.
const MAX_KINDS: usize = 40;

/// The number of names in a message about what is not shown.
const LISTED: usize = 12;

impl Oddities {
    /// Merges the oddities of a later part of the file, which begins after this many lines.
    pub(crate) fn append(&mut self, part: Oddities, lines: u32) {
        for Oddity { grade, what, first, count, mut at } in part.kinds {
            at.line = at.line.saturating_add(lines);
            self.add(grade, &what, || first, || at, count);
        }
    }

    /// Counts one of a kind; evaluates `at` only for the first.
    pub(crate) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add(Grade::Fault, what, String::new, at, 1);
    }

    /// The same with text about the first of the kind, which precedes the common text.
    pub(crate) fn note_first(
        &mut self,
        what: &str,
        first: impl FnOnce() -> String,
        at: impl FnOnce() -> Span,
    ) {
        self.add(Grade::Fault, what, first, at, 1);
    }

    /// Counts one of a kind that is no fault of the file and changes nothing in the picture.
    pub(crate) fn remark(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add(Grade::Remark, what, String::new, at, 1);
    }

    /// Names something that the file brings, that one would see, and that the picture does not show. All such things
    /// of a file become one warning.
    pub(crate) fn not_shown(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add(Grade::NotShown, what, String::new, at, 1);
    }

    /// The same for data that nobody expects to see, which become one note.
    pub(crate) fn not_used(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.add(Grade::NotUsed, what, String::new, at, 1);
    }

    fn add(
        &mut self,
        grade: Grade,
        what: &str,
        first: impl FnOnce() -> String,
        at: impl FnOnce() -> Span,
        count: u64,
    ) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.grade == grade && kind.what == what) {
            kind.count += count;
            return;
        }
        let (what, first) = match self.kinds.iter().filter(|kind| kind.grade == grade).count() {
            known if known < MAX_KINDS => (what.to_owned(), first()),
            MAX_KINDS => ("further faults from here on are not listed".to_owned(), String::new()),
            _ => return,
        };
        self.kinds.push(Oddity { grade, what, first, count, at: at() });
    }

    /// Converts them to warnings and notes, each with its count and the location of the first.
    pub(crate) fn into_warnings(mut self, scene: &mut SceneBuilder) {
        for grade in [Grade::NotShown, Grade::NotUsed] {
            let all: Vec<&Oddity> = self.kinds.iter().filter(|kind| kind.grade == grade).collect();
            let Some(first) = all.first() else { continue };
            let names: Vec<&str> = all.iter().map(|kind| &*kind.what).take(LISTED).collect();
            let more = match all.len() - names.len() {
                0 => String::new(),
                more if all.len() <= MAX_KINDS => format!(" and {more} more"),
                _ => " and others".to_owned(),
            };
            let message = format!("the file has more than the picture shows: {}{more}", names.join(", "));
            grade.report(message, first.at.clone(), scene);
        }
        self.kinds.retain(|kind| matches!(kind.grade, Grade::Fault | Grade::Remark));
        self.kinds.sort_by_key(|kind| (kind.at.line, kind.at.column));
        for Oddity { grade, what, first, count, at } in self.kinds {
            let times =
                if count > 1 { format!(" ({count} times; this is the first)") } else { String::new() };
            grade.report(format!("{first}{what}{times}"), at, scene);
        }
    }
}

impl Grade {
    fn report(self, message: String, at: Span, scene: &mut SceneBuilder) {
        match self {
            Grade::Fault | Grade::NotShown => scene.warnings.push(Warning { message, at }),
            Grade::Remark | Grade::NotUsed => scene.notes.push(Warning { message, at }),
        }
    }
}
