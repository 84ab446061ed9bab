//! Finds the Python package pyoidn, which contains the library.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

const NAME: &str = "pyoidn";

/// Interpreters by their names on the path.
const INTERPRETERS: &[&str] =
    if cfg!(target_os = "windows") { &["python3.exe", "python.exe"] } else { &["python3"] };

/// Folders of the package, derived from where Python is installed: the active environment, the interpreters on the
/// path, pyenv's version behind its shim, the user's own packages. Nothing is executed.
pub(super) fn packages() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for prefix in prefixes() {
        for package in in_prefix(&prefix) {
            if package.is_dir() && !found.contains(&package) {
                found.push(package);
            }
        }
    }
    found.extend(in_path().filter(|package| package.is_dir()));
    found
}

/// The package in the folders of `PYTHONPATH`.
fn in_path() -> impl Iterator<Item = PathBuf> {
    let path = env::var_os("PYTHONPATH").unwrap_or_default();
    let folders: Vec<PathBuf> = env::split_paths(&path).filter(|folder| folder.is_absolute()).collect();
    folders.into_iter().map(|folder| folder.join(NAME))
}

/// Interpreters on the path, in its order.
fn on_path() -> Vec<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path)
        .flat_map(|bin| INTERPRETERS.iter().map(move |name| bin.join(name)))
        .filter(|interpreter| interpreter.is_file())
        .collect()
}

fn prefixes() -> Vec<PathBuf> {
    let named = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(env::var_os).map(PathBuf::from);
    let on_path: Vec<PathBuf> = on_path()
        .into_iter()
        .flat_map(|interpreter| {
            // A virtual environment's interpreter is a link to the one it was created from: packages may be next to
            // either.
            let version = version_behind(&interpreter);
            let resolved = interpreter.canonicalize().ok();
            let prefix = |interpreter: PathBuf| Some(interpreter.parent()?.parent()?.to_owned());
            version.into_iter().chain([Some(interpreter), resolved].into_iter().flatten().filter_map(prefix))
        })
        .collect();
    let own = env::var_os("HOME").map(|home| Path::new(&home).join(".local"));
    named.chain(on_path).chain(own).collect()
}

/// Folder of the version that pyenv starts where this interpreter is its shim: the first that is named by `PYENV_VERSION`, by a file
/// `.python-version` in the working directory or above it, or by its own file `version`.
fn version_behind(shim: &Path) -> Option<PathBuf> {
    let shims = shim.parent().filter(|folder| folder.ends_with("shims"))?;
    let root = shims.parent()?;
    let named = env::var("PYENV_VERSION").ok().filter(|named| !named.is_empty());
    let here = env::current_dir().unwrap_or_default();
    let mut files =
        here.ancestors().map(|folder| folder.join(".python-version")).chain([root.join("version")]);
    let named = named.or_else(|| files.find_map(|file| std::fs::read_to_string(file).ok()))?;
    let version = named.split([':', '\n']).next()?.trim();
    let folder = root.join("versions").join(version);
    (!version.is_empty() && !version.contains(['/', '\\']) && folder.is_dir()).then_some(folder)
}

/// Whether an interpreter is a script that knows what no folder reveals.
fn is_script(interpreter: &Path) -> bool {
    use std::io::Read;
    let mut begin = [0; 2];
    let read = std::fs::File::open(interpreter).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && &begin == b"#!" && version_behind(interpreter).is_none()
}

/// The package in every `lib/python3.x/site-packages` of a prefix, in order of names.
fn in_prefix(prefix: &Path) -> Vec<PathBuf> {
    let mut folders = vec![prefix.join("Lib/site-packages")];
    for lib in ["lib", "lib64", "local/lib"] {
        let entries = std::fs::read_dir(prefix.join(lib)).into_iter().flatten().flatten();
        for folder in entries.map(|entry| entry.path()) {
            let is_python =
                folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python3"));
            if is_python {
                folders.extend([folder.join("site-packages"), folder.join("dist-packages")]);
            }
        }
    }
    folders.sort();
    folders.into_iter().map(|folder| folder.join(NAME)).collect()
}

/// Prints where `import pyoidn` would find the package. The working directory, where Python looks first, is excluded:
/// a library must not be loaded merely because a folder of this name happens to be there.
const QUESTION: &str = "import sys; sys.path = [p for p in sys.path if p]; import importlib.util as u; \
    s = u.find_spec('pyoidn'); print(*(s.submodule_search_locations if s else []), sep='\\n')";

/// An interpreter that has not answered after this time is abandoned.
const PATIENCE: Duration = Duration::from_secs(3);

/// The answer of `python3` itself, where it is a script of a manager of versions and environments that no folder reveals. It is asked
/// once: that takes longer than many a thumbnail.
pub(super) fn asked() -> Vec<PathBuf> {
    static ANSWER: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let is_asked = || on_path().first().is_some_and(|interpreter| is_script(interpreter));
    ANSWER.get_or_init(|| if is_asked() { ask() } else { Vec::new() }).clone()
}

fn ask() -> Vec<PathBuf> {
    let answer = |name: &&str| {
        let child = Command::new(name)
            .args(["-c", QUESTION])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        finished(child.ok()?)
    };
    let text = INTERPRETERS.iter().find_map(answer).unwrap_or_default();
    text.lines().filter(|line| !line.trim().is_empty()).map(PathBuf::from).collect()
}

/// The output of a process, if it ended successfully and in time.
fn finished(mut child: Child) -> Option<String> {
    let begun = Instant::now();
    while child.try_wait().ok()?.is_none() {
        if begun.elapsed() > PATIENCE {
            // Whether the process could be killed makes no difference.
            let _ = child.kill();
            let _ = child.wait();
            return None;
        }
        sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
