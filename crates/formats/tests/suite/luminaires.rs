//! Files of lamps: IES LM-63 and EULUMDAT.

use bilux_formats::{ReadOptions, WriteOptions, read, read_distribution, write};
use bilux_math::transcendental::cos_f64;
use bilux_scene::{Goniometer, IntensityDistribution, SceneBuilder, Spec, Value};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/luminaire")
}

fn seeds() -> Vec<(String, Vec<u8>)> {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let named = |path: PathBuf| {
        (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(path).unwrap())
    };
    let mut all: Vec<_> = files.map(named).collect();
    all.sort();
    all
}

fn reads(bytes: &[u8]) -> Result<(IntensityDistribution, Vec<String>), String> {
    read_distribution(bytes, "lamp", &ReadOptions::default()).map_err(|error| error.to_string())
}

fn seed(name: &str) -> IntensityDistribution {
    reads(&std::fs::read(folder().join(name)).unwrap()).unwrap().0
}

#[track_caller]
fn close(found: f64, wanted: f64) {
    assert!((found - wanted).abs() <= 1e-5 * wanted.abs().max(1e-3), "{found} for {wanted}");
}

#[test]
fn the_seeds_read_and_broken_ones_are_refused_with_their_place() {
    let files = seeds();
    assert!(files.len() >= 10);
    for (name, bytes) in files {
        let read = reads(&bytes);
        assert_eq!(read.is_err(), name.starts_with("broken"), "{name}: {read:?}");
    }
    for (name, why) in [
        ("broken_cut_off.ies", "lamp:9:5: the file ends before one of the 3 intensities: it is cut off"),
        ("broken_negative.ies", "an intensity is -100 cd: it must not be negative"),
        ("broken_angles.ies", "lamp:7:6: the vertical angles do not ascend: 90 is followed by 45"),
        ("broken_count.ies", "the file ends before vertical angles, of which there are 3000"),
        ("broken_tilt_file.ies", "lamp:4:1: the factors for a tilted lamp are in the file 'lamp.tlt'"),
        ("broken_dark.ies", "all its intensities are 0"),
        ("broken_type.ies", "4 for the photometric type, which is a whole number from 1 to 3"),
        ("broken_planes.ies", "the horizontal angles go from 0 to 120 degrees"),
        ("broken_nothing.ies", "there is no line TILT=NONE"),
        ("broken_cut_off.ldt", "one of the 7 intensities: it is cut off"),
        ("broken_symmetry.ldt", "6 C planes (Mc) are no multiple of 4"),
        ("broken_word.ldt", "lamp:29:1: 'two thousand' is no number: here is the luminous flux of the lamps"),
        ("broken_gamma.ldt", "the γ angles do not ascend: 30 is followed by 15"),
        ("broken_no_lamp.txt", "this is no file of a lamp"),
    ] {
        let error = reads(&std::fs::read(folder().join(name)).unwrap()).unwrap_err();
        assert!(error.contains(why), "{name}: {error}");
    }
}

#[test]
fn an_ies_file_is_its_intensities_times_its_factors() {
    let round = seed("round_1986.ies");
    close(round.at(0.0, 77.0), 500.0);
    close(round.at(60.0, 300.0), 250.0);
    assert_eq!(round.at(91.0, 0.0), 0.0);
    // Multiplier 0.5, ballast factor 0.9; 100 + 2γ + C in a quadrant.
    let quadrants = seed("quadrants_1995.ies");
    for (c, same) in [(30.0, 30.0), (150.0, 30.0), (210.0, 30.0), (-30.0, 30.0), (90.0, 90.0), (300.0, 60.0)]
    {
        close(quadrants.at(40.0, c), 0.45 * (180.0 + same));
    }
    let latin = seed("latin_2002.ies");
    assert_eq!(latin.name(), "Wandflächenstrahler");
    for (c, same) in
        [(90.0, 90.0), (0.0, 180.0), (180.0, 180.0), (300.0, 240.0), (60.0, 120.0), (270.0, 270.0)]
    {
        close(latin.at(10.0, c), 120.0 + same);
    }
    // The last factor of the edition of 2019 is none, and nothing is symmetrical.
    let turn = seed("turn_2019.ies");
    close(turn.at(10.0, 90.0), 210.0);
    close(turn.at(10.0, 270.0), 390.0);
}

