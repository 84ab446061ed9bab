//! Transforms of prims: stacks of operations.

use crate::layers::value::Value;
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_math::glam::DQuat;
use bilux_math::{DMat4, DVec3};

/// The place of a prim in its parent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    pub(crate) matrix: DMat4,
    /// True if it does not move with its parent.
    pub(crate) is_reset: bool,
}

/// The place of a prim: the operations that `xformOpOrder` lists, the outermost first.
pub(crate) fn local(stage: &Stage, prim: u32, budget: &mut Budget) -> Result<Local, FormatError> {
    let mut local = Local { matrix: DMat4::IDENTITY, is_reset: false };
    let order = stage.value(prim, "xformOpOrder", budget)?.and_then(|value| value.texts());
    for name in order.iter().flat_map(|list| list.iter()) {
        if &**name == "!resetXformStack!" {
            local = Local { matrix: DMat4::IDENTITY, is_reset: true };
            continue;
        }
        let (name, is_inverse) = match name.strip_prefix("!invert!") {
            Some(name) => (name, true),
            None => (&**name, false),
        };
        let Some(value) = stage.value(prim, name, budget)? else { continue };
        let kind = name.strip_prefix("xformOp:").unwrap_or(name).split(':').next().unwrap_or_default();
        let Some(matrix) = operation(kind, &value) else { continue };
        local.matrix *= if is_inverse { matrix.inverse() } else { matrix };
    }
    Ok(local)
}

/// The place of a prim in one above it; `None` if that is not above it.
pub(crate) fn below(
    stage: &Stage,
    prim: u32,
    above: u32,
    budget: &mut Budget,
) -> Result<Option<DMat4>, FormatError> {
    let mut place = Local { matrix: DMat4::IDENTITY, is_reset: false };
    let mut at = prim;
    while at != above {
        if !place.is_reset {
            let own = local(stage, at, budget)?;
            place = Local { matrix: own.matrix * place.matrix, is_reset: own.is_reset };
        }
        let Some(next) = stage.above(at) else { return Ok(None) };
        at = next;
    }
    Ok(Some(place.matrix))
}

/// A matrix that is written as rows for row vectors, for column vectors.
pub(crate) fn matrix(value: &Value) -> Option<DMat4> {
    value.tuple::<16>().map(|rows| DMat4::from_cols_array(&rows))
}

fn operation(kind: &str, value: &Value) -> Option<DMat4> {
    let vector = || value.tuple::<3>().map(DVec3::from);
    let turn = |axis: char, degrees: f64| {
        let angle = degrees.to_radians();
        match axis {
            'X' => DMat4::from_rotation_x(angle),
            'Y' => DMat4::from_rotation_y(angle),
            _ => DMat4::from_rotation_z(angle),
        }
    };
    let axis = |letter: &str| match letter {
        "X" => Some(DVec3::X),
        "Y" => Some(DVec3::Y),
        "Z" => Some(DVec3::Z),
        _ => None,
    };
    match kind {
        "translate" => Some(DMat4::from_translation(vector()?)),
        "scale" => Some(DMat4::from_scale(vector()?)),
        "transform" => matrix(value),
        "orient" => {
            let turn = DQuat::from_array(value.tuple::<4>()?);
            Some(DMat4::from_quat(if turn.length_squared() > 0.0 {
                turn.normalize()
            } else {
                DQuat::IDENTITY
            }))
        }
        _ => {
            if let Some(letter) = kind.strip_prefix("translate") {
                return Some(DMat4::from_translation(axis(letter)? * value.number()?));
            }
            if let Some(letter) = kind.strip_prefix("scale") {
                let axis = axis(letter)?;
                return Some(DMat4::from_scale(DVec3::ONE - axis + axis * value.number()?));
            }
            let letters = kind.strip_prefix("rotate")?;
            if letters.len() == 1 {
                return Some(turn(letters.chars().next()?, value.number()?));
            }
            // The first of three turns is made first.
            let angles = vector()?;
            let each = letters.chars().map(|letter| {
                turn(
                    letter,
                    match letter {
                        'X' => angles.x,
                        'Y' => angles.y,
                        _ => angles.z,
                    },
                )
            });
            Some(each.fold(DMat4::IDENTITY, |before, next| next * before))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point on the x axis that turns about z by 90 degrees and then about x is on the z axis.
    #[test]
    fn the_first_letter_turns_first() {
        let angles = Value::Tuple(vec![90.0, 0.0, 90.0]);
        let turned = |kind: &str| operation(kind, &angles).unwrap().transform_point3(DVec3::X);
        assert!((turned("rotateZYX") - DVec3::Z).length() < 1e-12);
        assert!((turned("rotateXYZ") - DVec3::Y).length() < 1e-12);
    }
}
