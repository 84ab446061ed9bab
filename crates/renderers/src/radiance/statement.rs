//! The statements of a file: primitives, and commands whose output would stand in their place.

use super::command::Command;
use super::kinds::{self, KINDS, Kind, Row};
use super::lexer::{Lexer, Word};
use super::sky_model::{Sky, given};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::float::parse_f64;
use bilux_import::bytes::text::{name_of, quoted};
use bilux_import::input::names::unknown;
use bilux_scene::Span;
use std::rc::Rc;
use std::sync::Arc;

/// A statement.
#[derive(Clone, Debug)]
pub(super) enum Statement {
    Primitive(Rc<Primitive>),
    Command(Rc<Command>),
}

/// A surface, or something that modifies surfaces.
#[derive(Clone, Debug)]
pub(super) struct Primitive {
    /// The name of what modifies it.
    pub(super) modifier: Rc<str>,
    pub(super) kind: Kind,
    /// Type in the file.
    pub(super) word: &'static str,
    pub(super) name: Rc<str>,
    /// Words of the primitive; of an alias the name that it stands for.
    pub(super) strings: Vec<Rc<str>>,
    pub(super) reals: Vec<f64>,
    /// The brightness of a sky, for a pattern as generators of skies write it.
    pub(super) sky: Option<Rc<Sky>>,
    pub(super) at: Span,
}

impl Primitive {
    /// The first three numbers, as a colour.
    pub(super) fn colour(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.reals.get(i).copied().unwrap_or(0.0))
    }
}

/// Reads all statements of a file.
pub(super) fn parse(
    file: &Arc<str>,
    bytes: &[u8],
    budget: &mut Budget,
) -> Result<Vec<Statement>, FormatError> {
    let mut lexer = Lexer::new(file, bytes);
    let mut statements = Vec::new();
    while let Some(first) = lexer.peek() {
        budget.take::<Statement>(1, file)?;
        statements.push(if first == b'!' {
            let (line, at) = lexer.line();
            budget.take_bytes(4 * line.len() as u64, file)?;
            Statement::Command(Rc::new(Command::parse(&line[1..], lexer.place(at))))
        } else {
            Statement::Primitive(Rc::new(primitive(&mut lexer, budget, file)?))
        });
    }
    Ok(statements)
}

/// Reads a primitive: modifier, type and name, then the numbers of words, of integers and of reals, each followed by as many.
fn primitive(lexer: &mut Lexer, budget: &mut Budget, file: &Arc<str>) -> Result<Primitive, FormatError> {
    let modifier = needed(lexer, "a modifier")?;
    let word = needed(lexer, "the type of a primitive")?;
    let name = needed(lexer, "the name of a primitive")?;
    let at = lexer.place(modifier.at);
    let Some(row) = kinds::named(word.text) else {
        let names = KINDS.iter().map(|row| row.name);
        return Err(unknown("type", &name_of(word.text), names, &lexer.place(word.at)));
    };
    budget.take_bytes((size_of::<Primitive>() + modifier.text.len() + 2 * name.text.len()) as u64, file)?;
    let mut made = Primitive {
        modifier: name_of(modifier.text).into(),
        kind: row.kind,
        word: row.name,
        name: name_of(name.text).into(),
        strings: Vec::new(),
        reals: Vec::new(),
        sky: None,
        at,
    };
    if row.kind == Kind::Alias {
        let of = needed(lexer, "the name that an alias stands for")?;
        budget.take_bytes(2 * of.text.len() as u64, file)?;
        made.strings.push(name_of(of.text).into());
        return Ok(made);
    }
    for _ in 0..count(lexer, &made, "words")? {
        let word = needed(lexer, "a word")?;
        budget.take_bytes((2 * size_of::<Rc<str>>() + 2 * word.text.len()) as u64, file)?;
        made.strings.push(name_of(word.text).into());
    }
    for _ in 0..count(lexer, &made, "integers")? {
        lexer.word_after_comments().ok_or_else(|| cut_off(lexer, "an integer"))?;
    }
    let reals = count(lexer, &made, "numbers")?;
    check_count(row, &made, reals)?;
    budget.take::<f64>(reals, file)?;
    made.reals.reserve_exact(reals);
    for _ in 0..reals {
        let word = lexer.word_after_comments().ok_or_else(|| cut_off(lexer, "a number"))?;
        made.reals.push(real(lexer, word)?);
    }
    if made.kind == Kind::Pattern {
        made.sky = given(&made.strings, &made.reals, &made.at).map(Rc::new);
    }
    Ok(made)
}

/// Number of words, integers or numbers that come next; no more than the file can hold.
fn count(lexer: &mut Lexer, of: &Primitive, what: &str) -> Result<usize, FormatError> {
    let wanted = format!("the number of {what} of the {} '{}'", of.word, of.name);
    let word = lexer.word_after_comments().ok_or_else(|| cut_off(lexer, &wanted))?;
    let count = std::str::from_utf8(word.text).ok().and_then(|text| text.parse::<u64>().ok());
    let Some(count) = count else {
        let message =
            format!("{} stands where {wanted} should: it must be a whole number", quoted(word.text));
        return Err(lexer.error(message, word.at));
    };
    match usize::try_from(count).ok().filter(|&count| count <= lexer.most_words()) {
        Some(count) => Ok(count),
        None => {
            let message = format!("{wanted} is {count}, and the file ends before: correct it");
            Err(lexer.error(message, word.at))
        }
    }
}

/// An error if a type does not take so many numbers.
fn check_count(row: &Row, of: &Primitive, reals: usize) -> Result<(), FormatError> {
    let is_polygon = row.kind == Kind::Polygon;
    let fits = match row.reals {
        [] => !is_polygon || reals >= 9 && reals.is_multiple_of(3),
        known => known.contains(&reals),
    };
    if fits {
        return Ok(());
    }
    let wanted = match is_polygon {
        true => "three for each of at least three corners".to_owned(),
        false => row.reals.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or "),
    };
    let message = format!("the {} '{}' has {reals} numbers, and needs {wanted}", of.word, of.name);
    Err(FormatError::malformed(message, of.at.clone()))
}

fn real(lexer: &Lexer, word: Word) -> Result<f64, FormatError> {
    match parse_f64(word.text) {
        Some(number) if number.is_finite() => Ok(number),
        _ => Err(lexer.error(format!("{} stands where a number should", quoted(word.text)), word.at)),
    }
}

/// The next word.
fn needed<'a>(lexer: &mut Lexer<'a>, what: &str) -> Result<Word<'a>, FormatError> {
    lexer.word().ok_or_else(|| cut_off(lexer, what))
}

fn cut_off(lexer: &Lexer, wanted: &str) -> FormatError {
    lexer.error(format!("the file ends where {wanted} should be"), usize::MAX)
}
