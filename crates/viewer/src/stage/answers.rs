//! Answers to questions about the picture.

use super::command::Whole;
use super::measure::Measurement;
use super::show::Shown;
use super::{Stage, pick};
use crate::message::Question;
use crate::open_scene::{SCENE, Version};
use crate::settings::{Level, denoiser_of};
use bilux::Error;
use bilux::pictures::write_bytes;
use serde_json::json;
use std::path::Path;

impl Stage {
    /// Answers all questions that there is a picture for; the others wait for it.
    pub(super) fn answer_waiting(&mut self) {
        for question in self.questions.take() {
            match question {
                // Pixels are those of the picture in full size.
                Question::Pick { at, paths, answers }
                    if matches!(self.refinement.level, Level::Preview(1) | Level::Full) =>
                {
                    let answer = pick::answer(&self.session, at, paths);
                    let error = |error: Error| json!({ "say": "error", "message": error.to_string() });
                    // A browser that does not take its answers loses them.
                    let _ = answers.try_send(answer.unwrap_or_else(error).to_string());
                }
                Question::Save { format, to }
                    if self.refinement.level == Level::Full && self.session.samples() > 0 =>
                {
                    // Whoever has asked may have gone.
                    let _ = to.send(self.saved(format).map_err(|error| error.to_string()));
                }
                Question::Overlay { to } => {
                    // Whoever has asked may have gone.
                    let _ = to.send(self.overlay());
                }
                Question::Measure { answers } => {
                    let common = self.common.clone();
                    self.questions.measure(Some(Measurement::begin(self.session.job(), answers, common)));
                }
                early => self.questions.keep(early),
            }
        }
    }

    /// The scene with its edits, as an overlay of its file, which lies in the same folder.
    fn overlay(&self) -> String {
        let Version { words, changes, .. } = &*self.version;
        let asked = self.asked();
        let base = Path::new(words.get(SCENE).map_or("", String::as_str)).file_name().unwrap_or_default();
        let settings = self.whole().settings(&asked);
        let mut own = words.clone();
        if let Some(scene) = own.get_mut(SCENE) {
            "edited.toml".clone_into(scene);
        }
        let rest: Vec<&str> = own.iter().map(String::as_str).collect();
        let how = format!("# {} -o picture.png\n", rest.join(" ").replace('\n', " "));
        how + &bilux::formats::overlay(&base.to_string_lossy(), &settings, changes)
    }

    /// The picture as it will be in the end.
    pub(super) fn whole(&self) -> Whole {
        let job = self.session.job();
        let denoise = denoiser_of(job.settings()).unwrap_or("off").to_owned();
        Whole { size: self.viewpoint.size, samples: job.samples_per_pixel(), denoise }
    }

    /// The picture as a file of this format.
    fn saved(&self, format: &str) -> Result<Vec<u8>, Error> {
        let Some(outcome) = self.session.outcome() else { return Ok(Vec::new()) };
        let is_display = format == "png";
        let (picture, options) = Shown::Picture.of(
            self.session.job(),
            outcome,
            self.denoisers.chosen.as_ref().filter(|_| is_display),
        )?;
        Ok(write_bytes(format, &picture, &options)?)
    }
}
