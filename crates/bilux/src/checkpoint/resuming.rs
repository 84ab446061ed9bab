//! Goes on with a render that was saved.

use super::file::SavedRender;
use super::identity::Identity;
use crate::error::CheckpointError;
use crate::{Error, Job, Outcome};
use bilux_transport::{Observer, Progress};
use std::time::Duration;

/// Renders a picture, all of it or what a checkpoint lacks, while an observer sees it. The time that was spent on the
/// checkpoint counts for a time limit.
///
/// # Errors
/// As for [`Job::render`]; and if the checkpoint is that of another picture.
pub fn render_from(
    job: &Job,
    from: Option<SavedRender>,
    progress: &dyn Progress,
    observer: &dyn Observer,
) -> Result<Outcome, Error> {
    let Some(SavedRender { head, checkpoint, path }) = from else {
        return job.render_observed(None, Duration::ZERO, progress, observer);
    };
    let differences = Identity::of(job).differences(&head.identity);
    if !differences.is_empty() {
        return Err(CheckpointError::OtherPicture { path, differences }.into());
    }
    // Rendering has a clock of its own.
    let aside = head.spent.saturating_sub(checkpoint.rendering());
    job.render_observed(Some(checkpoint), aside, progress, observer)
}
