//! Parameter lists: any number of `"type name" [ values ]`.

use super::lexer::{Lexer, Token, number_of, shown};
use bilux_import::FormatError;
use bilux_import::appearance::spectra::colours::ColourSpace;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::names::{shortened, unknown};
use bilux_math::{Vec2, Vec3};
use bilux_scene::Span;
use bilux_scene::error::nearest_name;
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// The declared type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Integer,
    Bool,
    Text,
    Point2,
    /// Points, vectors and normals, with three numbers each.
    Triple,
    Rgb,
    Xyz,
    Blackbody,
    Spectrum,
    Texture,
}

/// The names of the types, including those of version 3.
const KINDS: &[(&str, Kind)] = &[
    ("float", Kind::Float),
    ("integer", Kind::Integer),
    ("bool", Kind::Bool),
    ("string", Kind::Text),
    ("point2", Kind::Point2),
    ("vector2", Kind::Point2),
    ("point3", Kind::Triple),
    ("vector3", Kind::Triple),
    ("normal3", Kind::Triple),
    ("point", Kind::Triple),
    ("vector", Kind::Triple),
    ("normal", Kind::Triple),
    ("rgb", Kind::Rgb),
    ("color", Kind::Rgb),
    ("xyz", Kind::Xyz),
    ("blackbody", Kind::Blackbody),
    ("spectrum", Kind::Spectrum),
    ("texture", Kind::Texture),
];

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f32>),
    Integers(Vec<i32>),
    Texts(Vec<String>),
    Bools(Vec<bool>),
}

/// One parameter of a list.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    pub(super) kind: Kind,
    pub(super) name: String,
    pub(super) values: Values,
    pub(super) at: Span,
    /// The colour space of its colours.
    pub(super) space: ColourSpace,
    used: Cell<bool>,
}

/// The parameters of an entity.
#[derive(Clone, Debug)]
pub(super) struct ParameterList {
    /// The owner of the list, for messages: `shape 'sphere'`.
    pub(super) what: String,
    pub(super) at: Span,
    list: Vec<Parameter>,
    /// Attributes, which apply where the list itself has no such parameter.
    attributes: Arc<Vec<Parameter>>,
    /// The names that were looked up.
    asked: RefCell<Vec<&'static str>>,
}

impl Parameter {
    fn wrong(&self, wanted: &str) -> FormatError {
        let found = match &self.values {
            Values::Numbers(list) => counted(list.len(), "number"),
            Values::Integers(list) => counted(list.len(), "whole number"),
            Values::Texts(list) => counted(list.len(), "text"),
            Values::Bools(list) => counted(list.len(), "truth value"),
        };
        let message = format!("'{}' must be {wanted}, not {found}", self.name);
        FormatError::malformed(message, self.at.clone())
    }

    /// Numbers of the parameter, if it holds numbers.
    pub(super) fn numbers(&self) -> Option<&[f32]> {
        match &self.values {
            Values::Numbers(list) => Some(list),
            _ => None,
        }
    }

    /// String of the parameter, if it holds a single one.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.values {
            Values::Texts(list) => match list.as_slice() {
                [one] => Some(one),
                _ => None,
            },
            _ => None,
        }
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Reads parameters up to the next directive.
pub(super) fn read(
    lexer: &mut Lexer,
    space: ColourSpace,
    budget: &mut Budget,
) -> Result<Vec<Parameter>, FormatError> {
    let mut list: Vec<Parameter> = Vec::new();
    while let Some((Token::Quoted(declared), at)) = lexer.peek()? {
        lexer.next()?;
        let place = lexer.place(at);
        let declared = String::from_utf8_lossy(&declared).into_owned();
        let mut words = declared.split_ascii_whitespace();
        let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
            let message = format!(
                "'{declared}' does not declare a parameter: write a type and a name, as in \"float radius\""
            );
            return Err(FormatError::malformed(message, place));
        };
        let Some((_, kind)) = KINDS.iter().find(|(known, _)| *known == kind) else {
            let names = KINDS.iter().map(|(name, _)| *name);
            return Err(unknown("type of parameters", kind, names, &place));
        };
        budget.take::<Parameter>(1, &place.file)?;
        let values = values(lexer, *kind, name, budget, &place)?;
        list.push(Parameter {
            kind: *kind,
            name: name.to_owned(),
            values,
            at: place,
            space,
            used: Cell::new(false),
        });
    }
    Ok(list)
}

