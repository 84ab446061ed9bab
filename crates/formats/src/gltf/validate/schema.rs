//! How the tables say what an object of glTF may hold. [glTF 2.0, 5]

/// One kind of object.
pub(super) struct Kind {
    /// What such objects are called in messages, in the plural.
    pub(super) plural: &'static str,
    pub(super) properties: &'static [Property],
    /// Properties that are not listed are left alone.
    pub(super) is_open: bool,
}

/// One property of an object.
pub(super) struct Property {
    pub(super) key: &'static str,
    pub(super) shape: Shape,
    pub(super) is_required: bool,
}

/// What the value of a property has to be.
pub(super) enum Shape {
    /// Anything: a rule of its own looks at it.
    Any,
    Text,
    Flag,
    /// A whole number from the first to the second.
    Whole(u64, u64),
    /// One of some whole numbers.
    Code(&'static [u64]),
    /// One of some texts.
    Choice(&'static [&'static str]),
    Number(Range),
    /// So many numbers at least and at most.
    Numbers(usize, usize, Range),
    /// The index of an item of a list of the document.
    Index(&'static str),
    /// Indices of different items of such a list.
    Indices(&'static str),
    /// Indices of items of such a list, by name.
    Named(&'static str),
    /// Different texts.
    Texts,
    Object(&'static Kind),
    List(&'static Kind),
}

/// The numbers from `min` to `max`, without `min` itself where it is excluded.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) excludes_min: bool,
}

impl Range {
    pub(super) const ANY: Range = Range::between(f64::NEG_INFINITY, f64::INFINITY);
    pub(super) const UNIT: Range = Range::between(0.0, 1.0);
    pub(super) const SIGNED_UNIT: Range = Range::between(-1.0, 1.0);
    pub(super) const POSITIVE: Range = Range { excludes_min: true, ..Range::at_least(0.0) };

    pub(super) const fn between(min: f64, max: f64) -> Range {
        Range { min, max, excludes_min: false }
    }

    pub(super) const fn at_least(min: f64) -> Range {
        Range::between(min, f64::INFINITY)
    }

    pub(super) fn contains(&self, x: f64) -> bool {
        (self.min..=self.max).contains(&x) && !(self.excludes_min && x == self.min)
    }

    /// The range in words, to stand behind "must be".
    pub(super) fn words(&self) -> String {
        match (self.min.is_finite(), self.max.is_finite()) {
            (true, true) => format!("from {} to {}", self.min, self.max),
            (true, false) if self.excludes_min => format!("greater than {}", self.min),
            (true, false) => format!("{} or more", self.min),
            _ => "a finite number".to_owned(),
        }
    }
}

/// A kind of object with these properties and no others.
pub(super) const fn kind(plural: &'static str, properties: &'static [Property]) -> Kind {
    Kind { plural, properties, is_open: false }
}

/// A property that may be left out.
pub(super) const fn may(key: &'static str, shape: Shape) -> Property {
    Property { key, shape, is_required: false }
}

/// A property that must be there.
pub(super) const fn must(key: &'static str, shape: Shape) -> Property {
    Property { key, shape, is_required: true }
}

pub(super) const NAME: Property = may("name", Shape::Text);
