//! Output of a process of tests, as it comes.

/// The text so far, and the test that runs.
#[derive(Debug, Default)]
pub(super) struct Printed {
    text: String,
    /// Beginning of the first line that has not ended.
    line: usize,
    running: Option<String>,
    is_closed: bool,
}

/// A test that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ended {
    pub(super) name: String,
    pub(super) has_failed: bool,
}

impl Printed {
    /// Adds what came, and returns the tests that have ended by it.
    pub(super) fn add(&mut self, bytes: &[u8]) -> Vec<Ended> {
        self.text += &String::from_utf8_lossy(bytes);
        let mut ended = Vec::new();
        while let Some(length) = self.text[self.line..].find('\n') {
            let line = self.text[self.line..self.line + length].to_owned();
            self.line += length + 1;
            ended.extend(self.read_line(line.trim_end()));
        }
        // The name of a test comes before it runs.
        if let Some((name, _)) = begun(&self.text[self.line..]) {
            self.running = Some(name.to_owned());
        }
        ended
    }

    /// A line between the names of tests is from a program that a test started, and so may be the beginning of one.
    fn read_line(&mut self, line: &str) -> Option<Ended> {
        if self.is_closed {
            return None;
        }
        self.is_closed = line.starts_with("test result: ");
        let said = match begun(line) {
            Some((name, said)) => {
                self.running = Some(name.to_owned());
                said
            }
            None => line,
        };
        let has_failed = said.ends_with("FAILED");
        if has_failed || said.ends_with("ok") {
            return self.running.take().map(|name| Ended { name, has_failed });
        }
        None
    }

    /// The test that has begun and not ended.
    pub(super) fn running(&self) -> Option<&str> {
        self.running.as_deref()
    }

    /// Whether all tests have run: the closing line has come.
    pub(super) fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Output of failing tests: the first section of failures.
    pub(super) fn failures(&self) -> &str {
        let Some(start) = self.text.find("\nfailures:\n") else { return "" };
        let section = &self.text[start + "\nfailures:\n".len()..];
        section.find("\nfailures:\n").map_or(section, |end| &section[..end]).trim()
    }

    /// The tests that passed because they had nothing to do, with what they say about it.
    pub(super) fn skipped(&self) -> Vec<(String, String)> {
        let mut skipped = Vec::new();
        let mut test = "";
        for line in self.text.lines() {
            if let Some(name) = line.strip_prefix("---- ").and_then(|line| line.strip_suffix(" stdout ----"))
            {
                test = name;
            } else if let Some(reason) = line.strip_prefix("skipped: ").filter(|_| !test.is_empty()) {
                skipped.push((test.to_owned(), reason.to_owned()));
            }
        }
        skipped
    }

    /// All of it.
    pub(super) fn text(&self) -> &str {
        &self.text
    }
}

/// The name in `test NAME ... ` and what comes after it.
fn begun(line: &str) -> Option<(&str, &str)> {
    let (name, said) = line.strip_prefix("test ")?.split_once(" ... ")?;
    Some((name.strip_suffix(" - should panic").unwrap_or(name), said))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(name: &str, has_failed: bool) -> Ended {
        Ended { name: name.to_owned(), has_failed }
    }

    #[test]
    fn tests_end_as_they_come() {
        let mut printed = Printed::default();
        assert_eq!(printed.add(b"\nrunning 4 tests\ntest a::b ... "), []);
        assert_eq!(printed.running(), Some("a::b"));
        assert_eq!(
            printed.add(b"ok\ntest c - should panic ... FAILED\ntest d ..."),
            [ended("a::b", false), ended("c", true)]
        );
        assert_eq!(printed.running(), None);
        assert_eq!(printed.add(b" a child speaks\nand once more"), []);
        assert_eq!(printed.running(), Some("d"));
        assert_eq!(printed.add(b"ok\ntest e ... "), [ended("d", false)]);
        assert_eq!((printed.running(), printed.is_closed()), (Some("e"), false));
    }

    #[test]
    fn sections_are_found() {
        let mut printed = Printed::default();
        let text = "test a ... ok\ntest b ... FAILED\n\nsuccesses:\n\n---- a stdout ----\nskipped: no Mitsuba\nrest\n\n\n\
                    successes:\n    a\n\nfailures:\n\n---- b stdout ----\npanicked at ok\n\n\nfailures:\n    b\n\n\
                    test result: FAILED. 1 passed; 1 failed;\n\n";
        assert_eq!(printed.add(text.as_bytes()).len(), 2);
        assert!(printed.is_closed() && printed.running().is_none());
        assert_eq!(printed.failures(), "---- b stdout ----\npanicked at ok");
        assert_eq!(printed.skipped(), [("a".to_owned(), "no Mitsuba".to_owned())]);
    }
}
