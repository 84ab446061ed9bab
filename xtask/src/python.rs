//! The Python package: `cargo xtask wheel` builds it as it is handed out, and the step `python` of `cargo xtask test`
//! builds, installs and tests it. Both work in virtual environments in the target folder.

use crate::process::{output, root, run as run_process, target_folder};
use crate::stamp::Stamp;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the package, relative to the root of the repository.
const PACKAGE: &str = "crates/python";

/// The oldest Python that it works with.
const OLDEST: (u32, u32) = (3, 10);

/// Packages that build a wheel.
const BUILDERS: &[&str] = &["maturin>=1.7,<2"];

/// Packages that the tests use.
const TESTERS: &[&str] = &["numpy", "pytest", "mypy", "trimesh", "rtree", "scipy", "tqdm"];

/// Packages that only some tests use, which skip aloud where they cannot be had: what runs jobs for farms, notebooks, their
/// widgets, plots, videos, the renderer that one page compares with, and what reads EXR files as compositors do.
const EXTRAS: &[&str] = &[
    "openjd-cli",
    "nbclient ipykernel",
    "anywidget",
    "matplotlib",
    "imageio imageio-ffmpeg",
    "pyrender",
    "OpenEXR OpenImageIO mmh3",
];

/// Packages that the tests of clusters use.
const CLUSTER_TESTERS: &[&str] = &["numpy", "pytest", "ray>=2.9"];

/// The tests of clusters.
const CLUSTER_TESTS: &str = "test_cluster.py";

/// The tests of the examples.
const EXAMPLE_TESTS: &str = "test_examples.py";

/// The largest wheel that is handed out, in bytes.
const LARGEST: u64 = 9_000_000;

/// Builds the wheel into `target/wheels`, and prints its size.
pub(crate) fn wheel(_: &[String]) -> Result<()> {
    let python = python()?;
    let builders = builders(&python)?;
    let wheel = build(
        &builders,
        &["--release", "--strip", "--compression-level", "9"],
        &target_folder().join("wheels"),
    )?;
    let bytes = fs::metadata(&wheel)?.len();
    println!("{bytes} bytes  {}", wheel.display());
    if bytes > LARGEST {
        bail!("the wheel is larger than {LARGEST} bytes: find out what is in it");
    }
    audit(&builders, &wheel)?;
    println!("install it: pip install {}", wheel.display());
    Ok(())
}

/// Makes the virtual environments that the tests need, which takes a while: they are downloaded. The tests say what is
/// missing.
pub(crate) fn prepare() -> Result<()> {
    drop(environments());
    Ok(())
}

/// Environments that build the package and that test it.
fn environments() -> Result<(Environment, Environment)> {
    let python = python()?;
    let testers = Environment::new(&python, "test", TESTERS, EXTRAS)?;
    Ok((builders(&python)?, testers))
}

/// Builds the package with the development profile, installs it, and runs its tests and the checks of its types. Skips
/// all that, and says so, where Python or the packages for it cannot be had.
pub(crate) fn test(is_built: bool) -> Result<()> {
    let (builders, testers) = match environments() {
        Ok(environments) => environments,
        Err(error) => {
            println!("SKIPPED: the Python package is not tested: {error:#}");
            return Ok(());
        }
    };
    println!("SKIPPED: {CLUSTER_TESTS} needs Ray, which is large: `cargo xtask python-cluster` runs it");
    // The tests compare with what the command line writes.
    if !is_built {
        crate::build::all()?;
    }
    place(&builders, &testers)?;
    let binary = target_folder().join("debug").join(format!("bilux{}", std::env::consts::EXE_SUFFIX));
    let package = root().join(PACKAGE);
    let inputs = [package.clone(), library(), binary.clone()];
    let examples = Stamp::new("examples", &inputs.into_iter().chain(testers.marks()).collect::<Vec<_>>())?;
    let mut pytest = pytest(&testers, "");
    if examples.is_fresh() {
        println!("left out: the examples, since neither they nor what they run have changed");
        pytest.arg("--ignore").arg(package.join("tests").join(EXAMPLE_TESTS));
    }
    run_process(pytest.env("BILUX_BINARY", binary))?;
    examples.write()?;
    check_types(&testers)
}

/// Checks the types within the package, and that they are those of the library.
fn check_types(testers: &Environment) -> Result<()> {
    let package = root().join(PACKAGE);
    let settings = package.join("pyproject.toml");
    let inputs = [package.join("python"), package.join("src"), settings.clone()];
    let stamp = Stamp::new("types", &inputs.into_iter().chain(testers.marks()).collect::<Vec<_>>())?;
    if stamp.is_fresh() {
        println!("left out: the types, since nothing of the package has changed");
        return Ok(());
    }
    let cache = target_folder().join("python/mypy");
    let mut mypy = testers.python();
    mypy.args(["-m", "mypy", "-p", "bilux", "--config-file"]).arg(&settings).arg("--cache-dir").arg(&cache);
    run_process(&mut mypy)?;
    run_process(testers.python().args(["-m", "mypy.stubtest", "bilux"]))?;
    stamp.write()
}

