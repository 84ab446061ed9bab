//! Verdicts of statistical tests that are remembered by the bits of what they render first: `docs/adr/0055-verdicts.md`.
//!
//! A picture has the same bytes on every machine, so the outcome of a statistical test is a function of bytes. A [`Suite`] lets a
//! test render its first pictures, and compares their hashes with those in `verdicts.txt`. Where they are as recorded, what the
//! whole run gave then is taken for what it would give now; where one differs, or nothing is recorded, everything is rendered.
//! Tests of planted bugs ask a [`Side`] for all of its pictures, and never get here.

mod hash;
mod ledger;
pub mod records;
mod side;
mod test_name;

pub use hash::{Bits, Hash};
pub use side::{Picture, Side};

use ledger::{LEDGER, Question, say};
use records::Key;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Of so many samples or pictures, one is rendered first.
const FIRST: u32 = 16;

/// The statistical tests of a crate.
#[derive(Clone, Copy, Debug)]
pub struct Suite {
    name: &'static str,
}

impl Suite {
    /// Suite of a crate: `Suite::new(env!("CARGO_PKG_NAME"))`.
    pub const fn new(name: &'static str) -> Suite {
        Suite { name }
    }

    /// The p-value that `judge` gives for all pictures of two sides, `[cell][picture]` each. `asked` says what decides beside
    /// them.
    pub fn agreement(
        &self,
        case: &str,
        asked: &str,
        [a, b]: [&Side; 2],
        judge: impl FnOnce(&[Vec<f64>], &[Vec<f64>]) -> f64,
    ) -> f64 {
        let asked = format!("{asked}, {} and {} pictures", a.count(), b.count());
        let whole = || vec![judge(a.cells(), b.cells())];
        self.verdict(case, &asked, vec![a.first(), b.first()], whole)[0]
    }

    /// Results of `numbers` for so many samples or pictures, of which a sixteenth is rendered first, by the same `render`.
    /// `asked` says what decides beside them.
    pub fn numbers<P: Bits>(
        &self,
        case: &str,
        asked: &str,
        count: u32,
        render: impl Fn(u32) -> P,
        numbers: impl FnOnce(&P) -> Vec<f64>,
    ) -> Vec<f64> {
        let first = Hash::of(&render((count / FIRST).max(1)));
        self.verdict(case, &format!("{asked}, {count}"), vec![first], || numbers(&render(count)))
    }

    /// Whether a check of many samples holds, of which `first` draws some.
    ///
    /// # Errors
    /// What `check` says: only success is recorded.
    pub fn check<P: Bits>(
        &self,
        case: &str,
        asked: &str,
        first: impl FnOnce() -> P,
        check: impl FnOnce() -> Result<(), String>,
    ) -> Result<(), String> {
        let mut failure = None;
        let whole = || {
            failure = check().err();
            vec![f64::from(u8::from(failure.is_some()))]
        };
        let failures = self.verdict(case, asked, vec![Hash::of(&first())], whole);
        match failure {
            Some(wrong) => Err(wrong),
            None if failures == [0.0] => Ok(()),
            None => Err("the record is of a failure".to_owned()),
        }
    }

    fn verdict(
        &self,
        case: &str,
        asked: &str,
        firsts: Vec<Hash>,
        whole: impl FnOnce() -> Vec<f64>,
    ) -> Vec<f64> {
        let Some(test) = test_name::test_name() else {
            say("a comparison outside a test's own thread has no name, and runs whole");
            return whole();
        };
        let key = numbered(self.name, test, case);
        LEDGER.verdict(&key, Question { asked: one_line(asked), firsts }, whole)
    }
}

/// The key of a comparison; the second one of a name in a test gets a number.
fn numbered(suite: &str, test: String, case: &str) -> Key {
    static ASKED: Mutex<BTreeMap<Key, u32>> = Mutex::new(BTreeMap::new());
    let mut key = Key { suite: suite.to_owned(), test, case: one_line(case) };
    let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    let count = asked.entry(key.clone()).or_insert(0);
    *count += 1;
    if *count > 1 {
        key.case = format!("{} #{count}", key.case);
    }
    key
}

fn one_line(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_in_a_test_are_counted() {
        let cases = || numbered("suite", "test".to_owned(), "a\tcase").case;
        assert_eq!([cases(), cases(), cases()], ["a case", "a case #2", "a case #3"]);
        assert_eq!(numbered("suite", "other".to_owned(), "a\tcase").case, "a case");
    }
}
