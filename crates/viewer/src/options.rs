//! What a viewer is started with.

use bilux::scene::{Parameters, SceneBuilder};
use std::net::SocketAddr;

/// Opens the scene, again whenever its files have changed. The error is a message for people.
pub(crate) type Open = Box<dyn Fn() -> Result<SceneBuilder, String> + Send>;

/// What a viewer shows, to whom.
pub struct Options {
    /// Where it listens; port 0 is any that is free. Anywhere but on the loopback interface, the address that it prints
    /// has a random token in it, without which nothing is served.
    pub address: SocketAddr,
    /// What the page is titled: the scene's name.
    pub title: String,
    /// Whether those who watch may change materials.
    pub may_edit: bool,
    /// The settings that the user asks for.
    pub settings: Parameters,
    /// The memory that the picture may take, in bytes.
    pub max_memory: u64,
    /// The words of the command line that renders the scene as it is opened, up to the settings of the picture: `bilux`,
    /// `render`, the scene, and so on.
    pub command: Vec<String>,
    /// Opens the scene.
    pub open: Open,
}
