//! The models: built-in ones converted to other formats, and public ones if they are available.

use bilux::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The built-in models: each generator, and the file that is made of it.
const OURS: &[(&str, &str)] = &[
    ("teapot", "teapot.obj"),
    ("scan", "scan.stl"),
    ("trio", "trio.glb"),
    ("cornell-spheres", "cornell-spheres.glb"),
    ("interior", "interior.glb"),
    ("caustics", "caustics.glb"),
];

/// Public models, in folders next to the repository, if they are available.
const SHARED: &[&str] = &[
    "gltf/WaterBottle/glTF/WaterBottle.gltf",
    "gltf/Suzanne/glTF/Suzanne.gltf",
    "gltf/SheenCloth/glTF/SheenCloth.gltf",
    "gltf/IridescenceSuzanne/glTF/IridescenceSuzanne.gltf",
    "gltf/TransmissionRoughnessTest/glTF/TransmissionRoughnessTest.gltf",
    "obj/spot.obj",
];

/// All of the models; the built-in ones are written to a folder.
pub(super) fn all(program: &Path, folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for (generator, file) in OURS {
        let (scene, file) = (folder.join(format!("{generator}.toml")), folder.join(file));
        let mut generate = Command::new(program);
        generate.args(["generate", generator, "--quiet", "-o"]).arg(&scene);
        finish(generate)?;
        let mut convert = Command::new(program);
        convert.args(["convert", "--quiet", "-o"]).arg(&file).arg(&scene);
        finish(convert)?;
        files.push(file);
    }
    let shared = Path::new("../shared/scenes");
    files.extend(SHARED.iter().map(|file| shared.join(file)).filter(|file| file.is_file()));
    Ok(files)
}

/// Runs a command, which must succeed.
pub(super) fn finish(mut command: Command) -> Result<(), Error> {
    let output = command.output();
    let failed = |why: &str| {
        let arguments: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy()).collect();
        Error::Settings(format!("bilux {}: {why}", arguments.join(" ")))
    };
    match output {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            Err(failed(said.trim().trim_start_matches("error: ")))
        }
        Err(why) => Err(failed(&why.to_string())),
    }
}
