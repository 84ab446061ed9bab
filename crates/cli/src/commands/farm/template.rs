//! The job template, in YAML as Open Job Description defines it (its specification of 2023-09).

use super::farm_job::{FarmJob, Word};
use super::split::Split;
use anyhow::bail;

/// The longest name of a job that the specification allows.
const LONGEST_NAME: usize = 128;

/// The template of a job.
///
/// # Errors
/// If a word would be taken for an expression.
pub(super) fn of(job: &FarmJob) -> anyhow::Result<String> {
    let texts = job.options.iter().chain([&job.scene]).map(|word| match word {
        Word::Text(text) | Word::File(_, text) => text.as_str(),
    });
    if let Some(word) =
        texts.chain([job.picture.as_str()]).find(|word| word.contains("{{") || word.contains("}}"))
    {
        bail!("'{word}': in a job template, double braces are an expression: rename the file");
    }
    let name: String = job.name.replace(|c: char| c.is_control() || "{}".contains(c), "_");
    let name: String = name.chars().take(LONGEST_NAME).collect();
    let parts = match job.split {
        Split::Frames(_) => "",
        Split::Samples(_) => PARTS,
    };
    let (parameter, output) = match job.split {
        Split::Frames(_) => ("Frames", format!("{{{{Param.Pictures}}}}/{}", job.picture)),
        Split::Samples(_) => ("Samples", "{{Param.Parts}}/{{Task.Param.Samples}}.exr".to_owned()),
    };
    let range = format!("{{{{Task.Param.{parameter}}}}}");
    let mut words = job.render(&output, &range, |word| match word {
        Word::Text(text) => text.clone(),
        Word::File(before, name) => format!("{before}{{{{Param.Files}}}}/{name}"),
    });
    words.insert(1, PROGRESS.to_owned());
    let ranges: Vec<String> = job.split.ranges().iter().map(|range| quoted(range)).collect();
    let mut text =
        format!("specificationVersion: jobtemplate-2023-09\nname: {}\n{PARAMETERS}{parts}", quoted(&name));
    text += &format!(
        "steps:\n  - name: Render\n    parameterSpace:\n      taskParameterDefinitions:\n        - name: {parameter}\n\
         \x20         type: STRING\n          range: [{}]\n",
        ranges.join(", ")
    );
    text += &script(&words);
    if let Split::Samples(_) = job.split {
        let mut words = vec!["merge".to_owned()];
        words.extend(job.parts("{{Param.Parts}}"));
        words.extend(["-o".to_owned(), format!("{{{{Param.Pictures}}}}/{}", job.picture)]);
        text += "  - name: Merge\n    dependencies:\n      - dependsOn: Render\n";
        text += &script(&words);
    }
    Ok(text)
}

/// Tells the scheduler how far a task is.
const PROGRESS: &str = "--progress=openjd";

/// Parameters that a scheduler may set. Paths are relative to the template.
const PARAMETERS: &str = "parameterDefinitions:
  - name: Bilux
    type: STRING
    default: bilux
    description: The program, if it is not on the PATH of the nodes.
  - name: Files
    type: PATH
    objectType: DIRECTORY
    dataFlow: IN
    default: files
    description: The scene and every file that it needs.
  - name: Pictures
    type: PATH
    objectType: DIRECTORY
    dataFlow: OUT
    default: pictures
    description: The folder for the finished pictures.
";

/// Another parameter, for a picture that is merged.
const PARTS: &str = "  - name: Parts
    type: PATH
    objectType: DIRECTORY
    dataFlow: INOUT
    default: parts
    description: The folder for partial renders, which the last step merges.
";

/// Runs `bilux` with these words.
fn script(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("            - {}\n", quoted(word))).collect();
    format!(
        "    script:\n      actions:\n        onRun:\n          command: \"{{{{Param.Bilux}}}}\"\n          args:\n{}",
        words.concat()
    )
}

/// A text in YAML: one in JSON is also one in YAML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
