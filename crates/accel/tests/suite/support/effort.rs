//! The short and the long form of tests, for the suites of several crates.
#![allow(unreachable_pub)]

/// What a test takes in its short form, and in its long one, the step `long-suites`: see `docs/trust.md`.
pub fn effort<T>(short: T, long: T) -> T {
    if std::env::var_os("BILUX_LONG").is_some() { long } else { short }
}
