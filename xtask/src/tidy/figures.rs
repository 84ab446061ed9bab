//! Figures of speed name their machine and day, and the pages agree: `cargo xtask performance` writes them.

use super::repository::Repository;
use super::violation::Violation;
use crate::performance::{PAGES, all, named};
use std::collections::HashMap;

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut known: HashMap<&str, (&str, &str)> = HashMap::new();
    // The page with whole tables comes last.
    for page in PAGES.iter().rev() {
        let Some(text) = repository.file(page).map(|file| &file.text) else { continue };
        let found = all(text);
        if found.len() != named(text) {
            violations.push(Violation::new(
                page,
                0,
                "has a comment of figures that no block of `text` follows",
            ));
        }
        for figures in found {
            let mut complain = |message: String| violations.push(Violation::new(page, figures.line, message));
            if !names_machine_and_day(figures.printed) {
                complain("these figures name no machine or no day: run `cargo xtask performance`".to_owned());
            }
            let (first, printed) = *known.entry(figures.command).or_insert((page, figures.printed));
            if figures.shown(printed) != figures.printed {
                complain(format!(
                    "`{}` printed something else in {first}: run `cargo xtask performance`",
                    figures.command
                ));
            }
        }
    }
    violations
}

/// Whether the first line ends with the number of cores and a day, as in `a CPU, 2 cores, 2026-11-25`.
fn names_machine_and_day(printed: &str) -> bool {
    let heading = printed.lines().next().unwrap_or_default();
    let mut parts = heading.rsplit(", ");
    let is_day = |day: &str| {
        let numbers: Vec<_> =
            day.split('-').map(|number| (number.len(), number.parse::<u16>().is_ok())).collect();
        numbers == [(4, true), (2, true), (2, true)]
    };
    parts.next().is_some_and(is_day)
        && parts.next().is_some_and(|cores| cores.ends_with(" cores"))
        && parts.next().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(printed: &str) -> String {
        format!("# Page\n\n<!-- figures: bilux bench rays -->\n```text\n{printed}\n```\n")
    }

    #[test]
    fn figures_that_disagree_or_name_no_machine_are_found() {
        let good = page("a CPU (AVX2), 2 cores, 2026-11-25\n1 2");
        let complaints = |readme: &str, other: &str| {
            check(&Repository::planted(&[(PAGES[0], readme), (PAGES[1], other)])).len()
        };
        assert_eq!(complaints(&good, &good), 0);
        assert_eq!(complaints(&good, "# Page\n"), 0);
        assert_eq!(complaints(&good, &page("a CPU (AVX2), 2 cores, 2026-11-26\n1 2")), 1);
        assert_eq!(complaints("# Page\n", &page("a CPU (AVX2), 2026-11-25\n1 2")), 1);
        assert_eq!(complaints("# Page\n", &page("a CPU, 2 cores\n1 2")), 1);
        assert_eq!(complaints("# Page\n", "<!-- figures: bilux bench rays -->\nnothing\n"), 1);
    }
}
