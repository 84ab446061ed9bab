//! Whether the sandbox of a process fits another job: each sandbox that a process enters on top of another takes away what the
//! new one does not have.

use crate::commands::shared::sandbox_paths::SandboxPaths;
use std::path::{Path, PathBuf};

/// Permissions that a process in a sandbox has, or that a job in one needs.
#[derive(Clone, Debug)]
pub struct Confines {
    read: Vec<Place>,
    write: Option<Place>,
    /// Whether a denoiser's library may be loaded, which only happens before the first sandbox.
    may_denoise: bool,
}

/// A file or a folder as the kernel knows it: another one of the same name is not the one that a sandbox has.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    path: PathBuf,
    /// The numbers of its device and of its place there.
    id: [u64; 2],
}

impl Confines {
    /// Permissions for these files and folders. What is not there needs none.
    pub fn of(paths: &SandboxPaths, may_denoise: bool) -> Confines {
        let (read, write) = paths.places();
        Confines { read: read.filter_map(Place::of).collect(), write: write.and_then(Place::of), may_denoise }
    }

    /// True if a process that has this can take a job that needs the other.
    pub fn covers(&self, job: &Confines) -> bool {
        self.write == job.write
            && (self.may_denoise || !job.may_denoise)
            && job.read.iter().all(|needed| self.read.iter().any(|own| own.contains(needed)))
    }

    /// Permissions of a process with these when it has also entered the sandbox of a job that they cover.
    pub fn then(&self, job: &Confines) -> Confines {
        Confines { may_denoise: self.may_denoise, ..job.clone() }
    }
}

impl Place {
    fn of(path: &Path) -> Option<Place> {
        let path = path.canonicalize().ok()?;
        Some(Place { id: id(&path)?, path })
    }

    /// True if it is still there, and is the other one or contains it.
    fn contains(&self, other: &Place) -> bool {
        other.path.starts_with(&self.path) && id(&self.path) == Some(self.id)
    }
}

#[cfg(unix)]
fn id(path: &Path) -> Option<[u64; 2]> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().ok().map(|file| [file.dev(), file.ino()])
}

/// Here no kernel knows better.
#[cfg(not(unix))]
fn id(path: &Path) -> Option<[u64; 2]> {
    path.exists().then_some([0; 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_sandbox_fits_a_job_that_needs_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a", "a/inner", "b", "out"] {
            fs::create_dir(path(name)).unwrap();
        }
        for name in ["a/1.obj", "a/2.obj", "a/inner/3.obj", "b/4.obj", "sky.exr", "other.exr"] {
            fs::write(path(name), "").unwrap();
        }
        let needs = |scene: &str, more: &[&str], out: &str, may_denoise: bool| {
            let paths = SandboxPaths::default().reading_scene(&path(scene)).writing(&path(out));
            let paths = more.iter().fold(paths, |paths, file| paths.reading(&path(file)));
            Confines::of(&paths, may_denoise)
        };
        let plain = |scene: &str| needs(scene, &[], "out/x.png", false);
        let first = needs("a/1.obj", &["sky.exr"], "out/x.png", true);
        assert!(first.covers(&plain("a/2.obj")) && first.covers(&plain("a/inner/3.obj")));
        assert!(first.covers(&needs("a/2.obj", &["sky.exr", "missing.exr"], "out/y.png", true)));
        for other in [
            plain("b/4.obj"),
            // It has a file of that folder, not the folder.
            needs("a/1.obj", &["other.exr"], "out/x.png", false),
            needs("a/1.obj", &[], "a/x.png", false),
        ] {
            assert!(!first.covers(&other), "{other:?}");
        }
        assert!(
            !plain("a/1.obj").covers(&needs("a/1.obj", &[], "out/x.png", true)),
            "it is too late to load"
        );
        // What the second sandbox lacks, the process does not have any more; but libraries stay.
        let second = first.then(&plain("a/inner/3.obj"));
        assert!(!second.covers(&plain("a/1.obj")));
        assert!(second.covers(&needs("a/inner/3.obj", &[], "out/x.png", true)));
        // Another folder of the same name.
        fs::rename(path("a"), path("before")).unwrap();
        fs::create_dir(path("a")).unwrap();
        fs::write(path("a/1.obj"), "").unwrap();
        assert!(!first.covers(&plain("a/1.obj")));
    }
}
