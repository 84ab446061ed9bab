//! The library as programs use it: sessions, parts of pictures, fingerprints, and its examples.

mod examples;
mod fingerprint;
mod fingerprint_fields;
mod fog;
mod ground;
mod meters;
mod nested_formats;
mod own_light;
mod parts;
mod photometry;
mod request;
mod session;
mod typed;
