//! Parts of files: text, numbers, archives, XML, within the memory that a reader may use; and the errors of reading them.

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
