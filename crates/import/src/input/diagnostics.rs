//! Diagnostics of a file, and what it has that the picture does not show, each said once.

use bilux_scene::{SceneBuilder, Span, Warning};

/// Counts diagnostics by kind, so that a file with a million of them gives one warning.
#[derive(Debug, Default)]
pub struct Diagnostics {
    kinds: Vec<Diagnostic>,
}

#[derive(Debug)]
struct Diagnostic {
    grade: Grade,
    /// The text that all of this kind share.
    what: String,
    /// The text about the first one, which precedes it in the message.
    first: String,
    count: u64,
    at: Span,
}

impl Diagnostic {
    /// Whether it stands for all kinds that are not listed.
    fn is_last(&self) -> bool {
        self.what == NOT_LISTED
    }
}

/// Way in which a diagnostic is reported.
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

/// The kind that stands for all after them.
const NOT_LISTED: &str = "further faults from here on are not listed";

/// The number of names in a message about what is not shown.
const LISTED: usize = 12;

impl Diagnostics {
    /// Merges the diagnostics of a later part of the file, which begins after this many lines.
    pub fn append(&mut self, part: Diagnostics, lines: u32) {
        for Diagnostic { grade, what, first, count, mut at } in part.kinds {
            at.line = at.line.saturating_add(lines);
            if let Some(new) = self.count(grade, &what, count) {
                new.at = at;
                if !new.is_last() {
                    new.first = first;
                }
            }
        }
    }

    /// Counts one of a kind; evaluates `at` only for the first.
    pub fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        if let Some(new) = self.count(Grade::Fault, what, 1) {
            new.at = at();
        }
    }

    /// Counts one of a kind as [`Diagnostics::note`] does, with text about the first, which precedes the common text.
    pub fn note_first(&mut self, what: &str, first: impl FnOnce() -> String, at: impl FnOnce() -> Span) {
        if let Some(new) = self.count(Grade::Fault, what, 1) {
            new.at = at();
            if !new.is_last() {
                new.first = first();
            }
        }
    }

    /// Counts one of a kind that is no fault of the file and changes nothing in the picture.
    pub fn remark(&mut self, what: &str, at: impl FnOnce() -> Span) {
        if let Some(new) = self.count(Grade::Remark, what, 1) {
            new.at = at();
        }
    }

    /// Names something that the file brings, that one would see, and that the picture does not show. All such things
    /// of a file become one warning.
    pub fn not_shown(&mut self, what: &str, at: impl FnOnce() -> Span) {
        if let Some(new) = self.count(Grade::NotShown, what, 1) {
            new.at = at();
        }
    }

    /// Names data of the file that nobody expects to see. All such data of a file become one note.
    pub fn not_used(&mut self, what: &str, at: impl FnOnce() -> Span) {
        if let Some(new) = self.count(Grade::NotUsed, what, 1) {
            new.at = at();
        }
    }

    /// Adds to the count of a kind. Returns the kind if it is new, which then needs its place in the file. (The functions above
    /// are compiled for each closure that says the place, so they do nothing but call it.)
    fn count(&mut self, grade: Grade, what: &str, count: u64) -> Option<&mut Diagnostic> {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.grade == grade && kind.what == what) {
            kind.count += count;
            return None;
        }
        let what = match self.kinds.iter().filter(|kind| kind.grade == grade).count() {
            known if known < MAX_KINDS => what,
            MAX_KINDS => NOT_LISTED,
            _ => return None,
        };
        let new =
            Diagnostic { grade, what: what.to_owned(), first: String::new(), count, at: Span::default() };
        self.kinds.push(new);
        self.kinds.last_mut()
    }

    /// Converts them to warnings and notes, each with its count and the location of the first.
    pub fn into_warnings(mut self, scene: &mut SceneBuilder) {
        for grade in [Grade::NotShown, Grade::NotUsed] {
            let all: Vec<&Diagnostic> = self.kinds.iter().filter(|kind| kind.grade == grade).collect();
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
        for Diagnostic { grade, what, first, count, at } in self.kinds {
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
