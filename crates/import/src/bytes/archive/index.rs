//! The names in an archive.

use super::member::Member;
use std::collections::HashMap;

/// The members of an archive, and their names in lower case.
pub(super) struct Index {
    members: Vec<Member>,
    exact: HashMap<String, usize>,
    in_lower_case: HashMap<String, usize>,
    /// By the part of the name after the last `/`, in lower case; `None` if several have it.
    bare: HashMap<String, Option<usize>>,
}

/// A name that leads out of an archive.
#[derive(Debug)]
pub(super) struct LeadsOut;

impl Index {
    /// Refuses names that lead out of the archive, with a message.
    pub(super) fn new(members: Vec<Member>) -> Result<Index, String> {
        let mut index =
            Index { members, exact: HashMap::new(), in_lower_case: HashMap::new(), bare: HashMap::new() };
        for (place, member) in index.members.iter_mut().enumerate() {
            member.name =
                portable("", &member.name).ok().filter(|_| !is_absolute(&member.name)).ok_or_else(|| {
                    let name = &member.name;
                    format!("the member '{name}' would lie outside the archive: such archives are not opened")
                })?;
            let lower = member.name.to_lowercase();
            let bare = lower.rsplit('/').next().unwrap_or_default().to_owned();
            // Of several members with one name, programs take the last.
            index.exact.insert(member.name.clone(), place);
            index.in_lower_case.insert(lower, place);
            index.bare.entry(bare).and_modify(|found| *found = None).or_insert(Some(place));
        }
        Ok(index)
    }

    pub(super) fn members(&self) -> &[Member] {
        &self.members
    }

    /// The memory that it takes, in bytes.
    pub(super) fn bytes_held(&self) -> u64 {
        let names: usize = self.members.iter().map(|member| 4 * member.name.len()).sum();
        (names + self.members.len() * (size_of::<Member>() + 3 * size_of::<(String, usize)>())) as u64
    }

    pub(super) fn exact(&self, name: &str) -> Option<&Member> {
        self.exact.get(name).map(|&place| &self.members[place])
    }

    /// The member with this name, seen from a folder; the flag says if it has another name. A member in another folder
    /// counts if no other has its name.
    pub(super) fn find(&self, folder: &str, name: &str) -> Result<Option<(&Member, bool)>, LeadsOut> {
        let whole = portable(folder, name)?;
        if let Some(member) = self.exact(&whole) {
            return Ok(Some((member, false)));
        }
        let bare = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let beside = portable(folder, bare)?;
        if let Some(member) = self.exact(&beside) {
            return Ok(Some((member, false)));
        }
        let found =
            [&whole, &beside].into_iter().find_map(|name| self.in_lower_case.get(&name.to_lowercase()));
        let found = found.copied().or_else(|| self.bare.get(&bare.to_lowercase()).copied().flatten());
        Ok(found.map(|place| (&self.members[place], true)))
    }
}

fn is_absolute(name: &str) -> bool {
    name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':')
}

/// A name from the root of an archive, of one that is seen from a folder. One that begins with `/` is seen from the root.
fn portable(folder: &str, name: &str) -> Result<String, LeadsOut> {
    let from = if name.starts_with(['/', '\\']) { "" } else { folder };
    let mut parts: Vec<&str> = Vec::new();
    for part in from.split('/').chain(name.split(['/', '\\'])) {
        match part {
            "" | "." => {}
            ".." => _ = parts.pop().ok_or(LeadsOut)?,
            part => parts.push(part),
        }
    }
    Ok(parts.join("/"))
}
