//! Diffuse and specular reflectance as the base colour and the metalness of one material.
//!
//! A surface whose specular reflectance only a metal reaches is metal. The metalness and the base colour are those
//! that give the same diffuse and the same specular reflectance together, as far as both are possible.

use bilux_math::Rgb;

/// The reflectance of a dielectric at normal incidence, for an index of refraction of 1.5.
const DIELECTRIC: f32 = 0.04;

/// The base colour and metalness of a surface with the given diffuse reflectance and specular reflectance at
/// normal incidence.
///
/// With base colour c and metalness m, diffuse is c (1 - m) (1 - 0.04) / (1 - s), where s is the maximum specular
/// reflectance, and specular is 0.04 (1 - m) + c m. Eliminating c, by brightness, leaves a quadratic equation for
/// m.
pub fn as_metal(diffuse: Rgb, specular: Rgb) -> (Rgb, f32) {
    let left = 1.0 - specular.to_array().into_iter().fold(0.0, f32::max).min(1.0);
    let (d, s) = (brightness(diffuse) * left / (1.0 - DIELECTRIC), brightness(specular));
    let metalness = if s < DIELECTRIC {
        0.0
    } else {
        let (b, c) = (d + s - 2.0 * DIELECTRIC, DIELECTRIC - s);
        ((-b + (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt()) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
    };
    let from_diffuse = diffuse * (left / (1.0 - DIELECTRIC) / (1.0 - metalness).max(1e-6));
    let from_specular = specular.map(|c| (c - DIELECTRIC * (1.0 - metalness)) / metalness.max(1e-6));
    // Each reflectance determines the colour to the degree that it contributes.
    (from_diffuse.lerp(from_specular, metalness * metalness).clamp(0.0, 1.0), metalness)
}

/// The perceived brightness of a colour, as the root of its weighted mean square.
fn brightness(colour: Rgb) -> f32 {
    let [r, g, b] = colour.to_array();
    (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Rgb, b: Rgb) -> bool {
        a.to_array().iter().zip(b.to_array()).all(|(a, b)| (a - b).abs() < 0.01)
    }

    #[test]
    fn plastic_stays_plastic_and_gold_is_metal() {
        let (base, metalness) = as_metal(Rgb::new(0.5, 0.2, 0.1), Rgb::grey(DIELECTRIC));
        assert!(metalness < 1e-3 && near(base, Rgb::new(0.5, 0.2, 0.1)), "{base:?} {metalness}");
        let gold = Rgb::new(1.0, 0.77, 0.34);
        let (base, metalness) = as_metal(Rgb::BLACK, gold);
        assert!(metalness > 0.99 && near(base, gold), "{base:?} {metalness}");
    }
}
