//! A window to watch light in: a server that shows one scene to any number of browsers, and the page that they show.
//!
//! One thread owns a [`bilux::Session`] and refines its picture (`stage`). It publishes the newest frame, and takes
//! requests from an `inbox`. The `server` has a task for each browser: it sends that browser the newest frame
//! whenever the browser has seen the one before, so that a slow browser neither slows the render nor takes memory.

mod catalogue;
mod dropped;
mod error;
mod eye;
mod frame;
mod inbox;
mod message;
mod options;
mod server;
mod stage;
mod watch;

pub use error::ViewerError;
pub use options::{Opening, Options};
pub use server::Server;
