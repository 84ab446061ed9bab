//! Names of prims.

use std::collections::{HashMap, HashSet};

/// The names of the prims below one prim.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// The next number for each name.
    next: HashMap<String, u64>,
}

impl Names {
    /// An identifier that no other prim here has, as close as possible to a name, or to another if that is empty.
    pub(super) fn unused(&mut self, wanted: &str, otherwise: &str) -> String {
        let plain = identifier(if wanted.is_empty() { otherwise } else { wanted });
        let mut free = plain.clone();
        while !self.taken.insert(free.clone()) {
            let number = self.next.entry(plain.clone()).or_insert(2);
            free = format!("{plain}_{number}");
            *number += 1;
        }
        free
    }
}

/// A name with letters of ASCII, digits and underscores only, as all versions of OpenUSD demand.
fn identifier(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut plain: String = name.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    if plain.is_empty() || plain.starts_with(|c: char| c.is_ascii_digit()) {
        plain.insert(0, '_');
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers_that_differ() {
        let mut names = Names::default();
        let of: Vec<String> =
            ["2 legs", "_2_legs", "Tür", "", "T_r", "T_r_2"].map(|name| names.unused(name, "mesh")).into();
        assert_eq!(of, ["_2_legs", "_2_legs_2", "T_r", "mesh", "T_r_2", "T_r_2_2"]);
    }
}
