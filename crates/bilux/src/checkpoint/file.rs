//! The file of a checkpoint.

use super::identity::Identity;
use crate::encoding::ContentHash;
use crate::error::CheckpointError;
use bilux_pictures::formats::Unfinished;
use bilux_transport::{Checkpoint, FilmError};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// First bytes of a checkpoint, with the version of its form.
const MAGIC: &[u8; 20] = b"bilux checkpoint 2\n\0";
/// No head is longer.
const MAX_HEAD: u32 = 1 << 16;
/// The length of a hash in bytes.
const HASH: usize = 32;

/// The name of the checkpoint of a picture: its own, and `.checkpoint`.
pub fn checkpoint_path(picture: &Path) -> PathBuf {
    let mut name = picture.file_name().unwrap_or_default().to_owned();
    name.push(".checkpoint");
    picture.with_file_name(name)
}

/// Head of a checkpoint: whose it is, and how far it got.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Of which picture it is.
    pub identity: Identity,
    /// Samples per pixel, on average.
    pub samples: f64,
    /// The time that was spent on the picture, with reading and building.
    pub spent: Duration,
}

impl Head {
    /// Reads only the head of a checkpoint; the rest may still be damaged.
    ///
    /// # Errors
    /// When the file cannot be read or is no checkpoint.
    pub fn read(path: &Path) -> Result<Head, CheckpointError> {
        let fail = |action, source| CheckpointError::Io { path: path.to_owned(), action, source };
        let mut file = File::open(path).map_err(|source| fail("open it", source))?;
        let mut start = Vec::new();
        let most = MAGIC.len() as u64 + 4 + u64::from(MAX_HEAD) + HASH as u64;
        Read::by_ref(&mut file)
            .take(most)
            .read_to_end(&mut start)
            .map_err(|source| fail("read it", source))?;
        Ok(parse_head(path, &start)?.0)
    }

    fn to_text(&self) -> String {
        let Head { identity, samples, spent } = self;
        format!("samples={samples}\nspent={}\n{}", spent.as_secs_f64(), identity.to_text())
    }

    fn from_text(text: &str) -> Option<Head> {
        let mut identity = Identity::from_text(text);
        let number = |name: &str| {
            let (_, value) = identity.0.iter().find(|(other, _)| other == name)?;
            value.parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0)
        };
        let (samples, spent) = (number("samples")?, number("spent")?);
        identity.0.retain(|(name, _)| name != "samples" && name != "spent");
        Some(Head { identity, samples, spent: Duration::try_from_secs_f64(spent).ok()? })
    }
}

/// A render that was saved, and can go on.
pub struct SavedRender {
    /// Head of the file.
    pub head: Head,
    pub(crate) checkpoint: Checkpoint,
    pub(crate) path: PathBuf,
}

impl SavedRender {
    /// Reads a checkpoint of at most so many bytes.
    ///
    /// # Errors
    /// When the file cannot be read, is no checkpoint of this version, or is damaged.
    pub fn read(path: &Path, most: u64) -> Result<SavedRender, CheckpointError> {
        let fail = |action, source| CheckpointError::Io { path: path.to_owned(), action, source };
        let mut file = File::open(path).map_err(|source| fail("open it", source))?;
        let size = file.metadata().map_err(|source| fail("read it", source))?.len();
        if size > most {
            return Err(CheckpointError::TooLarge { path: path.to_owned(), size, most });
        }
        let mut bytes = Vec::new();
        let limited = Read::by_ref(&mut file).take(size.saturating_add(1)).read_to_end(&mut bytes);
        limited.map_err(|source| fail("read it", source))?;
        let (head, start) = parse_head(path, &bytes)?;
        let (content, hash) = bytes.split_at(bytes.len().saturating_sub(HASH));
        if content.len() < start || ContentHash::of(content).0 != *hash {
            return Err(damaged(path, "this checkpoint is damaged or not complete: its checksum is wrong"));
        }
        let read = Checkpoint::from_bytes(&content[start..]);
        let checkpoint = read.map_err(|error| match error {
            FilmError::NotAFilm { what } => damaged(path, &format!("this checkpoint cannot be used: {what}")),
            other => damaged(path, &other.to_string()),
        })?;
        Ok(SavedRender { head, checkpoint, path: path.to_owned() })
    }
}

/// Path of a checkpoint until it is complete. It is always the same, so that a process that is killed while it writes leaves at
/// most one such file.
pub(super) fn part_path(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    path.with_file_name(name)
}

/// Writes a checkpoint beside its place, and then puts it there.
pub(super) fn write(
    path: &Path,
    head: &Head,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), CheckpointError> {
    let text = head.to_text();
    let fill = || {
        let mut how = OpenOptions::new();
        let (unfinished, file) =
            Unfinished::create(&part_path(path), how.write(true).create(true).truncate(true))?;
        let mut out = Hashed { file: io::BufWriter::new(file), hash: blake3::Hasher::new() };
        out.write_all(MAGIC)?;
        out.write_all(&(text.len() as u32).to_le_bytes())?;
        out.write_all(text.as_bytes())?;
        out.write_all(&ContentHash::of(text.as_bytes()).0)?;
        content(&mut out)?;
        let hash = out.hash.finalize();
        out.file.write_all(hash.as_bytes())?;
        let file = out.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()?;
        unfinished.complete(path)
    };
    fill().map_err(|source| CheckpointError::Io {
        path: path.to_owned(),
        action: "write the checkpoint",
        source,
    })
}

/// Writes to a file, and hashes what it writes.
struct Hashed {
    file: io::BufWriter<File>,
    hash: blake3::Hasher,
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.hash.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The head, and where what follows begins.
fn parse_head(path: &Path, bytes: &[u8]) -> Result<(Head, usize), CheckpointError> {
    let not_one = || damaged(path, "this is not a checkpoint of this version of Bilux");
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(not_one)?;
    let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(not_one)?;
    let length = u32::from_le_bytes(*length);
    let broken = || damaged(path, "this checkpoint is damaged or not complete");
    let text = rest.get(..length.min(MAX_HEAD) as usize).ok_or_else(broken)?;
    let hash = rest.get(text.len()..text.len() + HASH).ok_or_else(broken)?;
    let head = std::str::from_utf8(text).ok().filter(|_| ContentHash::of(text).0 == *hash);
    let head = head.and_then(Head::from_text).ok_or_else(broken)?;
    Ok((head, MAGIC.len() + 4 + text.len() + HASH))
}

fn damaged(path: &Path, what: &str) -> CheckpointError {
    CheckpointError::Damaged { path: path.to_owned(), what: what.to_owned() }
}
