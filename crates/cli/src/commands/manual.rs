//! Shell completions, man pages and licences, all generated from the binary's own descriptions.

use super::DONE;
use crate::arguments::Arguments;
use crate::output;
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
            clap_mangen::generate_to(Arguments::command(), folder)
                .with_context(|| folder.display().to_string())?;
        }
        None => {
            let mut text = Vec::new();
            clap_mangen::Man::new(Arguments::command()).render(&mut text)?;
            output::print_bytes(&text)?;
        }
    }
    Ok(DONE)
}

pub fn licenses() -> anyhow::Result<u8> {
    output::print(include_str!("../../../../LICENSES.txt"))?;
    Ok(DONE)
}
