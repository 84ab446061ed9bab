//! `docs/SUMMARY.md`: the chapters of the manual, in the form that mdBook reads.

use super::paths::resolve;
use anyhow::{Result, bail};

/// The list of chapters.
pub(crate) const SUMMARY: &str = "docs/SUMMARY.md";

/// The chapters, in parts.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Summary {
    pub(super) parts: Vec<Part>,
}

/// Chapters under one heading; the first part has none.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Part {
    pub(super) title: String,
    pub(super) chapters: Vec<Chapter>,
}

/// A chapter.
#[derive(Debug, PartialEq)]
pub(super) struct Chapter {
    pub(super) title: String,
    /// Page of the chapter, as a path from the root of the repository.
    pub(super) path: String,
    /// Depth in the list: 0 for the outermost.
    pub(super) depth: usize,
}

impl Summary {
    /// Every chapter, in order.
    pub(super) fn chapters(&self) -> impl Iterator<Item = &Chapter> {
        self.parts.iter().flat_map(|part| &part.chapters)
    }
}

/// Reads the list. `# Title` begins a part, `- [Title](page.md)` is a chapter, indented by two blanks for each level; one
/// without a dash comes before the others.
pub(super) fn read(text: &str) -> Result<Summary> {
    let mut summary = Summary { parts: vec![Part::default()] };
    for (number, line) in text.lines().enumerate().skip(1) {
        if let Some(title) = line.strip_prefix("# ") {
            summary.parts.push(Part { title: title.to_owned(), chapters: Vec::new() });
        } else if !line.trim().is_empty() {
            let Some(chapter) = chapter(line) else {
                bail!("{}:{}: this is no chapter: `- [Title](page.md)` is one", SUMMARY, number + 1);
            };
            if summary.chapters().any(|other| other.path == chapter.path) {
                bail!("{}:{}: {} is listed twice", SUMMARY, number + 1, chapter.path);
            }
            if let Some(part) = summary.parts.last_mut() {
                part.chapters.push(chapter);
            }
        }
    }
    Ok(summary)
}

fn chapter(line: &str) -> Option<Chapter> {
    let depth = (line.len() - line.trim_start().len()) / 2;
    let link = line.trim().trim_start_matches("- ").strip_prefix('[')?.strip_suffix(')')?;
    let (title, path) = link.split_once("](")?;
    Some(Chapter { title: title.to_owned(), path: resolve(SUMMARY, path), depth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_depths_are_read() {
        let text = "# Summary\n\n[Bilux](../README.md)\n\n# Guide\n\n- [A `b`](a.md)\n  - [C](x/c.md)\n";
        let summary = read(text).expect("a list");
        let found: Vec<_> =
            summary.chapters().map(|c| (c.title.as_str(), c.path.as_str(), c.depth)).collect();
        assert_eq!(found, [("Bilux", "README.md", 0), ("A `b`", "docs/a.md", 0), ("C", "docs/x/c.md", 1)]);
        assert_eq!(summary.parts[1].title, "Guide");
        assert!(read("# Summary\n- no link\n").is_err());
        assert!(read("# Summary\n- [A](a.md)\n- [B](a.md)\n").is_err());
    }
}
