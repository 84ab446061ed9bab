//! Where the library may be.

use std::env;
use std::path::{Path, PathBuf};

/// Its file's name.
const FILE: &str = if cfg!(target_os = "windows") {
    "OpenImageDenoise.dll"
} else if cfg!(target_os = "macos") {
    "libOpenImageDenoise.2.dylib"
} else {
    "libOpenImageDenoise.so.2"
};

/// What `OIDN_LIB` names, alone if it is said; else beside this program, where Python keeps packages, and by its name alone, as the
/// system finds it.
pub(super) fn places() -> Vec<PathBuf> {
    if let Some(named) = env::var_os("OIDN_LIB").filter(|named| !named.is_empty()) {
        let named = PathBuf::from(named);
        return vec![if named.is_dir() { named.join(FILE) } else { named }];
    }
    let mut places = Vec::new();
    if let Ok(program) = env::current_exe()
        && let Some(folder) = program.parent()
    {
        places.extend([folder.join(FILE), folder.join("../lib").join(FILE)]);
    }
    for prefix in python_prefixes() {
        places.extend(in_packages(&prefix));
    }
    places.retain(|place| place.is_file());
    places.push(PathBuf::from(FILE));
    places
}

/// Where Pythons are installed: the active environment, those on the path, the user's own packages.
fn python_prefixes() -> Vec<PathBuf> {
    let named = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(env::var_os).map(PathBuf::from);
    let path = env::var_os("PATH").unwrap_or_default();
    let has_python =
        |bin: &PathBuf| ["python3", "python3.exe", "python.exe"].iter().any(|p| bin.join(p).exists());
    let on_path = env::split_paths(&path).filter(has_python).filter_map(|bin| Some(bin.parent()?.to_owned()));
    let own = env::var_os("HOME").map(|home| Path::new(&home).join(".local"));
    let mut prefixes: Vec<PathBuf> = named.chain(on_path).chain(own).collect();
    let mut seen = Vec::new();
    prefixes.retain(|prefix| {
        !seen.contains(prefix) && {
            seen.push(prefix.clone());
            true
        }
    });
    prefixes
}

/// The package pyoidn in all that a prefix has of `lib/python3.x/site-packages`, in order of names.
fn in_packages(prefix: &Path) -> Vec<PathBuf> {
    let mut packages = vec![prefix.join("Lib/site-packages")];
    for lib in ["lib", "lib64", "local/lib"] {
        let entries = std::fs::read_dir(prefix.join(lib)).into_iter().flatten().flatten();
        for folder in entries.map(|entry| entry.path()) {
            let is_python =
                folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python3"));
            if is_python {
                packages.extend([folder.join("site-packages"), folder.join("dist-packages")]);
            }
        }
    }
    packages.sort();
    let inner = if cfg!(target_os = "windows") { "pyoidn/oidn/bin" } else { "pyoidn/oidn/lib" };
    packages.into_iter().map(|folder| folder.join(inner).join(FILE)).collect()
}
