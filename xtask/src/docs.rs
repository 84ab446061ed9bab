//! `cargo xtask docs`: the library documentation, and the reference pages in `docs/reference/`, which are generated
//! from the tables that the binary lists. `--check` only checks whether those pages are up to date.

use crate::process::{cargo, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

/// The folder of the pages, relative to the root of the repository.
const FOLDER: &str = "docs/reference";

/// The names that `bilux list` accepts, and the title of each one's page.
const TABLES: &[(&str, &str)] = &[
    ("integrators", "Integrators"),
    ("accels", "Accelerators"),
    ("visibility", "Hidden-surface removal"),
    ("materials", "Materials"),
    ("textures", "Procedural textures"),
    ("bsdfs", "BSDFs"),
    ("lights", "Lights"),
    ("cameras", "Cameras"),
    ("generators", "Built-in scenes"),
    ("presets", "Presets"),
    ("formats", "Scene formats"),
    ("picture-formats", "Picture formats"),
    ("tonemaps", "Tone curves"),
    ("filters", "Pixel filters"),
    ("aovs", "Arbitrary output variables"),
    ("metrics", "Metrics"),
    ("settings", "Settings"),
];

/// Generates the pages and the library documentation, or checks the pages.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let check = match arguments {
        [] => false,
        [word] if word == "--check" => true,
        _ => bail!("the only option is `--check`"),
    };
    // Builds as the tests do, so that no package is built a second time with other features.
    run_process(&mut cargo(&["test", "--quiet", "--locked", "--workspace", "--no-run"]))?;
    if check {
        return check_reference();
    }
    write(&pages()?)?;
    let types = &["test", "--quiet", "--locked", "--workspace", "--test", "typed", "every_material"];
    run_process(cargo(types).env("BILUX_WRITE_TYPES", "1"))?;
    library()
}

/// Checks the reference pages against the binary that the tests have built.
pub(crate) fn check_reference() -> Result<()> {
    compare(&pages()?)
}

/// Builds the documentation of the libraries; a warning is an error. Public items may link to private ones that explain
/// them: anyone who wants the explanation reads the source.
pub(crate) fn library() -> Result<()> {
    let mut command = cargo(&["doc", "--locked", "--workspace", "--no-deps", "--quiet"]);
    run_process(command.env("RUSTDOCFLAGS", "--deny warnings --allow rustdoc::private_intra_doc_links"))
}

/// Every page by its file name.
fn pages() -> Result<BTreeMap<String, String>> {
    let mut pages = BTreeMap::new();
    let mut front = "# Reference\n\nEverything that can be named on the command line and in scene files. \
                     These pages are made by `cargo xtask docs`.\n\n"
        .to_owned();
    for (name, title) in TABLES {
        let text = bilux(&["list", name, "--json"])?;
        let rows: Value =
            serde_json::from_str(&text).with_context(|| format!("`bilux list {name} --json`"))?;
        let rows =
            rows[*name].as_array().with_context(|| format!("`bilux list {name} --json` lists no rows"))?;
        pages.insert(format!("{name}.md"), page(name, title, rows));
        let names: Vec<_> = rows.iter().map(|row| format!("`{}`", text_of(row, "name"))).collect();
        front += &format!("- [{title}]({name}.md): {}\n", names.join(", "));
    }
    front += "- [JSON schema of scene files](scene.schema.json), for editors\n";
    pages.insert("README.md".to_owned(), front);
    pages.insert("scene.schema.json".to_owned(), bilux(&["schema"])?.trim_end().to_owned() + "\n");
    Ok(pages)
}

fn bilux(arguments: &[&str]) -> Result<String> {
    output(Command::new(target_folder().join("debug").join("bilux")).args(arguments))
}

fn page(name: &str, title: &str, rows: &[Value]) -> String {
    let mut page = format!(
        "# {title}\n\nMade by `cargo xtask docs` from what `bilux list {name}` lists; not edited by hand.\n"
    );
    for row in rows {
        page += &format!("\n## `{}`\n{}.", text_of(row, "name"), capitalised(text_of(row, "summary")));
        match text_of(row, "source") {
            "" => {}
            source => page += &format!(" [[{source}]](../../REFERENCES.md)"),
        }
        page += "\n";
        let parameters = row["parameters"].as_array().into_iter().flatten().map(parameter);
        let parameters: String = parameters.collect();
        if !parameters.is_empty() {
            page += "\n| parameter | what | values | unit | default |\n| --- | --- | --- | --- | --- |\n";
            page += &parameters;
        }
    }
    page
}

fn parameter(parameter: &Value) -> String {
    let cell = |key: &str| text_of(parameter, key).replace('|', "\\|");
    let default = match text_of(parameter, "default") {
        "" => "required".to_owned(),
        default => format!("`{default}`"),
    };
    let (name, summary, values, unit) = (cell("name"), cell("summary"), cell("values"), cell("unit"));
    format!("| `{name}` | {summary} | {values} | {unit} | {default} |\n")
}

fn text_of<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

fn capitalised(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

fn compare(pages: &BTreeMap<String, String>) -> Result<()> {
    let folder = root().join(FOLDER);
    let stale = pages.iter().filter(|(name, page)| !is_fresh(&fs::read(folder.join(name)), page));
    let stale: Vec<_> = stale.map(|(name, _)| name.as_str()).collect();
    if !stale.is_empty() {
        bail!("out of date in {FOLDER}: {}; run `cargo xtask docs`", stale.join(", "));
    }
    println!("{} pages in {FOLDER}, all fresh", pages.len());
    Ok(())
}

fn is_fresh(file: &std::io::Result<Vec<u8>>, page: &str) -> bool {
    file.as_ref().is_ok_and(|bytes| bytes == page.as_bytes())
}

fn write(pages: &BTreeMap<String, String>) -> Result<()> {
    let folder = root().join(FOLDER);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {FOLDER}"))?;
    for (name, page) in pages {
        fs::write(folder.join(name), page).with_context(|| format!("cannot write {FOLDER}/{name}"))?;
    }
    println!("{} pages in {FOLDER}", pages.len());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_row_becomes_a_section_with_its_parameters() {
        let parameter =
            json!({ "name": "mode", "summary": "which", "unit": "", "values": "a|b", "default": "" });
        let rows = [
            json!({ "name": "x", "summary": "an x", "source": "Woop 2013", "parameters": [parameter] }),
            json!({ "name": "y", "summary": "a y", "source": "", "parameters": [] }),
        ];
        let page = page("things", "Things", &rows);
        assert!(
            page.contains("\n## `x`\nAn x. [[Woop 2013]](../../REFERENCES.md)\n\n| parameter "),
            "{page}"
        );
        assert!(page.contains("| `mode` | which | a\\|b |  | required |\n\n## `y`\nA y.\n"), "{page}");
    }
}
