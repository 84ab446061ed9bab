//! The verdicts of statistical tests (`docs/adr/0055-verdicts.md`): each is of a test that there is, which rendered something before it
//! trusted the record, in a file that nobody edited; and the tests of a crate grow no further than its budget says.

use super::repository::{Repository, TextFile};
use super::violation::Violation;
use crate::verdicts::{BUDGETS, Budget, FILE, budgets};
use bilux_testing::verdicts::Hash;
use bilux_testing::verdicts::records::Records;

/// A suite may have this times its budget.
const GROWTH: f64 = 1.1;

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let text = |path: &str| repository.file(path).map_or("", |file| &file.text);
    let (records, mut violations) = match Records::parse(text(FILE)) {
        Ok(records) => (records, Vec::new()),
        Err(wrong) => {
            let message = format!("{wrong}: renew it by `cargo xtask verdicts --write`");
            (Records::default(), vec![Violation::new(FILE, 0, message)])
        }
    };
    for (key, record) in &records.verdicts {
        if !is_there(repository, &key.suite, &key.test) {
            let message = format!("there is no test {} in {}: delete its verdicts", key.test, key.suite);
            violations.push(Violation::new(FILE, 0, message));
        }
        if record.firsts.contains(&Hash::NOTHING) {
            let message = format!("{} '{}' is trusted before anything is rendered", key.test, key.case);
            violations.push(Violation::new(FILE, 0, message));
        }
    }
    violations.extend(check_budgets(repository, &records, text(BUDGETS)));
    violations
}

fn check_budgets(repository: &Repository, records: &Records, text: &str) -> Vec<Violation> {
    let wrong = |message: String| Violation::new(BUDGETS, 0, message);
    let budgets = match budgets(text) {
        Ok(budgets) => budgets,
        Err(message) => return vec![wrong(message)],
    };
    let mut violations = Vec::new();
    for (name, folder) in crates(repository) {
        let count = files_in(repository, &folder).flat_map(tests_in).count();
        match budgets.iter().find(|budget| budget.name == name) {
            None if count > 0 => violations.push(wrong(format!("{name} has {count} tests and no budget"))),
            Some(budget) => violations.extend(check_budget(budget, count, records).map(wrong)),
            None => {}
        }
    }
    let is_known = |name: &str| crates(repository).any(|(known, _)| known == name);
    let unknown = budgets.iter().filter(|budget| !is_known(budget.name));
    violations.extend(unknown.map(|budget| wrong(format!("there is no crate {}", budget.name))));
    violations
}

fn check_budget(budget: &Budget, count: usize, records: &Records) -> Option<String> {
    let Budget { name, tests, seconds } = budget;
    if count as f64 > GROWTH * f64::from(*tests) {
        return Some(format!(
            "{name} has {count} tests, over a tenth more than its budget of {tests}: test less, or raise the budget"
        ));
    }
    match (records.seconds.get(*name), seconds) {
        (Some(measured), Some(seconds)) if *measured as f64 > GROWTH * f64::from(*seconds) => Some(format!(
            "the tests of {name} took {measured} s, over a tenth more than their budget of {seconds} s"
        )),
        (Some(_), None) => Some(format!("{name} has comparisons, and no budget of seconds for them")),
        (None, Some(_)) => Some(format!("{name} was never measured: `cargo xtask verdicts --write {name}`")),
        _ => None,
    }
}

/// The name and folder of each crate.
fn crates(repository: &Repository) -> impl Iterator<Item = (&str, String)> {
    repository.files.iter().filter_map(|file| {
        let folder = file.path.strip_suffix("Cargo.toml")?;
        let is_ours = folder == "xtask/" || folder.starts_with("crates/");
        let name = file.text.lines().find_map(|line| line.strip_prefix("name = \""))?.trim_end_matches('"');
        is_ours.then(|| (name, folder.to_owned()))
    })
}

/// The files in the folder of a crate.
fn files_in<'a>(repository: &'a Repository, folder: &'a str) -> impl Iterator<Item = &'a TextFile> + 'a {
    repository.files.iter().filter(move |file| file.path.starts_with(folder))
}

/// The names of the tests in a file.
fn tests_in(file: &TextFile) -> impl Iterator<Item = &str> {
    let lines = file.rust.iter().flat_map(|rust| rust.code.lines());
    let mut is_test = false;
    lines.filter_map(move |line| {
        let line = line.trim();
        let name = line.split_once("fn ").map(|(_, rest)| rest.split('(').next().unwrap_or(rest));
        let found = name.filter(|_| is_test);
        is_test = line.starts_with("#[test]") || (is_test && name.is_none());
        found
    })
}

