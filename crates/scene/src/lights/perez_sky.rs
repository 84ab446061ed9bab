//! `perez-sky`: the sky of any weather, from the light of the sun and of the sky that was measured. [Perez 1993]

use super::LightEntry;
use super::sky_dome::{
    AZIMUTH, Amount, ELEVATION, GROUND, Gradation, SUN_DIAMETER, SkyFormula, Surroundings, number,
};
use bilux_math::photometry::LUMENS_PER_WATT;
use bilux_math::registry::Entry;
use bilux_math::transcendental::{acos_f64, cos_f64, exp_f64, powf_f64};

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "perez-sky",
        summary: "sky of any weather, from the light of the sun and that of the sky as they were measured",
        source: "Perez 1993",
        parameters: &[
            ELEVATION,
            AZIMUTH,
            super::colour(
                "direct",
                "irradiance by the sun of a surface that faces it (direct normal)",
                "W/m²",
                "3",
            ),
            super::colour(
                "diffuse",
                "irradiance of level ground by the sky (diffuse horizontal)",
                "W/m²",
                "1",
            ),
            number(
                "clearness",
                "clearness ε of the sky, from 1; 0 finds it from direct and diffuse",
                "",
                [0.0, 20.0],
                "0",
            ),
            number(
                "brightness",
                "brightness Δ of the sky; 0 finds it from diffuse, in lux",
                "",
                [0.0, 1.0],
                "0",
            ),
            SUN_DIAMETER,
            GROUND,
            super::GROUP,
        ],
    },
    surrounds: true,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| {
        let around = Surroundings::read(reader);
        let (direct, diffuse) = (reader.colour("direct"), reader.colour("diffuse"));
        let zenith = acos_f64(f64::from(around.towards.y.clamp(-1.0, 1.0)));
        let [sun, sky] = [direct, diffuse].map(|light| f64::from(light.luminance()));
        let given = |key: &str, found: f64| match reader.number_f64(key) {
            0.0 => found,
            given => given,
        };
        let clearness = given("clearness", perez_clearness(sun, sky, zenith));
        let brightness =
            given("brightness", sky * f64::from(LUMENS_PER_WATT) * air_mass(zenith) / ABOVE_THE_AIR);
        let [a, b, c, d, e] = perez_coefficients(clearness, brightness, zenith).map(|c| c as f32);
        let gradation = Gradation::Exponential([a, b]);
        let formula = SkyFormula { gradation, indicatrix: [c, d, e], across: 0.0 };
        Ok(around.lights(&formula, Amount::Level(diffuse), direct))
    },
};

/// Illuminance by the sun above the atmosphere, in lx.
const ABOVE_THE_AIR: f64 = 127_500.0;

/// Air mass: vertical depths of the atmosphere that the light of the sun passes, by its zenith angle in radians.
/// \[Kasten 1966]
fn air_mass(zenith: f64) -> f64 {
    let degrees = zenith.to_degrees().min(90.0);
    1.0 / (cos_f64(degrees.to_radians()).max(0.0) + 0.15 * powf_f64(93.885 - degrees, -1.253))
}

/// The clearness ε of a sky by the direct normal and the diffuse horizontal irradiance, at a zenith angle of the sun in
/// radians. \[Perez 1990, eq. 1]
pub fn perez_clearness(direct: f64, diffuse: f64, zenith: f64) -> f64 {
    let cube = 1.041 * zenith * zenith * zenith;
    if diffuse > 0.0 { ((diffuse + direct) / diffuse + cube) / (1.0 + cube) } else { 1.0 }
}

/// The upper ends of the ranges of clearness.
const RANGES: [f64; 7] = [1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2];

