//! The page with the notices of everything that the binary and the Python package are built from.

use crate::process::root;
use crate::workspace::{Package, built_into};
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Products that are handed out: the binary, and the Python package.
const PRODUCTS: [&str; 2] = ["bilux-cli", "bilux-python"];

const RULE: &str = "------------------------------------------------------------------------------";

/// The page: our own licence, the packages that we build on, and each notice once.
pub(super) fn page(packages: &[Package]) -> Result<String> {
    let own = root().join("LICENSE-MIT");
    let own = fs::read_to_string(&own).with_context(|| format!("cannot read {}", own.display()))?;
    let parts = PRODUCTS.iter().flat_map(|product| built_into(product, packages));
    let mut parts: Vec<_> = parts.filter(|part| !part.member).collect();
    parts.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    parts.dedup_by(|a, b| a.id == b.id);
    let mut page = format!(
        "Bilux is licensed under the MIT licence, which follows, or, as you like, under the Apache\n\
         License 2.0 (LICENSE-APACHE in its repository).\n\n{}\n\n{RULE}\n\
         It is built with the Rust standard library (MIT OR Apache-2.0, https://github.com/rust-lang/rust)\n\
         and from these packages, whose notices follow.\n\n",
        tidied(&own)
    );
    for Package { name, version, licence, repository, .. } in &parts {
        let licence = licence.as_deref().unwrap_or_default();
        page +=
            &format!("{name} {version}, {licence}, {}\n", repository.as_deref().unwrap_or("no home page"));
    }
    for (text, names) in notices(&parts)?.into_values() {
        page += &format!("\n{RULE}\n{}\n\n{text}\n", wrapped(&names));
    }
    Ok(page)
}

/// Each distinct notice with the names of the packages that carry it, keyed by the notice's words.
fn notices<'a>(parts: &[&'a Package]) -> Result<BTreeMap<String, (String, Vec<&'a str>)>> {
    let mut notices: BTreeMap<String, (String, Vec<&str>)> = BTreeMap::new();
    for part in parts {
        for file in chosen(file_names(&part.folder)?) {
            let bytes =
                fs::read(part.folder.join(&file)).with_context(|| format!("{} of {}", file, part.name))?;
            let text = tidied(&String::from_utf8_lossy(&bytes));
            let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
            let notice = notices.entry(words).or_insert_with(|| (text, Vec::new()));
            if !notice.1.contains(&part.name.as_str()) {
                notice.1.push(&part.name);
            }
        }
    }
    Ok(notices)
}

fn file_names(folder: &Path) -> Result<Vec<String>> {
    let listing = fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let files = listing.filter_map(|entry| entry.ok().filter(|entry| entry.path().is_file()));
    let mut names: Vec<_> = files.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    Ok(names)
}

/// The files that carry the notice: if there is a choice of licences, the MIT one, which is the shortest, together with
/// whatever must accompany it.
fn chosen(names: Vec<String>) -> Vec<String> {
    let upper = |name: &str| name.to_uppercase();
    let is_notice = |name: &String| {
        let starts = ["LICENSE", "LICENCE", "COPYING", "UNLICENSE", "NOTICE", "COPYRIGHT"];
        starts.iter().any(|start| upper(name).starts_with(start))
    };
    let mut names: Vec<_> = names.into_iter().filter(is_notice).collect();
    if names.iter().any(|name| upper(name).contains("MIT")) {
        let goes_along = ["MIT", "NOTICE", "UNICODE"];
        names.retain(|name| goes_along.iter().any(|word| upper(name).contains(word)));
    }
    names
}

/// A text without carriage returns, trailing spaces, and leading and trailing empty lines.
fn tidied(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_matches('\n').to_owned()
}

fn wrapped(names: &[&str]) -> String {
    let mut text = String::new();
    let mut width = 0;
    for (number, name) in names.iter().enumerate() {
        let separator = match number {
            0 => "",
            _ if width + name.len() > RULE.len() - 2 => ",\n",
            _ => ", ",
        };
        width = if separator.ends_with('\n') { 0 } else { width + separator.len() } + name.len();
        text = text + separator + name;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen_of(names: &[&str]) -> Vec<String> {
        chosen(names.iter().map(|&name| name.to_owned()).collect())
    }

    #[test]
    fn the_shortest_choice_is_taken_with_its_dependents() {
        assert_eq!(chosen_of(&["Cargo.toml", "LICENSE-APACHE", "LICENSE-MIT"]), ["LICENSE-MIT"]);
        let names = ["LICENSE-APACHE", "LICENSE-MIT", "LICENSE-UNICODE"];
        assert_eq!(chosen_of(&names), ["LICENSE-MIT", "LICENSE-UNICODE"]);
        assert_eq!(chosen_of(&["LICENSE.md", "README.md"]), ["LICENSE.md"]);
    }

    #[test]
    fn equal_notices_are_listed_once_whatever_their_line_ends() {
        let folder = std::env::temp_dir().join(format!("bilux-notices-{}", std::process::id()));
        let write = |name: &str, text: &str| {
            fs::create_dir_all(folder.join(name))
                .and_then(|()| fs::write(folder.join(name).join("LICENSE"), text))
        };
        write("a", "be\nnice \n")
            .and_then(|()| write("b", "\r\nbe nice\r\n"))
            .expect("a folder for the test");
        let package =
            |name: &str| Package { name: name.into(), folder: folder.join(name), ..Package::default() };
        let (a, b) = (package("a"), package("b"));
        let notices = notices(&[&a, &b]);
        fs::remove_dir_all(&folder).expect("the folder of the test goes away");
        let notices: Vec<_> = notices.expect("both can be read").into_values().collect();
        assert_eq!(notices, [("be\nnice".to_owned(), vec!["a", "b"])]);
    }
}
