//! The rows of the tables of formats, and how files are read and written by them.

pub mod calibrations;
pub mod files;
pub mod formats;
pub mod grids;
pub mod luminaires;
pub mod vdb;
