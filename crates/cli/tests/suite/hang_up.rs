//! SIGHUP in the programs that tests start.
#![cfg(unix)]

use signal_hook::consts::SIGHUP;
use signal_hook::flag;
use std::sync::Arc;

/// Makes SIGHUP what it is by default in programs that are started from now on, also where this process ignores it, as under
/// `nohup`: programs inherit that a signal is ignored, and not that it has a handler.
pub(crate) fn is_not_ignored() {
    flag::register(SIGHUP, Arc::default()).unwrap();
}
