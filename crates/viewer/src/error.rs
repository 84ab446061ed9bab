//! Errors of a viewer.

use std::io;
use std::net::SocketAddr;

/// Anything that keeps a viewer from starting, or ends it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// Another program listens there.
    #[error("cannot listen on {address}: the port is in use: name another one, or 0 for any that is free")]
    PortInUse {
        /// The address.
        address: SocketAddr,
    },
    /// The system does not let it listen there.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The error of the system.
        source: io::Error,
    },
    /// The scene cannot be opened.
    #[error("{0}")]
    Open(String),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Scene(#[from] bilux::Error),
    /// The system gives no threads or no random numbers.
    #[error("cannot start: {0}")]
    Start(String),
}
