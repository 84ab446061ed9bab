//! Files of luminaires: what a lamp emits in which direction. The table is [`LUMINAIRE_FORMATS`].

mod eulumdat;
mod file;
mod ies;
mod symmetry;
mod words;

pub use file::file_of;

use crate::bytes::text::whole_file;
use crate::input::reading::{Reading, Source};
use crate::{FormatError, ReadOptions};
use bilux_scene::{IntensityDistribution, Span};
use std::path::Path;
use std::sync::Arc;

/// All formats of luminaires.
pub static LUMINAIRE_FORMATS: &[LuminaireFormatEntry] = &[ies::FORMAT, eulumdat::FORMAT];

/// A row of [`LUMINAIRE_FORMATS`].
#[derive(Clone, Copy, Debug)]
pub struct LuminaireFormatEntry {
    /// True if the bytes look like this format.
    pub sniff: fn(&[u8]) -> bool,
    /// Reads a file.
    pub read: fn(&Source) -> Result<Measured, FormatError>,
}

/// Contents of a file of a luminaire.
#[derive(Debug)]
pub struct Measured {
    pub distribution: IntensityDistribution,
    /// Sentences on what the file says and is not used.
    pub warnings: Vec<String>,
}

/// Reads the intensity distribution of a lamp from a file in memory, IES LM-63 or EULUMDAT; `file` is what messages call it. The second
/// part is what the file says and is not used, in sentences.
///
/// # Errors
/// When the file is in no such format or broken, or takes more memory than allowed.
pub fn read_distribution(
    bytes: &[u8],
    file: &str,
    options: &ReadOptions,
) -> Result<(IntensityDistribution, Vec<String>), FormatError> {
    let source = Source { bytes, name: &Arc::from(file), folder: None };
    let mut reading = Reading::new(options, None);
    let measured = measured(&mut reading, &source)?;
    Ok((measured.distribution, measured.warnings))
}

/// Reads a file within the budget, of which it takes nothing for good.
fn measured(reading: &mut Reading, source: &Source) -> Result<Measured, FormatError> {
    // A number takes two bytes of text at least, and eight in memory, a few times.
    let bytes = 64 * source.bytes.len() as u64;
    reading.budget.take_bytes(bytes, source.name)?;
    let format = LUMINAIRE_FORMATS.iter().find(|row| (row.sniff)(source.bytes)).ok_or_else(|| {
        let message = "this is no file of a lamp: known are IES LM-63 (.ies) and EULUMDAT (.ldt)";
        FormatError::malformed(message, whole_file(source.name))
    })?;
    let measured = (format.read)(source)?;
    reading.budget.release(bytes);
    if measured.distribution.peak() <= 0.0 {
        let message = "all its intensities are 0: the lamp is dark";
        return Err(FormatError::malformed(message, whole_file(source.name)));
    }
    Ok(measured)
}

impl Reading<'_> {
    /// The intensity distribution of a file that a scene refers to, read only once.
    pub fn distribution(
        &mut self,
        folder: Option<&Path>,
        file: &str,
        at: &Span,
    ) -> Result<Arc<IntensityDistribution>, FormatError> {
        let path = self.locator.locate(folder, file, at)?;
        if let Some(known) = self.distributions.get(&path) {
            return Ok(known.clone());
        }
        let bytes = self.load(&path)?;
        let shown: Arc<str> = path.display().to_string().into();
        let Measured { distribution, warnings } =
            measured(self, &Source { bytes: &bytes, name: &shown, folder: None })?;
        self.release(bytes);
        self.note_faults(&format!("the lamp '{file}'"), &warnings, at);
        self.keep_distribution(distribution.bytes(), &shown)?;
        let distribution = Arc::new(distribution);
        self.distributions.insert(path, distribution.clone());
        Ok(distribution)
    }
}
