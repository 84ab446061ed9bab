//! Sources: arrays of numbers or names, and how they are grouped.

use super::document::Document;
use super::element::{Element, Number};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// Rows of numbers.
pub(super) struct Table<T> {
    numbers: Vec<T>,
    stride: usize,
    offset: usize,
    /// The number of rows.
    pub(super) len: usize,
    /// The number of columns.
    pub(super) width: usize,
}

impl<T: Number> Table<T> {
    /// The table of a source. Its array may be that of another source.
    pub(super) fn read(
        source: Element,
        document: &Document,
        budget: &mut Budget,
    ) -> Result<Table<T>, FormatError> {
        let accessor = source.path(&["technique_common", "accessor"]);
        let (array, _) = array(source, document, &["float_array", "int_array"])
            .ok_or_else(|| source.error("this source has no array of numbers"))?;
        let numbers: Vec<T> = array.numbers(budget)?;
        let size = |name: &str| accessor.and_then(|accessor| accessor.attribute(name)?.trim().parse().ok());
        let stride = size("stride").filter(|&stride| stride > 0).unwrap_or(1);
        let offset = size("offset").unwrap_or(0);
        let there = numbers.len().saturating_sub(offset).div_ceil(stride);
        let named = accessor.and_then(|accessor| named_columns(accessor, stride));
        let needed = named.as_ref().and_then(|columns| columns.last()).map_or(stride, |last| last + 1);
        // Arrays are often longer or shorter than stated.
        let whole = (numbers.len() + stride).saturating_sub(offset + needed) / stride;
        let len = size("count").unwrap_or(there).min(whole);
        let Some(columns) = named else { return Ok(Table { numbers, stride, offset, len, width: stride }) };
        budget.take::<T>(len * columns.len(), source.file())?;
        let row = |row: usize| columns.iter().map(move |column| offset + row * stride + column);
        let numbers = (0..len).flat_map(row).map(|at| numbers[at]).collect();
        Ok(Table { numbers, stride: columns.len(), offset: 0, len, width: columns.len() })
    }

    /// A row; `None` beyond the end.
    #[inline]
    pub(super) fn row(&self, row: usize) -> Option<&[T]> {
        if row >= self.len {
            return None;
        }
        self.numbers.get(self.offset + row * self.stride..)?.get(..self.stride)
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &[T]> {
        (0..self.len).map_while(|row| self.row(row))
    }
}

/// Strides from which on a row is a matrix.
const MATRIX: usize = 9;

/// The columns of a row that parameters with names stand for, if these are some of them: a parameter without a name is not part of what
/// the accessor gives. [Collada 1.4.1, accessor]
fn named_columns(accessor: Element, stride: usize) -> Option<Vec<usize>> {
    let params = accessor.children_named("param").take(stride.min(MATRIX));
    let has_name = |param: &Element| param.attribute("name").is_some_and(|name| !name.trim().is_empty());
    let is_number = |param: &Element| !param.attribute("type").is_some_and(|kind| kind.contains('x'));
    let params: Vec<Element> = params.collect();
    let named: Vec<usize> = (0..params.len()).filter(|&column| has_name(&params[column])).collect();
    let is_some = !named.is_empty() && named.len() < stride && stride < MATRIX;
    (is_some && params.iter().all(is_number)).then_some(named)
}

/// The array of a source, which has one of these names, and its name.
fn array<'d>(source: Element<'d>, document: &Document<'d>, names: &[&str]) -> Option<(Element<'d>, &'d str)> {
    let is_array = |element: &Element| names.contains(&element.name());
    let stated = source.path(&["technique_common", "accessor"]).and_then(|a| a.attribute("source"));
    let found = stated.and_then(|uri| document.target(uri)).filter(is_array);
    let found = found.or_else(|| source.children().find(is_array))?;
    Some((found, found.name()))
}

/// Names or ids, and whether they are ids.
pub(super) fn names<'d>(
    source: Element<'d>,
    document: &Document<'d>,
    budget: &mut Budget,
) -> Result<(Vec<&'d str>, bool), FormatError> {
    let found = array(source, document, &["Name_array", "IDREF_array", "SIDREF_array"]);
    let (array, kind) = found.ok_or_else(|| source.error("this source has no array of names"))?;
    budget.take::<&str>(array.words().count(), source.file())?;
    Ok((array.words().collect(), kind == "IDREF_array"))
}

/// The most words in a name with spaces.
const MAX_WORDS: usize = 8;

/// Names like those of `names`, for a list that has more words than it states names: 3ds Max writes names with spaces in them. The
/// longest row of words that is known is one name.
pub(super) fn names_with_spaces<'d>(
    source: Element<'d>,
    document: &Document<'d>,
    budget: &mut Budget,
    is_known: impl Fn(&str) -> bool,
) -> Result<Vec<&'d str>, FormatError> {
    let (words, _) = names(source, document, budget)?;
    let array = array(source, document, &["Name_array", "IDREF_array", "SIDREF_array"]);
    let stated = array.and_then(|(array, _)| array.attribute("count")?.trim().parse::<usize>().ok());
    let text = array.map(|(array, _)| array.text()).unwrap_or_default();
    if stated.is_none_or(|stated| stated >= words.len())
        || text.split_ascii_whitespace().count() != words.len()
    {
        return Ok(words);
    }
    let place = |word: &str| word.as_ptr() as usize - text.as_ptr() as usize;
    let (mut names, mut rest) = (Vec::new(), &words[..]);
    while let Some(first) = rest.first() {
        let row = |length: &usize| &text[place(first)..place(rest[*length - 1]) + rest[*length - 1].len()];
        let length = (1..=rest.len().min(MAX_WORDS)).rev().find(|length| is_known(row(length))).unwrap_or(1);
        names.push(row(&length));
        rest = &rest[length..];
    }
    Ok(names)
}

/// An input of a primitive, a sampler or a controller.
#[derive(Clone, Copy)]
pub(super) struct Input<'d> {
    pub(super) semantic: &'d str,
    pub(super) source: Element<'d>,
    /// Place of the input's index among the indices of a vertex.
    pub(super) offset: usize,
    pub(super) set: Option<u32>,
}

/// The inputs of an element, of which those without a source are left out.
pub(super) fn inputs<'d>(element: Element<'d>, document: &Document<'d>) -> Vec<Input<'d>> {
    let input = |input: Element<'d>| {
        Some(Input {
            semantic: input.attribute("semantic")?,
            source: document.target(input.attribute("source")?)?,
            offset: input.attribute("offset").and_then(|offset| offset.trim().parse().ok()).unwrap_or(0),
            set: input.attribute("set").and_then(|set| set.trim().parse().ok()),
        })
    };
    // A primitive has a few inputs; a hostile one is not worth a search.
    element.children_named("input").take(MAX_INPUTS).filter_map(input).collect()
}

/// The most inputs of an element.
const MAX_INPUTS: usize = 64;

/// The source of the first input with this meaning.
pub(super) fn input<'d>(inputs: &[Input<'d>], semantic: &str) -> Option<Element<'d>> {
    inputs.iter().find(|input| input.semantic == semantic).map(|input| input.source)
}
