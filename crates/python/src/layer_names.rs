//! The names of layers. A layer is called as users ask for it (`bilux.aovs`), whatever its channels are called in files.

use bilux::transport::aovs::{AOVS, Aov, AovEntry};

/// AOVs of several layers, and how the names of these begin.
const STACKS: [(Aov, &str); 2] = [(Aov::Groups, "group_"), (Aov::Strategies, "strategy_")];

/// The layer to which a channel belongs, given what is before the last dot of its name.
pub(crate) fn layer_of(prefix: &str) -> &str {
    let numbered = prefix.len().checked_sub(2).and_then(|stem| prefix.split_at_checked(stem));
    let numbered = numbered.filter(|(_, number)| number.bytes().all(|digit| digit.is_ascii_digit()));
    let is_layer = |row: &&AovEntry| match (row.layer, numbered) {
        (Some(layer), Some((stem, _))) if row.aov.is_matte() => layer == stem,
        (Some(layer), _) => layer == prefix && !row.aov.is_matte() && row.aov != Aov::Groups,
        (None, _) => false,
    };
    AOVS.iter().find(is_layer).map_or(prefix, |row| row.entry.name)
}

/// The layers that a name stands for.
pub(crate) enum Meaning<'n> {
    /// The layer of this name.
    Layer(&'n str),
    /// All layers whose names begin like this.
    Stack(&'static str),
}

/// Meaning of a name: a layer, also by the name that files give it, or all layers of an AOV.
pub(crate) fn meaning(name: &str) -> Meaning<'_> {
    let Some(row) = AOVS.iter().find(|row| is_name(row, name)) else { return Meaning::Layer(name) };
    match STACKS.iter().find(|(aov, _)| *aov == row.aov) {
        Some((_, beginning)) => Meaning::Stack(beginning),
        None => Meaning::Layer(row.entry.name),
    }
}

/// The names of the channels of a layer in a file, by their usual order.
pub(crate) fn channels(layer: &str, count: usize) -> Vec<String> {
    let row = AOVS.iter().find(|row| is_name(row, layer));
    let prefix = row.and_then(|row| row.layer).unwrap_or(layer);
    if row.is_some_and(|row| row.aov.is_matte()) {
        let component = |i: usize| ["red", "green", "blue", "alpha"][i % 4];
        return (0..count).map(|i| format!("{prefix}{:02}.{}", i / 4, component(i))).collect();
    }
    let components: &[&str] = match (row, count) {
        (None, 1) if layer.is_empty() => &["Y"],
        (None, 2) if layer.is_empty() => &["Y", "A"],
        (Some(row), _) if row.channels.len() == count => row.channels,
        (_, 1) => &[""],
        (_, 2) => &["X", "Y"],
        (_, 3) => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    components.iter().map(|component| qualified(prefix, component)).collect()
}

/// True for Cryptomatte, which has more than four channels.
pub(crate) fn is_matte(layer: &str) -> bool {
    AOVS.iter().any(|row| row.aov.is_matte() && is_name(row, layer))
}

fn is_name(row: &AovEntry, name: &str) -> bool {
    !name.is_empty() && (row.entry.name == name || row.layer == Some(name))
}

fn qualified(prefix: &str, component: &str) -> String {
    match (prefix, component) {
        ("", component) => component.to_owned(),
        (prefix, "") => prefix.to_owned(),
        (prefix, component) => format!("{prefix}.{component}"),
    }
}
