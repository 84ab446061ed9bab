//! The table of contents, and the sections that all values refer to.

use super::bytes::{Bytes, broken};
use super::integers::{integers, unpack};
use super::paths::Paths;
use crate::layers::value::Text;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::borrow::Cow;
use std::sync::Arc;

/// A crate file in memory, whose values are read where they are used.
pub(super) struct Crate<'b> {
    pub(super) bytes: Cow<'b, [u8]>,
    pub(super) name: Arc<str>,
    /// Minor version: 4 and later can be read.
    pub(super) version: u8,
    pub(super) tokens: Vec<Text>,
    /// Indices of tokens.
    pub(super) strings: Vec<u32>,
    pub(super) paths: Paths,
}

/// Contents of specs: fields by their numbers, in lists that end.
pub(super) struct Specs {
    /// Token and value.
    pub(super) fields: Vec<(u32, u64)>,
    /// Fields of a spec follow each other up to [`END`].
    pub(super) sets: Vec<u32>,
    /// Path, first field and type.
    pub(super) specs: Vec<[u32; 3]>,
}

/// The end of a list of fields.
pub(super) const END: u32 = u32::MAX;

/// The first bytes of every crate file.
pub(crate) const MAGIC: &[u8] = b"PXR-USDC";

/// Older ones were never in a release that people used.
const OLDEST: u8 = 4;
/// The newest whose parts are known.
const NEWEST: u8 = 14;

pub(super) fn open<'b>(
    all: Cow<'b, [u8]>,
    name: &Arc<str>,
    budget: &mut Budget,
) -> Result<(Crate<'b>, Specs), FormatError> {
    let head = Bytes { all: &all, at: 0, name };
    let mut version = head.moved(8)?;
    let [major, minor, patch] = [version.u8()?, version.u8()?, version.u8()?];
    if major != 0 || !(OLDEST..=NEWEST).contains(&minor) {
        let what = format!(
            "this crate file has version {major}.{minor}.{patch}, but only 0.{OLDEST} to 0.{NEWEST} can be read: save it \
             with another version, or as .usda"
        );
        return Err(FormatError::malformed(
            what,
            bilux_scene::Span { file: name.clone(), line: 0, column: 0 },
        ));
    }
    let table = head.moved(16)?.u64()?;
    let mut table = head.moved(table)?;
    let count = table.count(32)?;
    let mut sections = Vec::new();
    for _ in 0..count.min(64) {
        let title = table.take(16)?;
        let (start, size) = (table.u64()?, table.u64()?);
        sections.push((title.split(|b| *b == 0).next().unwrap_or_default(), start, size));
    }
    let section = |title: &str| -> Result<Bytes, FormatError> {
        let found = sections.iter().find(|(known, ..)| *known == title.as_bytes());
        let &(_, start, size) = found.ok_or_else(|| broken(name, &format!("it has no section {title}")))?;
        let end = start.checked_add(size).filter(|end| *end <= all.len() as u64);
        let end = end.ok_or_else(|| broken(name, &format!("its section {title} goes on beyond its end")))?;
        Bytes { all: &all[..end as usize], at: 0, name }.moved(start)
    };
    let tokens = tokens(&mut section("TOKENS")?, budget)?;
    let strings = strings(&mut section("STRINGS")?, budget)?;
    let fields = fields(&mut section("FIELDS")?, budget)?;
    let sets = sets(&mut section("FIELDSETS")?, budget)?;
    let paths = Paths::read(&mut section("PATHS")?, tokens.len(), budget)?;
    let specs = specs(&mut section("SPECS")?, budget)?;
    let name = name.clone();
    Ok((Crate { bytes: all, name, version: minor, tokens, strings, paths }, Specs { fields, sets, specs }))
}

fn tokens(bytes: &mut Bytes, budget: &mut Budget) -> Result<Vec<Text>, FormatError> {
    let (count, size, packed) = (bytes.u64()?, bytes.u64()?, bytes.u64()?);
    let packed = bytes.take(packed)?;
    let all = unpack(packed, size, bytes, budget)?;
    // Each ends with a zero.
    if count > all.len() as u64 {
        return Err(bytes.error("it states more tokens than it has bytes for"));
    }
    budget.take_bytes(count * 48 + size, bytes.name)?;
    let words = all.split(|byte| *byte == 0).take(count as usize);
    let tokens = words.map(|word| Text::from(&*String::from_utf8_lossy(word))).collect();
    budget.release(size);
    Ok(tokens)
}

fn strings(bytes: &mut Bytes, budget: &mut Budget) -> Result<Vec<u32>, FormatError> {
    let count = bytes.count(4)?;
    budget.take_bytes(4 * count as u64, bytes.name)?;
    (0..count).map(|_| bytes.u32()).collect()
}

/// A count of things that a section packs to at least two bits each.
fn packed_count(bytes: &mut Bytes) -> Result<usize, FormatError> {
    let count = bytes.u64()?;
    let left = (bytes.all.len() - bytes.at) as u64;
    if count / 1024 > left {
        return Err(bytes.error("it states more items than it has bytes for"));
    }
    Ok(count as usize)
}

fn fields(bytes: &mut Bytes, budget: &mut Budget) -> Result<Vec<(u32, u64)>, FormatError> {
    let count = packed_count(bytes)?;
    let names = integers(bytes, count, budget)?;
    let size = bytes.u64()?;
    let packed = bytes.take(size)?;
    let values = unpack(packed, 8 * count as u64, bytes, budget)?;
    budget.take_bytes(16 * count as u64, bytes.name)?;
    let (values, _) = values.as_chunks::<8>();
    if values.len() < count {
        return Err(bytes.error("its fields end too early"));
    }
    let list =
        names.iter().zip(values).map(|(name, value)| (*name as u32, u64::from_le_bytes(*value))).collect();
    budget.release(12 * count as u64);
    Ok(list)
}

fn sets(bytes: &mut Bytes, budget: &mut Budget) -> Result<Vec<u32>, FormatError> {
    let count = packed_count(bytes)?;
    Ok(integers(bytes, count, budget)?.into_iter().map(|index| index as u32).collect())
}

fn specs(bytes: &mut Bytes, budget: &mut Budget) -> Result<Vec<[u32; 3]>, FormatError> {
    let count = packed_count(bytes)?;
    let paths = integers(bytes, count, budget)?;
    let sets = integers(bytes, count, budget)?;
    let types = integers(bytes, count, budget)?;
    let both = paths.into_iter().zip(sets).zip(types);
    Ok(both.map(|((path, set), kind)| [path, set, kind].map(|x| x as u32)).collect())
}