/// Planted bugs: the multiplier left out, and an angle in the wrong half plane, are far beyond what the tests above allow.
#[test]
fn the_seeds_tell_factors_and_half_planes_apart() {
    let text = String::from_utf8(std::fs::read(folder().join("quadrants_1995.ies")).unwrap()).unwrap();
    let whole = reads(text.replace("2000 0.5 7", "2000 1 7").as_bytes()).unwrap().0;
    assert!((whole.at(40.0, 30.0) / 0.45 / 210.0 - 2.0).abs() < 1e-5);
    let turn = seed("turn_2019.ies");
    assert!((turn.at(10.0, 90.0) - turn.at(10.0, -90.0)).abs() > 100.0);
}

#[test]
fn floodlights_and_headlights_have_their_own_planes() {
    let (flood, warnings) = reads(&std::fs::read(folder().join("flood_b_1991.ies")).unwrap()).unwrap();
    assert_eq!(
        (flood.goniometer(), &*warnings[0]),
        (Goniometer::B, "its factors for a lamp that is tilted are left out")
    );
    // The azimuth is V, and the polar angle H + 90; the file has H on one side only.
    for h in [30.0, -30.0] {
        close(flood.at(90.0 + h, 0.0), 10.0);
        close(flood.at(90.0 + h, -30.0), 5.0);
    }
    assert_eq!([flood.at(90.0, 61.0), flood.at(151.0, 0.0)], [0.0; 2]);
    let head = seed("headlight_a.ies");
    assert_eq!(head.goniometer(), Goniometer::A);
    close(head.at(90.0, 0.0), 500.0);
    close(head.at(110.0, 0.0), 40.0);
    close(head.at(90.0, 20.0), 50.0);
    // One that begins in the middle is the same on its other side.
    let text = String::from_utf8(std::fs::read(folder().join("headlight_a.ies")).unwrap()).unwrap();
    let half = text
        .replace('\r', "")
        .replace("10 3 5 3", "10 3 3 3")
        .replace("-40 -20 0 20 40\n0 1 0\n1 5 2\n", "0 20 40\n");
    let (half, _) = reads(half.as_bytes()).unwrap();
    for (v, h) in [(90.0, -20.0), (100.0, 10.0), (75.0, -35.0), (90.0, 30.0)] {
        close(half.at(v, h), head.at(v, h));
    }
    assert_eq!([head.at(90.0, 41.0), head.at(69.0, 0.0)], [0.0; 2]);
}

#[test]
fn an_eulumdat_file_is_intensities_per_thousand_lumen_of_its_lamps() {
    let value = |c: f64, gamma: f64| {
        let cos = |degrees: f64| cos_f64(degrees.to_radians());
        // 2,000 lm.
        2.0 * (200.0 * cos(gamma) * (1.0 + 0.3 * cos(c)) + 20.0 * cos(90.0 - c) + 50.0)
    };
    let all = |name: &str, factor: f64, same: &dyn Fn(f64) -> f64| {
        let lamp = seed(name);
        assert_eq!(lamp.name(), "Office, für Räume");
        for c in (0..16).map(|i| 45.0 * f64::from(i)) {
            for gamma in [0.0, 45.0, 90.0] {
                let found = lamp.at(gamma, c);
                let wanted = factor * value(same(c % 360.0), gamma);
                assert!((found - wanted).abs() < 1e-2, "{name}, C {c}, γ {gamma}: {found} for {wanted}");
            }
        }
    };
    all("office_none.ldt", 1.0, &|c| c);
    all("office_round.ldt", 1.0, &|_| 0.0);
    all("office_c0_c180.ldt", 1.0, &|c| if c > 180.0 { 360.0 - c } else { c });
    all("office_c90_c270.ldt", 1.0, &|c| if c > 90.0 && c < 270.0 { 180.0 - c } else { c });
    all("office_quadrants.ldt", 1.1, &|c| {
        let c = if c > 180.0 { 360.0 - c } else { c };
        if c > 90.0 { 180.0 - c } else { c }
    });
    let (_, warnings) = reads(&std::fs::read(folder().join("office_c0_c180.ldt")).unwrap()).unwrap();
    assert_eq!(warnings, ["of its 2 sets of lamps the first is used, with 2000 lm"]);
}

