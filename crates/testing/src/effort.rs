//! The short and the long form of tests.

/// Effort of a test in its short form, and in its long one, the step `long-suites`: see `docs/trust.md`.
pub fn effort<T>(short: T, long: T) -> T {
    if is_long() { long } else { short }
}

/// Whether tests run in their long form.
pub(crate) fn is_long() -> bool {
    std::env::var_os("BILUX_LONG").is_some()
}
