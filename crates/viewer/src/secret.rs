//! Words that nobody can guess.

use crate::ViewerError;

/// The number of random bytes.
const BYTES: usize = 16;

/// Another secret, in hexadecimal digits.
///
/// # Errors
/// If the system has no random numbers.
pub(crate) fn secret() -> Result<String, ViewerError> {
    let mut bytes = [0u8; BYTES];
    let failed =
        |error: getrandom::Error| ViewerError::Start(format!("there are no random numbers: {error}"));
    getrandom::fill(&mut bytes).map_err(failed)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
