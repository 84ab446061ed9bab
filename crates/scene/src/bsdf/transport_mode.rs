//! Quantities that a path carries.

/// The quantity that a path carries: radiance from the lights, or importance from the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The path began at the camera: refraction scales radiance by the square of the relative index.
    Radiance,
    /// The path began at a light.
    Importance,
}

impl TransportMode {
    /// The quantity that the same path carries when traced from its other end.
    #[inline]
    pub fn reversed(self) -> TransportMode {
        match self {
            TransportMode::Radiance => TransportMode::Importance,
            TransportMode::Importance => TransportMode::Radiance,
        }
    }
}
