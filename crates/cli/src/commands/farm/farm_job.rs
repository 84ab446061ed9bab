//! A job for a farm, and the words of its commands.

use super::split::Split;

/// A job for a farm.
pub(super) struct FarmJob {
    /// The scene's name without folder and extension.
    pub(super) name: String,
    /// The scene file, in the job's folder of files.
    pub(super) scene: Word,
    /// The name of the picture, or of its frames.
    pub(super) picture: String,
    pub(super) split: Split,
    /// The pictures of a whole turn, if the frames are some of them.
    pub(super) turntable: Option<u32>,
    /// The options of `bilux render`.
    pub(super) options: Vec<Word>,
}

/// A word of a command line.
pub(super) enum Word {
    Text(String),
    /// A file in the job's folder of files, after some text, such as that of an option.
    File(String, String),
}

impl FarmJob {
    /// The words of a task's command after `bilux`, each as the caller writes them: `range` stands for the part that the
    /// task renders, `picture` for the file that it writes.
    pub(super) fn render(
        &self,
        picture: &str,
        range: &str,
        written: impl Fn(&Word) -> String,
    ) -> Vec<String> {
        let mut words = vec!["render".to_owned(), written(&self.scene), "-o".to_owned(), picture.to_owned()];
        words.extend([self.split.flag().to_owned(), range.to_owned()]);
        words.extend(
            self.turntable.into_iter().flat_map(|count| ["--turntable".to_owned(), count.to_string()]),
        );
        words.extend(self.options.iter().map(written));
        words
    }

    /// The parts that the merge reads, in a folder.
    pub(super) fn parts(&self, folder: &str) -> Vec<String> {
        self.split.ranges().iter().map(|range| format!("{folder}/{range}.exr")).collect()
    }
}
