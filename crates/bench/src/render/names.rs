//! Names that users give, checked against those that there are.

use bilux::Error;
use bilux::scene::error::nearest_name;

/// # Errors
/// If the name of a `what` is not one of those that are known.
pub(super) fn check(what: &str, name: &str, known: &[String]) -> Result<(), Error> {
    if known.iter().any(|k| k == name) {
        return Ok(());
    }
    let hint = match nearest_name(name, known) {
        Some(nearest) => format!("did you mean '{nearest}'?"),
        None => format!("there are {}", known.join(", ")),
    };
    Err(Error::Settings(format!("there is no {what} '{name}'; {hint}")))
}
