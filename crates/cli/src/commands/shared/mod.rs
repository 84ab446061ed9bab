//! Files, pictures, progress and advice of several commands.

pub(crate) mod advice;
pub(crate) mod checks;
pub(in crate::commands) mod given;
pub(in crate::commands) mod outputs;
pub(in crate::commands) mod pictures;
pub(crate) mod progress;
pub(in crate::commands) mod reading;
pub(crate) mod sandbox_paths;
