//! Physically right pictures on plain CPUs: the library that joins all of Bilux.
