//! The Python package: `cargo xtask wheel` builds it as it is handed out, and the step `python` of `cargo xtask test`
//! builds, installs and tests it. Both work in virtual environments in the target folder.

use crate::process::{cargo, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the package, relative to the root of the repository.
const PACKAGE: &str = "crates/python";

/// The oldest Python that it works with.
const OLDEST: (u32, u32) = (3, 10);

/// What builds a wheel.
const BUILDERS: &[&str] = &["maturin>=1.7,<2"];

/// What the tests use.
const TESTERS: &[&str] = &["numpy", "pytest", "mypy", "trimesh", "rtree", "scipy", "tqdm"];

/// What the tests of clusters use.
const CLUSTER_TESTERS: &[&str] = &["numpy", "pytest", "ray>=2.9"];

/// The tests of clusters.
const CLUSTER_TESTS: &str = "test_cluster.py";

/// The largest wheel that is handed out, in bytes.
const LARGEST: u64 = 15_000_000;

/// Builds the wheel into `target/wheels`, and prints its size.
pub(crate) fn wheel(_: &[String]) -> Result<()> {
    let python = python()?;
    let builders = Environment::new(&python, "build", BUILDERS)?;
    let wheel = build(&builders, "dist", &target_folder().join("wheels"))?;
    let bytes = fs::metadata(&wheel)?.len();
    println!("{bytes} bytes  {}", wheel.display());
    if bytes > LARGEST {
        bail!("the wheel is larger than {LARGEST} bytes: find out what is in it");
    }
    println!("install it: pip install {}", wheel.display());
    Ok(())
}

/// Builds the package with the development profile, installs it, and runs its tests and the checks of its types. Skips
/// all that, and says so, where Python or the packages for it cannot be had.
pub(crate) fn test() -> Result<()> {
    let environments = python().and_then(|python| {
        Ok((Environment::new(&python, "build", BUILDERS)?, Environment::new(&python, "test", TESTERS)?))
    });
    let (builders, testers) = match environments {
        Ok(environments) => environments,
        Err(error) => {
            println!("SKIPPED: the Python package is not tested: {error:#}");
            return Ok(());
        }
    };
    println!("SKIPPED: {CLUSTER_TESTS} needs Ray, which is large: `cargo xtask python-cluster` runs it");
    // The tests compare with what the command line writes. Of the whole workspace, since the step `test` has built that.
    run_process(&mut cargo(&["build", "--quiet", "--locked", "--workspace", "--bin", "bilux"]))?;
    install(&builders, &testers)?;
    let mut pytest = pytest(&testers, "");
    run_process(pytest.env("BILUX_BINARY", target_folder().join("debug/bilux")))?;
    let settings = root().join(PACKAGE).join("pyproject.toml");
    let cache = target_folder().join("python/mypy");
    let mut mypy = testers.python();
    mypy.args(["-m", "mypy", "-p", "bilux", "--config-file"]).arg(&settings).arg("--cache-dir").arg(&cache);
    run_process(&mut mypy)?;
    run_process(testers.python().args(["-m", "mypy.stubtest", "bilux"]))
}

/// Tests `bilux.cluster`: two nodes in processes of this machine, of which some are killed.
pub(crate) fn cluster(_: &[String]) -> Result<()> {
    let python = python()?;
    let builders = Environment::new(&python, "build", BUILDERS)?;
    let testers = Environment::new(&python, "cluster", CLUSTER_TESTERS)?;
    install(&builders, &testers)?;
    run_process(&mut pytest(&testers, CLUSTER_TESTS))
}

/// Builds the package with the development profile, and installs it.
fn install(builders: &Environment, testers: &Environment) -> Result<()> {
    let wheel = build(builders, "dev", &target_folder().join("python/wheels"))?;
    let mut install = testers.python();
    run_process(
        install.args(["-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]).arg(&wheel),
    )
}

/// Runs the tests, or one file of them.
fn pytest(testers: &Environment, file: &str) -> Command {
    let mut pytest = testers.python();
    let tests = root().join(PACKAGE).join("tests").join(file);
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]).arg(tests);
    pytest
}

/// Builds a wheel into a folder that then holds no other, and returns its path.
fn build(builders: &Environment, profile: &str, folder: &Path) -> Result<PathBuf> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    let mut maturin = builders.python();
    maturin
        .args(["-m", "maturin", "build", "--quiet", "--locked", "--profile", profile, "--out"])
        .arg(folder);
    maturin.arg("--manifest-path").arg(root().join(PACKAGE).join("Cargo.toml"));
    maturin.arg("--target-dir").arg(target_folder());
    run_process(maturin.arg("--interpreter").arg(&builders.interpreter))?;
    let mut files = fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let wheel = files.find_map(|file| file.ok().map(|file| file.path()).filter(|path| is_wheel(path)));
    wheel.with_context(|| format!("maturin has left no wheel in {}", folder.display()))
}

fn is_wheel(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "whl")
}

/// The name of a Python that is new enough.
fn python() -> Result<String> {
    const ASK: &str = "import sys; print(sys.version_info[0], sys.version_info[1])";
    for name in ["python3", "python"] {
        let Ok(answer) = Command::new(name).args(["-c", ASK]).output() else { continue };
        if version(&String::from_utf8_lossy(&answer.stdout)).is_some_and(|version| version >= OLDEST) {
            return Ok(name.to_owned());
        }
    }
    let (major, minor) = OLDEST;
    bail!("there is no Python {major}.{minor} or later on the PATH: install it")
}

/// Reads `3 11`.
fn version(answer: &str) -> Option<(u32, u32)> {
    let (major, minor) = answer.trim().split_once(' ')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// A virtual environment with packages.
struct Environment {
    interpreter: PathBuf,
}

impl Environment {
    /// The environment of this name in the target folder, made if it is not there or has other packages.
    fn new(python: &str, name: &str, packages: &[&str]) -> Result<Environment> {
        let folder = target_folder().join("python").join(name);
        let scripts = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
        let environment = Environment { interpreter: folder.join(scripts) };
        let stamp = folder.join("packages.txt");
        let wanted = packages.join("\n");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
            return Ok(environment);
        }
        let made = output(Command::new(python).args(["-m", "venv", "--clear"]).arg(&folder));
        made.context("cannot make a virtual environment: install Python's module venv")?;
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        let installed = output(environment.python().args(install).args(packages));
        installed.with_context(|| format!("pip cannot install {}", packages.join(", ")))?;
        fs::write(&stamp, wanted).with_context(|| format!("cannot write {}", stamp.display()))?;
        Ok(environment)
    }

    /// Its Python, in the root of the repository, without influence from the user's own packages.
    fn python(&self) -> Command {
        let mut command = Command::new(&self.interpreter);
        command.current_dir(root()).env_remove("PYTHONPATH").env("PYTHONDONTWRITEBYTECODE", "1");
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        assert!(version("3 11\n").is_some_and(|version| version >= OLDEST));
        assert!(version("3 9").is_some_and(|version| version < OLDEST));
        assert_eq!(version("Python 2.7"), None);
    }
}
