//! Enforcement of `--sandbox` by the kernel, where it can, whatever a faulty decoder may try.

mod enforcement;
#[cfg(target_os = "linux")]
mod landlock;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub use self::landlock::{available, restrict};
#[cfg(not(target_os = "linux"))]
pub use self::unsupported::{available, restrict};
pub use enforcement::Enforcement;
