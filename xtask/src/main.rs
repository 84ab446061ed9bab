//! Repository chores: `cargo xtask COMMAND`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command line program speaks to its user")]

mod build;
mod build_time;
mod command_pages;
mod contact_sheet;
mod cores;
mod cpu_levels;
mod dist;
mod docs;
mod gallery;
mod instructions;
mod library_docs;
mod licences;
mod manual;
mod misuse;
mod mutants;
mod package;
mod performance;
mod process;
mod python;
mod stamp;
mod strips;
mod suites;
mod test;
mod tidy;
mod verdicts;
mod viewer;
mod workspace;

use misuse::Misuse;
use std::process::ExitCode;

/// One chore.
struct Chore {
    name: &'static str,
    summary: &'static str,
    run: fn(&[String]) -> anyhow::Result<()>,
}

/// Every chore.
const CHORES: &[Chore] = &[
    Chore { name: "test", summary: "every check that a change must pass", run: test::run },
    Chore { name: "tidy", summary: "the repository's own rules", run: tidy::run },
    Chore {
        name: "licences",
        summary: "check that the licence of every dependency is permissive",
        run: licences::run,
    },
    Chore { name: "docs", summary: "library documentation and reference pages", run: docs::run },
    Chore { name: "manual", summary: "the manual as web pages, in target/manual", run: manual::run },
    Chore {
        name: "strips",
        summary: "render what each parameter of materials, lights and textures does (minutes)",
        run: strips::run,
    },
    Chore {
        name: "gallery",
        summary: "render the pictures of the manual (minutes; `--only WORD` for some of them)",
        run: gallery::run,
    },
    Chore { name: "contact-sheet", summary: "models next to their screenshots", run: contact_sheet::run },
    Chore {
        name: "dist",
        summary: "build the release: the binary, its man pages, a checksum",
        run: dist::run,
    },
    Chore {
        name: "package",
        summary: "check that the libraries can be published to a package registry (minutes)",
        run: package::run,
    },
    Chore {
        name: "performance",
        summary: "measure the figures of the README and of docs/performance.md again (half an hour)",
        run: performance::run,
    },
    Chore {
        name: "build-time",
        summary: "measure the first build and builds after one changed line, in a clone (half an hour)",
        run: build_time::run,
    },
    Chore { name: "wheel", summary: "build the wheel of the Python package", run: python::wheel },
    Chore {
        name: "python-cluster",
        summary: "test bilux.cluster on a Ray cluster of two nodes (downloads Ray; minutes)",
        run: python::cluster,
    },
    Chore {
        name: "verdicts",
        summary: "run the statistical tests whole, and compare their verdicts (minutes; `--write` records them)",
        run: verdicts::run,
    },
    Chore { name: "viewer", summary: "test the viewer in a browser, and take screenshots", run: viewer::run },
    Chore { name: "instructions", summary: "count the instructions per ray", run: instructions::run },
    Chore {
        name: "cpu-levels",
        summary: "check that every CPU level renders the same pictures (minutes)",
        run: cpu_levels::run,
    },
    Chore {
        name: "mutants",
        summary: "which bugs, planted in changed lines or in those whose turn it is, no test notices (minutes to hours)",
        run: mutants::run,
    },
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((name, rest)) = arguments.split_first() else {
        return usage("say which chore");
    };
    let Some(chore) = CHORES.iter().find(|chore| chore.name == name) else {
        return usage(&format!("there is no chore '{name}'"));
    };
    match (chore.run)(rest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask {name}: {error:#}");
            if error.is::<Misuse>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

fn usage(problem: &str) -> ExitCode {
    eprintln!("xtask: {problem}\n\nusage: cargo xtask CHORE\n");
    for chore in CHORES {
        eprintln!("  {:<13} {}", chore.name, chore.summary);
    }
    ExitCode::from(2)
}
