//! Checkpoints of long renders, as files: another process goes on from one to the same bytes.
//!
//! A file has a head, which says of which picture it is, then what [`bilux_transport::Standing::write`] writes, and the
//! hash of all of that. It is written beside the old one and then renamed over it, so there is always a whole one.
//!
//! ```
//! use bilux::checkpoint::{CheckpointWriter, SavedRender, render_from};
//! use bilux::prelude::*;
//! # use std::time::Duration;
//!
//! # let folder = tempfile::tempdir().unwrap();
//! let file = folder.path().join("cornell.png.checkpoint");
//! let scene = bilux::generate(&Spec::new("", "cornell"))?;
//! let job = Job::new(&scene, JobRequest::new().size(16, 16).spp(4))?;
//! let writer = CheckpointWriter::new(&job, &file, Some(Duration::ZERO));
//! let whole = render_from(&job, None, &Quiet, &writer)?;
//! // Some other day:
//! let saved = SavedRender::read(&file, u64::MAX)?;
//! let rest = render_from(&job, Some(saved), &Quiet, &bilux::transport::Unobserved)?;
//! assert_eq!(rest.picture()?, whole.picture()?);
//! # Ok::<(), bilux::Error>(())
//! ```

mod file;
mod identity;
mod resuming;
mod writer;

pub use crate::error::CheckpointError;
pub use file::{Head, SavedRender, checkpoint_path};
pub use identity::Identity;
pub use resuming::render_from;
pub use writer::CheckpointWriter;
