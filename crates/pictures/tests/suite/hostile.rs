//! Untrusted bytes: a picture or an error, never a panic, never more memory than allowed.

use bilux_pictures::{
    Limits, PICTURE_FORMATS, Picture, PictureError, PictureFormatEntry, read_bytes, read_crop_bytes,
};
use proptest::prelude::*;
use std::path::Path;

const LIMITS: Limits = Limits::new(1 << 20);

/// Small, valid files of one format.
fn seeds(format: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../fuzz/corpus/picture_{format}"));
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|seed| seed.unwrap().path()).collect();
    paths.retain(|path| !path.file_name().unwrap().to_string_lossy().starts_with("broken"));
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

fn bytes_of(picture: &Picture) -> u64 {
    (4 * picture.pixel_count() * (picture.channels().len() + picture.integer_planes().len())) as u64
}

fn check(row: &PictureFormatEntry, bytes: &[u8]) -> Result<(), TestCaseError> {
    match (row.read)(bytes, &LIMITS) {
        Ok(picture) => prop_assert!(bytes_of(&picture) <= LIMITS.max_bytes),
        Err(error) => prop_assert!(error.to_string().len() > 10),
    }
    if let Ok(part) = read_crop_bytes(bytes, Some(row.entry.name), &LIMITS) {
        prop_assert!(bytes_of(&part) <= LIMITS.max_bytes);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for row in PICTURE_FORMATS {
            check(row, &bytes)?;
        }
        let _ = read_bytes(&bytes, None, &LIMITS);
    }

    #[test]
    fn arbitrary_bytes_after_a_valid_beginning(
        which in any::<prop::sample::Index>(), kept in 0.0f64..1.0,
        tail in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        for row in PICTURE_FORMATS {
            let seeds = seeds(row.entry.name);
            let seed = which.get(&seeds);
            let mut bytes = seed[..(seed.len() as f64 * kept) as usize].to_vec();
            bytes.extend(&tail);
            check(row, &bytes)?;
        }
    }

    #[test]
    fn good_files_with_a_few_bytes_changed(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        for row in PICTURE_FORMATS {
            let seeds = seeds(row.entry.name);
            let mut bytes = which.get(&seeds).clone();
            for (place, value) in &changes {
                let place = place.index(bytes.len());
                bytes[place] = *value;
            }
            check(row, &bytes)?;
        }
    }
}

/// Wherever a file is cut, it is rejected, or says that it was cut short, or the lost part held nothing of the picture.
#[test]
fn files_cut_short_are_refused_or_say_so() {
    for row in PICTURE_FORMATS {
        for seed in seeds(row.entry.name) {
            let whole = (row.read)(&seed, &LIMITS).unwrap();
            // The last number of a text file can lose its last digit undetected.
            let text = seed.starts_with(b"P2") || seed.starts_with(b"P3");
            for length in 0..seed.len() - if text { 4 } else { 0 } {
                if let Ok(picture) = (row.read)(&seed[..length], &LIMITS) {
                    if picture.warnings.iter().any(|warning| warning.contains("cut short")) {
                        continue;
                    }
                    assert_eq!(picture.channels(), whole.channels(), "{} at {length}", row.entry.name);
                    assert_eq!(picture.integer_planes(), whole.integer_planes());
                }
            }
        }
    }
}

#[test]
fn pictures_beyond_the_limit_are_refused() {
    for row in PICTURE_FORMATS {
        for seed in seeds(row.entry.name) {
            let error = (row.read)(&seed, &Limits::new(3)).unwrap_err();
            let refused = matches!(error, PictureError::TooLarge { .. } | PictureError::Unsupported { .. });
            assert!(refused, "{}: {error}", row.entry.name);
        }
    }
}

#[test]
fn unknown_formats_are_rejected_with_a_list() {
    let error = read_bytes(b"nothing", None, &LIMITS).unwrap_err().to_string();
    assert!(error.contains("png") && error.contains("exr"), "{error}");
    let error = read_bytes(b"nothing", Some("gif"), &LIMITS).unwrap_err().to_string();
    assert!(error.contains("'gif'") && error.contains("png"), "{error}");
    let error = read_bytes(b"GIF89a", Some("gif"), &LIMITS).unwrap_err().to_string();
    assert!(error.contains("a GIF picture") && error.contains("png"), "{error}");
    assert!(read_bytes(b"", None, &LIMITS).is_err());
}