/// The library of the package, as the development profile builds it.
fn library() -> PathBuf {
    let (before, after) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    target_folder().join("debug").join(format!("{before}_bilux{after}"))
}

/// Builds a wheel with the development profile, installs it, and runs the tests of the package itself.
pub(crate) fn test_wheel() -> Result<()> {
    let python = python()?;
    let testers = Environment::new(&python, "test", TESTERS, EXTRAS)?;
    install(&builders(&python)?, &testers)?;
    run_process(&mut pytest(&testers, "test_package.py"))
}

/// Checks with auditwheel, on Linux, that the wheel runs wherever its name says.
fn audit(builders: &Environment, wheel: &Path) -> Result<()> {
    if !cfg!(target_os = "linux") {
        println!("SKIPPED: auditwheel checks wheels on Linux only");
        return Ok(());
    }
    if output(builders.python().args(["-m", "auditwheel", "--version"])).is_err() {
        println!("SKIPPED: auditwheel is not installed, so the wheel's tag is not checked");
        return Ok(());
    }
    let report = output(builders.python().args(["-m", "auditwheel", "show"]).arg(wheel))?;
    let tag = tag_of(&report).with_context(|| format!("auditwheel gives the wheel no tag:\n{report}"))?;
    let name = wheel.file_name().unwrap_or_default().to_string_lossy();
    if !name.ends_with(&format!("{tag}.whl")) {
        bail!("{name}: auditwheel says that it runs where {tag} does:\n{report}");
    }
    println!("auditwheel: the wheel is {tag}, as its name says");
    Ok(())
}

/// The platform tag in what `auditwheel show` prints, whose lines it breaks anywhere.
fn tag_of(report: &str) -> Option<String> {
    let words: Vec<&str> = report.split_whitespace().collect();
    let text = words.join(" ");
    let (_, rest) = text.split_once("following platform tag: \"")?;
    Some(rest.split_once('"')?.0.to_owned())
}

/// The environment that builds wheels.
fn builders(python: &str) -> Result<Environment> {
    Environment::new(python, "build", BUILDERS, &["auditwheel"])
}

/// Tests `bilux.cluster`: two nodes in processes of this machine, of which some are killed.
pub(crate) fn cluster(_: &[String]) -> Result<()> {
    let python = python()?;
    let builders = builders(&python)?;
    let testers = Environment::new(&python, "cluster", CLUSTER_TESTERS, &[])?;
    install(&builders, &testers)?;
    run_process(&mut pytest(&testers, CLUSTER_TESTS))
}

/// Builds the package with the development profile, and installs it.
fn install(builders: &Environment, testers: &Environment) -> Result<()> {
    let wheel = build(builders, &["--profile", "dev"], &target_folder().join("python/wheels"))?;
    emptied(testers)?;
    let mut install = testers.python();
    run_process(
        install.args(["-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]).arg(&wheel),
    )
}

/// Installs the package as a wheel would, from the library that [`crate::build::all`] has left: a wheel is built with other features
/// of shared dependencies, so all libraries below would be built a second time.
fn place(builders: &Environment, testers: &Environment) -> Result<()> {
    if !cfg!(target_os = "linux") {
        // Elsewhere it takes more than cargo to link a module of Python.
        return install(builders, testers);
    }
    let site = emptied(testers)?;
    let package = root().join(PACKAGE);
    let placed = site.join("bilux");
    copy(&package.join("python/bilux"), &placed)?;
    let library = library();
    fs::copy(&library, placed.join("_bilux.abi3.so"))
        .with_context(|| format!("cannot copy {}", library.display()))?;
    output(testers.python().args(["-m", "compileall", "-q"]).arg(&placed))?;
    let mut maturin = builders.python();
    maturin.args(["-m", "maturin", "pep517", "write-dist-info", "--manifest-path"]);
    maturin.arg(package.join("Cargo.toml")).arg("--metadata-directory").arg(&site);
    output(maturin.arg("--interpreter").arg(&testers.interpreter)).map(drop)
}

/// Folder of an environment's packages, without ours: pip refuses to remove a package that [`place`] has put there.
fn emptied(testers: &Environment) -> Result<PathBuf> {
    let ask = ["-c", "import sysconfig; print(sysconfig.get_path('platlib'))"];
    let site = PathBuf::from(output(testers.python().args(ask))?.trim());
    for entry in fs::read_dir(&site).with_context(|| format!("cannot list {}", site.display()))?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name == "bilux" || name.starts_with("bilux-") && name.ends_with(".dist-info") {
            fs::remove_dir_all(entry.path())
                .with_context(|| format!("cannot remove {}", entry.path().display()))?;
        }
    }
    Ok(site)
}

/// Copies a folder of modules.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("cannot make {}", to.display()))?;
    for entry in fs::read_dir(from).with_context(|| format!("cannot list {}", from.display()))? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        match entry.file_type()?.is_dir() {
            true if entry.file_name() == "__pycache__" => {}
            true => copy(&entry.path(), &target)?,
            false if entry.path().extension().is_some_and(|extension| extension == "so") => {}
            false => fs::copy(entry.path(), &target)
                .map(drop)
                .with_context(|| format!("cannot write {}", target.display()))?,
        }
    }
    Ok(())
}

