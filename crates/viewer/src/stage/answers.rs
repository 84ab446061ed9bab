//! Answers to questions about the picture.

use super::show::Shown;
use super::{Level, Stage, pick};
use crate::message::Question;
use bilux::Error;
use bilux::pictures::write_bytes;
use serde_json::json;

impl Stage {
    /// Answers all questions that there is a picture for; the others wait for it.
    pub(super) fn answer_waiting(&mut self) {
        for question in std::mem::take(&mut self.questions) {
            match question {
                // Pixels are those of the picture in full size.
                Question::Pick { at, paths, answers }
                    if matches!(self.level, Level::Preview(1) | Level::Full) =>
                {
                    let answer = pick::answer(&self.session, at, paths);
                    let error = |error: Error| json!({ "say": "error", "message": error.to_string() });
                    // A browser that does not take its answers loses them.
                    let _ = answers.try_send(answer.unwrap_or_else(error).to_string());
                }
                Question::Save { format, to } if self.level == Level::Full && self.session.samples() > 0 => {
                    // Whoever has asked may have gone.
                    let _ = to.send(self.saved(format).map_err(|error| error.to_string()));
                }
                early => self.questions.push(early),
            }
        }
    }

    /// The picture as a file of this format.
    fn saved(&self, format: &str) -> Result<Vec<u8>, Error> {
        let Some(outcome) = self.session.outcome() else { return Ok(Vec::new()) };
        let is_display = format == "png";
        let (picture, options) =
            Shown::Picture.of(self.session.job(), outcome, self.denoiser.as_ref().filter(|_| is_display))?;
        Ok(write_bytes(format, &picture, &options)?)
    }
}
