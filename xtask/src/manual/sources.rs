//! Files of the repository that a chapter links to, shown as they are, so that the manual works without the repository.

use super::page::escaped;
use super::paths::{Files, source_path};
use super::summary::Summary;
use super::theme;
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// The page of a file, or those of a folder and of the files in it.
pub(super) fn files(root: &Path, target: &str, summary: &Summary) -> Result<Files> {
    let path = root.join(target);
    let mut files = Files::new();
    if path.is_dir() {
        let listing = fs::read_dir(&path).with_context(|| format!("cannot list {target}"))?;
        let mut names: Vec<String> = Vec::new();
        for entry in listing {
            let entry = entry?;
            if entry.file_type()?.is_file() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.sort();
        let folder = target.rsplit('/').next().unwrap_or(target);
        let items: String = names
            .iter()
            .map(|name| {
                format!("<li><a href=\"{folder}/{name}.html\"><code>{}</code></a></li>\n", escaped(name))
            })
            .collect();
        files.insert(source_path(target), page(target, &format!("<ul>\n{items}</ul>\n"), summary));
        for name in names {
            let file = format!("{target}/{name}");
            files.insert(source_path(&file), page(&file, &shown(root, &file)?, summary));
        }
    } else {
        files.insert(source_path(target), page(target, &shown(root, target)?, summary));
    }
    Ok(files)
}

fn shown(root: &Path, path: &str) -> Result<String> {
    let bytes = fs::read(root.join(path)).with_context(|| format!("cannot read {path}"))?;
    let text = String::from_utf8(bytes);
    Ok(match text {
        Ok(text) => format!("<pre><code>{}</code></pre>\n", escaped(&text)),
        Err(error) => format!("<p>A binary file of {} bytes.</p>\n", error.as_bytes().len()),
    })
}

fn page(path: &str, body: &str, summary: &Summary) -> Vec<u8> {
    let body = format!("<h1><code>{}</code></h1>\n{body}", escaped(path));
    theme::document(&source_path(path), path, &body, summary).into_bytes()
}
