//! What can be wrong with a scene.

use crate::parameters::Span;

/// Why a scene cannot be built. Every message says what, where and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A name that no table holds.
    #[error("{at}: there is no {}{}", named(.what, .name), suggestion(.nearest, .known))]
    Unknown {
        /// What kind of name.
        what: String,
        /// The name.
        name: String,
        /// The nearest known name, when one is near.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
        /// Where it was written.
        at: Span,
    },
    /// A value of the wrong kind or out of range.
    #[error("{at}: {what} is {found}, but has to be {wanted}")]
    BadValue {
        /// Which parameter.
        what: String,
        /// What it has to be.
        wanted: String,
        /// What was found.
        found: String,
        /// Where.
        at: Span,
    },
    /// Something has to be given and is not.
    #[error("{at}: {what} has to be given")]
    Missing {
        /// What is missing.
        what: String,
        /// Where it belongs.
        at: Span,
    },
    /// Anything else, said in full.
    #[error("{at}: {message}")]
    Invalid {
        /// What is wrong and what to do.
        message: String,
        /// Where.
        at: Span,
    },
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

    /// Where the fault was written.
    pub fn at(&self) -> &Span {
        match self {
            SceneError::Unknown { at, .. }
            | SceneError::BadValue { at, .. }
            | SceneError::Missing { at, .. }
            | SceneError::Invalid { at, .. } => at,
        }
    }

    /// Anything else.
    pub fn invalid(message: impl Into<String>, at: &Span) -> SceneError {
        SceneError::Invalid { message: message.into(), at: at.clone() }
    }
}

/// The known name that a misspelt one most likely means.
pub fn nearest_name(name: &str, known: &[String]) -> Option<String> {
    let distance = |k: &String| strsim::damerau_levenshtein(&name.to_lowercase(), k);
    let best = known.iter().min_by_key(|k| distance(k))?;
    (distance(best) <= 1 + name.chars().count() / 3).then(|| best.clone())
}

/// The name behind its kind, before what it would belong to: "key 'fow' of a camera".
fn named(what: &str, name: &str) -> String {
    match what.split_once(" of ") {
        Some((what, whole)) => format!("{what} '{name}' of {whole}"),
        None => format!("{what} '{name}'"),
    }
}

fn suggestion(nearest: &Option<String>, known: &[String]) -> String {
    match nearest {
        Some(name) => format!("; did you mean '{name}'?"),
        None if known.is_empty() => ", nor any other".to_owned(),
        None => format!(" (known: {})", known.join(", ")),
    }
}

/// Something worth saying that does not stop the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// What, and what was done about it.
    pub message: String,
    /// Where.
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
