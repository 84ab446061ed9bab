//! Every seed of the fuzz targets: those named broken are rejected with a reason; the others are read.

use bilux_pictures::{Limits, PICTURE_FORMATS, format_named};
use std::path::Path;

#[test]
fn every_seed_is_read_or_refused() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let limits = Limits::new(64 << 20);
    for row in PICTURE_FORMATS {
        let folder = corpus.join(format!("picture_{}", row.entry.name));
        let mut seeds = 0;
        for seed in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        {
            let path = seed.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).unwrap();
            match ((row.read)(&bytes, &limits), name.starts_with("broken")) {
                (Ok(picture), false) => assert!(!picture.channels().is_empty(), "{name}"),
                (Err(error), true) => assert!(error.to_string().len() > 20, "{name}: {error}"),
                (Ok(_), true) => panic!("{name} is broken, and was read"),
                (Err(error), false) => panic!("{name}: {error}"),
            }
            seeds += 1;
        }
        assert!(seeds >= 3, "{}: too few seeds", row.entry.name);
    }
}

#[test]
fn every_seed_is_recognised_by_its_first_bytes() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    for row in PICTURE_FORMATS {
        for seed in std::fs::read_dir(corpus.join(format!("picture_{}", row.entry.name))).unwrap() {
            let path = seed.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            let reported = PICTURE_FORMATS.iter().find(|row| (row.sniff)(&bytes)).map(|row| row.entry.name);
            // TGA has no signature, and no other format claims its files.
            let expected = Some(row.entry.name).filter(|&name| name != "tga");
            assert_eq!(reported, expected, "{}", path.display());
            let extension = path.extension().unwrap().to_string_lossy();
            assert_eq!(format_named(&extension).map(|row| row.entry.name), Some(row.entry.name));
        }
    }
}
