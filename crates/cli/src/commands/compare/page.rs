//! `--html`: a page that shows pairs of pictures and their errors. It holds everything that it shows: nothing is fetched.

use super::compared::Compared;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bilux::pictures::{Picture, WriteOptions};
use std::path::Path;

/// The page, with places for its rows.
const PAGE: &str = include_str!("page.html");

/// A pair on the page, as HTML.
pub(super) struct Entry(String);

impl Entry {
    /// The pair with its pictures, its metrics, and the bounds that do not hold.
    pub(super) fn of(pair: &Compared, broken: &[String]) -> anyhow::Result<Entry> {
        let name = escaped(&pair.name);
        let values = pair
            .report
            .values
            .iter()
            .map(|(metric, value)| format!("<div><dt>{metric}</dt><dd>{value:.5}</dd></div>"));
        let broken: Vec<String> = broken
            .iter()
            .map(|bound| format!("<p class=\"broken\">Out of bounds: {}</p>", escaped(bound)))
            .collect();
        let pictures =
            [("picture", &pair.picture), ("reference", &pair.reference), ("error", &pair.heat_map()?)];
        let mut images = String::new();
        for (class, picture) in pictures {
            images += &image(class, &name, picture)?;
        }
        Ok(Entry(format!(
            "<article data-view=\"slide\"><h2>{name}</h2><dl>{}</dl>{}\
             <div class=\"stage\" style=\"--w:{};--h:{}\">{images}</div></article>\n",
            values.collect::<String>(),
            broken.join(""),
            pair.picture.width(),
            pair.picture.height(),
        )))
    }
}

fn image(class: &str, name: &str, picture: &Picture) -> anyhow::Result<String> {
    let bytes = bilux::pictures::write_bytes("png", &picture.main(), &WriteOptions::default())?;
    let bytes = STANDARD.encode(bytes);
    Ok(format!("<img class=\"{class}\" alt=\"{class} of {name}\" src=\"data:image/png;base64,{bytes}\">"))
}

/// Writes the page.
pub(super) fn write(path: &Path, entries: &[Entry], troubles: &[String]) -> anyhow::Result<()> {
    let troubles: Vec<String> =
        troubles.iter().map(|trouble| format!("<p class=\"broken\">{}</p>\n", escaped(trouble))).collect();
    let rows: Vec<&str> = entries.iter().map(|Entry(html)| &**html).collect();
    let page = PAGE.replacen("<!-- troubles -->", &troubles.join(""), 1).replacen(
        "<!-- pairs -->",
        &rows.join(""),
        1,
    );
    Ok(bilux::pictures::write_atomically(path, page.as_bytes()).map_err(|error| error.in_file(path))?)
}

/// Text as HTML: names come from strangers.
fn escaped(text: &str) -> String {
    let mut html = String::new();
    for letter in text.chars() {
        match letter {
            '&' => html += "&amp;",
            '<' => html += "&lt;",
            '>' => html += "&gt;",
            '"' => html += "&quot;",
            '\'' => html += "&#39;",
            _ => html.push(letter),
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_strangers_stay_text() {
        assert_eq!(
            escaped("<img src=x onerror='a(\"b\")'> & co"),
            "&lt;img src=x onerror=&#39;a(&quot;b&quot;)&#39;&gt; &amp; co"
        );
    }

    #[test]
    fn the_page_fetches_nothing() {
        assert!(!PAGE.contains("://") && PAGE.contains("default-src 'none'"));
        assert_eq!(PAGE.matches("<!-- pairs -->").count(), 1);
    }
}
