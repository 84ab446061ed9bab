//! Distinguishes a wrong command line (exit status 2) from work that failed (1).

use std::fmt;
use std::path::Path;

/// An error that the command line is to blame for.
struct UsageError(anyhow::Error);

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&crate::process::output::message(&self.0))
    }
}

impl fmt::Debug for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for UsageError {}

/// Blames the command line for an error.
pub fn wrong(error: impl Into<anyhow::Error>) -> anyhow::Error {
    anyhow::Error::new(UsageError(error.into()))
}

/// Adds the scene's name to an error, unless it already has it or is about the command line.
pub fn naming(scene: &Path, error: anyhow::Error) -> anyhow::Error {
    let is_about_scene = !is_command_line(&error) && !error.is::<crate::process::output::PrintError>();
    if !is_about_scene || scene == Path::new("-") {
        return error;
    }
    let name = scene.display().to_string();
    if format!("{error:#}").contains(&name) { error } else { error.context(name) }
}

/// True for errors that the command line is to blame for: marked as such, or about a value that a flag gave.
pub fn is_command_line(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let scene = match cause.downcast_ref::<bilux::Error>() {
            Some(bilux::Error::Scene(scene)) => Some(scene),
            _ => cause.downcast_ref::<bilux::scene::SceneError>(),
        };
        cause.is::<UsageError>()
            || scene.is_some_and(|s| s.at().file.starts_with("--"))
            || cause.downcast_ref().is_some_and(is_about_options)
    })
}

/// True for errors that only options can have caused.
fn is_about_options(error: &bilux::Error) -> bool {
    use bilux::transport::{FilmError, RenderError};
    let bilux::Error::Render(error) = error else { return false };
    matches!(
        error,
        RenderError::StopOfPart
            | RenderError::IntervalOfPattern
            | RenderError::Samples { .. }
            | RenderError::Pixel { .. }
            | RenderError::Film(FilmError::Window { .. })
    )
}
