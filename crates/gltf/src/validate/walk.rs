//! Walks a document along the tables of kinds.

use super::extension_kinds::{ANYWHERE, EXTENSIONS};
use super::rules::RULES;
use super::schema::{Kind, Property, Shape, singular};
use super::{Check, counted, whole_float};
use crate::document::json::JsonNode;
use bilux_scene::error::nearest_name;
use serde_json::Value;
use std::collections::HashSet;

impl<'d> Check<'d, '_> {
    /// Checks an object, everything it contains, and the rules for its kind.
    pub(super) fn object(&mut self, node: JsonNode<'d>, kind: &'static Kind) {
        if !node.is_object() {
            self.wrong(node, "an object in braces");
            return;
        }
        for property in kind.properties {
            match node.get(property.key) {
                Some(value) => self.property(value, property),
                None if property.is_required => {
                    self.report(node, format!("'{}' is missing here", property.key));
                }
                None => {}
            }
        }
        if !kind.is_open {
            self.unknown_keys(node, kind);
        }
        if let Some(extensions) = node.get("extensions") {
            self.extensions(extensions, kind);
        }
        for rule in RULES.iter().filter(|rule| rule.of.plural == kind.plural) {
            (rule.check)(self, node);
        }
    }

    fn unknown_keys(&mut self, node: JsonNode<'d>, kind: &Kind) {
        for (key, value) in node.entries() {
            if matches!(key, "extensions" | "extras") || kind.properties.iter().any(|p| p.key == key) {
                continue;
            }
            let known: Vec<String> = kind.properties.iter().map(|p| p.key.to_owned()).collect();
            let advice = match nearest_name(key, &known) {
                Some(name) => format!("did you mean '{name}'?"),
                None => "put your own data under 'extras'".to_owned(),
            };
            self.report(value, format!("{} have no property '{key}' in glTF: {advice}", kind.plural));
        }
    }

    fn property(&mut self, value: JsonNode<'d>, property: &Property) {
        match &property.shape {
            Shape::Any => {}
            Shape::Text => self.expect(value, value.value().is_string(), "text"),
            Shape::Flag => self.expect(value, value.value().is_boolean(), "true or false"),
            Shape::Whole(least, greatest) => self.whole_number(value, *least, *greatest),
            Shape::Code(codes) => {
                let fits = whole_of(value.value()).is_some_and(|code| codes.contains(&code));
                self.expect(value, fits, &one_of(codes.iter().map(u64::to_string)));
            }
            Shape::Choice(choices) => {
                let fits = value.value().as_str().is_some_and(|text| choices.contains(&text));
                self.expect(value, fits, &one_of(choices.iter().map(|choice| format!("\"{choice}\""))));
            }
            Shape::Number(range) => {
                let fits = value.value().as_f64().is_some_and(|x| range.contains(x));
                self.expect(value, fits, &range.words());
            }
            Shape::Numbers(least, most, range) => {
                let Some(all) = value.value().as_array() else {
                    return self.wrong(value, "a list of numbers");
                };
                if !(*least..=*most).contains(&all.len()) {
                    let wanted = if least == most { format!("{least}") } else { format!("{least} or more") };
                    let have = counted(all.len(), "number");
                    return self.report(value, format!("this list has {have}, but must have {wanted}"));
                }
                for item in value.children() {
                    let fits = item.value().as_f64().is_some_and(|x| range.contains(x));
                    self.expect(item, fits, &range.words());
                }
            }
            Shape::Index(list) => self.index(value, list),
            Shape::Indices(list) => self.different(value, |check, item| check.index(item, list)),
            Shape::Named(list) => self.indices_by_name(value, list),
            Shape::Texts => self.different(value, |check, item| {
                check.expect(item, item.value().is_string(), "text");
            }),
            Shape::Object(kind) => self.object(value, kind),
            Shape::List(kind) => self.items(value, |check, item| check.object(item, kind)),
        }
    }

    pub(super) fn expect(&mut self, node: JsonNode<'d>, is_right: bool, wanted: &str) {
        if !is_right {
            self.wrong(node, wanted);
        }
    }

    fn wrong(&mut self, node: JsonNode<'d>, wanted: &str) {
        self.report(node, format!("this is {}, but must be {wanted}", node.shortened()));
    }

    fn whole_number(&mut self, node: JsonNode<'d>, least: u64, greatest: u64) {
        let number = whole_of(node.value());
        if number.is_none() || number.is_some_and(|x| x < least) {
            self.wrong(node, &format!("a whole number, {least} or more"));
        } else if number.is_some_and(|x| x > greatest) {
            self.wrong(node, &format!("a whole number from {least} to {greatest}"));
        }
    }

    /// Checks the items of a list, which must not be empty.
    pub(super) fn items(&mut self, list: JsonNode<'d>, mut check: impl FnMut(&mut Self, JsonNode<'d>)) {
        match list.value().as_array() {
            None => self.wrong(list, "a list in brackets"),
            Some(items) if items.is_empty() => self.report(list, "this list is empty: leave it out"),
            Some(_) => list.children().for_each(|item| check(self, item)),
        }
    }

    /// Checks the items of a list, which must all be different.
    fn different(&mut self, list: JsonNode<'d>, mut check: impl FnMut(&mut Self, JsonNode<'d>)) {
        let mut seen = HashSet::new();
        self.items(list, |this, item| {
            check(this, item);
            if !seen.insert(item.value().to_string()) {
                this.report(item, format!("{} occurs in this list twice", item.shortened()));
            }
        });
    }

    /// Checks that an index refers to an item of a list of the document.
    pub(super) fn index(&mut self, node: JsonNode<'d>, list: &'static str) {
        let Some(index) = whole_of(node.value()).and_then(|index| usize::try_from(index).ok()) else {
            return self.wrong(node, "a whole number, 0 or more");
        };
        self.used.insert((list, index));
        if self.root.item(list, index).is_none() {
            let (count, noun) = (self.list(list).len(), singular(list));
            let have = match count {
                0 => format!("the file has no {noun}"),
                1 => format!("the only {noun} of the file is number 0"),
                _ => format!("the file has only {count}, counted from 0"),
            };
            self.report(node, format!("this refers to {noun} {index}, but {have}"));
        }
    }

    fn indices_by_name(&mut self, node: JsonNode<'d>, list: &'static str) {
        if !node.is_object() {
            return self.wrong(node, "an object in braces");
        }
        if node.entries().next().is_none() {
            return self.report(node, "this object is empty, but must name something");
        }
        for (_, index) in node.entries() {
            self.index(index, list);
        }
    }

    fn extensions(&mut self, node: JsonNode<'d>, extended: &'static Kind) {
        if !node.is_object() {
            return self.wrong(node, "an object in braces");
        }
        for (name, extension) in node.entries() {
            self.extensions.insert(name);
            let mut rows = EXTENSIONS.iter().filter(|row| row.name == name).peekable();
            if rows.peek().is_none() || ANYWHERE.contains(&name) {
                continue;
            }
            match rows.clone().find(|row| row.extends.plural == extended.plural) {
                Some(row) => self.object(extension, &row.kind),
                None => {
                    let places: Vec<_> = rows.map(|row| row.extends.plural).collect();
                    let places = places.join(" or ");
                    self.report(
                        extension,
                        format!("{name} extends {places}, not {}: it has no effect here", extended.plural),
                    );
                }
            }
        }
    }
}

fn whole_of(value: &Value) -> Option<u64> {
    value.as_u64().or_else(|| whole_float(value))
}

fn one_of(choices: impl ExactSizeIterator<Item = String>) -> String {
    let last = choices.len().saturating_sub(1);
    let mut words = String::new();
    for (i, choice) in choices.enumerate() {
        words += if i == 0 {
            ""
        } else if i == last {
            " or "
        } else {
            ", "
        };
        words += &choice;
    }
    words
}