/// Cut off anywhere, and with a byte of any kind in any place.
#[test]
fn damaged_files_never_panic() {
    let options = ReadOptions { max_memory: 1 << 20, ..ReadOptions::default() };
    let survive = |bytes: &[u8]| {
        if let Ok((distribution, _)) = read_distribution(bytes, "lamp", &options) {
            assert!(distribution.lumens().is_finite());
            assert!(distribution.candela().iter().all(|value| *value >= 0.0));
        }
    };
    for (_, bytes) in seeds() {
        (0..bytes.len()).for_each(|length| survive(&bytes[..length]));
        for at in 0..bytes.len() {
            for byte in [b' ', b'\n', b'-', b'9', b'e', b'.', 0, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] = byte;
                survive(&damaged);
            }
        }
    }
}

#[test]
fn counts_of_strangers_ask_for_no_memory() {
    let text = "IESNA91\nTILT=NONE\n1 1 1 3601 3601 1 1 0 0 0 1 1 1\n0 1 2";
    assert!(reads(text.as_bytes()).unwrap_err().contains("of which there are 3601"));
    let small = ReadOptions { max_memory: 1000, ..ReadOptions::default() };
    let bytes = std::fs::read(folder().join("turn_2019.ies")).unwrap();
    assert!(read_distribution(&bytes, "lamp", &small).unwrap_err().to_string().contains("memory"));
}

/// All kinds come back from the files that a scene is written with, each angle and intensity the same.
#[test]
fn lamps_in_scene_files_come_back_from_written_ones() {
    let temporary = tempfile::tempdir().unwrap();
    let names: Vec<String> =
        seeds().into_iter().map(|(name, _)| name).filter(|name| !name.starts_with("broken")).collect();
    let mut text = String::new();
    for name in &names {
        std::fs::copy(folder().join(name), temporary.path().join(name)).unwrap();
        text += &format!("[[light]]\nkind = \"luminaire\"\ndistribution = \"{name}\"\n");
    }
    let path = temporary.path().join("in.toml");
    std::fs::write(&path, text).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let out = temporary.path().join("out.toml");
    write(&out, &scene, &WriteOptions::default()).unwrap();
    let back = read(&out, &ReadOptions::default()).unwrap();
    assert_eq!(back.lights.len(), names.len());
    for ((one, two), name) in scene.lights.iter().zip(&back.lights).zip(&names) {
        let [one, two] = [one, two].map(distribution);
        assert_eq!(one.goniometer(), two.goniometer(), "{name}");
        for polar in (0..=36).map(|i| 5.0 * f64::from(i)) {
            for azimuth in (-12..=12).map(|i| 15.0 * f64::from(i)) {
                assert_eq!(one.at(polar, azimuth), two.at(polar, azimuth), "{name} {polar} {azimuth}");
            }
        }
    }
}

