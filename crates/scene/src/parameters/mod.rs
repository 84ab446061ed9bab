//! Parameters as written in scene files, and how a row of a table reads them.
pub(crate) mod intensity_distribution;
mod quantity;
mod value;

use crate::grid::Grid;
use crate::messages::error::{SceneError, nearest_name};
pub use crate::messages::span::Span;
use crate::parameters::intensity_distribution::IntensityDistribution;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{DVec3, Rgb, Vec3};
pub use quantity::units_of;
pub(crate) use quantity::{Measure, Quantity};
use std::sync::Arc;
pub use value::Value;
use value::describe;

/// Keys with their values, in the order written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters(pub Vec<(String, Value, Span)>);

impl Parameters {
    /// The value of a key.
    pub fn find(&self, key: &str) -> Option<(&Value, &Span)> {
        self.0.iter().find(|(k, ..)| k == key).map(|(_, v, s)| (v, s))
    }

    /// Sets a key, replacing an older value.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.set_at(key, value.into(), Span::default());
    }

    /// Sets a key that was written at a location.
    pub fn set_at(&mut self, key: &str, value: Value, span: Span) {
        match self.0.iter_mut().find(|(k, ..)| k == key) {
            Some(row) => (row.1, row.2) = (value, span),
            None => self.0.push((key.to_owned(), value, span)),
        }
    }
}

/// An entry to build from a table: the row's name, and its parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spec {
    /// The user's name for it; may be empty.
    pub name: String,
    /// The row's name, such as `dielectric`.
    pub kind: String,
    /// Parameters of the entry.
    pub parameters: Parameters,
    /// Place where the spec was written.
    pub span: Span,
}

impl Spec {
    /// A spec made by the program.
    pub fn new(name: &str, kind: &str) -> Spec {
        Spec { name: name.to_owned(), kind: kind.to_owned(), ..Spec::default() }
    }

    /// The number under a key, if there is one.
    pub fn number(&self, key: &str) -> Option<f32> {
        self.parameters.find(key)?.0.as_number().map(|x| x as f32)
    }

    /// The colour under a key, if there is one; white for a texture. A flux in place of an intensity stays a flux: [`crate::lights::in_numbers`]
    /// makes it an intensity first.
    pub fn colour(&self, key: &str) -> Option<Rgb> {
        match self.parameters.find(key)?.0 {
            Value::List(list) => {
                let channel = |i: usize| list.get(i)?.as_number().map(|x| x as f32);
                Some(Rgb::new(channel(0)?, channel(1)?, channel(2)?))
            }
            Value::Texture(_) => Some(Rgb::WHITE),
            Value::Text(text) => Some(Quantity::read(text).ok()?.colour),
            one => one.as_number().map(|x| Rgb::grey(x as f32)),
        }
    }

    /// The three numbers under a key, if there are any.
    pub fn vector(&self, key: &str) -> Option<Vec3> {
        self.parameters.find(key).and_then(|(value, _)| triple(value)).map(Vec3::from)
    }

    /// The value under a key, or a default.
    pub fn value_or(&self, key: &str, default: impl Into<Value>) -> Value {
        self.parameters.find(key).map_or_else(|| default.into(), |(value, _)| value.clone())
    }

    /// Sets a parameter.
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Spec {
        self.parameters.set(key, value);
        self
    }

    /// True for an environment that only the camera sees.
    pub fn is_backdrop(&self) -> bool {
        matches!(self.parameters.find("backdrop"), Some((Value::Bool(true), _)))
    }
}

/// Reads a spec's parameters according to its row.
///
/// It comes from [`Reader::new`], which rejects unknown keys.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    spec: &'a Spec,
    parameters: &'static [Parameter],
}