/// Of each range of clearness: x1 to x4 of a to e. \[Perez 1993, table 1]
const TABLE: [[[f64; 4]; 5]; 8] = [
    [
        [1.3525, -0.2576, -0.2690, -1.4366],
        [-0.7670, 0.0007, 1.2734, -0.1233],
        [2.8000, 0.6004, 1.2375, 1.0000],
        [1.8734, 0.6297, 0.9738, 0.2809],
        [0.0356, -0.1246, -0.5718, 0.9938],
    ],
    [
        [-1.2219, -0.7730, 1.4148, 1.1016],
        [-0.2054, 0.0367, -3.9128, 0.9156],
        [6.9750, 0.1774, 6.4477, -0.1239],
        [-1.5798, -0.5081, -1.7812, 0.1080],
        [0.2624, 0.0672, -0.2190, -0.4285],
    ],
    [
        [-1.1000, -0.2515, 0.8952, 0.0156],
        [0.2782, -0.1812, -4.5000, 1.1766],
        [24.7219, -13.0812, -37.7000, 34.8438],
        [-5.0000, 1.5218, 3.9229, -2.6204],
        [-0.0156, 0.1597, 0.4199, -0.5562],
    ],
    [
        [-0.5484, -0.6654, -0.2672, 0.7117],
        [0.7234, -0.6219, -5.6812, 2.6297],
        [33.3389, -18.3000, -62.2500, 52.0781],
        [-3.5000, 0.0016, 1.1477, 0.1062],
        [0.4659, -0.3296, -0.0876, -0.0329],
    ],
    [
        [-0.6000, -0.3566, -2.5000, 2.3250],
        [0.2937, 0.0496, -5.6812, 1.8415],
        [21.0000, -4.7656, -21.5906, 7.2492],
        [-3.5000, -0.1554, 1.4062, 0.3988],
        [0.0032, 0.0766, -0.0656, -0.1294],
    ],
    [
        [-1.0156, -0.3670, 1.0078, 1.4051],
        [0.2875, -0.5328, -3.8500, 3.3750],
        [14.0000, -0.9999, -7.1406, 7.5469],
        [-3.4000, -0.1078, -1.0750, 1.5702],
        [-0.0672, 0.4016, 0.3017, -0.4844],
    ],
    [
        [-1.0000, 0.0211, 0.5025, -0.5119],
        [-0.3000, 0.1922, 0.7023, -1.6317],
        [19.0000, -5.0000, 1.2438, -1.9094],
        [-4.0000, 0.0250, 0.3844, 0.2656],
        [1.0468, -0.3788, -2.4517, 1.4656],
    ],
    [
        [-1.0500, 0.0289, 0.4260, 0.3590],
        [-0.3250, 0.1156, 0.7781, 0.0025],
        [31.0625, -14.5000, -46.1148, 55.3750],
        [-7.2312, 0.4050, 13.3500, 0.6234],
        [1.5000, -0.6426, 1.8564, 0.5636],
    ],
];