fn values(
    lexer: &mut Lexer,
    kind: Kind,
    name: &str,
    budget: &mut Budget,
    place: &Span,
) -> Result<Values, FormatError> {
    let wanted = format!("the value of '{name}'");
    let mut values = match kind {
        Kind::Integer => Values::Integers(Vec::new()),
        Kind::Bool => Values::Bools(Vec::new()),
        Kind::Text | Kind::Texture => Values::Texts(Vec::new()),
        Kind::Spectrum if is_text(lexer)? => Values::Texts(Vec::new()),
        _ => Values::Numbers(Vec::new()),
    };
    let (token, at) = lexer.need(&wanted)?;
    if token != Token::Open {
        push(&mut values, &token, lexer, name, at)?;
        return Ok(values);
    }
    loop {
        let (token, at) = lexer.need("']', which ends the list")?;
        if token == Token::Close {
            return Ok(values);
        }
        let size = match &token {
            Token::Quoted(text) => size_of::<String>() + text.len(),
            _ => size_of::<f32>(),
        };
        budget.take::<u8>(size, &place.file)?;
        push(&mut values, &token, lexer, name, at)?;
    }
}

/// True if the list, or the single value, consists of strings.
fn is_text(lexer: &mut Lexer) -> Result<bool, FormatError> {
    let mut ahead = lexer.ahead();
    Ok(match ahead.next()? {
        Some((Token::Open, _)) => matches!(ahead.next()?, Some((Token::Quoted(_), _))),
        Some((Token::Quoted(_), _)) => true,
        _ => false,
    })
}

fn push(values: &mut Values, token: &Token, lexer: &Lexer, name: &str, at: usize) -> Result<(), FormatError> {
    let wrong = |wanted: &str| {
        let message = format!("'{name}' takes {wanted}, not {}", shown(token));
        Err(lexer.error(message, at))
    };
    match values {
        Values::Numbers(list) => match token {
            Token::Word(word) => match number_of(word) {
                Some(number) => list.push(number),
                None => return wrong("numbers"),
            },
            _ => return wrong("numbers"),
        },
        Values::Integers(list) => {
            let word = if let Token::Word(word) = token { std::str::from_utf8(word).ok() } else { None };
            // Some exporters write 1.0.
            let whole = |x: f64| (x.fract() == 0.0 && x.abs() < f64::from(i32::MAX)).then_some(x as i32);
            match word.and_then(|w| w.parse().ok().or_else(|| w.parse().ok().and_then(whole))) {
                Some(number) => list.push(number),
                None => return wrong("whole numbers"),
            }
        }
        Values::Texts(list) => match token {
            Token::Quoted(text) => list.push(String::from_utf8_lossy(text).into_owned()),
            _ => return wrong("texts in quotes"),
        },
        Values::Bools(list) => match token {
            // Version 3 puts them in quotes.
            Token::Word(b"true") => list.push(true),
            Token::Word(b"false") => list.push(false),
            Token::Quoted(text) if **text == *b"true" => list.push(true),
            Token::Quoted(text) if **text == *b"false" => list.push(false),
            _ => return wrong("true or false"),
        },
    }
    Ok(())
}

impl ParameterList {
    pub(super) fn new(
        what: String,
        at: Span,
        list: Vec<Parameter>,
        attributes: Arc<Vec<Parameter>>,
    ) -> ParameterList {
        ParameterList { what, at, list, attributes, asked: RefCell::new(Vec::new()) }
    }

    /// The parameter with this name.
    pub(super) fn find(&self, name: &'static str) -> Option<&Parameter> {
        self.find_where(name, |_| true)
    }

    /// The parameter with this name that satisfies a condition.
    pub(super) fn find_where(
        &self,
        name: &'static str,
        fits: impl Fn(&Parameter) -> bool,
    ) -> Option<&Parameter> {
        {
            let mut asked = self.asked.borrow_mut();
            if !asked.contains(&name) {
                asked.push(name);
            }
        }
        let mut all = self.list.iter().chain(&*self.attributes);
        let found = all.find(|p| p.name == name && fits(p));
        found.inspect(|p| p.used.set(true))
    }

    /// True if the list itself or an attribute has this parameter.
    pub(super) fn has(&self, name: &'static str) -> bool {
        self.find(name).is_some()
    }

    /// The location of a parameter, or else of the whole list.
    pub(super) fn place(&self, name: &str) -> Span {
        let mut all = self.list.iter().chain(&*self.attributes);
        all.find(|p| p.name == name).map_or(&self.at, |p| &p.at).clone()
    }

