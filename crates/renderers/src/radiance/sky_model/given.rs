//! Skies as the generators write them: patterns by functions of Radiance's library.

use super::formula::{Formula, Weather, level, level_irradiance};
use super::sky::{Form, Sky, form};
use crate::radiance::xform::Xform;
use bilux_math::DVec3;
use bilux_scene::Span;
use std::rc::Rc;

/// The sky of a pattern, if it is one of `gensky` or `gendaylit`.
pub(in super::super) fn given(strings: &[Rc<str>], reals: &[f64], at: &Span) -> Option<Sky> {
    let [_, file, turns @ ..] = strings else { return None };
    let (matrix, _) = Xform::parse(turns, at).ok()?.copy(0);
    let direction = |reals: &[f64]| matrix.transform_vector3(DVec3::from_slice(reals)).normalize_or(DVec3::Z);
    match (&**file, reals) {
        ("skybright.cal", &[kind, zenith, ground, ref rest @ ..]) => {
            let weather = match kind {
                1.0 => Weather::Clear,
                2.0 => Weather::Overcast,
                3.0 => Weather::Uniform,
                4.0 => Weather::Intermediate,
                _ => return None,
            };
            let sun = if rest.len() >= 4 { direction(&rest[1..4]) } else { DVec3::Z };
            let level = zenith * level_irradiance(weather, sun);
            Some(Sky { form: form(weather, zenith), sun, level, ground })
        }
        ("perezlum.cal", &[factor, ground, a, b, c, d, e, x, y, z]) => {
            let formula = Formula::Perez { factor, coefficients: [a, b, c, d, e] };
            let sun = direction(&[x, y, z]);
            let level = level(|direction| formula.in_file(direction, sun));
            Some(Sky { form: Form::Formula(formula), sun, level, ground })
        }
        _ => None,
    }
}
