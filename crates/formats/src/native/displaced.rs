//! `displacement = { map = { texture = "stones.png" }, scale = 0.1 }`: moves the surfaces of a model.

use super::document::{Table, TomlValue};
use super::include::Part;
use super::plain::{missing, plain_value};
use super::reader::Native;
use bilux_import::FormatError;
use bilux_import::geometry::displacement::{Along, Displacement};
use bilux_import::input::reading::Texels;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice};
use bilux_scene::{Reader, Spec};

const ALONG: [(&str, Along); 3] =
    [("normal", Along::Normal), ("tangents", Along::Tangents), ("axes", Along::Axes)];
const ALONG_WORDS: &[&str] = &[ALONG[0].0, ALONG[1].0, ALONG[2].0];

const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min: -1e6, max: 1e6 }, default }
}

/// The keys of the displacement of a model.
pub(super) const DISPLACEMENT: Entry = Entry {
    name: "displacement",
    summary: "moves points of the model as a picture says, on triangles as fine as the picture",
    source: "",
    parameters: &[
        Parameter {
            name: "map",
            summary: "the picture: heights, or vectors as colours",
            unit: "",
            kind: ParameterKind::NumberTexture { min: -1e6, max: 1e6 },
            default: "",
        },
        number("scale", "how far a value of 1 more moves a point", "m", "1"),
        number("middle", "the value that leaves points where they are", "", "0"),
        choice(
            "along",
            "where to: heights along the normal; vectors along tangent, normal and bitangent; or along the axes of the model",
            ALONG_WORDS,
            "normal",
        ),
    ],
};

impl Native<'_, '_> {
    /// The displacement of a model, if it has one.
    pub(super) fn displacement(
        &mut self,
        table: &Table,
        part: &Part,
    ) -> Result<Option<Displacement>, FormatError> {
        let Some(item) = table.find("displacement") else { return Ok(None) };
        let TomlValue::Table(given) = &item.node else {
            return Err(item.wrong(
                "displacement",
                "a table, as in { map = { texture = \"stones.png\" }, scale = 0.1 }",
            ));
        };
        given.check_keys("a displacement", DISPLACEMENT.parameters.iter().map(|p| p.name))?;
        let map = given.find("map").ok_or_else(|| missing("map (the picture of a displacement)", given))?;
        let TomlValue::Table(texture) = &map.node else {
            return Err(map.wrong("map", "a texture, as in { texture = \"stones.png\" }"));
        };
        let mut spec = Spec { span: given.at.clone(), ..Spec::new("", DISPLACEMENT.name) };
        for (key, at, value) in given.entries.iter().filter(|(key, ..)| key != "map") {
            spec.parameters.set_at(key, plain_value(key, value)?, at.clone());
        }
        let kind = Some(DISPLACEMENT.parameters[0].kind);
        let Some(texture) = self.texture("displacement", kind, Texels::Colours, texture, part)? else {
            return Ok(None);
        };
        // The picture is given above, and has no value to check.
        let rest = Entry { parameters: &DISPLACEMENT.parameters[1..], ..DISPLACEMENT };
        let said = Reader::new(&spec, &rest)?;
        let along = ALONG.iter().find(|(name, _)| *name == said.text("along"));
        Ok(Some(Displacement {
            map: (*texture).clone(),
            along: along.map_or(Along::Normal, |found| found.1),
            scale: said.number("scale"),
            middle: said.number("middle"),
            at: item.at.clone(),
        }))
    }
}
