//! Zip and tar files, whose members are read in place: nothing is unpacked to the disk.

mod data;
mod index;
mod member;
mod tar;
mod zip;

use crate::FormatError;
use crate::bytes::text::whole_file;
use bilux_pictures::guarded_decoding;
use bilux_scene::Span;
use flate2::read::DeflateDecoder;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use data::Data;
use data::{Checked, Part};
use index::Index;
pub use member::Member;
use member::Packing;

/// True if the bytes begin as archives do.
pub fn is_archive(bytes: &[u8]) -> bool {
    bytes.starts_with(zip::SIGNATURE) || tar::is_tar(bytes)
}

/// An archive: a file whose members are files below it.
pub struct Archive {
    data: Data,
    index: Index,
}

/// A member that is being read, and its size in bytes.
pub type OpenMember = (Box<dyn Read + Send>, u64);

impl Archive {
    /// The archive in these bytes, of at most `limit` bytes where it has to be unpacked as a whole.
    ///
    /// # Errors
    /// If it is damaged, or if a name leads out of it.
    fn new(data: Data, name: &Arc<str>, limit: u64) -> Result<Archive, FormatError> {
        let read = guarded_decoding(|| -> io::Result<(Data, Vec<Member>)> {
            if zip::is_zip(&data)? {
                let members = zip::members(&data)?;
                Ok((data, members))
            } else {
                tar::unpacked(data, limit)
            }
        });
        let failed = |why: String| {
            let message = format!("this archive cannot be read: {why}; pack it again");
            FormatError::malformed(message, whole_file(name))
        };
        let (data, members) = read
            .unwrap_or_else(|| Err(io::Error::other("its parts contradict each other")))
            .map_err(|error| failed(error.to_string()))?;
        let index =
            Index::new(members).map_err(|message| FormatError::malformed(message, whole_file(name)))?;
        Ok(Archive { data, index })
    }

    fn bytes_held(&self) -> u64 {
        self.data.bytes_held() + self.index.bytes_held()
    }

    /// Members in the order of the archive.
    pub fn members(&self) -> &[Member] {
        self.index.members()
    }

    fn open(&self, member: &Member) -> io::Result<OpenMember> {
        let part = Part::new(self.data.clone(), member.start, member.stored);
        let unpacked: Box<dyn Read + Send> = match &member.packing {
            Packing::Stored => Box::new(part),
            Packing::Deflated => Box::new(DeflateDecoder::new(part)),
            Packing::Unknown(what) => {
                return Err(io::Error::other(format!("this member of the archive is {what}; pack it again")));
            }
        };
        Ok((Box::new(Checked::new(unpacked, member.size, member.checksum)), member.size))
    }
}

/// The archives that are open now, by their paths.
#[derive(Default)]
pub struct Archives(BTreeMap<PathBuf, Archive>);

impl Archives {
    /// Opens an archive as the folder `root`. Returns how much memory it takes.
    ///
    /// # Errors
    /// If it is damaged, or if a name leads out of it.
    pub fn mount(
        &mut self,
        root: &Path,
        data: Data,
        name: &Arc<str>,
        limit: u64,
    ) -> Result<u64, FormatError> {
        let archive = Archive::new(data, name, limit)?;
        let bytes = archive.bytes_held();
        self.0.insert(root.to_owned(), archive);
        Ok(bytes)
    }

    /// Closes it again. Returns how much memory it took.
    pub fn unmount(&mut self, root: &Path) -> u64 {
        self.0.remove(root).map_or(0, |archive| archive.bytes_held())
    }

    /// The archive that is this folder.
    pub fn at(&self, root: &Path) -> Option<&Archive> {
        self.0.get(root)
    }

    /// The archive that contains this path, and the way from there.
    fn around<'p>(&self, path: &'p Path) -> Option<(&Path, &Archive, &'p Path)> {
        path.ancestors().find_map(|root| {
            let (root, archive) = self.0.get_key_value(root)?;
            Some((root.as_path(), archive, path.strip_prefix(root).ok()?))
        })
    }

    /// True for the path of an archive, and for paths in it.
    pub fn contain(&self, path: &Path) -> bool {
        self.around(path).is_some()
    }

    /// The path of the member with this name, seen from a folder in an archive; the flag says if its name differs from
    /// what was asked for. `None` if there is none.
    ///
    /// # Errors
    /// If the name leads out of the archive.
    pub fn locate(
        &self,
        folder: &Path,
        name: &str,
        at: &Span,
    ) -> Result<Option<(PathBuf, bool)>, FormatError> {
        let Some((root, archive, inner)) = self.around(folder) else { return Ok(None) };
        let inner = inner.to_string_lossy().replace('\\', "/");
        let found = archive
            .index
            .find(&inner, name)
            .map_err(|_| FormatError::Outside { name: name.to_owned(), at: at.clone() })?;
        Ok(found.map(|(member, is_renamed)| (root.join(&member.name), is_renamed)))
    }

    /// Opens the member at this path, if the path lies in an archive. Also returns the path of the archive.
    pub fn open(&self, path: &Path) -> Option<(&Path, io::Result<OpenMember>)> {
        let (root, archive, inner) = self.around(path)?;
        let opened = match archive.index.exact(&inner.to_string_lossy().replace('\\', "/")) {
            Some(member) => archive.open(member),
            None => Err(io::Error::new(io::ErrorKind::NotFound, "no file in the archive has this name")),
        };
        Some((root, opened))
    }
}