    /// A single number.
    pub(super) fn number(&self, name: &'static str) -> Result<Option<f32>, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(None) };
        match &parameter.values {
            Values::Numbers(list) if list.len() == 1 && parameter.kind == Kind::Float => Ok(Some(list[0])),
            Values::Integers(list) if list.len() == 1 => Ok(Some(list[0] as f32)),
            _ => Err(parameter.wrong("one number")),
        }
    }

    /// A single number, which must be finite.
    pub(super) fn finite(&self, name: &'static str, default: f32) -> Result<f32, FormatError> {
        let number = self.number(name)?.unwrap_or(default);
        if number.is_finite() {
            return Ok(number);
        }
        Err(FormatError::malformed(format!("'{name}' must be finite, not {number}"), self.place(name)))
    }

    /// A single whole number.
    pub(super) fn integer(&self, name: &'static str) -> Result<Option<i32>, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(None) };
        match &parameter.values {
            Values::Integers(list) if list.len() == 1 => Ok(Some(list[0])),
            _ => Err(parameter.wrong("one whole number")),
        }
    }

    /// A Boolean.
    pub(super) fn flag(&self, name: &'static str, default: bool) -> Result<bool, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(default) };
        match &parameter.values {
            Values::Bools(list) if list.len() == 1 => Ok(list[0]),
            _ => Err(parameter.wrong("true or false")),
        }
    }

    /// A single string.
    pub(super) fn text(&self, name: &'static str) -> Result<Option<&str>, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(None) };
        match parameter.text().filter(|_| parameter.kind == Kind::Text) {
            Some(text) => Ok(Some(text)),
            None => Err(parameter.wrong("one text")),
        }
    }

    /// All strings.
    pub(super) fn texts(&self, name: &'static str) -> Result<&[String], FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(&[]) };
        match &parameter.values {
            Values::Texts(list) => Ok(list),
            _ => Err(parameter.wrong("texts")),
        }
    }

    /// The name of a texture, if one is given.
    pub(super) fn texture(&self, name: &'static str) -> Option<(&str, &Span)> {
        let parameter = self.find_where(name, |p| p.kind == Kind::Texture)?;
        Some((parameter.text()?, &parameter.at))
    }

    /// All whole numbers.
    pub(super) fn integers(&self, name: &'static str) -> Result<&[i32], FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(&[]) };
        match &parameter.values {
            Values::Integers(list) => Ok(list),
            _ => Err(parameter.wrong("whole numbers")),
        }
    }

    /// All numbers.
    pub(super) fn numbers(&self, name: &'static str) -> Result<&[f32], FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(&[]) };
        parameter.numbers().ok_or_else(|| parameter.wrong("numbers"))
    }

    /// All points, vectors or normals.
    pub(super) fn triples(&self, name: &'static str) -> Result<Vec<Vec3>, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(Vec::new()) };
        let numbers = parameter.numbers().filter(|list| list.len().is_multiple_of(3));
        let numbers = numbers.ok_or_else(|| parameter.wrong("triples of numbers"))?;
        Ok(numbers.chunks_exact(3).map(Vec3::from_slice).collect())
    }

    /// A single point or vector.
    pub(super) fn triple(&self, name: &'static str, default: Vec3) -> Result<Vec3, FormatError> {
        match self.triples(name)?.as_slice() {
            [] => Ok(default),
            [one] if one.is_finite() => Ok(*one),
            _ => {
                let message = format!("'{name}' must be three finite numbers");
                Err(FormatError::malformed(message, self.place(name)))
            }
        }
    }

    /// All pairs of numbers, which version 3 also writes as plain numbers.
    pub(super) fn pairs(&self, name: &'static str) -> Result<Vec<Vec2>, FormatError> {
        let Some(parameter) = self.find(name) else { return Ok(Vec::new()) };
        let numbers = parameter.numbers().filter(|list| list.len().is_multiple_of(2));
        let numbers = numbers.ok_or_else(|| parameter.wrong("pairs of numbers"))?;
        Ok(numbers.chunks_exact(2).map(Vec2::from_slice).collect())
    }

    /// Warns about parameters that nothing looked up.
    pub(super) fn report_unused(&self, diagnostics: &mut Diagnostics) {
        for parameter in self.list.iter().filter(|p| !p.used.get()) {
            let known: Vec<String> = self.asked.borrow().iter().map(|name| (*name).to_owned()).collect();
            let meant = nearest_name(&shortened(&parameter.name), &known);
            let meant = meant.map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
            let what = format!("'{}' of {} is not used{meant}", shortened(&parameter.name), self.what);
            diagnostics.note(&what, || parameter.at.clone());
        }
    }
}
