//! Lenses of several elements, which are shown as the thin lens that is nearest to them: without their distortion, vignetting
//! and aberrations.

use super::lexer::number_of;
use super::loader::Loader;
use super::parameters::ParameterList;
use bilux_import::FormatError;

use bilux_scene::Span;

/// A thin lens in front of a film; lengths in metres.
pub(super) struct ThinLens {
    /// Half the height of the film over its distance from the lens.
    pub(super) half_height: f64,
    /// The radius of the entrance pupil.
    pub(super) radius: f64,
    pub(super) focus: f64,
    pub(super) focal_length: f64,
}

/// A surface between two media, from the front to the film.
struct Surface {
    /// In millimetres, positive where it bulges forwards; 0 where it is plane.
    radius: f64,
    /// The distance to the next one, in millimetres.
    thickness: f64,
    /// The refractive index behind it; none of the aperture.
    index: Option<f64>,
    /// Width in millimetres.
    width: f64,
}

impl ThinLens {
    /// Thin lens for the one in `lensfile`, for a film with this diagonal in millimetres and this width over height.
    pub(super) fn read(
        list: &ParameterList,
        loader: &mut Loader,
        diagonal: f64,
        aspect: f64,
    ) -> Result<Option<ThinLens>, FormatError> {
        let Some(name) = list.text("lensfile")? else { return Ok(None) };
        let at = list.place("lensfile");
        let surfaces = surfaces(name, &at, loader)?;
        let widest = list.finite("aperturediameter", 1.0)?;
        let focus = f64::from(list.finite("focusdistance", 10.0)?);
        let system = System::of(&surfaces, f64::from(widest));
        let Some(System { focal_length, radius }) = system.filter(|system| focus > system.focal_length)
        else {
            let message = format!("the lens '{name}' forms no picture at a focus distance of {focus} m");
            return Err(FormatError::malformed(message, at));
        };
        let film = focal_length * focus / (focus - focal_length);
        let height = 1e-3 * diagonal / (1.0 + aspect * aspect).sqrt();
        Ok(Some(ThinLens { half_height: 0.5 * height / film, radius, focus, focal_length }))
    }
}

/// Properties of a lens near its axis.
struct System {
    focal_length: f64,
    /// The radius of the entrance pupil.
    radius: f64,
}

impl System {
    /// Follows a ray that comes in parallel to the axis [Hecht 2017, 6.2]; `None` where it is not brought together.
    fn of(surfaces: &[Surface], aperture: f64) -> Option<System> {
        let (mut height, mut slope, mut index) = (1.0, 0.0, 1.0);
        let mut radius = f64::INFINITY;
        for (i, surface) in surfaces.iter().enumerate() {
            match surface.index {
                Some(behind) => {
                    let power = if surface.radius == 0.0 { 0.0 } else { (behind - index) / surface.radius };
                    slope = (index * slope - height * power) / behind;
                    index = behind;
                }
                // Of all the light that comes in parallel, this much gets through.
                None => radius = 0.5 * surface.width.min(aperture) / height,
            }
            if i + 1 < surfaces.len() {
                height += surface.thickness * slope;
            }
        }
        let radius = if radius.is_finite() { radius } else { 0.5 * aperture };
        let found = System { focal_length: -1e-3 / slope, radius: 1e-3 * radius };
        (found.focal_length > 0.0 && found.focal_length.is_finite() && found.radius >= 0.0).then_some(found)
    }
}

/// The surfaces of a file: four numbers each.
fn surfaces(name: &str, at: &Span, loader: &mut Loader) -> Result<Vec<Surface>, FormatError> {
    let path = loader.reading.locator.locate(loader.folder.as_deref(), name, at)?;
    let bytes = loader.reading.load_text(&path)?;
    loader.reading.budget.take::<f64>(bytes.len() / 2, name)?;
    let lines = bytes.split(|b| matches!(b, b'\n' | b'\r'));
    let words = lines.map(|line| line.split(|b| *b == b'#').next().unwrap_or_default());
    let words =
        words.flat_map(|line| line.split(|b| b.is_ascii_whitespace())).filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> = words.map(|word| number_of(word).map(f64::from)).collect();
    let numbers = numbers.filter(|numbers| !numbers.is_empty() && numbers.len() % 4 == 0).ok_or_else(|| {
        let message = format!("'{name}' is no lens: it needs four numbers for each surface: radius, thickness, index and width");
        FormatError::malformed(message, at.clone())
    })?;
    let surface = |[radius, thickness, index, width]: &[f64; 4]| Surface {
        radius: *radius,
        thickness: *thickness,
        index: (*index != 0.0).then_some(*index),
        width: *width,
    };
    loader.reading.budget.release(2 * (bytes.len() / 2 * size_of::<f64>()) as u64);
    loader.reading.release(bytes);
    Ok(numbers.as_chunks::<4>().0.iter().map(surface).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/f = (n - 1) (1/R1 - 1/R2 + (n - 1) d / (n R1 R2)).
    #[test]
    fn the_focal_length_is_that_of_a_thick_lens() {
        let (n, d, [a, b]) = (1.6, 12.0, [40.0, -70.0]);
        let surface = |radius, thickness, index| Surface { radius, thickness, index, width: 9.0 };
        let surfaces = [surface(a, d, Some(n)), surface(b, 5.0, Some(1.0)), surface(0.0, 30.0, None)];
        let found = System::of(&surfaces, 4.0).unwrap();
        let expected = 1.0 / ((n - 1.0) * (1.0 / a - 1.0 / b + (n - 1.0) * d / (n * a * b)));
        assert!((found.focal_length * 1e3 - expected).abs() < 1e-9, "{}", found.focal_length);
        // The stop behind the lens looks larger from the front.
        assert!(found.radius > 2e-3 && found.radius < 3e-3, "{}", found.radius);
    }
}
