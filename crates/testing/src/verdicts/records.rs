//! The file of verdicts: one line for each comparison, sorted, and a checksum that shows edits by hand.

use super::hash::Hash;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Which comparison of which test.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// The crate of the test.
    pub suite: String,
    /// The path of the test in its binary.
    pub test: String,
    /// Which of its comparisons.
    pub case: String,
}

/// The verdict on a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The question: numbers of pictures and samples, and what else decides beside the bits of pictures.
    pub asked: String,
    /// Hashes of what was rendered first, on each side.
    pub firsts: Vec<Hash>,
    /// Results of the whole run: a p-value, or means with their errors.
    pub numbers: Vec<f64>,
}

/// All verdicts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// CPU seconds of a suite whose comparisons all run whole.
    pub seconds: BTreeMap<String, u64>,
    /// The verdicts.
    pub verdicts: BTreeMap<Key, Record>,
}

const HEADER: &str = "\
# Verdicts of statistical tests, by the hashes of what they render first (docs/adr/0055-verdicts.md). Only `cargo xtask verdicts
# --write` writes this file. Columns, parted by tabs: suite and test, comparison, question, hashes, numbers; or `seconds`, suite,
# CPU seconds of its tests when all comparisons run whole.
";
const CHECKSUM: &str = "checksum ";

impl Records {
    /// Reads a file with its checksum.
    ///
    /// # Errors
    /// If a line is wrong, or the file is not what was written.
    pub fn parse(text: &str) -> Result<Records, String> {
        let body = text.trim_end().rfind('\n').map(|end| text.split_at(end + 1));
        let Some((body, checksum)) = body.filter(|(_, last)| last.starts_with(CHECKSUM)) else {
            return Err("the checksum at its end is missing".to_owned());
        };
        if checksum.trim_end() != format!("{CHECKSUM}{}", Hash::of(body.as_bytes())) {
            return Err("its checksum is wrong: it was damaged, merged, or edited by hand".to_owned());
        }
        let mut records = Records::default();
        for (number, line) in body.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
            records.add(line).map_err(|wrong| format!("line {}: {wrong}", number + 1))?;
        }
        Ok(records)
    }

    /// Adds what a line says.
    ///
    /// # Errors
    /// If the line is wrong, or there is another one for the same comparison.
    pub fn add(&mut self, line: &str) -> Result<(), String> {
        if let Some((suite, seconds)) = line.strip_prefix("seconds\t").and_then(|rest| rest.split_once('\t'))
        {
            let seconds = seconds.parse().map_err(|_| format!("'{seconds}' is no number of seconds"))?;
            self.seconds.insert(suite.to_owned(), seconds);
            return Ok(());
        }
        let (key, record) = read_line(line).ok_or("this is no verdict")?;
        if self.verdicts.contains_key(&key) {
            return Err(format!("{} '{}' occurs twice", key.test, key.case));
        }
        self.verdicts.insert(key, record);
        Ok(())
    }

    /// The file's text.
    pub fn to_text(&self) -> String {
        let mut text = HEADER.to_owned();
        for (suite, seconds) in &self.seconds {
            let _ = writeln!(text, "seconds\t{suite}\t{seconds}");
        }
        for (key, record) in &self.verdicts {
            text.push_str(&line(key, record));
        }
        let checksum = Hash::of(text.as_bytes());
        let _ = writeln!(text, "{CHECKSUM}{checksum}");
        text
    }
}

/// A verdict as a line of the file.
pub(super) fn line(key: &Key, record: &Record) -> String {
    let joined = |words: Vec<String>| words.join(" ");
    let hashes = joined(record.firsts.iter().map(Hash::to_string).collect());
    let numbers = joined(record.numbers.iter().map(f64::to_string).collect());
    format!("{} {}\t{}\t{}\t{hashes}\t{numbers}\n", key.suite, key.test, key.case, record.asked)
}

fn read_line(line: &str) -> Option<(Key, Record)> {
    let mut columns = line.split('\t');
    let (suite, test) = columns.next()?.split_once(' ')?;
    let (case, asked) = (columns.next()?, columns.next()?);
    let firsts = columns.next()?.split(' ').map(Hash::parse).collect::<Option<Vec<_>>>()?;
    let numbers = columns.next()?.split(' ').map(|word| word.parse().ok()).collect::<Option<Vec<_>>>()?;
    let key = Key { suite: suite.to_owned(), test: test.to_owned(), case: case.to_owned() };
    columns.next().is_none().then(|| (key, Record { asked: asked.to_owned(), firsts, numbers }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records() -> Records {
        let mut records = Records::default();
        records.seconds.insert("a".to_owned(), 12);
        for (test, case) in [("b::c", "fog: bdpt"), ("a::b", "")] {
            let key = Key { suite: "a".to_owned(), test: test.to_owned(), case: case.to_owned() };
            let firsts = vec![Hash::of(&1.5f32), Hash::NOTHING];
            let record = Record { asked: "12 pictures".to_owned(), firsts, numbers: vec![0.25, 1e-9] };
            records.verdicts.insert(key, record);
        }
        records
    }

    #[test]
    fn what_is_written_is_read() {
        let text = records().to_text();
        assert_eq!(Records::parse(&text), Ok(records()));
        let lines: Vec<_> = text.lines().filter(|line| line.starts_with("a ")).collect();
        assert!(lines.is_sorted() && lines.len() == 2, "{text}");
    }

    #[test]
    fn damaged_and_edited_files_are_refused() {
        let text = records().to_text();
        let wrong = |text: &str| Records::parse(text).unwrap_err();
        assert!(wrong(&text.replace("0.25", "0.35")).contains("edited by hand"));
        assert!(wrong(&text[..text.len() / 2]).contains("missing"));
        assert!(wrong("").contains("missing"));
        assert!(wrong("checksum 1").contains("missing"));
        let sealed = |body: &str| format!("{body}checksum {}\n", Hash::of(body.as_bytes()));
        assert_eq!(wrong(&sealed("# a\nb c\td\n")), "line 2: this is no verdict");
        let twice = text.lines().find(|line| line.starts_with("a ")).unwrap();
        assert!(wrong(&sealed(&format!("{twice}\n{twice}\n"))).contains("occurs twice"));
        assert!(wrong(&sealed("seconds\ta\tb\n")).contains("no number of seconds"));
    }
}