impl<'a> Reader<'a> {
    /// Checks that every key belongs to the row, and that every value is of its kind and within its range.
    ///
    /// # Errors
    /// The first key or value that is wrong, with its location and, for a key, the nearest name.
    pub fn new(spec: &'a Spec, entry: &Entry) -> Result<Reader<'a>, SceneError> {
        for (key, value, span) in &spec.parameters.0 {
            let is_flag = span.file.starts_with("--");
            let Some(parameter) = entry.parameters.iter().find(|p| p.name == key) else {
                let names = entry.parameters.iter().map(|p| p.name);
                return Err(SceneError::unknown(format!("parameter of {}", entry.name), key, names, span));
            };
            check_kind(parameter, value).map_err(|wanted| SceneError::BadValue {
                // A flag is its own name.
                what: if is_flag { "the value".to_owned() } else { format!("{}.{}", entry.name, key) },
                wanted,
                found: describe(value),
                at: span.clone(),
            })?;
        }
        for parameter in entry.parameters {
            if parameter.default.is_empty() && spec.parameters.find(parameter.name).is_none() {
                return Err(SceneError::Missing {
                    what: format!("{}.{} ({})", entry.name, parameter.name, parameter.summary),
                    at: spec.span.clone(),
                });
            }
        }
        Ok(Reader { spec, parameters: entry.parameters })
    }

    /// True when the file sets it, false when the default applies.
    pub fn is_given(&self, key: &str) -> bool {
        self.spec.parameters.find(key).is_some()
    }

    /// Place where a key was written, or otherwise the whole spec.
    pub fn span(&self, key: &str) -> &Span {
        self.spec.parameters.find(key).map_or(&self.spec.span, |(_, span)| span)
    }

    /// A number.
    pub fn number(&self, key: &str) -> f32 {
        self.value(key).as_number().unwrap_or_default() as f32
    }

    /// A number in double precision.
    pub fn number_f64(&self, key: &str) -> f64 {
        self.value(key).as_number().unwrap_or_default()
    }

    /// The minimum and maximum of a key; both 0 if it is not a number.
    pub fn range(&self, key: &str) -> [f64; 2] {
        match self.parameters.iter().find(|p| p.name == key).map(|p| p.kind) {
            Some(ParameterKind::Number { min, max } | ParameterKind::NumberTexture { min, max }) => {
                [min, max]
            }
            _ => [0.0; 2],
        }
    }

    /// A whole number.
    pub fn integer(&self, key: &str) -> i64 {
        self.value(key).as_number().unwrap_or_default() as i64
    }

    /// True or false.
    pub fn bool(&self, key: &str) -> bool {
        self.value(key) == Value::Bool(true)
    }

    /// Text or a choice.
    pub fn text(&self, key: &str) -> String {
        match self.value(key) {
            Value::Text(text) => text,
            _ => String::new(),
        }
    }

    /// Three numbers, or one for all three.
    pub fn vector(&self, key: &str) -> Vec3 {
        triple(&self.value(key)).map_or(Vec3::ZERO, Vec3::from)
    }

    /// Three numbers, or one for all three, in double precision.
    pub fn vector_f64(&self, key: &str) -> DVec3 {
        match self.value(key) {
            Value::List(list) => {
                let number = |i: usize| list.get(i).and_then(Value::as_number).unwrap_or_default();
                DVec3::new(number(0), number(1), number(2))
            }
            one => DVec3::splat(one.as_number().unwrap_or_default()),
        }
    }

    /// A parameter, except these, that has another value in another spec of the same row.
    pub(crate) fn differs(&self, other: &Reader, except: &[&str]) -> Option<&'static str> {
        let rows = self.parameters.iter().map(|row| row.name).filter(|name| !except.contains(name));
        rows.into_iter().find(|name| self.value(name) != other.value(name))
    }

    /// A colour; white if a texture is given.
    pub fn colour(&self, key: &str) -> Rgb {
        match self.value(key) {
            Value::Text(text) => quantity::shown(&text)
                .unwrap_or_else(|| Quantity::read(&text).map_or(Rgb::WHITE, |quantity| quantity.colour)),
            value => triple(&value).map_or(Rgb::WHITE, Rgb::from_array),
        }
    }

    /// The stops of a gradient, in order.
    pub fn stops(&self, key: &str) -> Vec<(f32, Rgb)> {
        stops(&self.value(key)).unwrap_or_default()
    }

    /// The texture given in place of a colour or a number, if any.
    pub fn texture(&self, key: &str) -> Option<usize> {
        match self.value(key) {
            Value::Texture(index) => Some(index),
            _ => None,
        }
    }

    /// The grid under a key, if there is one.
    pub fn grid(&self, key: &str) -> Option<Arc<Grid>> {
        match self.value(key) {
            Value::Grid(grid) => Some(grid),
            _ => None,
        }
    }

    /// The intensity distribution under a key, if there is one.
    pub fn distribution(&self, key: &str) -> Option<Arc<IntensityDistribution>> {
        match self.value(key) {
            Value::Distribution(distribution) => Some(distribution),
            _ => None,
        }
    }

    /// The material under a key, as an index; an invalid index if none is given.
    pub fn material(&self, key: &str) -> usize {
        match self.value(key) {
            Value::Material(index) => index,
            _ => usize::MAX,
        }
    }

    fn value(&self, key: &str) -> Value {
        if let Some((value, _)) = self.spec.parameters.find(key) {
            return value.clone();
        }
        let row = self.parameters.iter().find(|p| p.name == key);
        row.map_or(Value::Bool(false), |p| parse_default(p.kind, p.default))
    }
}

impl Spec {
    /// The keys whose values differ from their row's defaults.
    pub fn differing<'s>(&'s self, entry: &'s Entry) -> impl Iterator<Item = &'s str> {
        let is_default = |key: &str, value: &Value| {
            let Some(row) = entry.parameters.iter().find(|p| p.name == key) else { return false };
            let default = parse_default(row.kind, row.default);
            *value == default || triple(value).is_some_and(|given| Some(given) == triple(&default))
        };
        let given = self.parameters.0.iter().filter(move |(key, value, _)| !is_default(key, value));
        given.map(|(key, ..)| key.as_str())
    }
}