/// Runs the tests, or one file of them.
fn pytest(testers: &Environment, file: &str) -> Command {
    let mut pytest = testers.python();
    let tests = root().join(PACKAGE).join("tests").join(file);
    pytest.args(["-m", "pytest", "-q", "-rs", "--durations=15", "-p", "no:cacheprovider"]).arg(tests);
    pytest
}

/// Builds a wheel into a folder that then holds no other, and returns its path.
fn build(builders: &Environment, how: &[&str], folder: &Path) -> Result<PathBuf> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    let mut maturin = builders.python();
    maturin.args(["-m", "maturin", "build", "--quiet", "--locked"]).args(how).arg("--out").arg(folder);
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
pub(crate) fn python() -> Result<String> {
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
pub(crate) struct Environment {
    interpreter: PathBuf,
}

impl Environment {
    /// The environment of this name in the target folder, made if it is not there or has other packages.
    /// `extras` are groups of packages, separated by spaces, that it also works without.
    pub(crate) fn new(python: &str, name: &str, packages: &[&str], extras: &[&str]) -> Result<Environment> {
        let folder = target_folder().join("python").join(name);
        let scripts = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
        let environment = Environment { interpreter: folder.join(scripts) };
        let stamp = folder.join("packages.txt");
        let wanted = [packages, extras].concat().join("\n");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
            return Ok(environment);
        }
        let made = output(Command::new(python).args(["-m", "venv", "--clear"]).arg(&folder));
        made.context("cannot make a virtual environment: install Python's module venv")?;
        // What is imported is compiled then, once; most of it never is.
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-compile"];
        let can_install = |names: &[&str]| {
            let words = names.iter().flat_map(|group| group.split(' '));
            output(environment.python().args(install).args(words))
        };
        // All at once takes half the time of one after the other.
        if can_install(&[packages, extras].concat()).is_err() {
            let installed = can_install(packages);
            installed.with_context(|| format!("pip cannot install {}", packages.join(", ")))?;
            let lacking: Vec<&&str> = extras.iter().filter(|group| can_install(&[group]).is_err()).collect();
            if !lacking.is_empty() {
                // Without the stamp, the next run tries again.
                println!("SKIPPED: pip cannot install {lacking:?}: tests that use them are skipped");
                return Ok(environment);
            }
        }
        fs::write(&stamp, wanted).with_context(|| format!("cannot write {}", stamp.display()))?;
        Ok(environment)
    }

    /// The files that say which Python it is, and which packages it has.
    fn marks(&self) -> impl Iterator<Item = PathBuf> {
        let folder = self.interpreter.ancestors().nth(2).unwrap_or(Path::new(""));
        ["pyvenv.cfg", "packages.txt"].map(|name| folder.join(name)).into_iter().filter(|path| path.exists())
    }

    /// Python of the environment, in the root of the repository, without influence from the user's own packages.
    pub(crate) fn python(&self) -> Command {
        let mut command = Command::new(&self.interpreter);
        command.current_dir(root()).env_remove("PYTHONPATH");
        // Next to the environments, and not among the sources.
        command.env("PYTHONPYCACHEPREFIX", target_folder().join("python/cache"));
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tag_of_a_wheel_is_found() {
        let report =
            "a.whl is consistent with\nthe following platform tag:\n\"manylinux_2_34_x86_64\".\n\nThe wheel";
        assert_eq!(tag_of(report).as_deref(), Some("manylinux_2_34_x86_64"));
        assert_eq!(tag_of("This does not look like a platform wheel"), None);
    }

    #[test]
    fn versions_are_compared_as_numbers() {
        assert!(version("3 11\n").is_some_and(|version| version >= OLDEST));
        assert!(version("3 9").is_some_and(|version| version < OLDEST));
        assert_eq!(version("Python 2.7"), None);
    }
}
