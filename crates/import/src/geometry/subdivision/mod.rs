//! Subdivision surfaces: a cage of polygons, refined towards its smooth limit. [Catmull 1978, Loop 1987, DeRose 1998]

mod cage;
mod edges;
mod layers;
mod meshes;
mod pending;
mod rules;

pub use cage::{Attribute, Cage};
pub use layers::Linear;
pub use pending::PendingCage;
pub use rules::Scheme;
