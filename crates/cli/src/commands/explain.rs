//! `bilux explain`: why a scene is slow or noisy, and what would help.

use crate::arguments::settings_from;
use crate::arguments::{Common, Explain};
use crate::commands::DONE;
use crate::commands::shared::given::Given;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::{output, usage};
use bilux::explain::{Explanation, Measures, slower};
use bilux::{Job, JobRequest};
use serde_json::{Value, json};
use std::path::Path;

pub fn run(arguments: &Explain, common: &Common) -> anyhow::Result<u8> {
    let user = settings_from::explain(arguments).map_err(usage::wrong)?;
    arguments.studio.check().map_err(usage::wrong)?;
    arguments.studio.check_files()?;
    let given = Given::open(&arguments.scene, &arguments.input_format, common)?;
    let confines = SandboxPaths::default().reading_scene(Given::place(&arguments.scene));
    confines.reading_options(&arguments.studio).enter(common)?;
    let options = read_options_with(common, &arguments.choices, arguments.studio.time());
    let mut scene = given.scene(&options)?;
    check_choices(&scene, &arguments.choices).map_err(usage::wrong)?;
    arguments.studio.set_up(&mut scene, &options)?;
    report_warnings(&scene.warnings, common)?;
    let job = Job::new(&scene, JobRequest::from(&user).max_memory(common.max_memory))?;
    report_warnings(job.warnings(), common)?;
    let found = Explanation::of(&job)?;
    if arguments.json {
        output::print(serde_json::to_string_pretty(&as_json(&job, &found))?)?;
    } else {
        output::print(as_text(&arguments.scene, &job, &found))?;
    }
    Ok(DONE)
}

fn as_json(job: &Job, found: &Explanation) -> Value {
    let m = &found.measures;
    let choice = found.choice.as_ref().map(|choice| {
        let candidates = choice.candidates.iter().map(|candidate| {
            json!({
                "name": candidate.name, "techniques": candidate.techniques, "error": candidate.error,
                "lost": candidate.lost, "nanoseconds": candidate.nanoseconds,
                "times_as_long": slower(candidate, choice.best()),
            })
        });
        json!({ "chosen": choice.best().name, "candidates": candidates.collect::<Vec<_>>() })
    });
    let findings = found
        .findings
        .iter()
        .map(|finding| json!({ "what": finding.what, "options": finding.options, "advice": finding.advice }));
    json!({
        "integrator": job.settings().integrator.entry.name, "choice": choice,
        "measures": {
            "surfaces": m.surfaces, "transparent": m.transparent, "backs": m.backs, "open": m.open, "lights": m.lights,
            "points": m.points, "has_surroundings": m.has_surroundings, "texture_bytes": m.texture_bytes,
            "onto_glass": m.onto_glass.iter().map(|(name, share)| json!({ "light": name, "share": share })).collect::<Vec<_>>(),
            "huge_textures": m.huge_textures.iter().map(|(name, width, height)| {
                json!({ "name": name, "width": width, "height": height })
            }).collect::<Vec<_>>(),
        },
        "findings": findings.collect::<Vec<_>>(),
    })
}

fn as_text(scene: &Path, job: &Job, found: &Explanation) -> String {
    let mut lines = vec!["What auto found".to_owned()];
    match &found.choice {
        None => lines.push(format!(
            "  nothing: the integrator is '{}', and only 'auto' chooses",
            job.settings().integrator.entry.name
        )),
        Some(choice) => {
            lines.push(format!(
                "  it renders with '{}'; relative time of each candidate to the same noise:",
                choice.best().name
            ));
            for candidate in &choice.candidates {
                let misses = match candidate.lost {
                    lost if lost > 1e-3 => format!(", and misses {:.1}% of the light", lost * 100.0),
                    _ => String::new(),
                };
                lines.push(format!(
                    "  {:>8.2} x  {}{misses}",
                    slower(candidate, choice.best()),
                    candidate.name
                ));
            }
        }
    }
    lines.extend(["".to_owned(), "What the scene is like".to_owned()]);
    lines.extend(facts(&found.measures).into_iter().map(|fact| format!("  {fact}")));
    lines.extend(["".to_owned(), "What makes it difficult, and what helps".to_owned()]);
    if found.findings.is_empty() {
        lines.push("  nothing found".to_owned());
    }
    for finding in &found.findings {
        lines.push(format!("  - {}", finding.what));
        let command =
            |options: &String| format!("      bilux render {} -o picture.png {options}", scene.display());
        lines.extend(finding.options.iter().map(command));
        lines.extend(finding.advice.iter().map(|advice| format!("      {advice}")));
    }
    lines.join("\n")
}

fn facts(m: &Measures) -> Vec<String> {
    let percent = |share: f32| format!("{:.0}%", share * 100.0);
    let mut facts = vec![format!(
        "surfaces fill {} of the picture; {} of them are transparent",
        percent(m.surfaces),
        percent(m.transparent)
    )];
    facts.push(format!(
        "{} with any power, {} of them points, spots or directions{}",
        output::counted(m.lights, "light", "lights"),
        m.points,
        if m.has_surroundings { "; light also comes from all around" } else { "" }
    ));
    if let Some(open) = m.open {
        facts.push(format!("{} of the directions around visible surfaces lead outside", percent(open)));
    }
    facts
}
