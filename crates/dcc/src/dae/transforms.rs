//! The transforms of nodes: a product of matrices, in the order of the file.

use super::element::Element;
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::world::placement::rotation;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat4, DVec3};

/// From the space of a node to that of its parent.
pub(super) fn local(node: Element, posed: &Posed, budget: &mut Budget) -> Result<DMat4, FormatError> {
    let mut whole = DMat4::IDENTITY;
    for element in node.children() {
        let width = match element.name() {
            "matrix" => 16,
            "translate" | "scale" => 3,
            "rotate" => 4,
            "skew" => 7,
            "lookat" => 9,
            _ => continue,
        };
        let spent = budget.spent();
        let numbers = posed.numbers(element, budget)?;
        budget.release(budget.spent() - spent);
        let Some(numbers) = numbers.get(..width).filter(|_| numbers.len() == width) else {
            let message = format!("<{}> has {width} numbers, not {}", element.name(), numbers.len());
            return Err(element.error(message));
        };
        let vector = |at: usize| DVec3::from_slice(&numbers[at..]);
        whole *= match element.name() {
            // Its rows follow each other in the file.
            "matrix" => DMat4::from_cols_slice(numbers).transpose(),
            "translate" => DMat4::from_translation(vector(0)),
            "scale" => DMat4::from_scale(vector(0)),
            "rotate" => rotation(numbers[3], vector(0)).unwrap_or(DMat4::IDENTITY),
            // Points are shifted along the first axis, the more the further they are along the second.
            "skew" => skew(numbers[0], vector(4), vector(1)).unwrap_or(DMat4::IDENTITY),
            _ => look_at(vector(0), vector(3), vector(6))
                .ok_or_else(|| element.error("this <lookat> has no direction, or one along its up axis"))?,
        };
    }
    Ok(whole)
}

/// Shifts points along `to` so that `from` turns by an angle in degrees towards it.
fn skew(degrees: f64, from: DVec3, to: DVec3) -> Option<DMat4> {
    let along = to.try_normalize()?;
    let across = (from - along * from.dot(along)).try_normalize()?;
    let (near, far) = (from.dot(across), from.dot(along));
    let (sin, cos) = sin_cos_f64(degrees.to_radians());
    let (x, y) = (near * cos - far * sin, near * sin + far * cos);
    // A turn onto the first axis would shift points infinitely far.
    let is_possible = x > 1e-9 * from.length();
    let shift = Some(y / x - far / near).filter(|shift| is_possible && shift.is_finite())?;
    let column = |axis: DVec3| (axis + along * (shift * axis.dot(across))).extend(0.0);
    Some(DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), DVec3::ZERO.extend(1.0)))
}

/// A node at `eye` whose -z axis points at `at`.
fn look_at(eye: DVec3, at: DVec3, up: DVec3) -> Option<DMat4> {
    let back = (eye - at).try_normalize()?;
    let right = up.cross(back).try_normalize()?;
    let columns = [right, back.cross(right), back].map(|axis| axis.extend(0.0));
    Some(DMat4::from_cols(columns[0], columns[1], columns[2], eye.extend(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skew_turns_one_axis_towards_another() {
        let skewed = skew(45.0, DVec3::Y, DVec3::X).unwrap();
        assert!((skewed.transform_point3(DVec3::Y) - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-12);
        assert_eq!(skewed.transform_point3(DVec3::new(3.0, 0.0, 5.0)), DVec3::new(3.0, 0.0, 5.0));
        assert_eq!(skew(90.0, DVec3::Y, DVec3::X), None);
    }
}
