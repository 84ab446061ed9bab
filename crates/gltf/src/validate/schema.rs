//! The schema of the tables that describe glTF objects. [glTF 2.0, 5]

/// A kind of object.
pub(super) struct Kind {
    /// The plural that messages use for such objects.
    pub(super) plural: &'static str,
    pub(super) properties: &'static [Property],
    /// True if properties that are not listed are ignored.
    pub(super) is_open: bool,
}

/// A property of an object.
pub(super) struct Property {
    pub(super) key: &'static str,
    pub(super) shape: Shape,
    pub(super) is_required: bool,
}

/// The required shape of a property's value.
pub(super) enum Shape {
    /// Anything: a rule of its own checks it.
    Any,
    Text,
    Flag,
    /// A whole number in the inclusive range.
    Whole(u64, u64),
    /// One of these whole numbers.
    Code(&'static [u64]),
    /// One of these texts.
    Choice(&'static [&'static str]),
    Number(Range),
    /// A list of numbers with this minimum and maximum length.
    Numbers(usize, usize, Range),
    /// The index of an item in a list of the document.
    Index(&'static str),
    /// Distinct indices into such a list.
    Indices(&'static str),
    /// Indices into such a list, by name.
    Named(&'static str),
    /// Distinct texts.
    Texts,
    Object(&'static Kind),
    List(&'static Kind),
}

/// The numbers from `min` to `max`, optionally excluding `min` itself.
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

    /// The range in words, for use after "must be".
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

/// An optional property.
pub(super) const fn may(key: &'static str, shape: Shape) -> Property {
    Property { key, shape, is_required: false }
}

/// A required property.
pub(super) const fn must(key: &'static str, shape: Shape) -> Property {
    Property { key, shape, is_required: true }
}

pub(super) const NAME: Property = may("name", Shape::Text);

/// The singular of a list's name.
pub(super) fn singular(list: &str) -> &'static str {
    match list {
        "accessors" => "accessor",
        "bufferViews" => "buffer view",
        "buffers" => "buffer",
        "cameras" => "camera",
        "images" => "image",
        "materials" => "material",
        "meshes" => "mesh",
        "nodes" => "node",
        "samplers" => "sampler",
        "scenes" => "scene",
        "skins" => "skin",
        _ => "texture",
    }
}