fn distribution(light: &Spec) -> Arc<IntensityDistribution> {
    match light.parameters.find("distribution") {
        Some((Value::Distribution(distribution), _)) => distribution.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_lamp_that_is_wrong_or_missing_or_outside_is_an_error_at_its_place() {
    let refused = |value: &str| {
        let temporary = tempfile::tempdir().unwrap();
        std::fs::write(temporary.path().join("dark.ies"), "IESNA91\nTILT=NONE\n").unwrap();
        let path = temporary.path().join("scene.toml");
        std::fs::write(&path, format!("[[light]]\nkind = \"luminaire\"\ndistribution = {value}\n")).unwrap();
        read(&path, &ReadOptions::default()).map(|_: SceneBuilder| ()).unwrap_err().to_string()
    };
    assert!(refused("\"dark.ies\"").contains("dark.ies"));
    assert!(refused("\"none.ies\"").contains("none.ies"));
    assert!(refused("\"../../lamp.ies\"").contains("scene.toml:3"));
    assert!(refused("3").contains("text"));
}

/// Quantities as text are kept in TOML, and are numbers in formats that have no units.
#[test]
fn quantities_of_light_are_read_written_and_refused_with_their_place() {
    let temporary = tempfile::tempdir().unwrap();
    let of = |text: &str| {
        let path = temporary.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        read(&path, &ReadOptions::default()).map_err(|error| error.to_string())
    };
    let scene = of(
        "[[light]]\nkind = \"point\"\nintensity = \"683 lm\"\n[[light]]\nkind = \"rect\"\nradiance = \"1366 nit\"\n\
         [[material]]\nname = \"m\"\nkind = \"diffuse\"\nemission = \"2000 nit 3000 K\"\n[[model]]\nshape = \"floor\"\nmaterial = \"m\"\n",
    )
    .unwrap();
    for (name, text) in
        [("out.toml", "\"683 lm\""), ("out.gltf", "\"intensity\""), ("out.pbrt", "0.07957747")]
    {
        let out = temporary.path().join(name);
        write(&out, &scene, &WriteOptions::default()).unwrap();
        let written = std::fs::read_to_string(&out).unwrap();
        assert!(written.contains(text), "{name}: {written}");
        let back = read(&out, &ReadOptions::default()).unwrap();
        let light = bilux_scene::lights::in_numbers(&back.lights[0]);
        let intensity = light.colour("intensity").unwrap();
        assert!((intensity.g * 4.0 * std::f32::consts::PI - 1.0).abs() < 1e-5, "{name}: {intensity:?}");
    }
    for (light, why) in [
        (
            "kind = \"point\"\nintensity = \"800 lumn\"",
            ":3:1: point.intensity is \"800 lumn\", but must be a colour",
        ),
        ("kind = \"point\"\nintensity = \"800 lumn\"", "there is no unit 'lumn'; did you mean 'lumen'?"),
        ("kind = \"point\"\nintensity = \"-5 cd\"", "-5 cd is negative"),
        ("kind = \"environment\"\nradiance = \"800 lm\"", "this is a radiance, and '800 lm' is a flux"),
        ("kind = \"directional\"\nirradiance = \"1e20 lux\"", "this is too much"),
        ("kind = \"point\"\nposition = \"5 K\"", "three numbers"),
    ] {
        let error = of(&format!("[[light]]\n{light}\n")).unwrap_err();
        assert!(error.contains(why), "{error}");
    }
    let error = of("[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = \"5000 K\"\n").unwrap_err();
    assert!(error.contains("a colour [r, g, b] with each from 0 to 1"), "{error}");
}

/// A lamp of 100 cd in all directions gives 400 π lm; of 683 cd, with the multiplier, all of them count.
#[test]
fn stated_lumens_that_cannot_be_are_said() {
    let file = |lamps: &str, multiplier: f64, ballast: f64| {
        format!(
            "IESNA:LM-63-2002\nTILT=NONE\n{lamps} {multiplier} 2 1 1 2 0 0 0\n{ballast} 1 10\n0 180\n0\n100 100\n"
        )
    };
    let said = |lamps: &str, multiplier: f64, ballast: f64| {
        let (lamp, warnings) = reads(file(lamps, multiplier, ballast).as_bytes()).unwrap();
        close(lamp.lumens(), 400.0 * std::f64::consts::PI * multiplier * ballast);
        warnings.join("; ")
    };
    // 1257 lm: from one lamp, from two, and of none that is stated.
    for right in ["1 1257", "2 700", "1 -1", "1 0"] {
        assert_eq!(said(right, 1.0, 1.0), "", "{right}");
    }
    assert_eq!(said("1 1257", 1.0, 0.5), "", "a ballast dims what is stated too");
    for (lamps, multiplier, wanted) in [
        ("1 1000", 1.0, "it states lamps of 1000 lm, but its intensities add up to 1257 lm (126%)"),
        ("2 3000", 1.0, "it states lamps of 6000 lm, but its intensities add up to 1257 lm (21%)"),
        ("1 1257", 3.0, "it states lamps of 1257 lm, but its intensities add up to 3770 lm (300%)"),
    ] {
        assert!(said(lamps, multiplier, 1.0).starts_with(wanted), "{}", said(lamps, multiplier, 1.0));
    }
}
