//! `[[replace]]`: replaces materials of models by name.

use super::document::Table;
use super::plain::missing;
use super::reader::{MAX_NAMES, Native};
use bilux_import::FormatError;
use bilux_scene::SceneError;
use std::collections::BTreeSet;

/// The keys of a replacement: what it selects, and the new material.
pub(super) const KEYS: [&str; 3] = ["material", "object", "with"];

/// The maximum number of replacements; each one is compared with every object.
const MAX: usize = 1000;

/// Longer patterns match nothing.
const LONGEST: usize = 1000;

impl Native<'_, '_> {
    /// Replaces materials of the objects so far. If several tables match an object, the last one wins.
    pub(super) fn replace(&mut self, tables: &[&Table]) -> Result<(), FormatError> {
        if let Some(table) = tables.get(MAX) {
            let message = format!("there are more than {MAX} replacements: use patterns, as in \"Glass*\"");
            return Err(SceneError::invalid(message, &table.at).into());
        }
        let before: Vec<usize> = self.scene.objects.iter().map(|object| object.material).collect();
        for table in tables {
            table.check_keys("a replacement", KEYS.into_iter())?;
            let with = table.find("with").ok_or_else(|| missing("with (the replacement material)", table))?;
            let with = self.material_named(with)?;
            let (material, object) = (pattern(table, "material")?, pattern(table, "object")?);
            if material.is_none() && object.is_none() {
                return Err(missing("material, or object (whose material is replaced)", table));
            }
            let materials = self.scene.materials.iter().enumerate();
            let is_meant: Vec<bool> = materials
                .map(|(i, spec)| self.may_replace(material, i) && fits(material, &spec.name))
                .collect();
            let mut found = false;
            for (placed, &its) in self.scene.objects.iter_mut().zip(&before) {
                if is_meant[its] && fits(object, &placed.name) {
                    placed.material = with;
                    found = true;
                }
            }
            if !found {
                return Err(self.without_match(table, material, object, &before));
            }
        }
        Ok(())
    }

    /// A pattern selects only materials of models; a material of the scene file itself must be named exactly.
    fn may_replace(&self, material: Option<&str>, index: usize) -> bool {
        index >= self.own_materials() || !material.is_some_and(|name| name.contains(['*', '?']))
    }

    /// The error if nothing has the requested names.
    fn without_match(
        &self,
        table: &Table,
        material: Option<&str>,
        object: Option<&str>,
        before: &[usize],
    ) -> FormatError {
        let objects = self.scene.objects.iter().zip(before);
        let of_models = objects.clone().filter(|(_, its)| self.may_replace(material, **its));
        let materials: BTreeSet<&str> =
            of_models.map(|(_, &its)| self.scene.materials[its].name.as_str()).collect();
        let names: BTreeSet<&str> = objects.map(|(object, _)| object.name.as_str()).collect();
        for (key, wanted, known) in [("material", material, &materials), ("object", object, &names)] {
            let Some(wanted) = wanted.filter(|wanted| !known.iter().any(|name| matches(wanted, name))) else {
                continue;
            };
            let at = table.find(key).map_or(&table.at, |item| &item.at);
            let known = known.iter().copied().filter(|name| !name.is_empty()).take(MAX_NAMES);
            return SceneError::unknown(key, wanted, known, at).into();
        }
        SceneError::invalid("no object has both this name and this material: remove one of them", &table.at)
            .into()
    }
}

fn pattern<'t>(table: &'t Table, key: &str) -> Result<Option<&'t str>, FormatError> {
    let Some(text) = table.text(key)? else { return Ok(None) };
    if text.len() > LONGEST {
        return Err(SceneError::invalid(
            format!(
                "names of more than {LONGEST} bytes are not supported here: use a pattern, as in \"Glass*\""
            ),
            &table.at,
        )
        .into());
    }
    Ok(Some(text))
}

fn fits(pattern: Option<&str>, name: &str) -> bool {
    pattern.is_none_or(|pattern| matches(pattern, name))
}

/// True if a name matches a pattern: `*` is any text, `?` any character, and all else is literal.
fn matches(pattern: &str, name: &str) -> bool {
    let (mut wanted, mut rest) = (pattern.chars(), name.chars());
    // The pattern after the last star, and the position where it was last tried.
    let mut retry = None;
    loop {
        let mut next = wanted.clone();
        match (next.next(), rest.clone().next()) {
            (Some('*'), _) => {
                retry = Some((next.clone(), rest.clone()));
                wanted = next;
                continue;
            }
            (None, None) => return true,
            (Some(w), Some(r)) if w == '?' || w == r => {
                wanted = next;
                rest.next();
                continue;
            }
            _ => {}
        }
        let Some((behind, tried)) = &mut retry else { return false };
        if tried.next().is_none() {
            return false;
        }
        (wanted, rest) = (behind.clone(), tried.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn stars_are_any_text_and_question_marks_one_character() {
        let yes = [
            ("Glass", "Glass"),
            ("Glass*", "Glass"),
            ("Glass*", "Glass.001"),
            ("*lass*", "Glass.001"),
            ("*", ""),
            ("?lass", "Glass"),
            ("*.0?1", "Glass.001"),
            ("a*b*c", "axxbyybzzc"),
            ("für*", "für alle"),
            ("**", "x"),
        ];
        for (pattern, name) in yes {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        let no =
            [("Glass", "glass"), ("Glass", "Glass.001"), ("?", ""), ("a*b", "ab "), ("*x", "xy"), ("", "a")];
        for (pattern, name) in no {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }
}
