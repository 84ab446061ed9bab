//! The contents of a scene: meshes, textures, materials, lights and cameras.
//!
//! Formats fill a [`SceneBuilder`] with plain data ([`Spec`]s: a kind and its parameters, each with its location in the
//! file). [`SceneBuilder::build`] checks all of it against the tables ([`MATERIALS`], [`LIGHTS`], [`CAMERAS`]) and
//! returns an immutable [`Scene`] for the integrators.
//!
//! Nothing here generates random numbers: callers pass them in.

pub mod bsdf;
pub mod builder;
pub mod cameras;
pub mod classic;
pub mod geometry;
mod grid;
mod kept;
pub mod lights;
pub mod materials;
pub mod media;
pub mod mesh;
mod messages;
pub mod orientation;
pub mod parameters;
pub mod presets;
pub mod scene;
pub mod surface;
pub mod texture;
pub mod typed;

pub use bilux_accel::{Counters, CpuLevel, Primitive, Query, Ray};
pub use bsdf::wavelength;
pub use bsdf::wavelength::Wavelength;
pub use bsdf::{Bsdf, BsdfSample, TransportMode};
pub use builder::change;
pub use builder::change::{Change, Part, Which};
pub use builder::inventory;
pub use builder::inventory::{Animation, Inventory};
pub use builder::{BuiltParts, Object, SceneBuilder};
pub use cameras::{CAMERAS, Camera, CameraConnection, CameraMatrices, CameraSample};
pub use classic::{ClassicLight, ClassicMaterial};
pub use geometry::TreeWork;
pub use geometry::accel_choice::AccelChoice;
pub use geometry::axis::{Axis, UpHint};
pub use geometry::placed::Visibility;
pub use geometry::spheres;
pub use geometry::strokes;
pub use geometry::strokes::StrokeWidths;
pub use lights::{ClassicLighting, EmissionSample, LIGHTS, Light, LightSample, LightTracing};
pub use materials::{MATERIALS, Material, Nested};
pub use media::{FreePath, Medium, PHASES, Phase};
pub use mesh::Mesh;
pub use messages::error;
pub use messages::error::{SceneError, Warning};
pub use messages::span::Span;
pub use orientation::{Orientation, OrientationSource};
pub use parameters::intensity_distribution::{Goniometer, IntensityDistribution, MAX_ANGLES};
pub use parameters::{Parameters, Reader, Spec, Value};
pub use scene::{Enclosure, MAX_NESTED, Scene, Shading, Tracer};
pub use surface::Surface;
pub use texture::{TEXTURES, Texture};