/// Whether a crate has a test at this path: those of `suite/both_ends.rs` are in `both_ends`.
fn is_there(repository: &Repository, suite: &str, test: &str) -> bool {
    let (module, name) = test.rsplit_once("::").unwrap_or(("", test));
    let Some((_, folder)) = crates(repository).find(|(known, _)| *known == suite) else { return false };
    let is_in = |file: &&TextFile| {
        let inside = file.path.strip_prefix(&folder).unwrap_or_default();
        let place = inside.strip_prefix("tests/suite/").or_else(|| inside.strip_prefix("src/"));
        let place = place.unwrap_or_default().trim_end_matches(".rs").trim_end_matches("/mod");
        let place = if ["main", "lib"].contains(&place) { String::new() } else { place.replace('/', "::") };
        module == place || module.strip_suffix("::tests").unwrap_or(module) == place
    };
    files_in(repository, &folder).filter(is_in).flat_map(tests_in).any(|known| known == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_testing::verdicts::records::{Key, Record};

    const MANIFEST: (&str, &str) = ("crates/a/Cargo.toml", "[package]\nname = \"bilux-a\"\n");
    const TESTS: (&str, &str) = (
        "crates/a/tests/suite/b/mod.rs",
        "#[test]\nfn c() {}\n/// d\n#[test]\n#[allow(x)]\nfn d() {}\nfn not_a_test() {}\n",
    );
    const BUDGET: &str = "bilux-a 2 50\n";

    fn records(test: &str, first: Hash) -> Records {
        let key = Key { suite: "bilux-a".to_owned(), test: test.to_owned(), case: "fog".to_owned() };
        let record = Record { asked: String::new(), firsts: vec![first], numbers: vec![0.5] };
        Records { seconds: [("bilux-a".to_owned(), 55)].into(), verdicts: [(key, record)].into() }
    }

    fn found(file: &str, budget: &str) -> Vec<String> {
        let files = [MANIFEST, TESTS, (FILE, file), (BUDGETS, budget)];
        check(&Repository::planted(&files)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn verdicts_of_tests_that_are_there_are_fine() {
        let text = records("b::c", Hash::of(b"x")).to_text();
        assert_eq!(found(&text, BUDGET), [""; 0]);
    }

    #[test]
    fn planted_verdicts_of_tests_that_are_gone_are_found() {
        for test in ["b::gone", "c", "other::c", "b::not_a_test"] {
            let found = found(&records(test, Hash::of(b"x")).to_text(), BUDGET);
            assert!(found.len() == 1 && found[0].contains(&format!("there is no test {test}")), "{found:?}");
        }
    }

    #[test]
    fn a_planted_verdict_on_nothing_is_found() {
        let found = found(&records("b::c", Hash::NOTHING).to_text(), BUDGET);
        assert!(found.len() == 1 && found[0].contains("before anything is rendered"), "{found:?}");
    }

    #[test]
    fn planted_edits_are_found() {
        let text = records("b::c", Hash::of(b"x")).to_text();
        for text in [text.replace("0.5", "0.6"), String::new()] {
            let found = found(&text, "bilux-a 2\n");
            assert!(found.len() == 1 && found[0].contains("cargo xtask verdicts --write"), "{found:?}");
        }
    }

    #[test]
    fn planted_growth_is_found() {
        let text = records("b::c", Hash::of(b"x")).to_text();
        for (budget, wanted) in [
            ("bilux-a 1 50\n", "has 2 tests, over a tenth more than its budget of 1"),
            ("bilux-a 2 49\n", "took 55 s, over a tenth more than their budget of 49 s"),
            ("bilux-a 2\n", "no budget of seconds"),
            ("# none\n", "has 2 tests and no budget"),
            ("bilux-a 2 50\nbilux-b 3\n", "there is no crate bilux-b"),
            ("bilux-a two\n", "line 1"),
        ] {
            let found = found(&text, budget);
            assert!(found.len() == 1 && found[0].contains(wanted), "{budget}: {found:?}");
        }
        let unmeasured = found(&Records::default().to_text(), BUDGET);
        assert!(unmeasured.len() == 1 && unmeasured[0].contains("was never measured"), "{unmeasured:?}");
    }
}
