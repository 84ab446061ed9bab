//! Files by other programs, if the folder with them is present.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use bilux_pictures::{ColourSpace, Limits, PICTURE_FORMATS, Picture, format_named, read, read_bytes};
use std::path::{Path, PathBuf};

/// The folder of shared scenes, or `None` and a notice.
fn scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !folder.is_dir() {
        eprintln!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}

fn pictures_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(pictures_below(&path));
        } else if path.extension().is_some_and(|e| format_named(&e.to_string_lossy()).is_some()) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Large files are read in the tests that need them: here they would only take time.
const LARGEST: u64 = 300_000;

#[test]
fn every_picture_is_read() {
    let Some(scenes) = scenes() else { return };
    let mut read_ones = 0;
    for path in pictures_below(&scenes).iter().filter(|path| path.metadata().unwrap().len() <= LARGEST) {
        let picture = read(path).unwrap_or_else(|error| panic!("{error}"));
        assert!(!picture.channels().is_empty(), "{}", path.display());
        read_ones += 1;
    }
    assert!(read_ones > 100, "only {read_ones} pictures");
}

#[test]
fn files_of_each_format_cut_short_are_refused_or_say_so() {
    let Some(scenes) = scenes() else { return };
    for row in PICTURE_FORMATS {
        let all = pictures_below(&scenes);
        let of_format =
            |path: &&PathBuf| row.extensions.contains(&&*path.extension().unwrap().to_string_lossy());
        for path in
            all.iter().filter(of_format).filter(|path| path.metadata().unwrap().len() <= LARGEST).take(12)
        {
            let bytes = std::fs::read(path).unwrap();
            for sixteenth in 0..15 {
                let cut = &bytes[..bytes.len() * sixteenth / 16];
                if let Ok(picture) = (row.read)(cut, &Limits::default()) {
                    let says_so = picture.warnings.iter().any(|warning| warning.contains("cut short"));
                    assert!(says_so, "{} cut to {} of {}", path.display(), cut.len(), bytes.len());
                }
            }
        }
    }
}

fn png_suite(name: &str) -> Option<Picture> {
    let folder = scenes()?.join("png/pngsuite");
    let found = ["primary", "16bit"].iter().map(|part| folder.join(part).join(format!("{name}.png")));
    let path = found.into_iter().find(|path| path.is_file());
    if path.is_none() {
        eprintln!("skipped: there is no {name}.png");
    }
    path.map(|path| read(path).unwrap_or_else(|error| panic!("{error}")))
}

/// The suite has most pictures twice: interlaced and not, in one chunk or in many, at different compression levels.
#[test]
fn pairs_of_the_png_suite_agree() {
    let mut pairs: Vec<(String, String)> = Vec::new();
    for kind in ["0g01", "0g02", "0g04", "0g08", "0g16", "2c08", "2c16", "3p01", "3p02", "3p04", "3p08"] {
        pairs.push((format!("basn{kind}"), format!("basi{kind}")));
    }
    for kind in ["4a08", "4a16", "6a08", "6a16"] {
        pairs.push((format!("basn{kind}"), format!("basi{kind}")));
    }
    for size in ["01", "02", "03", "04", "05", "06", "07", "08", "09"].into_iter().chain(["32", "33", "40"]) {
        let depth = if size < "05" {
            "01"
        } else if size < "10" {
            "02"
        } else {
            "04"
        };
        pairs.push((format!("s{size}n3p{depth}"), format!("s{size}i3p{depth}")));
    }
    for chunks in ["oi2", "oi4", "oi9"] {
        pairs.push(("oi1n2c16".to_owned(), format!("{chunks}n2c16")));
        pairs.push(("oi1n0g16".to_owned(), format!("{chunks}n0g16")));
    }
    pairs.extend(["z03", "z06", "z09"].map(|level| ("z00n2c08".to_owned(), format!("{level}n2c08"))));
    for (a, b) in pairs {
        if let (Some(a_picture), Some(b_picture)) = (png_suite(&a), png_suite(&b)) {
            assert_eq!(a_picture.channels(), b_picture.channels(), "{a} and {b}");
        }
    }
}

/// Known from the suite's own description: sizes by name, transparency, gamma.
#[test]
fn the_png_suite_is_understood() {
    for side in 1..=9 {
        let depth = if side < 5 { "01" } else { "02" };
        let Some(picture) = png_suite(&format!("s{side:02}n3p{depth}")) else { return };
        assert_eq!((picture.width(), picture.height()), (side, side));
    }
    let Some(linear) = png_suite("basn2c08") else { return };
    assert_eq!(linear.colour_space, ColourSpace::LinearRec709);
    let alphas = ["tbbn0g04", "tp1n3p08", "tbrn2c08", "tbwn3p08"];
    for picture in alphas.iter().filter_map(|name| png_suite(name)) {
        let alpha = picture.channel("A").unwrap();
        assert!(alpha.contains(&0.0) && alpha.contains(&1.0));
    }
    assert!(png_suite("tp0n2c08").unwrap().channel("A").is_none());
}

#[test]
fn every_half_is_read_exactly() {
    let Some(scenes) = scenes() else { return };
    let Ok(bytes) = std::fs::read(scenes.join("exr/TestImages/AllHalfValues.exr")) else { return };
    let picture = read_bytes(&bytes, None, &Limits::default()).unwrap();
    let mut seen = vec![false; 1 << 16];
    for sample in picture.channel("R").unwrap() {
        let half = half::f16::from_f32(*sample);
        assert!(half.to_f32().to_bits() == sample.to_bits() || sample.is_nan());
        seen[half.to_bits() as usize] = true;
    }
    // NaN values lose their payload; finite numbers and infinities all occur.
    let finite = seen.iter().enumerate().filter(|(bits, _)| !half::f16::from_bits(*bits as u16).is_nan());
    assert!(finite.into_iter().all(|(_, seen)| *seen));
}
