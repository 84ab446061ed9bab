//! Development only: contract suites, reference scenes and statistical tests.
