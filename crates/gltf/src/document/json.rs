//! A value of the document together with its location, as a JSON pointer. [Bryan 2013]

use bilux_import::FormatError;
use bilux_scene::Span;
use serde_json::Value;
use std::fmt::Write;
use std::sync::Arc;

/// A value and its location. Cheap to copy.
#[derive(Clone, Copy)]
pub(crate) struct JsonNode<'a> {
    value: &'a Value,
    file: &'a Arc<str>,
    path: [Step<'a>; LONGEST_PATH],
    length: usize,
}

#[derive(Clone, Copy)]
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

/// Deeper values are reported at the location of the value that contains them.
const LONGEST_PATH: usize = 10;

impl<'a> JsonNode<'a> {
    /// The whole document.
    pub(crate) fn root(value: &'a Value, file: &'a Arc<str>) -> JsonNode<'a> {
        JsonNode { value, file, path: [Step::Index(0); LONGEST_PATH], length: 0 }
    }

    fn step(&self, value: &'a Value, step: Step<'a>) -> JsonNode<'a> {
        let mut next = JsonNode { value, ..*self };
        if let Some(slot) = next.path.get_mut(self.length) {
            *slot = step;
            next.length += 1;
        }
        next
    }

    /// Location of the value: the file, and after `#` the pointer.
    pub(crate) fn at(&self) -> Span {
        let mut place = format!("{}#", self.file);
        for step in &self.path[..self.length] {
            // Writing to a String cannot fail.
            let _ = match step {
                Step::Key(key) => write!(place, "/{}", key.replace('~', "~0").replace('/', "~1")),
                Step::Index(index) => write!(place, "/{index}"),
            };
        }
        Span { file: place.into(), line: 0, column: 0 }
    }

    /// The location of a key of this value, whether or not the key exists.
    pub(crate) fn at_key(&self, key: &'a str) -> Span {
        self.step(self.value, Step::Key(key)).at()
    }

    /// An error at this location.
    pub(crate) fn error(&self, message: impl Into<String>) -> FormatError {
        FormatError::malformed(message, self.at())
    }

    fn wrong(&self, wanted: &str) -> FormatError {
        self.error(format!("this is {}, but must be {wanted}", self.shortened()))
    }

    /// The value as JSON text, truncated if it is long.
    pub(crate) fn shortened(&self) -> String {
        let found = self.value.to_string();
        if found.len() > 40 { format!("{}…", found.chars().take(40).collect::<String>()) } else { found }
    }

    /// The value itself.
    pub(crate) fn value(&self) -> &'a Value {
        self.value
    }

    /// Index of the value in the list that contains it.
    pub(crate) fn number_in_list(&self) -> Option<usize> {
        match self.path[..self.length].last() {
            Some(Step::Index(index)) => Some(*index),
            _ => None,
        }
    }

    /// The index of the item that contains its list: for a primitive, the index of its mesh.
    pub(crate) fn number_of_parent(&self) -> Option<usize> {
        match self.path[..self.length] {
            [.., Step::Index(index), Step::Key(_), Step::Index(_)] => Some(index),
            _ => None,
        }
    }

    /// The value of a key, if it exists.
    pub(crate) fn get(&self, key: &'a str) -> Option<JsonNode<'a>> {
        self.value.get(key).map(|value| self.step(value, Step::Key(key)))
    }

    /// The value of a required key.
    pub(crate) fn need(&self, key: &'a str) -> Result<JsonNode<'a>, FormatError> {
        self.get(key).ok_or_else(|| self.error(format!("'{key}' is missing here")))
    }

    /// An extension, if it is used on this value.
    pub(crate) fn extension(&self, name: &'a str) -> Option<JsonNode<'a>> {
        self.get("extensions")?.get(name)
    }

    /// The keys with their values.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&'a str, JsonNode<'a>)> + use<'a> {
        let here = *self;
        let entries = self.value.as_object().into_iter().flatten();
        entries.map(move |(key, value)| (key.as_str(), here.step(value, Step::Key(key))))
    }

    /// The items of a list.
    pub(crate) fn items(
        &self,
    ) -> Result<impl ExactSizeIterator<Item = JsonNode<'a>> + Clone + use<'a>, FormatError> {
        let here = *self;
        let items = self.value.as_array().ok_or_else(|| self.wrong("a list"))?;
        Ok(items.iter().enumerate().map(move |(i, value)| here.step(value, Step::Index(i))))
    }

    /// The items of a list; none if this is not a list.
    pub(crate) fn children(&self) -> impl Iterator<Item = JsonNode<'a>> + use<'a> {
        let here = *self;
        let items = self.value.as_array().into_iter().flatten().enumerate();
        items.map(move |(i, value)| here.step(value, Step::Index(i)))
    }

    /// The items of the list under a key; none if the key does not exist.
    pub(crate) fn list(&self, key: &'a str) -> Result<Vec<JsonNode<'a>>, FormatError> {
        self.get(key).map_or(Ok(Vec::new()), |list| Ok(list.items()?.collect()))
    }

    /// One item of the list under a key, such as one mesh of the document.
    pub(crate) fn item(&self, key: &'a str, index: usize) -> Option<JsonNode<'a>> {
        let list = self.get(key)?;
        let value = list.value.as_array()?.get(index)?;
        Some(list.step(value, Step::Index(index)))
    }

    pub(crate) fn is_object(&self) -> bool {
        self.value.is_object()
    }

    /// The value as a finite number.
    pub(crate) fn as_number(&self) -> Result<f64, FormatError> {
        let number = self.value.as_f64().filter(|x| (*x as f32).is_finite());
        number.ok_or_else(|| self.wrong("a number that is finite in 32 bits"))
    }

    /// The value as an index or a count, from 0. `3.0` counts as 3.
    pub(crate) fn as_count(&self) -> Result<usize, FormatError> {
        let whole = |x: &f64| x.fract() == 0.0 && (0.0..9e15).contains(x);
        let count = self.value.as_u64().or_else(|| self.value.as_f64().filter(whole).map(|x| x as u64));
        let count = count.and_then(|count| usize::try_from(count).ok());
        count.ok_or_else(|| self.wrong("a whole number, 0 or more"))
    }

    pub(crate) fn as_text(&self) -> Result<&'a str, FormatError> {
        self.value.as_str().ok_or_else(|| self.wrong("text"))
    }

    pub(crate) fn number(&self, key: &'a str) -> Result<Option<f64>, FormatError> {
        self.get(key).map(|node| node.as_number()).transpose()
    }

    pub(crate) fn count(&self, key: &'a str) -> Result<Option<usize>, FormatError> {
        self.get(key).map(|node| node.as_count()).transpose()
    }

    pub(crate) fn text(&self, key: &'a str) -> Result<Option<&'a str>, FormatError> {
        self.get(key).map(|node| node.as_text()).transpose()
    }

    pub(crate) fn as_switch(&self) -> Result<bool, FormatError> {
        self.value.as_bool().ok_or_else(|| self.wrong("true or false"))
    }

    pub(crate) fn switch(&self, key: &'a str) -> Result<bool, FormatError> {
        self.get(key).map_or(Ok(false), |node| node.as_switch())
    }

    /// A list of exactly `N` numbers.
    pub(crate) fn numbers<const N: usize>(&self, key: &'a str) -> Result<Option<[f64; N]>, FormatError> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let wrong = || node.wrong(&format!("a list of {N} numbers"));
        let items = node.items().map_err(|_| wrong())?;
        if items.len() != N {
            return Err(wrong());
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = item.as_number()?;
        }
        Ok(Some(numbers))
    }

    /// The name of the item in the file; empty if it has none.
    pub(crate) fn name(&self) -> &'a str {
        self.value.get("name").and_then(Value::as_str).unwrap_or_default()
    }
}
