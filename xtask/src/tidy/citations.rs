//! Whatever a comment cites, `[Woop 2013]` or `[Schlick 1994, eq. 15]`, and whatever an entry of a registry names as
//! its source, has a line in `REFERENCES.md` that begins `- **[Woop 2013]**`; and every entry there is cited by some
//! code file.

use super::repository::Repository;
use super::violation::Violation;
use std::collections::BTreeSet;

const LIST: &str = "REFERENCES.md";

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let Some(list) = repository.file(LIST) else {
        return vec![Violation::new(LIST, 0, "is missing")];
    };
    let (keys, mut violations) = keys(&list.text);
    for (file, rust) in repository.rust() {
        for (number, (line, comment)) in file.text.lines().zip(rust.comments.lines()).enumerate() {
            let cited = citations(comment).into_iter().chain(source(line));
            for key in cited.filter(|key| !keys.contains(key)) {
                let message = format!("[{key}] has no line in {LIST}");
                violations.push(Violation::new(&file.path, number + 1, message));
            }
        }
    }
    let code: Vec<String> = repository.rust().map(|(file, _)| in_one_line(&file.text)).collect();
    let cited: BTreeSet<&str> = code.iter().flat_map(|text| citations(text)).collect();
    // Most are found by looking once; the others are looked for one by one.
    let others = keys.iter().filter(|key| !cited.contains(*key));
    for key in others.filter(|key| !code.iter().any(|text| text.contains(**key))) {
        violations.push(Violation::new(LIST, 0, format!("[{key}] is cited by no code")));
    }
    violations
}

/// A text without the breaks between the lines of comments, which may stand after any word of a key.
fn in_one_line(text: &str) -> String {
    let lines = text.lines().map(|line| line.trim().trim_start_matches(['/', '!']).trim_start());
    lines.fold(String::with_capacity(text.len()), |whole, line| whole + line + " ")
}

/// The keys of the list; a key that appears twice is a violation.
fn keys(list: &str) -> (BTreeSet<&str>, Vec<Violation>) {
    let mut keys = BTreeSet::new();
    let mut violations = Vec::new();
    for (number, line) in list.lines().enumerate() {
        let key = line.strip_prefix("- **[").and_then(|rest| rest.split_once("]**"));
        if let Some((key, _)) = key.filter(|(key, _)| !keys.insert(*key)) {
            violations.push(Violation::new(LIST, number + 1, format!("[{key}] stands here twice")));
        }
    }
    (keys, violations)
}

/// The keys cited in one line of a comment. Links, `[text](…)` and `` [`item`] ``, are not citations.
fn citations(comment: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for part in comment.split('[').skip(1) {
        let Some((inside, after)) = part.split_once(']') else { continue };
        if !after.starts_with(['(', ':']) {
            let keys = inside.split(';').map(|key| key.split(',').next().unwrap_or_default().trim());
            found.extend(keys.filter(|key| is_key(key)));
        }
    }
    found
}

/// Whether a key is a name followed by a year or a number: `Woop 2013`, `IEC 61966-2-1`.
fn is_key(key: &str) -> bool {
    let Some((name, year)) = key.rsplit_once(' ') else { return false };
    name.starts_with(char::is_uppercase)
        && year.len() >= 4
        && year.as_bytes().iter().take(4).all(u8::is_ascii_digit)
}

/// The source that an entry of a registry names in this line.
fn source(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once("source: \"")?;
    rest.split_once('"').map(|(key, _)| key).filter(|key| !key.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOUND: &str = "- **[Woop 2013]** S. Woop, C. Benthin, I. Wald.\n";

    fn check_text(text: &str) -> Vec<usize> {
        let cites = ("b.rs", "// [Woop\n// 2013]\n");
        let repository = Repository::planted(&[("REFERENCES.md", FOUND), ("a.rs", text), cites]);
        check(&repository).into_iter().map(|found| found.line).collect()
    }

    #[test]
    fn planted_keys_are_found() {
        assert_eq!(check_text("// see [Nobody 1999]\n"), [1]);
        assert_eq!(check_text("/// By [Woop 2013; Nobody 1999, eq. 3].\n"), [1]);
        assert_eq!(check_text("\n/* [IEC 61966-2-1] */\n"), [2]);
        assert_eq!(check_text("source: \"Nobody\",\n"), [1]);
    }

    #[test]
    fn known_keys_links_and_code_pass() {
        assert!(check_text("//! [Woop 2013, section 3], [`Ray`], [a 2000](x), [0, 1000]\n").is_empty());
        assert!(check_text("let a = [Nobody 1999]; f(\"[Nobody 1999]\");\n").is_empty());
        assert!(check_text("source: \"Woop 2013\",\nsource: \"\",\n").is_empty());
    }

    #[test]
    fn keys_are_unique() {
        let cites = ("b.rs", "// [Woop 2013]\n");
        let twice = Repository::planted(&[("REFERENCES.md", &FOUND.repeat(2)), cites]);
        assert_eq!(check(&twice), [Violation::new("REFERENCES.md", 2, "[Woop 2013] stands here twice")]);
        assert_eq!(check(&Repository::default()).len(), 1, "no list at all");
        let alone = Repository::planted(&[("REFERENCES.md", FOUND)]);
        assert_eq!(check(&alone), [Violation::new("REFERENCES.md", 0, "[Woop 2013] is cited by no code")]);
    }
}
