//! The order of a layer's channels.

/// The components of layers in their usual order, in lower case: of colours, vectors, texture coordinates, ids, and of
/// Cryptomatte, whose four channels are called by the names of colours.
const COMPONENTS: [&str; 16] =
    ["r", "red", "g", "green", "b", "blue", "x", "y", "z", "w", "u", "v", "object", "material", "a", "alpha"];

/// The place of a component among those of its layer. Files such as EXR list channels by the alphabet, `A, B, G, R` or
/// `material, object`, so whoever reads them restores the order by this. Unknown components come last.
pub fn component_rank(component: &str) -> usize {
    let lower = component.to_ascii_lowercase();
    COMPONENTS.iter().position(|&known| known == lower).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::component_rank;

    #[test]
    fn the_alphabet_is_undone() {
        for layer in [
            "R G B A",
            "X Y Z",
            "X Y Z W",
            "U V",
            "object material",
            "red green blue alpha",
            "Y A",
            "r g b a",
        ] {
            let mut components: Vec<&str> = layer.split(' ').collect();
            components.sort_unstable();
            components.sort_by_key(|component| component_rank(component));
            assert_eq!(components.join(" "), layer);
        }
    }
}
