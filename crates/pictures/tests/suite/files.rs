//! Pictures that are written over files that exist: the links and the permissions that stay.
#![cfg(unix)]

use bilux_math::Rgb;
use bilux_pictures::{Picture, WriteOptions, read, write};
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use tempfile::TempDir;

fn picture(side: usize) -> Picture {
    Picture::from_rgb(side, 2, vec![Rgb::new(0.25, 0.5, 1.0); 2 * side]).unwrap()
}

/// A link stays one, whether its file exists already or not, through another link, and with a folder in it.
#[test]
fn a_picture_over_a_link_goes_where_the_link_points() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("pictures")).unwrap();
    symlink("pictures/latest.png", path("direct.png")).unwrap();
    symlink("direct.png", path("twice.png")).unwrap();
    symlink("circle.png", path("circle.png")).unwrap();
    for (number, link) in ["direct.png", "twice.png", "direct.png"].into_iter().enumerate() {
        write(path(link), &picture(number + 3), &WriteOptions::default()).unwrap();
        assert!(fs::symlink_metadata(path(link)).unwrap().is_symlink(), "{link}");
        let written = path("pictures/latest.png");
        assert!(fs::symlink_metadata(&written).unwrap().is_file());
        assert_eq!(read(&written).unwrap().width(), number + 3);
    }
    // A link to itself has no file to write to.
    write(path("circle.png"), &picture(9), &WriteOptions::default()).unwrap();
    assert_eq!(read(path("circle.png")).unwrap().width(), 9);
    let left: Vec<_> = fs::read_dir(path("pictures")).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

#[test]
fn a_picture_over_a_file_keeps_who_may_read_it() {
    let folder = TempDir::new().unwrap();
    let [old, new] = ["old.png", "new.png"].map(|name| folder.path().join(name));
    let mode = |path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for kept in [0o600, 0o664] {
        write(&old, &picture(3), &WriteOptions::default()).unwrap();
        fs::set_permissions(&old, Permissions::from_mode(kept)).unwrap();
        write(&old, &picture(4), &WriteOptions::default()).unwrap();
        assert_eq!((mode(&old), read(&old).unwrap().width()), (kept, 4));
    }
    // A new file has those that the system gives to new files.
    write(&new, &picture(5), &WriteOptions::default()).unwrap();
    fs::write(folder.path().join("plain"), "x").unwrap();
    assert_eq!(mode(&new), mode(&folder.path().join("plain")));
}
