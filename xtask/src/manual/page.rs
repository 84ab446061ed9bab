//! A page of the manual: what its Markdown says, and its HTML.

use super::paths::rewritten;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};
use std::collections::BTreeMap;

/// A link or a picture.
#[derive(Debug)]
pub(super) struct Link {
    pub(super) target: String,
    pub(super) line: usize,
    pub(super) picture: bool,
}

/// A heading and the text below it, for the search.
#[derive(Debug, Default)]
pub(super) struct Section {
    /// The heading, as text.
    pub(super) title: String,
    /// Anchor of the heading.
    pub(super) anchor: String,
    pub(super) level: usize,
    pub(super) text: String,
}

/// A page as it was read.
#[derive(Debug)]
pub(super) struct Page {
    /// From the root of the repository.
    pub(super) path: String,
    markdown: String,
    pub(super) links: Vec<Link>,
    /// HTML that is no comment, with its lines.
    pub(super) raw_html: Vec<(usize, String)>,
    pub(super) sections: Vec<Section>,
}

impl Page {
    /// Reads a page.
    pub(super) fn read(path: &str, markdown: &str) -> Page {
        let (path, markdown) = (path.to_owned(), markdown.to_owned());
        let mut page = Page { path, markdown, links: Vec::new(), raw_html: Vec::new(), sections: Vec::new() };
        let text = page.markdown.clone();
        let line = |offset: usize| text[..offset].matches('\n').count() + 1;
        let mut anchors = Anchors::default();
        let mut heading = None;
        for (event, range) in Parser::new_ext(&text, options()).into_offset_iter() {
            match event {
                Event::Start(Tag::Heading { level, .. }) => heading = Some((level, String::new())),
                Event::End(TagEnd::Heading(_)) => {
                    page.sections.extend(heading.take().map(|(level, title)| {
                        let anchor = anchors.next(&title);
                        Section { title, anchor, level: level as usize, text: String::new() }
                    }))
                }
                Event::Start(Tag::Link { dest_url, .. }) => {
                    page.links.push(Link {
                        target: dest_url.to_string(),
                        line: line(range.start),
                        picture: false,
                    });
                }
                Event::Start(Tag::Image { dest_url, .. }) => {
                    page.links.push(Link {
                        target: dest_url.to_string(),
                        line: line(range.start),
                        picture: true,
                    });
                }
                Event::Html(html) | Event::InlineHtml(html) if !is_comment(&html) => {
                    page.raw_html.push((line(range.start), html.trim().to_owned()));
                }
                Event::Text(words) | Event::Code(words) => match &mut heading {
                    Some((_, title)) => title.push_str(&words),
                    None => page.add_text(&words),
                },
                Event::SoftBreak | Event::End(TagEnd::Paragraph | TagEnd::TableCell | TagEnd::Item) => {
                    page.add_text(" ")
                }
                _ => {}
            }
        }
        page
    }

    fn add_text(&mut self, words: &str) {
        if let Some(section) = self.sections.last_mut() {
            section.text.push_str(words);
        }
    }

    /// The first heading.
    pub(super) fn title(&self) -> &str {
        self.sections.first().map_or("", |section| &section.title)
    }

    /// Whether a heading has this anchor.
    pub(super) fn has_anchor(&self, anchor: &str) -> bool {
        self.sections.iter().any(|section| section.anchor == anchor)
    }

    /// The HTML of its text. `is_chapter` says which pages are chapters.
    pub(super) fn html(&self, is_chapter: impl Fn(&str) -> bool) -> String {
        let mut sections = self.sections.iter();
        let link = |target: &str| CowStr::from(rewritten(target, &self.path, &is_chapter));
        let events = Parser::new_ext(&self.markdown, options()).filter_map(|event| match event {
            Event::Html(_) | Event::InlineHtml(_) => None,
            Event::Start(Tag::Heading { level, classes, attrs, .. }) => {
                let id = sections.next().map(|section| CowStr::from(section.anchor.clone()));
                Some(Event::Start(Tag::Heading { level, id, classes, attrs }))
            }
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                Some(Event::Start(Tag::Link { link_type, dest_url: link(&dest_url), title, id }))
            }
            Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                Some(Event::Start(Tag::Image { link_type, dest_url: link(&dest_url), title, id }))
            }
            event => Some(event),
        });
        let mut text = String::new();
        html::push_html(&mut text, events);
        // A wide table scrolls by itself, not the page.
        let text =
            text.replace("<table>", "<div class=\"table\"><table>").replace("</table>", "</table></div>");
        text.replace("<img ", "<img loading=\"lazy\" ")
    }
}

/// Whether HTML consists of comments alone, or is the line of one that goes on.
fn is_comment(html: &str) -> bool {
    let html = html.trim();
    html.is_empty() || html.starts_with("<!--") || !html.starts_with('<')
}

fn options() -> Options {
    Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH
}

/// Anchors of headings, as forges make them: small letters, hyphens for blanks, a number where one repeats.
#[derive(Default)]
struct Anchors(BTreeMap<String, usize>);

impl Anchors {
    fn next(&mut self, title: &str) -> String {
        let kept = title.to_lowercase().replace(' ', "-");
        let slug: String = kept.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect();
        let count = self.0.entry(slug.clone()).or_default();
        *count += 1;
        if *count == 1 { slug } else { format!("{slug}-{}", *count - 1) }
    }
}

/// Text in which HTML has no meaning.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_have_the_anchors_that_links_expect() {
        let page = Page::read(
            "docs/a.md",
            "# The `x` page
## Why & how
text
## Why & how
",
        );
        let anchors: Vec<_> = page.sections.iter().map(|section| section.anchor.as_str()).collect();
        assert_eq!(anchors, ["the-x-page", "why--how", "why--how-1"]);
        assert_eq!((page.title(), page.sections[1].text.trim()), ("The x page", "text"));
        assert!(page.html(|_| true).contains("<h2 id=\"why--how-1\">"));
    }

    #[test]
    fn comments_vanish_and_other_html_is_found() {
        let page = Page::read("docs/a.md", "# A\n<!-- one\ntwo -->\n\n<p>x</p>\n");
        assert_eq!(page.raw_html, [(5, "<p>x</p>".to_owned())]);
        assert!(!page.html(|_| true).contains("one"));
    }
}
