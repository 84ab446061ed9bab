//! Archives as folders, while they are read.

use crate::FormatError;
use crate::bytes::archive::Data;
use crate::bytes::opening::open;
use crate::input::reading::Reading;
use std::path::Path;
use std::sync::Arc;

impl Reading<'_> {
    /// Opens the archive at a path, so that its members are files below it, until [`Reading::unmount`].
    pub fn mount(&mut self, path: &Path, name: &Arc<str>) -> Result<(), FormatError> {
        if self.locator.archives.contain(path) {
            // An archive in an archive.
            let bytes = self.load(path)?;
            let mounted = self.mount_bytes(path, &bytes, name);
            self.release(bytes);
            return mounted;
        }
        let (file, length) = open(path)?;
        self.files.extend(std::fs::canonicalize(path));
        self.mount_data(path, Data::of_file(file, length), name)
    }

    /// Opens an archive in memory, so that its members are files below `root`, until [`Reading::unmount`].
    pub fn mount_bytes(&mut self, root: &Path, bytes: &[u8], name: &Arc<str>) -> Result<(), FormatError> {
        self.budget.take_bytes(bytes.len() as u64, name)?;
        self.budget.release(bytes.len() as u64);
        self.mount_data(root, Data::Memory(Arc::from(bytes)), name)
    }

    fn mount_data(&mut self, root: &Path, data: Data, name: &Arc<str>) -> Result<(), FormatError> {
        let held = self.locator.archives.mount(root, data, name, self.budget.left())?;
        self.budget.take_bytes(held, name)
    }

    /// Closes an archive.
    pub fn unmount(&mut self, root: &Path) {
        let held = self.locator.archives.unmount(root);
        self.budget.release(held);
    }
}
