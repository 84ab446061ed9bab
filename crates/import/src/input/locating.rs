//! Finds the files that a scene refers to, for all formats: files from other machines have names that were right there.
//! Nothing outside the scene's folder is opened, or listed.

use crate::bytes::archive::Archives;
use crate::{FormatError, ReadOptions};
use bilux_scene::{SceneBuilder, Span, Warning};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Known names that differ from those on the disk in upper and lower case.
#[derive(Default)]
struct Names {
    /// The names in a folder, by their lower-case form; of several the first.
    listings: RefCell<HashMap<PathBuf, BTreeMap<String, OsString>>>,
    /// Names in the scene, what is said of the files that were found for them, and where the scene refers to them.
    renamed: RefCell<BTreeMap<String, (String, Span)>>,
}

/// The number of names in a folder that are compared: a listing takes memory.
const MAX_LISTED: usize = 100_000;

impl Names {
    fn into_notes(self, scene: &mut SceneBuilder) {
        for (name, (what, at)) in self.renamed.into_inner() {
            scene.notes.push(Warning { message: format!("'{name}' is {what}"), at });
        }
    }

    /// Notes what a file is called that was found under another name.
    fn note(&self, name: &str, at: &Span, what: impl FnOnce() -> String) {
        let mut renamed = self.renamed.borrow_mut();
        renamed.entry(name.to_owned()).or_insert_with(|| (what(), at.clone()));
    }

    /// Spelling of a name in a folder, if only upper and lower case differ.
    fn called(&self, folder: &Path, name: &str) -> Option<OsString> {
        let mut listings = self.listings.borrow_mut();
        let listing = listings.entry(folder.to_owned()).or_insert_with(|| {
            let mut names: Vec<OsString> = fs::read_dir(folder)
                .map(|entries| entries.take(MAX_LISTED).flatten().map(|entry| entry.file_name()).collect())
                .unwrap_or_default();
            // The order of the disk is not the same everywhere; the first of these remains.
            names.sort_unstable_by(|a, b| b.cmp(a));
            names.into_iter().map(|name| (name.to_string_lossy().to_lowercase(), name)).collect()
        });
        listing.get(&name.to_lowercase()).cloned()
    }
}

/// Folders and archives where files may be.
pub struct Locator {
    /// Nothing outside this folder is opened, except files in [`Locator::working_folder`]: the scene's own, or that of its package.
    root: Option<PathBuf>,
    allow_outside: bool,
    /// A second folder where the current format looks for files.
    pub working_folder: Option<PathBuf>,
    /// The archives that are open, whose members are found as files are, and nothing else from inside of them.
    pub archives: Archives,
    /// Files that were found under other names.
    names: Names,
}

impl Locator {
    /// For what files in a folder refer to.
    pub fn new(folder: Option<&Path>, options: &ReadOptions) -> Locator {
        let own = folder.and_then(|folder| fs::canonicalize(non_empty(folder)).ok());
        let root = own.map(|own| if options.whole_package { package_of(&own) } else { own });
        Locator {
            root,
            allow_outside: options.allow_outside,
            working_folder: None,
            archives: Archives::default(),
            names: Names::default(),
        }
    }

    /// Adds a note to the scene for each file that was found under a name in other letters.
    pub fn into_notes(self, scene: &mut SceneBuilder) {
        self.names.into_notes(scene);
    }

    /// Finds a referenced file, if it exists and may be opened.
    pub fn locate(&self, folder: Option<&Path>, name: &str, at: &Span) -> Result<PathBuf, FormatError> {
        self.locate_except(folder, name, &[], at)
    }

    /// The file with the first of several spellings of its name that exists.
    pub fn locate_any(
        &self,
        folder: Option<&Path>,
        names: &[String],
        at: &Span,
    ) -> Result<PathBuf, FormatError> {
        let mut first = None;
        for name in names {
            match self.locate(folder, name, at) {
                Ok(path) => return Ok(path),
                Err(error) => _ = first.get_or_insert(error),
            }
        }
        Err(first.unwrap_or_else(|| FormatError::malformed("a file name is missing here", at.clone())))
    }

