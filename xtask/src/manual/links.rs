//! Targets of links: another page of the manual, a picture, or a file of the repository, which is shown as it
//! is.

use super::page::{Link, Page};
use super::paths::{is_web, resolve, split};
use std::fmt;
use std::path::Path;

/// Something that is wrong with a page.
#[derive(Debug)]
pub(super) struct Problem {
    pub(super) path: String,
    /// From 1; 0 for the whole page.
    pub(super) line: usize,
    pub(super) message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}: {}", self.path, self.line, self.message)
    }
}

/// The files that the links of a page lead to, and what is wrong with the page.
pub(super) fn check(root: &Path, page: &Page, pages: &[Page]) -> (Vec<String>, Vec<Problem>) {
    let mut targets = Vec::new();
    let mut problems = Vec::new();
    let mut fault = |line: usize, message: String| {
        problems.push(Problem { path: page.path.clone(), line, message });
    };
    for (line, html) in &page.raw_html {
        fault(*line, format!("only comments may be HTML, not '{html}'"));
    }
    for link in &page.links {
        match target(link, page) {
            Target::Web if link.picture => {
                fault(link.line, format!("the picture '{}' lies on another server", link.target));
            }
            Target::Web => {}
            Target::File { path, anchor } => {
                let other = pages.iter().find(|other| other.path == path);
                let heading = |anchor: &str| other.is_none_or(|other| other.has_anchor(anchor));
                if !root.join(&path).exists() {
                    fault(link.line, format!("the link '{}' leads nowhere", link.target));
                } else if anchor.is_some_and(|anchor| !heading(&anchor)) {
                    fault(link.line, format!("the link '{}' names a heading that is not there", link.target));
                } else {
                    targets.push(path);
                }
            }
        }
    }
    (targets, problems)
}

enum Target {
    /// Another server.
    Web,
    /// A file of the repository, and a heading in it.
    File { path: String, anchor: Option<String> },
}

fn target(link: &Link, page: &Page) -> Target {
    if is_web(&link.target) {
        return Target::Web;
    }
    let (path, anchor) = split(&link.target);
    let path = if path.is_empty() { page.path.clone() } else { resolve(&page.path, path) };
    Target::File { path, anchor: anchor.map(str::to_owned) }
}
