//! What files are made of: text, numbers, archives, XML, within the memory that a reader may use; and what can be wrong with them.

pub mod archive;
pub mod blocks;
pub mod budget;
pub mod error;
pub mod float;
pub mod gzip;
pub mod opening;
pub mod spellings;
pub mod text;
pub mod xml;
pub mod zipped;
