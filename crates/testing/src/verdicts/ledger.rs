//! The verdicts that a process trusts, or those that it records.

use super::hash::Hash;
use super::records::{Key, Record, Records, line};
use crate::effort::is_long;
use std::ffi::OsString;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The file of verdicts.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/verdicts.txt");

/// Ledger of this process.
pub(super) static LEDGER: LazyLock<Ledger> = LazyLock::new(|| {
    let folder = std::env::var_os("BILUX_VERDICTS_OUT");
    let ledger = Ledger::of(is_long(), folder, || std::fs::read_to_string(Path::new(FILE)));
    ledger.unwrap_or_else(|wrong| {
        say(&format!("statistical tests run whole, since verdicts.txt cannot be used: {wrong}"));
        Ledger::Unused
    })
});

pub(super) enum Ledger {
    /// All comparisons run whole.
    Unused,
    /// All run whole, and their verdicts go to this process's file in this folder.
    Recording(PathBuf),
    /// Recorded comparisons need not run whole.
    Recorded(Records),
}

/// Circumstances that decide a comparison.
pub(super) struct Question {
    /// Circumstances beside the bits of pictures.
    pub(super) asked: String,
    /// Hashes of what was rendered first.
    pub(super) firsts: Vec<Hash>,
}

impl Ledger {
    fn of(
        is_long: bool,
        folder: Option<OsString>,
        read: impl FnOnce() -> std::io::Result<String>,
    ) -> Result<Ledger, String> {
        match folder {
            _ if is_long => Ok(Ledger::Unused),
            Some(folder) => Ok(Ledger::Recording(folder.into())),
            None => {
                let text = read().map_err(|error| error.to_string())?;
                Ok(Ledger::Recorded(Records::parse(&text)?))
            }
        }
    }

    /// The numbers of a comparison, from its record or from the whole run.
    pub(super) fn verdict(
        &self,
        key: &Key,
        question: Question,
        whole: impl FnOnce() -> Vec<f64>,
    ) -> Vec<f64> {
        match self {
            Ledger::Unused => whole(),
            Ledger::Recording(folder) => {
                let numbers: Vec<f64> = whole().into_iter().map(rounded).collect();
                let Question { asked, firsts } = question;
                append(folder, key, &Record { asked, firsts, numbers: numbers.clone() });
                numbers
            }
            Ledger::Recorded(records) => match trusted(records.verdicts.get(key), &question) {
                Ok(numbers) => numbers,
                Err(wrong) => {
                    let Key { suite, test, case } = key;
                    say(&format!(
                        "{suite} {test} '{case}' runs whole, for {wrong}: see `cargo xtask verdicts`"
                    ));
                    whole()
                }
            },
        }
    }
}

/// The numbers of a record of the same question about the same pictures.
fn trusted(record: Option<&Record>, question: &Question) -> Result<Vec<f64>, &'static str> {
    match record {
        _ if question.firsts.contains(&Hash::NOTHING) => Err("nothing was rendered first"),
        None => Err("there is no record"),
        Some(record) if record.asked != question.asked => Err("the record is of another question"),
        Some(record) if record.firsts != question.firsts => Err("the record is of other pictures"),
        Some(record) => Ok(record.numbers.clone()),
    }
}

/// Nine digits: the last bits of a p-value depend on the system's own functions.
fn rounded(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

/// Appends a verdict to the file of this process.
///
/// # Panics
/// If it cannot be written: the chore that asked for it must not miss one.
fn append(folder: &Path, key: &Key, record: &Record) {
    let path = folder.join(format!("{}.txt", std::process::id()));
    let file = OpenOptions::new().create(true).append(true).open(&path);
    let written = file.and_then(|mut file| file.write_all(line(key, record).as_bytes()));
    written.unwrap_or_else(|error| panic!("cannot write {}: {error}", path.display()));
}

/// Says something in spite of libtest, which hides what tests print.
pub(super) fn say(message: &str) {
    let _ = writeln!(std::io::stderr(), "verdicts: {message}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_long_form_and_files_that_cannot_be_used_leave_everything_to_run() {
        let whole = || Ok(Records::default().to_text());
        assert!(matches!(Ledger::of(false, None, whole), Ok(Ledger::Recorded(_))));
        assert!(matches!(Ledger::of(true, None, whole), Ok(Ledger::Unused)));
        assert!(matches!(Ledger::of(true, Some("out".into()), whole), Ok(Ledger::Unused)));
        assert!(matches!(Ledger::of(false, Some("out".into()), whole), Ok(Ledger::Recording(_))));
        assert!(Ledger::of(false, None, || Ok("damaged".to_owned())).is_err());
        assert!(Ledger::of(false, None, || Err(std::io::ErrorKind::NotFound.into())).is_err());
    }

    #[test]
    fn only_the_same_question_about_the_same_pictures_is_trusted() {
        let firsts = [Hash::of(&1.0f32), Hash::of(&2.0f32)];
        let record = Record { asked: "12".to_owned(), firsts: firsts.to_vec(), numbers: vec![0.5] };
        let of = |record, asked: &str, firsts: &[Hash]| {
            trusted(record, &Question { asked: asked.to_owned(), firsts: firsts.to_vec() })
        };
        assert_eq!(of(Some(&record), "12", &firsts), Ok(vec![0.5]));
        assert!(of(None, "12", &firsts).is_err());
        assert!(of(Some(&record), "13", &firsts).is_err());
        assert!(of(Some(&record), "12", &[firsts[1], firsts[0]]).is_err());
        assert!(of(Some(&record), "12", &firsts[..1]).is_err());
        let nothing = [Hash::NOTHING, firsts[1]];
        let empty = Record { firsts: nothing.to_vec(), ..record.clone() };
        assert!(of(Some(&empty), "12", &nothing).is_err());
    }

    #[test]
    fn a_record_spares_the_whole_run_and_nothing_else_does() {
        let key = Key { suite: "a".to_owned(), test: "b".to_owned(), case: "c".to_owned() };
        let question = || Question { asked: "12".to_owned(), firsts: vec![Hash::of(&1.0f32)] };
        let Question { asked, firsts } = question();
        let mut records = Records::default();
        records.verdicts.insert(key.clone(), Record { asked, firsts, numbers: vec![0.5] });
        let of = |ledger: Ledger| ledger.verdict(&key, question(), || vec![0.25]);
        assert_eq!(of(Ledger::Recorded(records)), [0.5]);
        assert_eq!(of(Ledger::Unused), [0.25]);
    }

    #[test]
    fn numbers_keep_nine_digits() {
        assert_eq!(rounded(0.123_456_789_123), 0.123_456_789);
        assert_eq!(rounded(0.0), 0.0);
        assert!(rounded(f64::NAN).is_nan());
    }
}
