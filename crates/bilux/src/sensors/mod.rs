//! Sensors, laser scanners, and light by the time that it takes.

pub mod lidar;
pub mod sensing;
pub mod transient;
