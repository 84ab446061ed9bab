//! Requirements on every tone map.

use bilux_math::Rgb;
use bilux_pictures::{ColourSpace, Picture, TONEMAPS, to_display, tone_map};

#[test]
fn curves_are_bounded_monotone_and_keep_grey_grey() {
    for row in TONEMAPS {
        let name = row.entry.name;
        let mut before = -1.0;
        for i in 0..2000 {
            let light = f32::from_bits(0x3000_0000 + i * 0x8_0000).min(f32::MAX);
            let shown = (row.map)(Rgb::grey(light));
            assert!(shown.r == shown.g && shown.g == shown.b, "{name} tints {light}");
            assert!((0.0..=1.0).contains(&shown.r), "{name} of {light} is {}", shown.r);
            assert!(shown.r >= before - 1e-6, "{name} falls at {light}");
            before = shown.r;
        }
        assert_eq!((row.map)(Rgb::BLACK), Rgb::BLACK, "{name}");
        for extreme in [Rgb::grey(f32::MAX), Rgb::new(f32::MAX, 0.0, 1.0), Rgb::new(0.0, 1e-45, 0.0)] {
            let shown = (row.map)(extreme);
            assert!(
                shown.is_finite() && shown.clamp(0.0, 1.0) == shown,
                "{name} of {extreme:?} is {shown:?}"
            );
        }
        assert!((row.map)(Rgb::grey(f32::MAX)).r > 0.99, "{name} never reaches white");
    }
}

#[test]
fn exposure_is_in_stops() {
    let picture = Picture::from_rgb(1, 1, vec![Rgb::new(0.1, 0.2, 0.4)]).unwrap();
    let brighter = to_display(&picture, 1.0, &TONEMAPS[0]).unwrap().into_linear().rgb(0, 0);
    for (channel, expected) in [0.2, 0.4, 0.8].into_iter().enumerate() {
        assert!((brighter[channel] - expected).abs() < 1e-5);
    }
}

#[test]
fn encoded_pictures_stay_as_they_are() {
    let mut picture = Picture::from_rgb(2, 1, vec![Rgb::new(0.1, 0.5, 0.9), Rgb::grey(1.0)]).unwrap();
    picture.colour_space = ColourSpace::Srgb;
    assert_eq!(to_display(&picture, 0.0, &TONEMAPS[0]).unwrap().to_rgb(), picture.to_rgb());
}

#[test]
fn misspelt_names_suggest_the_closest() {
    assert_eq!(tone_map("reinhard").unwrap().entry.name, "reinhard");
    let error = tone_map("reinhart").unwrap_err().to_string();
    assert!(error.contains("did you mean 'reinhard'") && error.contains("aces"), "{error}");
}

/// Values of the published formulas, computed independently of this code in double precision.
#[test]
fn curves_are_those_that_were_published() {
    let known = [
        // Narkowicz: 0.18 (2.51 · 0.18 + 0.03) / (0.18 (2.43 · 0.18 + 0.59) + 0.14).
        ("aces", [0.18, 0.18, 0.18], [0.266_899, 0.266_899, 0.266_899]),
        // Up to 0.8 it subtracts 0.04; darker greys lie on a parabola; 1 becomes 1 - 0.24² / 0.44.
        ("neutral", [0.5, 0.5, 0.5], [0.46, 0.46, 0.46]),
        ("neutral", [0.04, 0.04, 0.04], [0.01, 0.01, 0.01]),
        ("neutral", [0.8, 0.2, 0.0], [0.794_286, 0.199_082, 0.000_680]),
        ("neutral", [1.0, 1.0, 1.0], [0.869_091, 0.869_091, 0.869_091]),
        ("agx", [0.18, 0.18, 0.18], [0.214_519, 0.214_519, 0.214_519]),
        ("agx", [1.0, 0.1, 0.02], [0.677_768, 0.160_326, 0.067_886]),
        ("agx", [0.0, 0.0, 8.0], [0.445_630, 0.445_495, 1.0]),
    ];
    for (name, light, wanted) in known {
        let shown = (tone_map(name).unwrap().map)(Rgb::from_array(light)).to_array();
        for (a, b) in shown.into_iter().zip(wanted) {
            assert!((a - b).abs() < 2e-4, "{name} of {light:?} is {shown:?}, not {wanted:?}");
        }
    }
}
