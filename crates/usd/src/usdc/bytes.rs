//! Numbers in bytes that may be cut off.

use bilux_import::FormatError;
use bilux_scene::Span;
use std::sync::Arc;

/// A place in the bytes of a crate file.
#[derive(Clone)]
pub(super) struct Bytes<'a> {
    pub(super) all: &'a [u8],
    pub(super) at: usize,
    pub(super) name: &'a Arc<str>,
}

/// An error about a crate file, whose parts have no lines.
pub(super) fn broken(name: &Arc<str>, what: &str) -> FormatError {
    let at = Span { file: name.clone(), line: 0, column: 0 };
    FormatError::malformed(format!("this is a broken crate file: {what}; export it again"), at)
}

impl<'a> Bytes<'a> {
    pub(super) fn error(&self, what: &str) -> FormatError {
        broken(self.name, what)
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: u64) -> Result<&'a [u8], FormatError> {
        let rest = self.all.get(self.at..).unwrap_or_default();
        let taken = usize::try_from(count).ok().and_then(|count| rest.get(..count));
        let taken = taken.ok_or_else(|| self.error("something goes on beyond its end"))?;
        self.at += taken.len();
        Ok(taken)
    }

    fn fixed<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        let taken = self.take(N as u64)?;
        Ok(std::array::from_fn(|i| taken[i]))
    }

    pub(super) fn u8(&mut self) -> Result<u8, FormatError> {
        Ok(self.fixed::<1>()?[0])
    }

    pub(super) fn u32(&mut self) -> Result<u32, FormatError> {
        self.fixed().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, FormatError> {
        self.fixed().map(u64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64, FormatError> {
        self.fixed().map(f64::from_le_bytes)
    }

    /// A count of things that take this many bytes each at least, all of which have to follow.
    pub(super) fn count(&mut self, each: u64) -> Result<usize, FormatError> {
        let count = self.u64()?;
        self.check_count(count, each)
    }

    /// Checks a count against the bytes that are left.
    pub(super) fn check_count(&self, count: u64, each: u64) -> Result<usize, FormatError> {
        let left = self.all.len().saturating_sub(self.at) as u64;
        if count.checked_mul(each).is_none_or(|bytes| bytes > left) {
            return Err(self.error("it states more items than it has bytes for"));
        }
        Ok(count as usize)
    }

    /// Goes to an offset from here.
    pub(super) fn skip(&mut self, offset: i64) -> Result<(), FormatError> {
        let to = i64::try_from(self.at).ok().and_then(|at| at.checked_add(offset));
        let to = to.and_then(|to| usize::try_from(to).ok()).filter(|to| *to <= self.all.len());
        self.at = to.ok_or_else(|| self.error("an offset leads out of it"))?;
        Ok(())
    }

    /// Another place in the same bytes.
    pub(super) fn moved(&self, at: u64) -> Result<Bytes<'a>, FormatError> {
        let at = usize::try_from(at).ok().filter(|at| *at <= self.all.len());
        Ok(Bytes { at: at.ok_or_else(|| self.error("an offset leads out of it"))?, ..self.clone() })
    }
}
