//! Files that other files include.

use crate::FormatError;
use crate::input::reading::Reading;
use bilux_scene::Span;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The cost of opening a file in addition to its bytes.
const MIN_FILE: u64 = 1 << 14;

/// Longer chains of includes are refused, since each level uses some of the stack.
const MAX_CHAIN: usize = 32;

/// The files that are open.
#[derive(Default)]
pub struct Includes {
    /// The chain of includes, from the first file to the current one.
    open: Vec<PathBuf>,
    /// The total bytes of included files, counted once per inclusion.
    included: u64,
}

/// A file that is included.
pub struct Included {
    /// Name of the file in messages.
    pub name: Arc<str>,
    pub bytes: Vec<u8>,
}

impl Includes {
    /// Of the first file, by its full path if it has one.
    pub fn of(first: Option<PathBuf>) -> Includes {
        Includes { open: vec![first.unwrap_or_default()], included: 0 }
    }

    /// Opens another file, until [`Includes::close`].
    pub fn open(
        &mut self,
        name: &str,
        at: &Span,
        folder: Option<&Path>,
        reading: &mut Reading,
    ) -> Result<Included, FormatError> {
        let path = reading.locator.locate_except(folder, name, &self.open, at)?;
        if self.open.contains(&path) {
            let message =
                format!("'{name}' includes itself, directly or through other files: remove it here");
            return Err(FormatError::malformed(message, at.clone()));
        }
        if self.open.len() >= MAX_CHAIN {
            let message = format!("files are included more than {MAX_CHAIN} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        let bytes = reading.load_text(&path)?;
        self.included = self.included.saturating_add(bytes.len() as u64 + MIN_FILE);
        if self.included > reading.options.max_memory {
            let message = "the includes multiply so much that reading would not end: remove some";
            return Err(FormatError::malformed(message, at.clone()));
        }
        let name = Path::new(&*at.file).with_file_name(name).display().to_string().into();
        self.open.push(path);
        Ok(Included { name, bytes })
    }

    /// Closes the file that was opened last.
    pub fn close(&mut self, file: Included, reading: &mut Reading) {
        self.open.pop();
        reading.release(file.bytes);
    }
}
