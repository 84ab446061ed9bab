//! Trees as files: written once, then read or mapped.
//!
//! A file is a header of 64 bytes followed by the units as they lie in memory, all little-endian. The header holds
//! `BILUXBV8`, the version, the root, the number of units (u64), the corners of the bounding box of everything (6
//! f32), zeros, and a checksum of everything but itself (u64). Nothing in a file is trusted before all of it has been
//! checked.

use super::Bvh8;
use super::build::binary::MAX_DEPTH;
use super::kernel::{HEADER, Units};
use super::layout::{
    self, BLOCK_UNITS, LANES, MAX_BLOCKS, MAX_UNITS, NO_TRIANGLE, NODE_UNITS, Ref, Unit, WIDTH,
};
use super::summary::TreeSummary;
use crate::CpuLevel;
use bilux_math::hash::mix64;
use std::io::{self, Read, Write};

const MAGIC: &[u8; 8] = b"BILUXBV8";
const VERSION: u32 = 2;
const UNIT: usize = size_of::<Unit>();

/// Why a file is not a valid tree.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StorageError {
    /// Failure to read the file.
    #[error("cannot read the tree: {0}")]
    Io(#[from] io::Error),
    /// File that does not begin with the magic bytes.
    #[error("this is not a bvh8 tree: it does not begin with BILUXBV8")]
    NotATree,
    /// File of another version.
    #[error("the tree has version {0}, but this library reads version {VERSION}: rebuild it")]
    Version(u32),
    /// File that is too short or too long.
    #[error("the tree has {found} bytes, but its header says {expected}")]
    Length {
        /// The length that the header states.
        expected: u64,
        /// The actual length.
        found: u64,
    },
    /// File whose bytes are not those that were written.
    #[error("the tree is damaged: {0}")]
    Damaged(&'static str),
}

/// The header in front of the units.
pub(super) struct Header {
    root: Ref,
    units: usize,
    corners: [[f32; 3]; 2],
    checksum: u64,
    /// All but the checksum, as read.
    front: [u8; HEADER - 8],
}

impl Bvh8 {
    /// Writes the tree, with its triangles; [`Bvh8::load`] and [`Bvh8::map`] read it.
    ///
    /// # Errors
    /// Returns the errors of the writer.
    pub fn save(&self, mut to: impl Write) -> io::Result<()> {
        let mut header = Vec::with_capacity(HEADER);
        header.extend(MAGIC);
        header.extend(VERSION.to_le_bytes());
        header.extend(self.outline.root.0.to_le_bytes());
        header.extend((self.units.len() as u64).to_le_bytes());
        for corner in self.outline.corners {
            header.extend(corner[..3].iter().flat_map(|x| x.to_le_bytes()));
        }
        header.resize(HEADER - 8, 0);
        header.extend(checksum(&header, &self.units).to_le_bytes());
        to.write_all(&header)?;
        for chunk in self.units.chunks(1 << 12) {
            let bytes: Vec<u8> = chunk.iter().flat_map(|unit| unit.0).flat_map(u32::to_le_bytes).collect();
            to.write_all(&bytes)?;
        }
        to.flush()
    }

    /// Reads a saved tree, for use with this machine's instructions.
    ///
    /// # Errors
    /// Returns an error when it cannot be read, or is not what [`Bvh8::save`] wrote.
    pub fn load(mut from: impl Read) -> Result<Bvh8, StorageError> {
        let mut header = [0; HEADER];
        if fill(&mut from, &mut header)? < HEADER {
            return Err(StorageError::NotATree);
        }
        let header = Header::read(&header)?;
        let expected = header.bytes();
        let mut units = Vec::new();
        let mut bytes = vec![0; UNIT << 12];
        while units.len() < header.units {
            // Memory grows with what was read, not with what the header promises.
            let chunk = (header.units - units.len()).min(1 << 12);
            let bytes = &mut bytes[..chunk * UNIT];
            let read = fill(&mut from, bytes)?;
            if read < bytes.len() {
                let found = (HEADER + units.len() * UNIT + read) as u64;
                return Err(StorageError::Length { expected, found });
            }
            let mut words = bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            units.extend((0..chunk).map(|_| Unit(std::array::from_fn(|_| words.next().unwrap_or(0)))));
        }
        if from.read(&mut [0])? > 0 {
            return Err(StorageError::Length { expected, found: expected + 1 });
        }
        Bvh8::trust(&header, Units::from(units))
    }

    /// Makes a tree of what was read, once all of it has been validated.
    pub(super) fn trust(header: &Header, units: Units) -> Result<Bvh8, StorageError> {
        if checksum(&header.front, &units) != header.checksum {
            return Err(StorageError::Damaged("its checksum does not match"));
        }
        check(&units, header.root)?;
        let level = CpuLevel::default().available();
        Ok(Bvh8 { units, outline: TreeSummary::new(header.root, header.corners), level })
    }
}

impl Header {
    pub(super) fn read(bytes: &[u8; HEADER]) -> Result<Header, StorageError> {
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let long = |at: usize| u64::from(word(at)) | u64::from(word(at + 4)) << 32;
        if &bytes[..8] != MAGIC {
            return Err(StorageError::NotATree);
        }
        if word(8) != VERSION {
            return Err(StorageError::Version(word(8)));
        }
        let units = long(16);
        if units > MAX_UNITS as u64 {
            return Err(StorageError::Damaged("it has more units than an index can address"));
        }
        let corner = |at: usize| [0, 4, 8].map(|k| f32::from_bits(word(at + k)));
        let corners = [corner(24), corner(36)];
        let front = std::array::from_fn(|i| bytes[i]);
        Ok(Header { root: Ref(word(12)), units: units as usize, corners, checksum: long(HEADER - 8), front })
    }

    /// Size of the whole file in bytes.
    pub(super) fn bytes(&self) -> u64 {
        (HEADER + self.units * UNIT) as u64
    }
}

/// Reads until the buffer is full or nothing is left; returns the number of bytes read.
fn fill(from: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut found = 0;
    while found < buffer.len() {
        match from.read(&mut buffer[found..]) {
            Ok(0) => break,
            Ok(n) => found += n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(found)
}

/// The checksum of the bytes before it and of the units: four parallel sums of mixed words.
pub(super) fn checksum(front: &[u8], units: &[Unit]) -> u64 {
    let mut sums = [0u64; 4];
    for unit in units {
        for (k, sum) in sums.iter_mut().enumerate() {
            let word = u64::from(unit.0[2 * k]) | u64::from(unit.0[2 * k + 1]) << 32;
            *sum = (sum.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
    }
    let front = front.iter().fold(0, |all, &byte| mix64(all ^ u64::from(byte)));
    sums.iter().fold(front, |all, &sum| mix64(all ^ sum))
}

/// Follows every reference once: nothing may be reached twice or lie outside the file, no path may be longer than the
/// stacks of the kernels allow, and leaves must hold finite triangles.
fn check(units: &[Unit], root: Ref) -> Result<(), StorageError> {
    let mut reached = vec![false; units.len()];
    let mut stack = if units.is_empty() { Vec::new() } else { vec![(root, 1)] };
    while let Some((reference, depth)) = stack.pop() {
        let blocks = if reference.is_node() { 0 } else { reference.blocks() };
        let size = if reference.is_node() { NODE_UNITS } else { blocks * BLOCK_UNITS };
        let range = reference.unit()..reference.unit() + size;
        let Some(own) = reached.get_mut(range.clone()) else {
            return Err(StorageError::Damaged("a reference points outside it"));
        };
        if own.contains(&true) {
            return Err(StorageError::Damaged("two references point to the same node"));
        }
        own.fill(true);
        if depth > MAX_DEPTH || blocks > MAX_BLOCKS {
            return Err(StorageError::Damaged(
                "it is deeper, or has larger leaves, than any tree that Bilux builds",
            ));
        }
        if reference.is_node() {
            let node = &units[range];
            let children =
                (0..WIDTH).map(|child| Ref(node[NODE_UNITS - 1].0[child])).filter(|r| *r != Ref::EMPTY);
            stack.extend(children.map(|child| (child, depth + 1)));
        } else {
            let mut last = None;
            for block in units[range].chunks_exact(BLOCK_UNITS) {
                for (corners, primitive) in (0..LANES).map(|lane| layout::triangle(block, lane)) {
                    if corners.iter().flatten().any(|x| !x.is_finite())
                        || primitive > NO_TRIANGLE >> 1 && primitive != NO_TRIANGLE
                    {
                        return Err(StorageError::Damaged("a leaf holds an index that is not a triangle"));
                    }
                    if last.is_some_and(|last| primitive <= last && last != NO_TRIANGLE) {
                        return Err(StorageError::Damaged("the triangles of a leaf are not in order"));
                    }
                    last = Some(primitive);
                }
            }
        }
    }
    Ok(())
}
