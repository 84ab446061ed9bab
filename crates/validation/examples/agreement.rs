//! Renders every shipped scene with every unbiased integrator, and compares their pictures block by block.
//!
//! ```text
//! cargo run --release -p bilux-validation --example agreement -- [--seconds N] [--scenes A,B] [--size 64x48] [--seed N]
//! ```
//! Each integrator has N seconds for each scene (3 by default). Each pair has a line: how many blocks and channels were
//! compared, how many are still undecided, how far apart two right means would lie (one standard error), the minimum
//! p-value corrected for their number, and the histogram of all p-values from 0 to 1, which is uniform where both have
//! the same mean. An integrator is also compared with itself, which shows that the test itself is right. A pair that
//! seems to disagree is rendered once more, with other seeds and four times the samples, and judged by what each half of the pictures knows
//! by itself. Exits with 1 when it still disagrees. Where media shine, only techniques that find that are compared.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_validation::agreement::{
    Comparison, Evidence, Stage, Technique, shipped, stages, techniques as all_techniques,
};
use bilux_validation::statistics::{bars, histogram, uniformity_p};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

/// A p-value below this is checked once more, and then reported.
const UNLIKELY: f64 = 1e-3;

struct Arguments {
    seconds: f64,
    scenes: Vec<String>,
    size: [u32; 2],
    seed: u64,
}

impl Arguments {
    fn read() -> Result<Arguments, Box<dyn Error>> {
        let mut read = Arguments { seconds: 3.0, scenes: Vec::new(), size: [64, 48], seed: 1 };
        let mut arguments = std::env::args().skip(1);
        while let Some(key) = arguments.next() {
            let value = arguments.next().ok_or_else(|| format!("{key} needs a value"))?;
            match key.as_str() {
                "--seconds" => read.seconds = value.parse()?,
                "--scenes" => read.scenes = value.split(',').map(str::to_owned).collect(),
                "--size" => {
                    let (width, height) = value.split_once('x').ok_or("--size is like 64x48")?;
                    read.size = [width.parse()?, height.parse()?];
                    if read.size.iter().any(|side| *side == 0 || side % 8 != 0) {
                        return Err("--size needs sides of whole blocks of 8 pixels".into());
                    }
                }
                "--seed" => read.seed = value.parse()?,
                _ => {
                    let known = "--seconds, --scenes, --size and --seed";
                    return Err(format!("unknown argument {key}; there are {known}").into());
                }
            }
        }
        Ok(read)
    }
}

/// P-values of all scenes for each pair, in the green channel.
type All = BTreeMap<String, Vec<f64>>;

fn line(pair: &str, found: &Comparison, more: &str) {
    println!(
        "  {pair:<14} {:>5} {:>9} {:>10} {:>10.2e}  [{}]{more}",
        found.p_values.len(),
        found.undecided,
        found.error.map_or("-".to_owned(), |error| format!("{:.1}%", 100.0 * error)),
        found.least(),
        bars(&histogram(&found.p_values)),
    );
}

/// Compares all pairs of techniques on one stage: whether all agree, and the number of decided cells.
fn check(stage: &Stage, arguments: &Arguments, all: &mut All) -> Result<(bool, usize), Box<dyn Error>> {
    let mut techniques: Vec<Technique> = Vec::new();
    for technique in all_techniques() {
        if stage.renders(&technique)? {
            techniques.push(technique);
        }
    }
    let mut rendered = Vec::new();
    for (i, technique) in techniques.iter().enumerate() {
        let is_wanted =
            techniques.iter().any(|other| other.name != technique.name && stage.compares(technique, other));
        let seed = (arguments.seed << 16) + ((i as u64) << 12);
        rendered.push(is_wanted.then(|| stage.render_for(technique, arguments.seconds, seed)).transpose()?);
    }
    let samples = |(technique, of): (&Technique, &Option<Evidence>)| {
        of.as_ref().map(|of| format!("{} {}", technique.name, of.spp * of.cells[0].len() as u32))
    };
    let samples: Vec<String> = techniques.iter().zip(&rendered).filter_map(samples).collect();
    println!("{} (samples a pixel: {})", stage.name, samples.join(", "));
    let (mut agrees, mut decided) = (true, 0);
    for (i, a) in techniques.iter().enumerate() {
        let Some(of_a) = &rendered[i] else { continue };
        let itself = stage.against_itself(of_a);
        let name = format!("{0} {0}", a.name);
        line(&name, &itself, "");
        all.entry(name).or_default().extend(itself.green);
        for (k, b) in techniques.iter().enumerate().skip(i + 1).filter(|(_, b)| stage.compares(a, b)) {
            let Some(of_b) = &rendered[k] else { continue };
            let name = format!("{} {}", a.name, b.name);
            let found = stage.compare((a, of_a), (b, of_b));
            decided += found.p_values.len();
            if found.least() >= UNLIKELY {
                line(&name, &found, "");
            } else {
                line(&name, &found, "  once more:");
                let seed = (arguments.seed << 16) + (1 << 15);
                let again = [(a, 0), (b, 1 << 10)].map(|(technique, offset)| {
                    stage.render_for(technique, 4.0 * arguments.seconds, seed + offset)
                });
                let [of_a, of_b] = again;
                let again = stage.compare_known((a, &of_a?), (b, &of_b?));
                let differs = again.least() < UNLIKELY;
                line("", &again, if differs { "  THEY DISAGREE" } else { "  agree" });
                agrees &= !differs;
            }
            all.entry(name).or_default().extend(found.green);
        }
    }
    Ok((agrees, decided))
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::read()?;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    println!(
        "  {:<14} {:>5} {:>9} {:>10} {:>10}  p from 0 to 1",
        "pair", "cells", "undecided", "error", "least p"
    );
    let (mut all, mut agree, mut undecided, mut count) = (All::new(), true, Vec::new(), 0);
    for (name, scene) in shipped(&folder)? {
        let is_wanted = |wanted: &String| *wanted == name || name.strip_suffix(".toml") == Some(wanted);
        if !arguments.scenes.is_empty() && !arguments.scenes.iter().any(is_wanted) {
            continue;
        }
        for stage in stages(&name, &scene, arguments.size)? {
            let (agrees, decided) = check(&stage, &arguments, &mut all)?;
            agree &= agrees;
            undecided.extend((decided == 0).then_some(stage.name));
            count += 1;
        }
    }
    if count == 0 {
        return Err("there is no such scene".into());
    }
    println!("all scenes, green channel");
    for (pair, p_values) in &all {
        let bins = histogram(p_values);
        let even = uniformity_p(p_values);
        println!("  {pair:<14} {:>5} uniformity p {even:.3}  [{}] {bins:?}", p_values.len(), bars(&bins));
    }
    if !undecided.is_empty() {
        println!("more seconds are needed to say anything of {}", undecided.join(", "));
    }
    println!("{}", if agree { "all agree" } else { "some disagree" });
    Ok(if agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
