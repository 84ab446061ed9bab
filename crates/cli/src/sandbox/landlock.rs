//! Linux: Landlock, with which any process can restrict itself irrevocably.

use super::enforcement::Enforcement;
use anyhow::Context;
use landlock::{
    ABI, Access, AccessFs, AccessNet, BitFlags, CompatLevel, Compatible, PathBeneath, PathFd, Ruleset,
    RulesetAttr, RulesetCreated, RulesetCreatedAttr, RulesetStatus, Scope,
};
use std::path::{Path, PathBuf};

/// Rules that are requested: on files, TCP, and signals and sockets to other processes. Older kernels enforce what they can.
const WANTED: ABI = ABI::V6;

/// The files that say how many cores a process may use, which sets the number of threads. They hold nobody's secrets.
const SYSTEM: [&str; 3] = ["/sys/fs/cgroup", "/sys/devices/system/cpu", "/proc/self/cgroup"];

/// Rules that this kernel can enforce.
pub fn available() -> Enforcement {
    let required = || Ruleset::default().set_compatibility(CompatLevel::HardRequirement);
    if required().handle_access(AccessNet::ConnectTcp).is_ok() {
        Enforcement::FilesAndNetwork
    } else if required().handle_access(AccessFs::ReadFile).is_ok() {
        Enforcement::Files
    } else {
        Enforcement::Nothing
    }
}

/// Restricts this thread, and the threads that it starts from now on.
pub fn restrict(read: &[PathBuf], write: Option<&Path>) -> anyhow::Result<Enforcement> {
    let failed = "--sandbox: the kernel refuses to restrict this process";
    let rules = Ruleset::default()
        .handle_access(AccessFs::from_all(WANTED))
        .and_then(|rules| rules.handle_access(AccessNet::from_all(WANTED)))
        .and_then(|rules| rules.scope(Scope::from_all(WANTED)))
        .and_then(Ruleset::create)
        .context(failed)?;
    let mut reads = read.iter().map(PathBuf::as_path).chain(SYSTEM.map(Path::new));
    let mut rules = reads
        .try_fold(rules, |rules, path| allow(rules, path, AccessFs::ReadFile | AccessFs::ReadDir))
        .context(failed)?;
    if let Some(folder) = write {
        // A picture is written to a temporary file in the same folder, and renamed when it is complete.
        let rights = AccessFs::WriteFile
            | AccessFs::Truncate
            | AccessFs::MakeReg
            | AccessFs::RemoveFile
            | AccessFs::MakeDir;
        rules = allow(rules, folder, rights).context(failed)?;
    }
    let status = rules.restrict_self().context(failed)?;
    Ok(match status.ruleset {
        RulesetStatus::NotEnforced => Enforcement::Nothing,
        _ => available(),
    })
}

/// Adds a rule for a file or a folder; a path that does not exist needs none.
fn allow(
    rules: RulesetCreated,
    path: &Path,
    rights: BitFlags<AccessFs>,
) -> Result<RulesetCreated, landlock::RulesetError> {
    let Ok(opened) = PathFd::new(path) else { return Ok(rules) };
    let rights = if path.is_dir() { rights } else { rights & AccessFs::from_file(WANTED) };
    rules.add_rule(PathBeneath::new(opened, rights))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::io::{Error, ErrorKind};
    use std::net::{TcpListener, TcpStream};

    /// Attempts that a faulty decoder might make, and the outcome.
    fn attempts(folder: &Path, port: u16) -> Vec<(&'static str, Result<(), Error>)> {
        let in_thread = {
            let secret = folder.join("secret");
            std::thread::spawn(move || fs::read(secret).map(drop)).join().unwrap()
        };
        vec![
            ("read the scene", fs::read(folder.join("scene/a.obj")).map(drop)),
            ("list the scene's folder", fs::read_dir(folder.join("scene")).map(drop)),
            ("write the picture", fs::write(folder.join("out/a.png"), "x")),
            ("replace the picture", fs::rename(folder.join("out/a.png"), folder.join("out/b.png"))),
            ("read another file", fs::read(folder.join("secret")).map(drop)),
            ("read another file in a thread", in_thread),
            ("read it through a link", fs::read(folder.join("scene/link")).map(drop)),
            ("list another folder", fs::read_dir(folder).map(drop)),
            ("write another file", fs::write(folder.join("secret"), "x")),
            ("write into the scene", fs::write(folder.join("scene/a.obj"), "x")),
            ("make a file", fs::write(folder.join("new"), "x")),
            ("remove a file", fs::remove_file(folder.join("old"))),
            ("move the picture away", fs::rename(folder.join("out/b.png"), folder.join("b.png"))),
            ("start a program", std::process::Command::new("/bin/true").status().map(drop)),
            ("connect", TcpStream::connect(("127.0.0.1", port)).map(drop)),
            ("listen", TcpListener::bind("127.0.0.1:0").map(drop)),
        ]
    }

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        ["scene", "out"].iter().for_each(|name| fs::create_dir(path.join(name)).unwrap());
        ["scene/a.obj", "secret", "old"].iter().for_each(|name| fs::write(path.join(name), "x").unwrap());
        std::os::unix::fs::symlink("../secret", path.join("scene/link")).unwrap();
        folder
    }

    /// Landlock applies per thread: only the test's own thread is restricted.
    #[test]
    fn the_kernel_refuses_what_a_sandbox_does_not_have() {
        if available() != Enforcement::FilesAndNetwork {
            return;
        }
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let free = folder();
        for (what, result) in attempts(free.path(), port) {
            assert!(result.is_ok(), "without a sandbox: {what}: {result:?}");
        }
        let folder = folder();
        let path = folder.path().to_owned();
        let results = std::thread::spawn(move || {
            let enforced = restrict(&[path.join("scene")], Some(&path.join("out"))).unwrap();
            assert_eq!(enforced, Enforcement::FilesAndNetwork);
            attempts(&path, port)
        });
        for (i, (what, result)) in results.join().unwrap().into_iter().enumerate() {
            match i {
                0..4 => assert!(result.is_ok(), "{what}: {result:?}"),
                _ => assert!(
                    result.as_ref().is_err_and(|error| {
                        [ErrorKind::PermissionDenied, ErrorKind::CrossesDevices].contains(&error.kind())
                    }),
                    "{what}: {result:?}"
                ),
            }
        }
    }
}
