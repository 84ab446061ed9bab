//! Gaussian splats, as programs that fit them to photographs write them: vertices with spherical harmonics, scales, a
//! rotation and an opacity. Each becomes a ball. [Kerbl 2023]

use super::header::Element;
use super::reader::{Ply, Splats};
use bilux_import::FormatError;
use bilux_import::geometry::colours::{decode, decoded};
use bilux_import::meshes::indexed_faces::NONE;
use bilux_math::transcendental::exp;
use bilux_math::{DVec3, Rgb, Vec3};
use std::ops::Range;

/// The properties that are used, in this order.
const PROPERTIES: [&str; 13] = [
    "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "red", "green",
    "blue",
];
const HARMONICS: Range<usize> = 3..6;
const SCALES: Range<usize> = 7..10;
const COLOURS: Range<usize> = 10..13;

/// The constant spherical harmonic, 1 / (2 √π).
const CONSTANT: f32 = 0.282_094_8;

/// True for vertices that are splats: their colours are spherical harmonics, or plain colours beside scales and a
/// rotation.
pub(super) fn are_splats(element: &Element) -> bool {
    let are_there = |names: Range<usize>| names.into_iter().all(|slot| has(element, PROPERTIES[slot]));
    let are_plain = are_there(SCALES) && are_there(COLOURS) && has(element, "rot_0");
    are_there(0..3) && (are_there(HARMONICS) || are_plain)
}

fn has(element: &Element, name: &str) -> bool {
    element.properties.iter().any(|p| p.name == name && p.count.is_none())
}

impl Ply<'_, '_, '_> {
    /// Reads splats.
    pub(super) fn splats(&mut self, element: &Element) -> Result<(), FormatError> {
        let at = || self.places.at(element.offset);
        if element.count >= u64::from(NONE) {
            let message = "there are more than 4 billion splats: split the file";
            return Err(FormatError::malformed(message, at()));
        }
        let meaning_of = |name: &str| PROPERTIES.iter().position(|known| *known == name);
        let meaning: Vec<Option<usize>> = element.properties.iter().map(|p| meaning_of(&p.name)).collect();
        self.diagnostics.not_shown(
            "how Gaussian splats fade, stretch and change colour with direction: each is a ball of its colour, mean \
             size and opacity",
            at,
        );
        // The count has been checked against the remaining bytes, so the memory is reserved at once.
        self.reading.budget.take_bytes(element.count * 32, self.source.name)?;
        let count = element.count as usize;
        self.indexed.positions.reserve_exact(count);
        self.indexed.colours.reserve_exact(count);
        let mut splats = Splats {
            opacities: Vec::with_capacity(count),
            widths: Vec::with_capacity(count),
            are_plain: !has(element, PROPERTIES[HARMONICS.start]),
            scales: SCALES.filter(|slot| has(element, PROPERTIES[*slot])).count(),
        };
        for _ in 0..element.count {
            let start = self.body.offset();
            let mut values = [0f64; PROPERTIES.len()];
            for (property, meaning) in element.properties.iter().zip(&meaning) {
                match meaning.filter(|_| property.count.is_none()) {
                    Some(slot) => values[slot] = self.body.wide_number(property.scalar)?,
                    None => self.skip(property)?,
                }
            }
            self.end_row(start);
            if values.iter().any(|x| !x.is_finite()) {
                let (places, what) =
                    (self.places, "a splat has numbers that are infinite or not numbers (NaN)");
                self.diagnostics.note(what, || places.at(start));
            }
            let position = DVec3::from_slice(&values) - self.reading.origin;
            self.push_splat(&mut splats, position.as_vec3(), values.map(|value| value as f32));
        }
        if !has(element, "opacity") {
            splats.opacities.clear();
        }
        if splats.scales == 0 {
            splats.widths.clear();
        }
        let red = element.properties.iter().find(|p| p.name == "red").filter(|_| splats.are_plain);
        if let Some(red) = red {
            decode(&mut self.indexed.colours, red.scalar.stored());
        }
        self.splats = Some(splats);
        Ok(())
    }

    fn push_splat(&mut self, splats: &mut Splats, position: Vec3, values: [f32; PROPERTIES.len()]) {
        let [_, _, _, r, g, b, opacity, x, y, z, colour @ ..] = values;
        self.indexed.positions.push(position);
        let harmonics = || decoded(Rgb::new(r, g, b).map(|c| 0.5 + CONSTANT * c), 1.0);
        self.indexed.colours.push(if splats.are_plain { Rgb::from_array(colour) } else { harmonics() });
        // `max` turns what is not a number into 0.
        splats.opacities.push((1.0 / (1.0 + exp(-opacity))).max(0.0));
        // The geometric mean of the standard deviations along the axes.
        let radius = exp((x + y + z) / splats.scales as f32);
        splats.widths.push(if radius.is_finite() { 2.0 * radius } else { 0.0 });
    }
}
