//! Enforcement of a sandbox by the kernel.

/// Rules of a sandbox that the kernel enforces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enforcement {
    /// Nothing.
    Nothing,
    /// Which files may be opened.
    Files,
    /// Which files may be opened, and that no TCP connection is made.
    FilesAndNetwork,
}

impl Enforcement {
    /// The wording that `-V` prints.
    pub fn describe(self) -> &'static str {
        match self {
            Enforcement::Nothing => "not enforced by this kernel",
            Enforcement::Files => "enforced by the kernel (files)",
            Enforcement::FilesAndNetwork => "enforced by the kernel (files and network)",
        }
    }
}
