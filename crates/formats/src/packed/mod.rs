//! Archives with a model and its textures, as people upload them. See `docs/formats/archives.md`.

mod manifest;

use crate::FORMATS;
use crate::{SCENE_FORMATS, format_named};
use bilux_import::FormatError;
use bilux_import::bytes::archive::{Archive, Member, is_archive};
use bilux_import::bytes::gzip::plain_name;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::tables::files::read_file;
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, extension};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneBuilder, UpHint, Warning};
use std::cmp::Reverse;
use std::path::Path;

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "archive",
        summary: "zip and tar archives: a model and its textures, read in place",
        source: "",
        parameters: &[],
    },
    extensions: &["zip", "tar", "tgz", "zae"],
    capabilities: &["what the model in it contains"],
    sniff: is_archive,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Packed(read)),
    write: None,
};

/// The names of other formats in a message.
const LISTED: usize = 8;

/// A member that may be the scene, and how likely it is.
struct Candidate<'a> {
    row: &'static SceneFormatEntry,
    member: &'a Member,
    /// Less is likelier.
    rank: (usize, usize, Reverse<u64>, &'a str),
}

fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let root = source.folder.unwrap_or(Path::new(""));
    let at = whole_file(source.name);
    let stated = manifest::scene(reading, root, &at)?;
    let Some(archive) = reading.locator.archives.at(root) else {
        return Err(FormatError::malformed("this is no archive", at));
    };
    let found = candidates(archive);
    let named = |path: &Path| found.iter().find(|candidate| root.join(&candidate.member.name) == path);
    let chosen = stated.as_ref().and_then(|stated| named(stated.as_ref().ok()?));
    let Some(best) = chosen.or(found.first()) else { return Err(no_scene(archive, source)) };
    let (row, path, shown) = (best.row, root.join(&best.member.name), best.member.name.clone());
    let others = found.iter().filter(|other| other.member.name != shown && chosen.is_none());
    let others: Vec<String> = others.take(LISTED).map(|other| other.member.name.clone()).collect();
    reading.enter(&path, &at)?;
    let mut scene = read_file(FORMATS, Some(row), reading, &path, &path.display().to_string().into())?;
    reading.leave();
    let mut warn = |message: String| scene.warnings.push(Warning { message, at: at.clone() });
    if let Some(Err(lost)) = stated {
        warn(format!(
            "the manifest names the scene '{lost}', which is not in the archive: shown is '{shown}'"
        ));
    } else if let Some(other) = others.first() {
        warn(format!(
            "this archive has several scenes; shown is '{shown}', not {}: name another one as in '{}/{other}'",
            others.join(", "),
            source.name
        ));
    }
    Ok(scene)
}

/// The members whose extension is that of a scene, the likeliest first: by format, by depth, by size.
fn candidates(archive: &Archive) -> Vec<Candidate<'_>> {
    let mut found: Vec<Candidate> = archive.members().iter().filter_map(candidate).collect();
    found.sort_by(|a, b| a.rank.cmp(&b.rank));
    found
}

fn candidate(member: &Member) -> Option<Candidate<'_>> {
    let name = member.name.as_str();
    // What names the model of a `.zae` is none itself.
    let is_hidden = name.split('/').any(|part| part.starts_with('.') || part == "__MACOSX")
        || name.eq_ignore_ascii_case(manifest::NAME);
    let extension = extension(&plain_name(Path::new(name))).filter(|_| !is_hidden)?.to_lowercase();
    let row = format_named(&extension).filter(|row| row.reads() && row.extensions.contains(&&*extension))?;
    let format = SCENE_FORMATS.iter().position(|other| other.entry.name == row.entry.name)?;
    let depth = name.matches('/').count();
    Some(Candidate { row, member, rank: (format, depth, Reverse(member.size), name) })
}

fn no_scene(archive: &Archive, source: &Source) -> FormatError {
    // Any characters may be in a name.
    let quoted = archive.members().iter().take(LISTED).map(|member| format!("'{}'", member.name));
    let names: Vec<String> = quoted.collect();
    let message = match names.as_slice() {
        [] => "this archive is empty".to_owned(),
        names => format!("no file in this archive is a scene that can be read; it has {}", names.join(", ")),
    };
    FormatError::malformed(message, whole_file(source.name))
}