/// A default as written in tables: `true`, `1.5`, `1 1 1` or a word.
fn parse_default(kind: ParameterKind, text: &str) -> Value {
    match kind {
        ParameterKind::Bool => Value::Bool(text == "true"),
        ParameterKind::Text
        | ParameterKind::Texture
        | ParameterKind::Grid
        | ParameterKind::Distribution
        | ParameterKind::Material
        | ParameterKind::Choice(_) => Value::Text(text.to_owned()),
        _ => {
            let numbers: Vec<Value> =
                text.split_whitespace().filter_map(|w| w.parse().ok().map(Value::Number)).collect();
            match <[Value; 1]>::try_from(numbers) {
                Ok([one]) => one,
                Err(many) => Value::List(many),
            }
        }
    }
}

fn triple(value: &Value) -> Option<[f32; 3]> {
    match value {
        Value::List(list) => {
            let numbers: Option<Vec<f32>> = list.iter().map(|v| v.as_number().map(|x| x as f32)).collect();
            numbers?.try_into().ok()
        }
        one => one.as_number().map(|x| [x as f32; 3]),
    }
}

/// Pairs of a position and a colour, if the value is a list of these.
fn stops(value: &Value) -> Option<Vec<(f32, Rgb)>> {
    let Value::List(list) = value else { return None };
    let stop = |value: &Value| match value {
        Value::List(pair) => match &pair[..] {
            [at, colour] => Some((at.as_number()? as f32, Rgb::from_array(triple(colour)?))),
            _ => None,
        },
        _ => None,
    };
    list.iter().map(stop).collect()
}

/// The expected value, where a value has the wrong kind or is out of range.
fn check_kind(parameter: &Parameter, value: &Value) -> Result<(), String> {
    let number_in = |v: Option<f64>, min: f64, max: f64| v.is_some_and(|x| x >= min && x <= max);
    if let (
        ParameterKind::Colour { min, max } | ParameterKind::ColourTexture { min, max },
        Value::Text(text),
    ) = (parameter.kind, value)
    {
        return quantity::colour_of(parameter, text, [min, max]).map(|_| ());
    }
    let (fits, wanted) = match parameter.kind {
        ParameterKind::Bool => (matches!(value, Value::Bool(_)), "true or false".to_owned()),
        ParameterKind::Integer { min, max } => (
            matches!(value, Value::Integer(i) if (min..=max).contains(i)),
            format!("a whole number from {min} to {max}"),
        ),
        ParameterKind::Number { min, max } => {
            (number_in(value.as_number(), min, max), format!("a number from {min} to {max}"))
        }
        ParameterKind::Colour { min, max } => (
            triple(value).is_some_and(|t| t.iter().all(|&c| number_in(Some(f64::from(c)), min, max))),
            format!("a colour [r, g, b] with each from {min} to {max}"),
        ),
        ParameterKind::ColourTexture { min, max } => (
            matches!(value, Value::Texture(_))
                || triple(value).is_some_and(|t| t.iter().all(|&c| number_in(Some(f64::from(c)), min, max))),
            format!("a colour [r, g, b] with each from {min} to {max}, or {{ texture = \"FILE\" }}"),
        ),
        ParameterKind::NumberTexture { min, max } => (
            matches!(value, Value::Texture(_)) || number_in(value.as_number(), min, max),
            format!("a number from {min} to {max}, or {{ texture = \"FILE\" }}"),
        ),
        ParameterKind::Texture => (matches!(value, Value::Texture(_)), "{ texture = \"FILE\" }".to_owned()),
        ParameterKind::Grid => {
            (matches!(value, Value::Grid(_)), "{ grid = \"FILE\" } or { kind = \"cloud\" }".to_owned())
        }
        ParameterKind::Distribution => {
            (matches!(value, Value::Distribution(_)), "the name of an IES or EULUMDAT file".to_owned())
        }
        ParameterKind::Stops { min, max } => {
            let is_right = |stops: Vec<(f32, Rgb)>| {
                let within = |c: f32| number_in(Some(f64::from(c)), min, max);
                let rise = stops.windows(2).all(|pair| pair[0].0 <= pair[1].0);
                let all = stops.iter().all(|(at, c)| at.is_finite() && c.to_array().into_iter().all(within));
                !stops.is_empty() && rise && all
            };
            let wanted = "stops [[position, [r, g, b]], …] whose positions never decrease";
            (stops(value).is_some_and(is_right), format!("{wanted}, with each channel from {min} to {max}"))
        }
        ParameterKind::Vector => (
            triple(value).is_some_and(|t| t.iter().all(|c| c.is_finite())),
            "three numbers [x, y, z]".to_owned(),
        ),
        ParameterKind::Choice(words) => (
            matches!(value, Value::Text(t) if words.contains(&t.as_str())),
            format!("one of {}{}", words.join(", "), meant(value, words)),
        ),
        ParameterKind::Text => (matches!(value, Value::Text(_)), "text".to_owned()),
        ParameterKind::Material => (matches!(value, Value::Material(_)), "the name of a material".to_owned()),
    };
    if fits { Ok(()) } else { Err(wanted) }
}

/// The word most likely meant by a misspelt one.
fn meant(value: &Value, words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
    let nearest = if let Value::Text(text) = value { nearest_name(text, &words) } else { None };
    nearest.map_or_else(String::new, |word| format!("; did you mean '{word}'?"))
}