/// The coefficients a to e of a sky: by its clearness ε (1 to 12, otherwise as at the end of that range), its brightness Δ (0.01 to
/// 0.6) and the zenith angle of the sun in radians. \[Perez 1993, table 1] In two ranges the formula is used only above a
/// brightness of 0.2, as below it has no light around the sun.
pub fn perez_coefficients(clearness: f64, brightness: f64, zenith: f64) -> [f64; 5] {
    let clearness = clearness.clamp(1.0, 12.0);
    let least = if clearness > 1.065 && clearness < 2.8 { 0.2 } else { 0.01 };
    let (delta, z) = (brightness.clamp(least, 0.6), zenith.clamp(0.0, std::f64::consts::FRAC_PI_2));
    let range = RANGES.partition_point(|end| *end <= clearness);
    let rows = TABLE[range];
    let mut found = rows.map(|[x1, x2, x3, x4]| x1 + x2 * z + delta * (x3 + x4 * z));
    if range == 0 {
        let [_, _, [c1, c2, c3, c4], [d1, d2, d3, d4], _] = rows;
        found[2] = exp_f64(powf_f64(delta * (c1 + c2 * z), c3)) - c4;
        found[3] = -exp_f64(delta * (d1 + d2 * z)) + d3 + delta * d4;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overcast_skies_have_no_sun_and_clear_ones_glow_around_it() {
        let zenith = acos_f64(0.5);
        let overcast = perez_coefficients(1.0, 0.2, zenith);
        let clear = perez_coefficients(8.0, 0.12, zenith);
        let at = |coefficients: [f64; 5], angle: f64| {
            let [_, _, c, d, e] = coefficients;
            let cos = cos_f64(angle);
            1.0 + c * exp_f64(d * angle) + e * cos * cos
        };
        assert!(at(overcast, 0.1) < 2.5 * at(overcast, 1.5), "{overcast:?}");
        assert!(at(clear, 0.1) > 5.0 * at(clear, 1.5), "{clear:?}");
    }

    /// In each range of clearness, at a brightness of 0.25 and 0.9 rad from the zenith, where no factor is 1: computed apart from the table
    /// in which Radiance's `gendaylit` has the numbers of the paper.
    #[test]
    fn coefficients_are_those_of_radiance() {
        let printed = [
            (1.03, [0.73017, -0.47576, 1.22577, -0.79647, 0.00412]),
            (1.15, [-1.31604, -0.94456, 8.71871, -2.45809, 0.17172]),
            (1.35, [-1.09904, -0.74514, 11.36368, -3.23924, 0.10796]),
            (1.7, [-1.05393, -0.66493, 13.02397, -3.18774, 0.13996]),
            (2.3, [-1.02282, -0.66762, 12.94438, -3.19858, 0.02662]),
            (3.6, [-0.77780, -0.39515, 13.01299, -3.41248, 0.26068]),
            (5.3, [-0.97056, -0.31858, 14.38133, -3.82164, 0.42271]),
            (8.0, [-0.83671, -0.02587, 18.94317, -3.38894, 1.51257]),
        ];
        for (clearness, wanted) in printed {
            let found = perez_coefficients(clearness, 0.25, 0.9);
            let off =
                found.iter().zip(wanted).map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
            assert!(off < 1e-5, "{clearness}: {found:?}, not {wanted:?}");
        }
    }

    /// The formula is used above a brightness of 0.2 where the clearness is from 1.065 to 2.8. [Radiance, gendaylit]
    #[test]
    fn dark_skies_have_the_least_brightness_of_their_range() {
        for (clearness, is_limited) in
            [(1.03, false), (1.15, true), (1.35, true), (1.7, true), (2.3, true), (2.9, false), (8.0, false)]
        {
            let [dark, least] = [0.1, 0.2].map(|brightness| perez_coefficients(clearness, brightness, 0.9));
            assert_eq!(dark == least, is_limited, "{clearness}");
        }
    }

    /// Found from the light of a sky that the sun lights through more air than at the zenith: 20 degrees high through 2.904 times as much.
    /// [Kasten 1966]
    #[test]
    fn brightness_follows_from_the_air_that_the_sun_shines_through() {
        let sky = |brightness: f32| {
            let spec =
                crate::Spec::new("", "perez-sky").with("elevation", 20.0f32).with("brightness", brightness);
            let spec = spec.with("diffuse", 20.0f32).with("clearness", 5.0f32).with("direct", 40.0f32);
            let crate::lights::BuiltLight::Several(lights) = crate::lights::build(&spec, &[]).unwrap() else {
                panic!("a sky and a sun")
            };
            lights[0].le(bilux_math::Vec3::new(0.3, 0.5, -0.8).normalize()).g
        };
        let stated = 20.0 * LUMENS_PER_WATT * 2.904 / 127_500.0;
        assert!((sky(0.0) / sky(stated) - 1.0).abs() < 1e-3, "{} {}", sky(0.0), sky(stated));
        assert!((sky(0.0) / sky(stated / 2.904) - 1.0).abs() > 1e-2, "{}", sky(stated / 2.904));
    }

    #[test]
    fn clearness_is_one_without_the_sun() {
        assert_eq!(perez_clearness(0.0, 100.0, 0.7), 1.0);
        assert!((perez_clearness(800.0, 100.0, 0.0) - 9.0).abs() < 1e-12);
        assert_eq!(perez_clearness(800.0, 0.0, 0.3), 1.0);
        assert!((air_mass(0.0) - 1.0).abs() < 1e-3 && (30.0..40.0).contains(&air_mass(1.57)));
        for strange in [f64::INFINITY, -3.0, 1e9] {
            assert!(perez_coefficients(strange, strange, strange).iter().all(|c| c.is_finite()));
        }
    }
}
