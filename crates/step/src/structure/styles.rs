//! Colours of faces, shells, solids and representations.

use crate::part21::Table;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use std::collections::{HashMap, HashSet};

/// Colour and opacity of something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Style {
    /// In linear light.
    pub(crate) colour: Rgb,
    /// From 0 to 1.
    pub(crate) opacity: f32,
}

impl Style {
    /// The bits that tell it from others.
    pub(crate) fn key(&self) -> [u32; 4] {
        [self.colour.r.to_bits(), self.colour.g.to_bits(), self.colour.b.to_bits(), self.opacity.to_bits()]
    }
}

/// The styles of a file by the number of what they are for, and what is not to be seen.
#[derive(Default)]
pub(crate) struct Styles {
    of: HashMap<u64, Style>,
    hidden: HashSet<u64>,
}

impl Styles {
    pub(crate) fn of_file(table: &Table) -> Styles {
        let mut styles = Styles::default();
        // What overrides comes after what it overrides.
        for name in ["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM"] {
            for (id, item) in table.all(name) {
                // Simple instances have a name first; parts of complex ones do not.
                let first = usize::from(table.simple(id).is_some());
                let styled = item.reference(first + 1).or_else(|| {
                    let part = table.part(id, "STYLED_ITEM")?;
                    part.reference(part.len().checked_sub(1)?)
                });
                let Some(styled) = styled else { continue };
                let mut search = Search { table, visits: 0, colour: None, opacity: 1.0 };
                let Some(list) = item.list(first) else { continue };
                list.references().for_each(|style| search.visit(style, 0));
                if let Some(colour) = search.colour {
                    styles.of.insert(styled, Style { colour, opacity: search.opacity });
                }
            }
        }
        for (_, invisible) in table.all("INVISIBILITY") {
            for item in invisible.references_at(0) {
                let styled = table
                    .part(item, "STYLED_ITEM")
                    .and_then(|part| part.reference(part.len().checked_sub(1)?));
                styles.hidden.extend([item, styled.unwrap_or(item)]);
            }
        }
        styles
    }

    pub(crate) fn of(&self, id: u64) -> Option<Style> {
        self.of.get(&id).copied()
    }

    pub(crate) fn hides(&self, id: u64) -> bool {
        self.hidden.contains(&id)
    }
}

/// Looks for the colour of surfaces below a style.
struct Search<'t, 'b> {
    table: &'t Table<'b>,
    visits: usize,
    colour: Option<Rgb>,
    opacity: f32,
}

/// The deepest and the largest styles that are searched; common ones have 6 levels and 8 parts.
const MAX_DEPTH: usize = 12;
const MAX_VISITS: usize = 64;

impl Search<'_, '_> {
    fn visit(&mut self, id: u64, depth: usize) {
        self.visits += 1;
        if depth > MAX_DEPTH || self.visits > MAX_VISITS {
            return;
        }
        match self.table.kind(id) {
            // Those of lines and points are not of surfaces.
            b"CURVE_STYLE"
            | b"POINT_STYLE"
            | b"SURFACE_STYLE_BOUNDARY"
            | b"SURFACE_STYLE_PARAMETER_LINE"
            | b"TEXT_STYLE" => {}
            b"SURFACE_STYLE_TRANSPARENT" => {
                let transparency = self.table.simple(id).and_then(|values| values.number(0)).unwrap_or(0.0);
                self.opacity = (1.0 - transparency).clamp(0.0, 1.0) as f32;
            }
            _ if self.colour.is_none() && colour(self.table, id).is_some() => {
                self.colour = colour(self.table, id)
            }
            _ => {
                // The context of a style leads elsewhere; the styles are the first parameter.
                let by_context = self.table.part(id, "PRESENTATION_STYLE_BY_CONTEXT");
                let below: Vec<u64> = match by_context.and_then(|values| values.list(0)) {
                    Some(styles) => styles.references().take(MAX_VISITS).collect(),
                    None => self
                        .table
                        .parts(id)
                        .flat_map(|(_, values)| values.all_references(MAX_VISITS))
                        .collect(),
                };
                below.into_iter().for_each(|below| self.visit(below, depth + 1));
            }
        }
    }
}

/// A colour, which is encoded as sRGB, as other programs take it.
fn colour(table: &Table, id: u64) -> Option<Rgb> {
    if let Some(values) = table.part(id, "COLOUR_RGB") {
        let last = values.len().checked_sub(3)?;
        let channel = |index: usize| Some(srgb_decode(values.number(last + index)?.clamp(0.0, 1.0) as f32));
        return Some(Rgb::new(channel(0)?, channel(1)?, channel(2)?));
    }
    let named =
        table.part(id, "DRAUGHTING_PRE_DEFINED_COLOUR").or_else(|| table.part(id, "PRE_DEFINED_COLOUR"))?;
    Some(match named.text(0).to_ascii_lowercase().as_str() {
        "red" => Rgb::new(1.0, 0.0, 0.0),
        "green" => Rgb::new(0.0, 1.0, 0.0),
        "blue" => Rgb::new(0.0, 0.0, 1.0),
        "yellow" => Rgb::new(1.0, 1.0, 0.0),
        "magenta" => Rgb::new(1.0, 0.0, 1.0),
        "cyan" => Rgb::new(0.0, 1.0, 1.0),
        "black" => Rgb::new(0.0, 0.0, 0.0),
        "white" => Rgb::WHITE,
        _ => return None,
    })
}