    /// Finds a file as [`Locator::locate`] does, but the files in `open`, which are being read, only under their full names.
    pub fn locate_except(
        &self,
        folder: Option<&Path>,
        name: &str,
        open: &[PathBuf],
        at: &Span,
    ) -> Result<PathBuf, FormatError> {
        let Some(folder) = folder.map(non_empty) else {
            let message = format!("'{name}' cannot be found: the scene was not read from a folder");
            return Err(FormatError::malformed(message, at.clone()));
        };
        let missing =
            || FormatError::MissingFile { name: name.to_owned(), folder: folder.to_owned(), at: at.clone() };
        // Files from other machines refer to folders there; the file itself often lies next to the scene.
        let portable = without_file_scheme(name).replace('\\', "/");
        if self.archives.contain(folder) {
            let (found, is_renamed) = self.archives.locate(folder, &portable, at)?.ok_or_else(missing)?;
            if open.contains(&found) {
                return Err(missing());
            }
            if is_renamed {
                self.names.note(name, at, || format!("'{}' in the archive", found.display()));
            }
            return Ok(found);
        }
        let beside = portable.rsplit('/').next().unwrap_or_default();
        if beside.is_empty() || name.contains('\0') {
            return Err(missing());
        }
        let there = |path: PathBuf| fs::canonicalize(path).ok();
        let named = [folder.join(name), folder.join(&portable)].into_iter().find_map(there);
        if named.is_none()
            && let Some(found) = self.in_working_folder(&portable)
        {
            return Ok(found);
        }
        let is_closed = |path: &PathBuf| !open.contains(path);
        let found = named
            .or_else(|| there(folder.join(beside)).filter(is_closed))
            .or_else(|| {
                let in_any_case = |name: &str| self.in_any_case(folder, name).filter(is_closed);
                let found = in_any_case(&portable).or_else(|| in_any_case(beside))?;
                self.names.note(name, at, || {
                    let found = found.file_name().unwrap_or_default().to_string_lossy();
                    format!("called '{found}' on this disk, where upper and lower case matter")
                });
                Some(found)
            })
            // This excludes pipes, which might never end.
            .filter(|path| path.is_file())
            .or_else(|| {
                let (found, shown) = self.elsewhere_in_package(folder, &portable, is_closed)?;
                self.names.note(name, at, || format!("'{shown}' here"));
                Some(found)
            })
            .ok_or_else(missing)?;
        match &self.root {
            Some(root) if found.starts_with(root) || self.allow_outside => Ok(found),
            None if self.allow_outside => Ok(found),
            _ => Err(FormatError::Outside { name: name.to_owned(), at: at.clone() }),
        }
    }

    /// The file whose name differs in upper and lower case only; `None` if there is none in the folders that may be
    /// opened.
    fn in_any_case(&self, folder: &Path, name: &str) -> Option<PathBuf> {
        let mut path = fs::canonicalize(folder).ok()?;
        for component in Path::new(name).components() {
            let part = match component {
                Component::CurDir => continue,
                Component::ParentDir => {
                    path.pop();
                    continue;
                }
                Component::Normal(part) => part,
                Component::RootDir | Component::Prefix(_) => return None,
            };
            let is_allowed = self.root.as_ref().is_some_and(|root| path.starts_with(root));
            if !is_allowed && !self.allow_outside {
                return None;
            }
            let exact = path.join(part);
            let next =
                if exact.exists() { exact } else { path.join(self.names.called(&path, part.to_str()?)?) };
            // A link may lead elsewhere.
            path = fs::canonicalize(next).ok()?;
        }
        path.is_file().then_some(path)
    }

