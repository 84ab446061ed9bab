//! Whether a Linux program is self-contained: nothing in its headers asks for a loader.

use anyhow::{Context, Result, bail};

/// The type of the program header that names a loader (`PT_INTERP`).
const INTERPRETER: u32 = 3;

/// Checks that a 64-bit little-endian ELF program is static.
///
/// # Errors
/// If it asks for a loader, or is not such a program.
pub(super) fn require_static(program: &[u8]) -> Result<()> {
    if !program.starts_with(&[0x7f, b'E', b'L', b'F', 2, 1]) {
        bail!("it is no 64-bit little-endian ELF program");
    }
    let offset = usize::try_from(u64::from_le_bytes(bytes(program, 32)?))?;
    let size = usize::from(u16::from_le_bytes(bytes(program, 54)?));
    let count = usize::from(u16::from_le_bytes(bytes(program, 56)?));
    for header in 0..count {
        let at = header.checked_mul(size).and_then(|at| at.checked_add(offset)).context("it is cut short")?;
        if u32::from_le_bytes(bytes(program, at)?) == INTERPRETER {
            bail!("it asks for a loader");
        }
    }
    Ok(())
}

fn bytes<const N: usize>(program: &[u8], at: usize) -> Result<[u8; N]> {
    let end = at.checked_add(N);
    let slice = end.and_then(|end| program.get(at..end)).context("it is cut short")?;
    Ok(slice.try_into()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program with one header of this type.
    fn program(kind: u32) -> Vec<u8> {
        let mut program = vec![0x7f, b'E', b'L', b'F', 2, 1];
        program.resize(64, 0);
        program[32] = 64;
        program[54] = 56;
        program[56] = 1;
        program.extend(kind.to_le_bytes());
        program
    }

    #[test]
    fn a_loader_is_found() {
        assert!(require_static(&program(1)).is_ok());
        let error = require_static(&program(INTERPRETER)).map_err(|error| error.to_string());
        assert_eq!(error, Err("it asks for a loader".to_owned()));
    }

    #[test]
    fn files_that_are_not_programs_are_errors() {
        for length in 0..program(1).len() {
            assert!(require_static(&program(1)[..length]).is_err(), "{length}");
        }
    }
}
