//! The units of a representation's context.

use crate::part21::Table;

/// Units in metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Units {
    pub(crate) length: f64,
    pub(crate) angle: f64,
}

/// Millimetres and radians, as nearly every program writes.
pub(crate) const USUAL: Units = Units { length: 1e-3, angle: 1.0 };

/// Units of units of units end here.
const MAX_DEPTH: usize = 8;

/// The units of a context, as far as it states them.
pub(crate) fn of_context(table: &Table, context: u64) -> Option<Units> {
    let assigned = table.part(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT")?;
    let mut units = USUAL;
    for unit in assigned.references_at(assigned.len() - 1) {
        let size = unit_size(table, unit, 0).filter(|size| *size > 0.0 && size.is_finite());
        match size {
            Some(size) if table.is(unit, "LENGTH_UNIT") => units.length = size,
            Some(size) if table.is(unit, "PLANE_ANGLE_UNIT") => units.angle = size,
            _ => {}
        }
    }
    Some(units)
}

/// A unit in metres or radians.
fn unit_size(table: &Table, unit: u64, depth: usize) -> Option<f64> {
    if depth > MAX_DEPTH {
        return None;
    }
    if let Some(si) = table.part(unit, "SI_UNIT") {
        // A simple instance has its dimensions first.
        let prefix = si.name(si.len().checked_sub(2)?);
        return prefix.map_or(Some(1.0), prefix_factor);
    }
    let based = table.part(unit, "CONVERSION_BASED_UNIT")?;
    let measure = based.reference(based.len().checked_sub(1)?)?;
    let (_, values) = table.parts(measure).find(|(_, values)| values.len() >= 2)?;
    Some(values.number(0)? * unit_size(table, values.reference(1)?, depth + 1)?)
}

fn prefix_factor(name: &[u8]) -> Option<f64> {
    Some(match name {
        b"EXA" => 1e18,
        b"PETA" => 1e15,
        b"TERA" => 1e12,
        b"GIGA" => 1e9,
        b"MEGA" => 1e6,
        b"KILO" => 1e3,
        b"HECTO" => 1e2,
        b"DECA" => 1e1,
        b"DECI" => 1e-1,
        b"CENTI" => 1e-2,
        b"MILLI" => 1e-3,
        b"MICRO" => 1e-6,
        b"NANO" => 1e-9,
        b"PICO" => 1e-12,
        b"FEMTO" => 1e-15,
        b"ATTO" => 1e-18,
        _ => return None,
    })
}
