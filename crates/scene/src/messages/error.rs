//! Errors and warnings of a scene.

use crate::messages::span::Span;

/// Why a scene cannot be built. Every message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A name that is in no table.
    #[error("{}there is no {}{}", place(.at), named(.what, .name), suggestion(.nearest, .known))]
    Unknown {
        /// The kind of name.
        what: String,
        /// The name.
        name: String,
        /// The nearest known name, when one is near.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
        /// Place where it was written.
        at: Span,
    },
    /// A value of the wrong kind or out of range.
    #[error("{}{what} is {found}, but must be {wanted}", place(.at))]
    BadValue {
        /// Which parameter.
        what: String,
        /// The expected value.
        wanted: String,
        /// The value found.
        found: String,
        /// Place where it was written.
        at: Span,
    },
    /// A required value is missing.
    #[error("{}{what} is missing: add it", place(.at))]
    Missing {
        /// Name of the missing value.
        what: String,
        /// Place where it belongs.
        at: Span,
    },
    /// Any other error, described in full.
    #[error("{}{message}", place(.at))]
    Invalid {
        /// Problem, and what to do.
        message: String,
        /// Place where the cause was written.
        at: Span,
    },
}

/// The beginning of a message: where something was written, unless the program made it.
fn place(at: &Span) -> String {
    if at.file.is_empty() { String::new() } else { format!("{at}: ") }
}

impl SceneError {
    /// An unknown name, with the nearest of the known ones.
    pub fn unknown<'n>(
        what: impl Into<String>,
        name: &str,
        known: impl IntoIterator<Item = &'n str>,
        at: &Span,
    ) -> SceneError {
        let known: Vec<String> = known.into_iter().map(str::to_owned).collect();
        SceneError::Unknown {
            what: what.into(),
            name: name.to_owned(),
            nearest: nearest_name(name, &known),
            known,
            at: at.clone(),
        }
    }

    /// Place where the error was written.
    pub fn at(&self) -> &Span {
        match self {
            SceneError::Unknown { at, .. }
            | SceneError::BadValue { at, .. }
            | SceneError::Missing { at, .. }
            | SceneError::Invalid { at, .. } => at,
        }
    }

    /// Any other error.
    pub fn invalid(message: impl Into<String>, at: &Span) -> SceneError {
        SceneError::Invalid { message: message.into(), at: at.clone() }
    }
}

/// Names from glTF, Blender and other renderers, and their equivalents here. If a material lacks a name, the next one
/// in the row applies.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("albedo", &["base_color", "reflectance", "kd"]),
    ("base_color_factor", &["base_color", "reflectance", "kd"]),
    ("color", &["base_color", "reflectance", "kd"]),
    ("colour", &["base_color", "reflectance", "kd"]),
    ("diffuse", &["base_color", "reflectance", "kd"]),
    ("diffuse_color", &["base_color", "reflectance", "kd"]),
    ("metallic", &["base_metalness"]),
    ("metalness", &["base_metalness"]),
    ("metallic_factor", &["base_metalness"]),
    ("roughness", &["roughness", "specular_roughness"]),
    ("roughness_factor", &["roughness", "specular_roughness"]),
    ("specular", &["specular_weight", "ks"]),
    ("ior", &["specular_ior", "eta"]),
    ("index_of_refraction", &["specular_ior", "eta"]),
    ("anisotropy", &["anisotropy", "specular_roughness_anisotropy"]),
    ("anisotropy_strength", &["anisotropy", "specular_roughness_anisotropy"]),
    ("transmission", &["transmission_weight", "kt"]),
    ("transmission_factor", &["transmission_weight", "kt"]),
    ("clearcoat", &["coat_weight"]),
    ("coat", &["coat_weight"]),
    ("clearcoat_factor", &["coat_weight"]),
    ("clearcoat_roughness", &["coat_roughness"]),
    ("clearcoat_roughness_factor", &["coat_roughness"]),
    ("sheen", &["fuzz_weight"]),
    ("fuzz", &["fuzz_weight"]),
    ("sheen_color", &["fuzz_color"]),
    ("sheen_roughness", &["fuzz_roughness"]),
    ("iridescence", &["thin_film_weight"]),
    ("iridescence_factor", &["thin_film_weight"]),
    ("iridescence_ior", &["thin_film_ior"]),
    ("attenuation_color", &["transmission_color", "absorption"]),
    ("attenuation_distance", &["transmission_depth", "absorption"]),
    ("emissive", &["emission"]),
    ("emissive_factor", &["emission"]),
    ("emission_color", &["emission"]),
    ("emissive_strength", &["emission_scale"]),
    ("emission_strength", &["emission_scale"]),
    ("emission_luminance", &["emission_scale"]),
    ("geometry_opacity", &["opacity"]),
    ("alpha", &["opacity"]),
    ("normal_texture", &["normal"]),
    ("normal_map", &["normal"]),
    ("double_sided", &["visible_sides"]),
];

/// The known name most likely meant by another one: a name that it abbreviates, a synonym, or one with a similar
/// spelling.
pub fn nearest_name(name: &str, known: &[String]) -> Option<String> {
    let plain = snake_case(name);
    let row = SYNONYMS.iter().find(|(other, _)| *other == plain);
    let same = row.and_then(|(_, names)| names.iter().find(|name| known.iter().any(|k| k == *name)));
    if let Some(same) = same {
        return Some((*same).to_owned());
    }
    let distance = |k: &String| strsim::damerau_levenshtein(&name.to_lowercase(), &k.to_lowercase());
    let best = known.iter().min_by_key(|k| distance(k))?;
    if distance(best) <= 1 + name.chars().count() / 3 {
        return Some(best.clone());
    }
    // `transmission` may abbreviate `transmission_weight`.
    let longer = |k: &&String| k.strip_prefix(&plain).is_some_and(|rest| rest.starts_with('_'));
    known.iter().filter(longer).min_by_key(|k| k.len()).cloned()
}

/// Converts `baseColorFactor` to `base_color_factor`.
fn snake_case(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !snake.is_empty() && !snake.ends_with('_') {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

/// The name inserted after its kind and before its owner: "key 'fow' of a camera".
fn named(what: &str, name: &str) -> String {
    match what.split_once(" of ") {
        Some((what, whole)) => format!("{what} '{name}' of {whole}"),
        None => format!("{what} '{name}'"),
    }
}

fn suggestion(nearest: &Option<String>, known: &[String]) -> String {
    match nearest {
        Some(name) => format!("; did you mean '{name}'?"),
        None if known.is_empty() => ", nor any other: add one, or correct the name".to_owned(),
        None => format!(" (known: {})", known.join(", ")),
    }
}

/// A problem worth reporting that does not stop the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Problem, and what was done about it.
    pub message: String,
    /// Place where the problem was found.
    pub at: Span,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.at == Span::default() {
            f.write_str(&self.message)
        } else {
            write!(f, "{}: {}", self.at, self.message)
        }
    }
}