    /// A file of the package for a name from another machine: by the longest end of that name, or else by the last part of it in
    /// the folders of textures beside the model's. Also returns the name that it has in the package.
    fn elsewhere_in_package(
        &self,
        folder: &Path,
        name: &str,
        is_closed: impl Fn(&PathBuf) -> bool,
    ) -> Option<(PathBuf, String)> {
        let root = self.root.as_deref()?;
        let own = fs::canonicalize(folder).ok()?;
        let parts: Vec<&str> = name.split('/').filter(|part| !matches!(*part, "" | "." | "..")).collect();
        let bare = parts.last()?;
        let ends = (parts.len().saturating_sub(MAX_PARTS)..parts.len()).map(|first| parts[first..].join("/"));
        let mut tried: Vec<PathBuf> = ends.map(|end| root.join(end)).collect();
        let around = own.parent().filter(|around| around.starts_with(root) || self.allow_outside);
        for folder in [Some(&*own), around].into_iter().flatten() {
            tried.extend(TEXTURES.iter().map(|textures| folder.join(textures).join(bare)));
        }
        let found = tried.into_iter().filter_map(|path| fs::canonicalize(path).ok());
        let found = found.filter(|path| path.is_file()).find(is_closed)?;
        let shown = found.strip_prefix(root).unwrap_or(&found).display().to_string();
        Some((found, shown))
    }

    /// A file with this name in or below the working folder.
    fn in_working_folder(&self, name: &str) -> Option<PathBuf> {
        let folder = fs::canonicalize(non_empty(self.working_folder.as_deref()?)).ok()?;
        let found = fs::canonicalize(folder.join(name)).ok()?;
        (found.starts_with(&folder) && found.is_file()).then_some(found)
    }
}

/// The most parts of a name that are looked for.
const MAX_PARTS: usize = 16;

/// Folders of textures, in packs of models beside those of each format.
const TEXTURES: [&str; 4] = ["textures", "texture", "Textures", "Texture"];

/// Files and folders at the top of a package: of ROS, of Gazebo, of Git.
const MARKS: [&str; 3] = ["package.xml", "model.config", ".git"];

/// The most folders between a model and the top of its package.
const MAX_DEPTH: usize = 8;

/// The package that a model's folder belongs to: the nearest folder with a mark, or that of a pack, in which a folder of textures
/// lies beside the model's; otherwise the model's own folder.
fn package_of(own: &Path) -> PathBuf {
    // Never the whole disk.
    let mut around = own.ancestors().take(MAX_DEPTH).filter(|folder| folder.parent().is_some());
    let marked = around.find(|folder| MARKS.iter().any(|mark| folder.join(mark).exists()));
    let of_pack = || {
        let parent = own.parent().filter(|parent| parent.parent().is_some())?;
        TEXTURES.iter().any(|textures| parent.join(textures).is_dir()).then_some(parent)
    };
    marked.or_else(of_pack).unwrap_or(own).to_owned()
}

fn non_empty(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// The path of a `file:` URI, without its host; other names stay as they are. [Kerwin 2017]
pub fn without_file_scheme(name: &str) -> &str {
    let Some(path) = name.get(..5).filter(|start| start.eq_ignore_ascii_case("file:")).map(|_| &name[5..])
    else {
        return name;
    };
    let Some(with_host) = path.strip_prefix("//") else { return path };
    let path = with_host.find('/').map_or(with_host, |slash| &with_host[slash..]);
    // `/C:/tex.png` is a Windows path.
    match path.as_bytes() {
        [b'/', letter, b':', ..] if letter.is_ascii_alphabetic() => &path[1..],
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forms of [Kerwin 2017], section 2 and appendices B and E, and what faulty exporters write.
    #[test]
    fn file_uris_name_paths() {
        for (uri, path) in [
            ("file:tex.png", "tex.png"),
            ("file:/srv/a/tex.png", "/srv/a/tex.png"),
            ("file:///srv/a/tex.png", "/srv/a/tex.png"),
            ("FILE://localhost/srv/a/tex.png", "/srv/a/tex.png"),
            ("file:///C:/a/tex.png", "C:/a/tex.png"),
            ("file://tex.png", "tex.png"),
            ("file.png", "file.png"),
        ] {
            assert_eq!(without_file_scheme(uri), path, "{uri}");
        }
    }
}
