//! The bytes of an archive, and parts of them.

use flate2::Crc;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

/// The bytes of an archive: a file, or memory.
#[derive(Clone)]
pub enum Data {
    File(Arc<Mutex<File>>, u64),
    Memory(Arc<[u8]>),
}

impl Data {
    /// The bytes of a file of this length.
    pub fn of_file(file: File, length: u64) -> Data {
        Data::File(Arc::new(Mutex::new(file)), length)
    }

    pub(super) fn length(&self) -> u64 {
        match self {
            Data::File(_, length) => *length,
            Data::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// The memory that it takes, in bytes.
    pub(super) fn bytes_held(&self) -> u64 {
        match self {
            Data::File(..) => 0,
            Data::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// Reads some bytes from this place on.
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Data::File(file, _) => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(at))?;
                file.read(into)
            }
            Data::Memory(bytes) => {
                let rest = usize::try_from(at).ok().and_then(|at| bytes.get(at..)).unwrap_or_default();
                let count = rest.len().min(into.len());
                into[..count].copy_from_slice(&rest[..count]);
                Ok(count)
            }
        }
    }
}

/// The bytes that are fetched from a file at once.
const FETCHED: usize = 1 << 16;

/// A part of the data, as a file of its own.
pub(super) struct Part {
    data: Data,
    start: u64,
    length: u64,
    /// Place in the part at which reading goes on.
    at: u64,
    /// Bytes that were fetched, and the place of the first of them in the part.
    fetched: Vec<u8>,
    first: u64,
}

impl Part {
    pub(super) fn new(data: Data, start: u64, length: u64) -> Part {
        let length = length.min(data.length().saturating_sub(start));
        Part { data, start, length, at: 0, fetched: Vec::new(), first: 0 }
    }

    pub(super) fn whole(data: Data) -> Part {
        let length = data.length();
        Part::new(data, 0, length)
    }

    /// Fetches the bytes from where the part is read.
    fn fetch(&mut self) -> io::Result<()> {
        let left = usize::try_from(self.length.saturating_sub(self.at)).unwrap_or(FETCHED);
        self.fetched.resize(FETCHED.min(left), 0);
        let count = self.data.read_at(self.start + self.at, &mut self.fetched)?;
        self.fetched.truncate(count);
        self.first = self.at;
        Ok(())
    }
}

impl Read for Part {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let is_fetched = (self.first..self.first + self.fetched.len() as u64).contains(&self.at);
        if !is_fetched {
            self.fetch()?;
        }
        let rest = &self.fetched[((self.at - self.first) as usize).min(self.fetched.len())..];
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Part {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(step) => self.length.checked_add_signed(step),
            SeekFrom::Current(step) => self.at.checked_add_signed(step),
        };
        self.at = target.ok_or_else(|| io::Error::other("it refers to bytes before its beginning"))?;
        Ok(self.at)
    }
}

/// A stream of a stated length, and perhaps with a stated checksum.
pub(super) struct Checked<R> {
    from: R,
    left: u64,
    expected: Option<u32>,
    sum: Crc,
}

impl<R: Read> Checked<R> {
    pub(super) fn new(from: R, length: u64, expected: Option<u32>) -> Checked<R> {
        Checked { from, left: length, expected, sum: Crc::new() }
    }
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if into.is_empty() {
            return Ok(0);
        }
        let damaged = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what.to_owned());
        let count = self.from.read(into)?;
        match self.left.checked_sub(count as u64) {
            None => return Err(damaged("it is longer than the archive states")),
            Some(_) if count == 0 && self.left > 0 => {
                return Err(damaged("it is shorter than the archive states: the archive was cut off"));
            }
            Some(left) => self.left = left,
        }
        self.sum.update(&into[..count]);
        if count == 0 && self.expected.is_some_and(|expected| expected != self.sum.sum()) {
            return Err(damaged("its checksum is wrong: the archive is damaged"));
        }
        Ok(count)
    }
}
