//! The colours of filaments.

use super::project::Project;
use crate::threemf::colour::Colour;
use crate::threemf::package::Package;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use serde_json::Value;

/// The memory that JSON takes, as a multiple of its text.
const JSON: u64 = 16;
/// More filaments are not counted.
const MAX_FILAMENTS: usize = 256;

/// Takes the colours from settings as JSON (Bambu Studio, OrcaSlicer).
pub(super) fn of_json(
    package: &Package,
    reading: &mut Reading,
    member: &str,
    project: &mut Project,
) -> Result<(), FormatError> {
    let bytes = reading.load(&package.path(member))?;
    reading.budget.take_bytes(JSON * bytes.len() as u64, member)?;
    if let Ok(Value::Object(settings)) = serde_json::from_slice::<Value>(&bytes)
        && let Some(Value::Array(colours)) = settings.get("filament_colour")
    {
        let colour = |value: &Value| Colour::parse(value.as_str()?);
        project.filaments = colours.iter().take(MAX_FILAMENTS).map(colour).collect();
    }
    reading.budget.release(JSON * bytes.len() as u64);
    reading.release(bytes);
    Ok(())
}

/// Takes the colours from settings as lines such as `; filament_colour = #FF8000;#DB5182` (PrusaSlicer, SuperSlicer).
/// What an extruder has comes before what its filament has.
pub(super) fn of_lines(
    package: &Package,
    reading: &mut Reading,
    member: &str,
    project: &mut Project,
) -> Result<(), FormatError> {
    let bytes = reading.load(&package.path(member))?;
    let list = |key: &str| -> Vec<Option<Colour>> {
        let lines = bytes.split(|&byte| byte == b'\n').filter_map(|line| std::str::from_utf8(line).ok());
        let mut values = lines.filter_map(|line| {
            let (name, value) = line.trim_start_matches([';', ' ']).split_once('=')?;
            (name.trim() == key).then_some(value)
        });
        let colours = values.next().map(|value| value.split(';').take(MAX_FILAMENTS));
        colours.into_iter().flatten().map(|word| Colour::parse(word.trim().trim_matches('"'))).collect()
    };
    let (of_extruders, of_filaments) = (list("extruder_colour"), list("filament_colour"));
    let count = of_extruders.len().max(of_filaments.len());
    let at = |list: &[Option<Colour>], i: usize| list.get(i).copied().flatten();
    let colours: Vec<Option<Colour>> =
        (0..count).map(|i| at(&of_extruders, i).or(at(&of_filaments, i))).collect();
    if colours.iter().any(Option::is_some) {
        project.filaments = colours;
    }
    reading.release(bytes);
    Ok(())
}
