//! How help is laid out: examples first, then the options under headings, the most used ones before all others.

/// Examples stand before the options, where they are seen without scrolling.
pub const TEMPLATE: &str = "{about}\n\n{usage-heading} {usage}{after-help}\n\n{all-args}\n";

/// Heading of the ten options that are used most.
pub const MAX_USED: &str = "Most used";
/// Heading: what of a scene is shown.
pub const WHAT: &str = "What";
/// Heading: how the picture looks.
pub const PICTURE: &str = "Picture";
/// Heading: which light is found.
pub const LIGHT: &str = "Light";
/// Heading: from where a model is seen, and what is around it.
pub const STUDIO: &str = "Camera and studio";
/// Heading: what makes it fast.
pub const SPEED: &str = "Speed";
/// Heading: how files are read.
pub const FILES: &str = "Files";
/// Heading: what is written and printed.
pub const OUTPUT: &str = "Output";
