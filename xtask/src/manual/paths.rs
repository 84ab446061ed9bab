//! Places of the repository's files in the manual, and the links to them.

use std::collections::BTreeMap;

/// Everything that is written: the path from the folder of the manual, and the bytes.
pub(super) type Files = BTreeMap<String, Vec<u8>>;

/// Whether a link leads to another server, or to a mailbox.
pub(super) fn is_web(target: &str) -> bool {
    target.contains("://") || target.starts_with("mailto:")
}

/// The path and the anchor of a link.
pub(super) fn split(target: &str) -> (&str, Option<&str>) {
    target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)))
}

/// Whether the manual takes a file as it is.
pub(super) fn is_picture(path: &str) -> bool {
    [".png", ".jpg", ".svg", ".webp"].iter().any(|ending| path.ends_with(ending))
}

/// A link of a page as the manual has it. `is_chapter` says which pages are chapters.
pub(super) fn rewritten(link: &str, page: &str, is_chapter: impl Fn(&str) -> bool) -> String {
    let (path, anchor) = split(link);
    if is_web(link) || path.is_empty() {
        return link.to_owned();
    }
    let path = resolve(page, path);
    let to = if is_picture(&path) || is_chapter(&path) { output_path(&path) } else { source_path(&path) };
    let anchor = anchor.map_or_else(String::new, |anchor| format!("#{anchor}"));
    relative(&output_path(page), &to) + &anchor
}

/// Path in the manual of a file of the repository: a page is `.html`, and `README.md` is the first of its folder.
pub(super) fn output_path(path: &str) -> String {
    let path = path.strip_prefix("docs/").unwrap_or(path);
    let path = path.replace("README.md", "index.md");
    path.strip_suffix(".md").map_or(path.clone(), |stem| format!("{stem}.html"))
}

/// Path at which the manual shows a file or a folder that is no chapter.
pub(super) fn source_path(path: &str) -> String {
    format!("source/{path}.html")
}

/// The way from one file of the manual to another.
pub(super) fn relative(from: &str, to: &str) -> String {
    let (from, to): (Vec<&str>, Vec<&str>) = (from.split('/').collect(), to.split('/').collect());
    let folders = &from[..from.len() - 1];
    let last = to.len() - 1;
    let shared = folders.iter().zip(&to[..last]).take_while(|(a, b)| a == b).count();
    "../".repeat(folders.len() - shared) + &to[shared..].join("/")
}

/// A target of a page, as a path from the root of the repository.
pub(super) fn resolve(page: &str, target: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            name => parts.push(name),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_from_page_to_page() {
        let is_chapter = |path: &str| path.ends_with(".md");
        let from = |page: &str, link: &str| rewritten(link, page, is_chapter);
        assert_eq!(from("README.md", "docs/tutorials/README.md#x"), "tutorials/index.html#x");
        assert_eq!(from("docs/tutorials/room.md", "../../README.md"), "../index.html");
        assert_eq!(from("docs/tutorials/room.md", "product.md"), "product.html");
        assert_eq!(from("docs/trust.md", "../crates/a/b.rs"), "source/crates/a/b.rs.html");
        assert_eq!(from("README.md", "docs/gallery/pool.png"), "gallery/pool.png");
        assert_eq!(from("docs/a.md", "#here"), "#here");
        assert_eq!(from("docs/a.md", "https://example.org/a.md"), "https://example.org/a.md");
    }
}
