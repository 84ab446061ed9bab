//! `cargo xtask gallery [--only WORD] [--scenes FOLDER]`: renders the pictures of the manual, in `docs/gallery`.
//!
//! [`table`] lists them. Those of models that are not ours need a folder with these models, by default `../shared/scenes`,
//! and are skipped, aloud, where it is missing. Some take minutes: `--only` renders those whose file names contain a word.
//! Screenshots of the viewer come from `cargo xtask viewer`, and strips of parameters from `cargo xtask strips`.

mod pages;
mod shell;
mod table;

use crate::process::{cargo, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use table::{HEAT_MAPS, PICTURES, Scene};

/// The folder of the pictures, relative to the root of the repository.
const FOLDER: &str = "docs/gallery";

/// Paths of the program and the scenes.
struct Studio {
    bilux: PathBuf,
    models: PathBuf,
    /// A folder for scenes that are made here.
    scenes: PathBuf,
}

/// Renders the pictures.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut only = "";
    let mut models = root().join("../shared/scenes");
    for pair in arguments.chunks(2) {
        match pair {
            [name, word] if name == "--only" => only = word,
            [name, folder] if name == "--scenes" => models = std::path::absolute(folder)?,
            _ => bail!("the options are `--only WORD` and `--scenes FOLDER`"),
        }
    }
    run_process(&mut cargo(&["build", "--quiet", "--locked", "--release", "-p", "bilux-cli"]))?;
    let scenes = target_folder().join("gallery");
    fs::create_dir_all(&scenes).with_context(|| format!("cannot make {}", scenes.display()))?;
    let studio = Studio { bilux: target_folder().join("release/bilux"), models, scenes };
    let is_wanted = |file: &str| file.contains(only);
    let mut files = PICTURES.iter().map(|row| row.file).chain(HEAT_MAPS.iter().map(|row| row.file));
    if !files.any(is_wanted) {
        bail!("no file name in {FOLDER} contains '{only}'");
    }
    for picture in PICTURES.iter().filter(|picture| is_wanted(picture.file)) {
        studio.render(picture).with_context(|| picture.file.to_owned())?;
    }
    for map in HEAT_MAPS.iter().filter(|map| is_wanted(map.file)) {
        let path = |file: &str| root().join(FOLDER).join(file);
        let mut compare = Command::new(&studio.bilux);
        compare.arg("compare").args([path(map.picture), path(map.reference)]).arg("--heat-map");
        run_process(compare.arg(path(map.file)))?;
    }
    Ok(())
}

impl Studio {
    /// Renders a picture, or says that its model is missing.
    fn render(&self, picture: &table::Picture) -> Result<()> {
        let Some(scene) = self.scene(picture.scene)? else {
            println!("SKIPPED: {}: its model is not in {}", picture.file, self.models.display());
            return Ok(());
        };
        let out = root().join(FOLDER).join(picture.file);
        fs::create_dir_all(out.parent().unwrap_or(&out))?;
        let mut render = Command::new(&self.bilux);
        render.current_dir(scene.parent().context("a scene lies in a folder")?);
        render.arg("render").arg(&scene).arg("-o").arg(&out).args(picture.options.split_whitespace());
        run_process(render.args(["--progress", "none", "--checkpoint", "off"]))
    }

    /// The path of a scene, which is made if need be; none for a model that is missing.
    fn scene(&self, scene: Scene) -> Result<Option<PathBuf>> {
        let path = match scene {
            Scene::BuiltIn(file) => {
                let path = self.scenes.join(file);
                let (name, _) =
                    file.split_once('.').context("a file of a built-in scene has an extension")?;
                let mut generate = Command::new(&self.bilux);
                run_process(generate.args(["generate", name, "--quiet", "-o"]).arg(&path))?;
                path
            }
            Scene::Repository(file) => root().join(file),
            Scene::Converted(from, to) => {
                let path = self.scenes.join(to);
                let mut convert = Command::new(&self.bilux);
                run_process(
                    convert.arg("convert").arg(root().join(from)).args(["--quiet", "-o"]).arg(&path),
                )?;
                path
            }
            Scene::Page(page, file) => pages::prepare(page, &self.scenes, &self.bilux)?.join(file),
            Scene::Model(name) => return Ok(model(&self.models.join(name))),
            Scene::Made(file) => {
                let path = self.scenes.join(file);
                fs::write(&path, shell::ply())?;
                path
            }
        };
        Ok(Some(path))
    }
}

/// The file of a model: itself, or the glTF file in the folder of a sample model.
fn model(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy();
    let inside = [format!("glTF/{name}.gltf"), format!("glTF-Binary/{name}.glb")];
    let mut paths = inside.into_iter().map(|file| path.join(file));
    if path.is_file() { Some(path.to_owned()) } else { paths.find(|path| path.is_file()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The pictures in a folder and those below it, by their paths from the gallery.
    fn pictures(folder: &Path, before: &str) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = format!("{before}{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                found.extend(pictures(&entry.path(), &format!("{name}/")));
            } else if name.ends_with(".png") || name.ends_with(".jpg") {
                found.insert(name);
            }
        }
        found
    }

    #[test]
    fn the_table_lists_every_picture_but_screenshots() {
        let there: BTreeSet<String> = pictures(&root().join(FOLDER), "")
            .into_iter()
            .filter(|name| !name.starts_with("viewer-"))
            .collect();
        let files = PICTURES.iter().map(|row| row.file).chain(HEAT_MAPS.iter().map(|row| row.file));
        assert_eq!(there, files.map(str::to_owned).collect());
    }

    #[test]
    fn scenes_of_the_repository_and_of_pages_exist() {
        for picture in PICTURES {
            match picture.scene {
                Scene::Repository(file) | Scene::Converted(file, _) => {
                    assert!(root().join(file).is_file(), "{file}")
                }
                Scene::Page(page, file) => {
                    let markdown = fs::read_to_string(root().join(page)).unwrap();
                    let is_there = pages::files(&markdown).iter().any(|(name, _)| *name == file)
                        || pages::commands(&markdown).iter().any(|command| command.ends_with(file));
                    assert!(is_there, "{page} says nothing of {file}");
                }
                _ => {}
            }
        }
    }
}
