//! Repository chores: test, tidy, docs, dist.
fn main() {}
