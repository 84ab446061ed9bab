//! `cargo xtask tidy`: the repository's own rules, one per file; the table is [`RULES`].

mod changelog;
mod chapters;
mod circles;
mod citations;
mod decisions;
mod dependencies;
mod directions;
mod doc_comments;
mod figures;
mod file_length;
mod forbidden;
mod front_page;
mod front_page_names;
mod function_length;
mod ignored_tests;
mod links;
mod manifests;
mod measures;
mod modules;
mod portable;
mod reading_order;
mod registries;
mod repository;
mod rooms;
mod rust_text;
mod test_suites;
mod unsafe_code;
mod verdicts;
mod violation;

use anyhow::{Result, bail};
use repository::Repository;
use violation::Violation;

/// One rule.
struct Rule {
    name: &'static str,
    check: fn(&Repository) -> Vec<Violation>,
}

/// Every rule. Each one's file says what it requires, why, and how to satisfy it.
const RULES: &[Rule] = &[
    Rule { name: "file-length", check: file_length::check },
    Rule { name: "function-length", check: function_length::check },
    Rule { name: "forbidden", check: forbidden::check },
    Rule { name: "ignored-tests", check: ignored_tests::check },
    Rule { name: "test-suites", check: test_suites::check },
    Rule { name: "verdicts", check: verdicts::check },
    Rule { name: "unsafe-code", check: unsafe_code::check },
    Rule { name: "portable", check: portable::check },
    Rule { name: "citations", check: citations::check },
    Rule { name: "links", check: links::check },
    Rule { name: "chapters", check: chapters::check },
    Rule { name: "registries", check: registries::check },
    Rule { name: "manifests", check: manifests::check },
    Rule { name: "directions", check: directions::check },
    Rule { name: "circles", check: circles::check },
    Rule { name: "reading-order", check: reading_order::check },
    Rule { name: "rooms", check: rooms::check },
    Rule { name: "dependencies", check: dependencies::check },
    Rule { name: "changelog", check: changelog::check },
    Rule { name: "doc-comments", check: doc_comments::check },
    Rule { name: "front-page", check: front_page::check },
    Rule { name: "front-page-names", check: front_page_names::check },
    Rule { name: "figures", check: figures::check },
    Rule { name: "decisions", check: decisions::check },
];

/// Applies every rule to the repository as it is on disk, or prints its measures.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let repository = Repository::read()?;
    match arguments {
        [] => {}
        [word] if word == "--measures" => {
            print!("{}", measures::table(&repository));
            return Ok(());
        }
        _ => bail!("the only option is `--measures`"),
    }
    let mut count = 0;
    for rule in RULES {
        for violation in (rule.check)(&repository) {
            println!("{violation} [{}]", rule.name);
            count += 1;
        }
    }
    if count > 0 {
        bail!("{count} untidy places");
    }
    println!("{} files, {} rules, all tidy", repository.files.len(), RULES.len());
    Ok(())
}
