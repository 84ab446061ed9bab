//! Options that a viewer is started with.

use bilux::scene::{Parameters, SceneBuilder};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Opens a scene, again whenever its files have changed. The error is a message for people.
pub(crate) type Open = Box<dyn Fn(&Opening) -> Result<SceneBuilder, String> + Send>;

/// Choices with which a scene is opened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Opening {
    /// A file in the place of the scene that the viewer was started with.
    pub file: Option<PathBuf>,
    /// The variant of its materials, by name, if another one than at the start.
    pub variant: Option<String>,
    /// The animation that it plays, by name or by number, if another one than at the start.
    pub animation: Option<String>,
    /// The environment that lights it, one of [`Options::environments`], if another one than at the start.
    pub environment: Option<String>,
    /// The time in seconds at which it is posed, if another one than at the start.
    pub time: Option<f32>,
}

/// The choice that stands for what was chosen at the start.
pub(crate) const AS_OPENED: &str = "";

/// Options of a viewer: what it shows, to whom.
pub struct Options {
    /// The address on which it listens; port 0 is any that is free. Anywhere but on the loopback interface, the address that it
    /// prints has a random token in it, without which nothing is served.
    pub address: SocketAddr,
    /// The title of the page: the name of the scene's file.
    pub title: String,
    /// Whether all see the same view, instead of each their own.
    pub shared: bool,
    /// The maximum number of browsers that watch at the same time.
    pub visitors: usize,
    /// Whether no library may be loaded any more.
    pub sandboxed: bool,
    /// The environments that may light the scene from all around, by the words of the option `--env`.
    pub environments: Vec<String>,
    /// Whether those who watch may change materials, lights and cameras, and drop files in.
    pub may_edit: bool,
    /// Whether files that are dropped in may be kept in a temporary folder while they are shown.
    pub may_drop: bool,
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
