//! The settings of objects and parts, as XML.

use super::project::{ObjectSettings, PartSettings, Project, Volume};
use crate::threemf::package::Package;
use crate::threemf::xml::{Element, Level, Xml};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;

/// The names of parts that are not printed, and what they are called.
const UNPRINTED: &[(&str, &str)] = &[
    ("NegativeVolume", "negative parts"),
    ("negative_part", "negative parts"),
    ("ParameterModifier", "modifiers"),
    ("modifier_part", "modifiers"),
    ("SupportBlocker", "support blockers"),
    ("support_blocker", "support blockers"),
    ("SupportEnforcer", "support enforcers"),
    ("support_enforcer", "support enforcers"),
];

pub(super) fn objects(
    package: &Package,
    reading: &mut Reading,
    member: &str,
    project: &mut Project,
) -> Result<(), FormatError> {
    let mut xml = package.xml(reading, member)?;
    let Some(root) = xml.child(Level::DOCUMENT)? else { return Ok(()) };
    let level = root.inside;
    while let Some(element) = xml.child(level)? {
        if element.name != "object" {
            continue;
        }
        let (Ok(Some(id)), inside) = (element.index("id"), element.inside) else { continue };
        reading.budget.take::<(u32, ObjectSettings)>(2, member)?;
        let settings = object(&mut xml, reading, member, inside)?;
        project.objects.insert(id, settings);
    }
    Ok(())
}

fn object(
    xml: &mut Xml,
    reading: &mut Reading,
    member: &str,
    level: Level,
) -> Result<ObjectSettings, FormatError> {
    let mut settings = ObjectSettings::default();
    while let Some(element) = xml.child(level)? {
        match element.name {
            "metadata" => {
                if let Some(extruder) = extruder(&element) {
                    settings.extruder = Some(extruder);
                }
            }
            "volume" => {
                let (range, inside) = ((element.index("firstid"), element.index("lastid")), element.inside);
                let part = part(xml, inside, PartSettings::default())?;
                if let (Ok(Some(first)), Ok(Some(last))) = range {
                    reading.budget.take::<Volume>(1, member)?;
                    settings.volumes.push(Volume { first, last, settings: part });
                }
            }
            "part" => {
                let (id, inside) = (element.index("id"), element.inside);
                let unprinted = element.get("subtype").and_then(unprinted);
                let part = part(xml, inside, PartSettings { extruder: None, unprinted })?;
                if let Ok(Some(id)) = id {
                    reading.budget.take::<(u32, PartSettings)>(2, member)?;
                    settings.parts.insert(id, part);
                }
            }
            _ => {}
        }
    }
    Ok(settings)
}

fn part(xml: &mut Xml, level: Level, mut settings: PartSettings) -> Result<PartSettings, FormatError> {
    while let Some(element) = xml.child(level)? {
        if element.name != "metadata" {
            continue;
        }
        if let Some(extruder) = extruder(&element) {
            settings.extruder = Some(extruder);
        }
        match (element.get("key"), element.get("value")) {
            (Some("volume_type"), Some(kind)) => settings.unprinted = unprinted(kind),
            (Some("modifier"), Some("1")) => settings.unprinted = Some("modifiers"),
            _ => {}
        }
    }
    Ok(settings)
}

/// The extruder that metadata name; 0 stands for that of the object.
fn extruder(element: &Element) -> Option<u32> {
    let is_it = element.get("key") == Some("extruder");
    element.index("value").ok().flatten().filter(|&extruder| is_it && extruder > 0)
}

fn unprinted(kind: &str) -> Option<&'static str> {
    UNPRINTED.iter().find(|(name, _)| *name == kind).map(|(_, what)| *what)
}
