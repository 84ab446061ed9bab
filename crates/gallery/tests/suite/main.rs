//! The built-in scenes.

mod generators;
