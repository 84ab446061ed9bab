//! The layout of the help: examples first, then the options under headings, the most used ones before all others.

/// Puts the examples before the options, so that they are visible without scrolling.
pub const TEMPLATE: &str = "{about}\n\n{usage-heading} {usage}{after-help}\n\n{all-args}\n";

/// The heading of the ten most used options.
pub const COMMON_OPTIONS: &str = "Most used";
/// The heading of options for which part of a scene is shown.
pub const WHAT: &str = "Scene";
/// The heading of options for how the picture looks.
pub const PICTURE: &str = "Picture";
/// The heading of options for how light is computed.
pub const LIGHT: &str = "Light";
/// The heading of options for where a model is seen from and what surrounds it.
pub const STUDIO: &str = "Camera and studio";
/// The heading of options for speed.
pub const SPEED: &str = "Speed";
/// The heading of options for how files are read.
pub const FILES: &str = "Files";
/// The heading of options for what is written and printed.
pub const OUTPUT: &str = "Output";

/// Headings in the order of the help.
pub const HEADINGS: [&str; 8] = [COMMON_OPTIONS, STUDIO, WHAT, LIGHT, PICTURE, SPEED, OUTPUT, FILES];

/// The place of the options of every command: after the command's own under the same heading.
pub const LAST: usize = 900;
