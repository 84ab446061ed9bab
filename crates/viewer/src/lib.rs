//! A window to watch light in: a server that shows one scene to any number of browsers, and the page that they show.
//!
//! One thread keeps the scene that is open, with its edits (`open_scene`). Each visitor has a view (`stage`): a thread that
//! owns a [`bilux::Session`], refines its picture, publishes the newest frame, and takes requests from an `inbox`. All of
//! them share the scene and its trees, and take `turns`. The `server` has a task for each browser: it sends that browser
//! the newest frame whenever the browser has seen the one before, so that a slow browser neither slows the render nor takes
//! memory.

mod catalogue;
mod common;
mod dropped;
mod error;
mod eye;
mod frame;
mod inbox;
mod message;
mod open_scene;
mod options;
mod secret;
mod server;
mod settings;
mod stage;
mod threads;
mod turns;
mod visitors;
mod watch;

pub use error::ViewerError;
pub use options::{Opening, Options};
pub use server::Server;
