//! The frame around each page: chapters at the side, search, and what is before and after. Everything is in the folder of
//! the manual, so that it works without a network, and without a server.

use super::page::{Page, escaped};
use super::paths::{Files, output_path, relative};
use super::summary::{Chapter, Summary};

const STYLE: &str = include_str!("manual.css");
const SCRIPT: &str = include_str!("manual.js");

/// Every page, its style, its script, and the index of the search.
pub(super) fn files(summary: &Summary, pages: &[Page]) -> Files {
    let mut files = Files::new();
    let is_chapter = |path: &str| pages.iter().any(|page| page.path == path);
    for (number, page) in pages.iter().enumerate() {
        let neighbour = |number: Option<usize>| number.and_then(|number| pages.get(number));
        let body = page.html(is_chapter)
            + &turning(page, neighbour(number.checked_sub(1)), neighbour(Some(number + 1)));
        let path = output_path(&page.path);
        let document = document(&path, page.title(), &body, summary);
        files.insert(path, document.into_bytes());
    }
    files.insert("manual.css".to_owned(), STYLE.into());
    files.insert("manual.js".to_owned(), SCRIPT.into());
    files.insert("search.js".to_owned(), search(pages).into_bytes());
    files
}

/// A whole document at this path of the manual.
pub(super) fn document(path: &str, title: &str, body: &str, summary: &Summary) -> String {
    let up = relative(path, "");
    let title = if title == "Bilux" { "Bilux".to_owned() } else { format!("{} – Bilux", escaped(title)) };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<link rel=\"stylesheet\" href=\"{up}manual.css\">\n\
         <script>document.documentElement.dataset.theme = localStorage.getItem(\"theme\") || \"\"</script>\n\
         </head>\n<body data-root=\"{up}\">\n<a class=\"skip\" href=\"#text\">Skip to the text</a>\n\
         <header><button id=\"chapters\" aria-expanded=\"false\" aria-controls=\"sidebar\">Chapters</button>\
         <a class=\"home\" href=\"{up}index.html\">Bilux</a>\
         <input id=\"search\" type=\"search\" placeholder=\"Search ( / )\" aria-label=\"Search the manual\">\
         <button id=\"theme\" title=\"Dark or light\" aria-label=\"Dark or light\">◐</button></header>\n\
         <nav id=\"sidebar\" aria-label=\"Chapters\">\n{}</nav>\n\
         <main id=\"text\">\n<div id=\"found\" role=\"status\" hidden></div>\n<article>\n{body}</article>\n</main>\n\
         <script src=\"{up}search.js\" defer></script>\n<script src=\"{up}manual.js\" defer></script>\n\
         </body>\n</html>\n",
        sidebar(path, summary),
    )
}

/// The chapters, part by part.
fn sidebar(path: &str, summary: &Summary) -> String {
    let mut html = String::new();
    for part in summary.parts.iter().filter(|part| !part.chapters.is_empty()) {
        if !part.title.is_empty() {
            html += &format!("<h2>{}</h2>\n", escaped(&part.title));
        }
        html += "<ul>\n";
        html.extend(part.chapters.iter().map(|chapter| item(path, chapter)));
        html += "</ul>\n";
    }
    html
}

fn item(path: &str, chapter: &Chapter) -> String {
    let to = output_path(&chapter.path);
    let current = if to == path { " aria-current=\"page\"" } else { "" };
    let (link, title) = (relative(path, &to), escaped(&chapter.title.replace('`', "")));
    format!("<li class=\"depth-{}\"><a href=\"{link}\"{current}>{title}</a></li>\n", chapter.depth)
}

/// Links to the pages before and after.
fn turning(page: &Page, before: Option<&Page>, after: Option<&Page>) -> String {
    let link = |other: Option<&Page>, rel: &str, arrow: [&str; 2]| {
        other.map_or_else(String::new, |other| {
            let (to, title) =
                (relative(&output_path(&page.path), &output_path(&other.path)), escaped(other.title()));
            format!("<a rel=\"{rel}\" href=\"{to}\">{}{title}{}</a>", arrow[0], arrow[1])
        })
    };
    let (before, after) = (link(before, "prev", ["← ", ""]), link(after, "next", ["", " →"]));
    format!("<footer class=\"turning\">{before}{after}</footer>\n")
}

/// The index of the search: page, heading, address and text of every section.
fn search(pages: &[Page]) -> String {
    let mut rows = Vec::new();
    for page in pages {
        let path = output_path(&page.path);
        for section in &page.sections {
            let address =
                if section.level == 1 { path.clone() } else { format!("{path}#{}", section.anchor) };
            let text: Vec<&str> = section.text.split_whitespace().collect();
            rows.push(serde_json::json!([page.title(), section.title, address, text.join(" ")]).to_string());
        }
    }
    format!("const SECTIONS = [\n{}\n];\n", rows.join(",\n"))
}
