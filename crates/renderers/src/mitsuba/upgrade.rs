//! The names of older versions, as Mitsuba 3 upgrades them.

use roxmltree::Node;

/// The version of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(u32);

impl Version {
    /// The version that the outermost element states; the newest if it states none.
    pub(super) fn of(root: &Node) -> Version {
        let text = root.attribute("version").unwrap_or("3");
        Version(text.split('.').next().and_then(|major| major.trim().parse().ok()).unwrap_or(3))
    }

    /// True if names are in camel case: before version 2.
    pub(super) fn is_old(self) -> bool {
        self.0 < 2
    }
}

/// A name in camel case as one of version 3: `toWorld` is `to_world`, `intIOR` is `int_ior`.
pub(super) fn snake_case(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    let mut was_lower = false;
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && was_lower {
            snake.push('_');
        }
        was_lower = letter.is_ascii_lowercase();
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

/// The type of plugin that older ones are read as.
pub(super) fn kind_of_version_3(kind: &str) -> &str {
    match kind {
        "roughcoating" => "coating",
        "bump" => "bumpmap",
        "difftrans" => "difftrans",
        "gridtexture" => "checkerboard",
        "ldrtexture" | "exrtexture" => "bitmap",
        "ldrfilm" | "tonemapfilm" | "mfilm" => "hdrfilm",
        "microfacet" | "lambertian" => {
            if kind == "lambertian" {
                "diffuse"
            } else {
                "roughplastic"
            }
        }
        "vertexcolors" => "mesh_attribute",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_older_versions_become_those_of_version_3() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("fovAxis", "fov_axis"),
            ("specularReflectance", "specular_reflectance"),
            ("sigmaT", "sigma_t"),
            ("alphaU", "alpha_u"),
            ("sampleCount", "sample_count"),
            ("radiance", "radiance"),
        ] {
            assert_eq!(snake_case(old), new);
        }
    }
}
