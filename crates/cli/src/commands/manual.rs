//! Shell completions, man pages and licences, all generated from the binary's own descriptions.

use crate::arguments::Arguments;
use crate::commands::DONE;
use crate::process::output;
use anyhow::Context;
use clap::CommandFactory;
use std::path::Path;

pub fn completions(shell: clap_complete::Shell) -> anyhow::Result<u8> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "bilux", &mut text);
    output::print_bytes(&text)?;
    Ok(DONE)
}

/// Prints the main page to standard output, or writes all pages to a folder.
pub fn pages(folder: Option<&Path>) -> anyhow::Result<u8> {
    match folder {
        Some(folder) => {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            write_pages(folder).with_context(|| folder.display().to_string())?;
        }
        None => {
            let mut text = Vec::new();
            clap_mangen::Man::new(command()).render(&mut text)?;
            output::print_bytes(readable(&String::from_utf8(text)?).as_bytes())?;
        }
    }
    Ok(DONE)
}

/// The command line as pages describe it: with a version that is not about one machine.
fn command() -> clap::Command {
    Arguments::command().version(env!("CARGO_PKG_VERSION"))
}

/// Writes all pages to a folder.
fn write_pages(folder: &Path) -> std::io::Result<()> {
    let mut command = command();
    clap_mangen::generate_to(command.clone(), folder)?;
    command.build();
    let mut left = vec![&command];
    while let Some(command) = left.pop() {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let page = folder.join(format!("{name}.1"));
        // There is no page about `help`.
        if page.is_file() {
            std::fs::write(&page, readable(&std::fs::read_to_string(&page)?))?;
        }
        // Benchmarks have pages of their own.
        left.extend(command.get_subcommands());
    }
    Ok(())
}

/// Gives the examples and the exit statuses sections of their own, and keeps their lines as they are.
fn readable(page: &str) -> String {
    let page = page.replace(".SH EXTRA\nExamples:\n", ".SH EXAMPLES\n.nf\n");
    let page = page.replace(".SH EXTRA\nExample:\n", ".SH EXAMPLE\n.nf\n");
    let page = page.replace("\nExit status:\n", "\n.fi\n.SH EXIT STATUS\n.nf\n");
    page.replace("\n.SH VERSION\n", "\n.fi\n.SH VERSION\n")
}

pub fn licenses() -> anyhow::Result<u8> {
    output::print(include_str!("../../../../LICENSES.txt"))?;
    Ok(DONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_a_page_keep_their_lines() {
        let page = ".SH EXTRA\nExamples:\n  one\n  two\n\nExit status:\n  0\n.SH VERSION\nv1\n";
        let wanted =
            ".SH EXAMPLES\n.nf\n  one\n  two\n\n.fi\n.SH EXIT STATUS\n.nf\n  0\n.fi\n.SH VERSION\nv1\n";
        assert_eq!(readable(page), wanted);
    }

    #[test]
    fn every_page_has_its_examples() {
        let folder = std::env::temp_dir().join(format!("bilux-pages-{}", std::process::id()));
        pages(Some(&folder)).unwrap();
        for name in ["bilux", "bilux-render", "bilux-compare", "bilux-schema", "bilux-bench-render"] {
            let page = std::fs::read_to_string(folder.join(format!("{name}.1"))).unwrap();
            assert!(page.contains(".SH EXAMPLE") && !page.contains(".SH EXTRA"), "{name}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
