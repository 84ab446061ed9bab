//! Bidirectional transport: subpaths from a light or from the camera, their throughput, and how they are connected.
//!
//! A path with `s` vertices from the light and `t` from the camera can be found by several techniques, one for each
//! pair (s, t). All of them are tried, and each is weighted by the balance heuristic against all others
//! [Veach 1997, 10.2]. A subpath carries the sums over the other techniques along as it grows
//! [Georgiev 2012, eq. 31 to 48], so a weight costs no more for long paths than for short ones. In words:
//! [`Partial::d_vcm`](crate::techniques::mis::Partial::d_vcm) is how likely a connection to the vertex is, over how likely the random walk is to reach it;
//! [`Partial::d_vc`](crate::techniques::mis::Partial::d_vc) is the same for all vertices before it.
//!
//! Densities assume a film of area 1 and one light subpath per camera subpath. They leave out Russian roulette: all
//! that weights need is to be the same for all techniques.

mod batches;
mod behind_panes;
mod both_ends;
mod camera_queue;
mod camera_subpath;
mod connect;
mod crossing;
mod emitters;
mod light_paths;
mod light_tracing;
mod merging;
mod queue;
mod queued_sample;
mod subpath;
mod vertex;
#[cfg(test)]
mod weights;

pub(crate) use batches::{BATCH, BatchQueue};
pub(crate) use both_ends::BothEnds;
pub(crate) use camera_queue::CameraQueue;
pub(crate) use camera_subpath::CameraSubpath;
pub(crate) use crossing::crossed;
pub(crate) use emitters::{emitted, from_infinity};
pub(crate) use light_paths::{LightPaths, connect_to_camera, light_vertices};
pub(crate) use light_tracing::{LightTracing, LightTracingSamples};
pub(crate) use merging::merged;
pub(crate) use queue::{BothEndsQueue, BothEndsSamples};
pub(crate) use queued_sample::QueuedSample;
pub(crate) use subpath::Subpath;
pub(crate) use vertex::Vertex;
