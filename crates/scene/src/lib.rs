//! The contents of a scene: meshes, textures, materials, lights and cameras.
//!
//! Formats fill a [`SceneBuilder`] with plain data ([`Spec`]s: a kind and its parameters, each with its location in the
//! file). [`SceneBuilder::build`] checks all of it against the tables ([`MATERIALS`], [`LIGHTS`], [`CAMERAS`]) and
//! returns an immutable [`Scene`] for the integrators.
//!
//! Nothing here generates random numbers: callers pass them in.

mod accel_choice;
mod axis;
pub mod bsdf;
pub mod builder;
pub mod cameras;
pub mod change;
pub mod classic;
mod closed;
mod corners;
pub mod error;
mod footprint;
pub mod generators;
pub mod geometry;
mod grid;
mod intensity_distribution;
pub mod inventory;
mod kept;
mod light_sample;
pub mod lights;
pub mod materials;
pub mod media;
pub mod mesh;
mod octaves;
pub mod orientation;
pub mod parameters;
mod placed;
pub mod presets;
pub mod scene;
mod sides;
mod span;
pub mod spheres;
pub mod strokes;
pub mod surface;
pub mod texture;
pub mod typed;
pub mod wavelength;

pub use accel_choice::AccelChoice;
pub use axis::{Axis, UpHint};
pub use bilux_accel::{Counters, CpuLevel, Primitive, Query, Ray};
pub use bsdf::{Bsdf, BsdfSample, TransportMode};
pub use builder::{BuiltParts, Object, SceneBuilder};
pub use cameras::{CAMERAS, Camera, CameraConnection, CameraMatrices, CameraSample};
pub use change::{Change, Part, Which};
pub use classic::{ClassicLight, ClassicMaterial};
pub use error::{SceneError, Warning};
pub use geometry::TreeWork;
pub use intensity_distribution::{Goniometer, IntensityDistribution, MAX_ANGLES};
pub use inventory::{Animation, Inventory};
pub use lights::{ClassicLighting, EmissionSample, LIGHTS, Light, LightSample, LightTracing};
pub use materials::{MATERIALS, Material, Nested};
pub use media::{FreePath, Medium, PHASES, Phase};
pub use mesh::Mesh;
pub use orientation::{Orientation, OrientationSource};
pub use parameters::{Parameters, Reader, Spec, Value};
pub use placed::Visibility;
pub use scene::{Enclosure, MAX_NESTED, Scene, Shading, Tracer};
pub use span::Span;
pub use strokes::StrokeWidths;
pub use surface::Surface;
pub use texture::{TEXTURES, Texture};
pub use wavelength::Wavelength;
