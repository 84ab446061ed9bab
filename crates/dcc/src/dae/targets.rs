//! Targets of animations: `id/sid/sid.member`, or `(i)(j)` in place of a member.

use super::document::Document;
use super::element::Element;
use std::collections::VecDeque;

/// An element, and which of its numbers; all of them without a first one.
pub(super) struct Target<'d> {
    pub(super) element: Element<'d>,
    pub(super) first: Option<usize>,
}

/// Number of elements that are searched for one with a sid.
const MAX_SEARCHED: usize = 4096;

/// The element and the number that a target names.
pub(super) fn target<'d>(text: &str, document: &Document<'d>) -> Option<Target<'d>> {
    let (mut path, mut member) = (text.trim(), None);
    let last = path.rfind('/').map_or(0, |slash| slash + 1);
    let found = document.with_id(path);
    if found.is_none() {
        if let Some(bracket) = path[last..].find('(') {
            member = Some(indexed(&path[last + bracket..])?);
            path = &path[..last + bracket];
        } else if let Some(dot) = path[last..].rfind('.') {
            member = Some(named(&path[last + dot + 1..])?);
            path = &path[..last + dot];
        }
    }
    let mut parts = path.split('/');
    let first = parts.next()?;
    let start = if first == "." { Some(document.root) } else { document.with_id(first) };
    let element = found.or_else(|| parts.try_fold(start?, with_sid))?;
    let of_array = || element.children().find(|child| child.name() == "float_array");
    // The weights of a morph are often named by their source.
    let element = if element.name() == "source" { of_array()? } else { element };
    Some(Target { element, first: member.filter(|member| *member != usize::MAX) })
}

/// The nearest element with a sid in another one.
pub(super) fn with_sid<'d>(within: Element<'d>, sid: &str) -> Option<Element<'d>> {
    let mut waiting = VecDeque::from([within]);
    let mut searched = 0;
    while let Some(element) = waiting.pop_front() {
        for child in element.children() {
            if child.attribute("sid") == Some(sid) {
                return Some(child);
            }
            searched += 1;
            if searched > MAX_SEARCHED {
                return None;
            }
            waiting.push_back(child);
        }
    }
    None
}

/// The index of a number: `(i)`, or `(column)(row)` of a matrix, whose rows follow each other in the file.
fn indexed(text: &str) -> Option<usize> {
    let mut parts = text.split('(').skip(1).map(|part| part.trim_end_matches(')').trim().parse::<usize>());
    let first = parts.next()?.ok()?;
    Some(match parts.next() {
        Some(second) => first.checked_add(second.ok()?.checked_mul(4)?)?,
        None => first,
    })
}

/// The index of a number by its name; `usize::MAX` for all of them.
fn named(member: &str) -> Option<usize> {
    Some(match member.to_ascii_uppercase().as_str() {
        "X" | "R" | "U" | "S" => 0,
        "Y" | "G" | "V" | "T" => 1,
        "Z" | "B" | "P" => 2,
        "W" | "A" | "Q" | "ANGLE" => 3,
        _ => usize::MAX,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_numbers_of_an_element() {
        assert_eq!(indexed("(2)"), Some(2));
        assert_eq!(indexed("(3)(1)"), Some(7), "the fourth number of the second row: y of a translation");
        assert_eq!((named("ANGLE"), named("y"), named("")), (Some(3), Some(1), Some(usize::MAX)));
        assert_eq!(indexed("(x)"), None);
    }
}
