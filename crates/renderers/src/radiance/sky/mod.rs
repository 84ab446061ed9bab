//! Skies and suns as Radiance's generators of skies make them.

mod gendaylit;
mod gensky;
mod moment;
mod perez;

use super::kinds::{Finish, Kind};
use super::sky_model::Sky;
use super::statement::{Primitive, Statement};
use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_scene::Span;
pub(super) use gendaylit::generate as gendaylit;
pub(super) use gensky::generate as gensky;
use std::rc::Rc;

/// The diameter of the sun and its radiance, if it is to be seen.
struct Sun {
    radiance: f64,
    degrees: f64,
}

/// The statements that a generator writes: a light, a source of it, and a pattern named `skyfunc`.
fn statements(sky: Sky, sun: Option<Sun>, at: &Span) -> Vec<Statement> {
    let primitive = |modifier: &str, kind, word, name: &str, reals: Vec<f64>, sky| {
        Statement::Primitive(Rc::new(Primitive {
            modifier: modifier.into(),
            kind,
            word,
            name: name.into(),
            strings: Vec::new(),
            reals,
            sky,
            at: at.clone(),
        }))
    };
    let mut made = Vec::new();
    if let Some(Sun { radiance, degrees }) = sun {
        let [x, y, z] = sky.sun.to_array();
        made.push(primitive(
            "void",
            Kind::Material(Finish::Light),
            "light",
            "solar",
            vec![radiance; 3],
            None,
        ));
        made.push(primitive("solar", Kind::Source, "source", "sun", vec![x, y, z, degrees], None));
    }
    made.push(primitive("void", Kind::Pattern, "brightfunc", "skyfunc", Vec::new(), Some(Rc::new(sky))));
    made
}

/// The options of a generator, which are words and numbers.
struct Options<'a> {
    words: std::slice::Iter<'a, Rc<str>>,
    program: &'static str,
    at: &'a Span,
}

impl<'a> Options<'a> {
    fn new(words: &'a [Rc<str>], program: &'static str, at: &'a Span) -> Options<'a> {
        Options { words: words.iter(), program, at }
    }

    fn next(&mut self) -> Option<&'a str> {
        self.words.next().map(|word| &**word)
    }

    fn error<T>(&self, message: &str) -> Result<T, FormatError> {
        Err(FormatError::malformed(format!("{} {message}", self.program), self.at.clone()))
    }

    /// The number after an option.
    fn number(&mut self, option: &str) -> Result<f64, FormatError> {
        let word = self.next();
        match word.and_then(|word| parse_f64(word.as_bytes())).filter(|number| number.is_finite()) {
            Some(number) => Ok(number),
            None => {
                self.error(&format!("needs a number after '{option}', not '{}'", word.unwrap_or_default()))
            }
        }
    }
}
