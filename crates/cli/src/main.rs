//! The command line: bilux.
fn main() {}
