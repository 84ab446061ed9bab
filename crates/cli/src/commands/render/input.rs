//! The scene that `bilux render` renders, and the jobs that it makes of it.

use super::aov;
use super::targets::{Target, is_stdout};
use crate::arguments::{Common, Render};
use crate::commands::shared::given::Given;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_warnings;
use crate::process::interrupt::Interrupt;
use crate::process::{output, usage};
use anyhow::{Context, anyhow};
use bilux::checkpoint::checkpoint_path;
use bilux::formats::ReadOptions;
use bilux::pictures::formats::format_of_path;
use bilux::scene::{Parameters, SceneBuilder};
use bilux::transport::Window;
use bilux::transport::aovs::Aov;
use bilux::watch::Watched;
use bilux::{Built, Denoised, Job, JobRequest, Series};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A picture that is wanted.
#[derive(Clone, Copy)]
pub struct Wanted<'a> {
    /// The settings of the command line.
    pub user: &'a Parameters,
    /// The series that it belongs to.
    pub series: &'a Series,
    /// The name of its file.
    pub output: &'a Path,
}

/// A scene file, which may have to be read again for another time.
pub struct Input<'a> {
    pub path: &'a Path,
    given: Given<'a>,
    pub arguments: &'a Render,
    pub common: &'a Common,
    pub interrupt: &'a Interrupt,
    /// When the picture that is rendered next was started.
    pub begun: Cell<Instant>,
    /// The parts of a scene that the pictures of a turntable share.
    built: RefCell<Built>,
    /// Every warning so far, for `--json`.
    pub warnings: RefCell<Vec<String>>,
    /// Every note that was printed.
    notes: RefCell<BTreeSet<String>>,
    /// Every file that was read.
    pub files: RefCell<BTreeSet<PathBuf>>,
    /// The watch on these files, if they are watched.
    watched: Option<&'a Watched>,
}

impl Input<'_> {
    pub fn open<'a>(
        path: &'a Path,
        arguments: &'a Render,
        common: &'a Common,
        interrupt: &'a Interrupt,
        watched: Option<&'a Watched>,
    ) -> anyhow::Result<Input<'a>> {
        let given = Given::open(path, &arguments.input_format, common)?;
        let begun = Cell::new(Instant::now());
        let (built, warnings) = (RefCell::default(), RefCell::default());
        let (notes, files) = (RefCell::default(), RefCell::default());
        Ok(Input { path, given, arguments, common, interrupt, begun, built, warnings, notes, files, watched })
    }

    /// Prints warnings, and keeps them for `--json`.
    pub fn warn(&self, warnings: &[bilux::scene::Warning]) -> anyhow::Result<()> {
        self.warnings.borrow_mut().extend(warnings.iter().map(ToString::to_string));
        report_warnings(warnings, self.common)
    }

    /// Prints notes about a picture, each once however many pictures there are.
    pub fn note(&self, output: &Path, notes: &[String]) {
        let mut known = self.notes.borrow_mut();
        for note in notes.iter().filter(|note| known.insert((*note).clone())) {
            output::eprint(format_args!("{}: {note}", output.display()));
        }
    }

    /// Reads the scene as it is at a time in seconds; for frames, with its whole movement.
    pub fn read(&self, time: f32, whole_movement: bool) -> anyhow::Result<SceneBuilder> {
        let choices = &self.arguments.choices;
        let options = ReadOptions { whole_movement, ..read_options_with(self.common, choices, time) };
        let mut scene = self.given.scene(&options)?;
        check_choices(&scene, &self.arguments.choices).map_err(usage::wrong)?;
        self.arguments.studio.set_up(&mut scene, &options)?;
        self.files.borrow_mut().extend(scene.files.iter().cloned());
        if let Some(watched) = self.watched {
            watched.add(&scene.files);
        }
        Ok(scene)
    }

    /// The name and the contents of every file that was read.
    pub fn contents(&self) -> impl Iterator<Item = (String, anyhow::Result<Vec<u8>>)> + '_ {
        let piped = self.given.piped().into_iter();
        let piped = piped.map(|bytes| ("on standard input".to_owned(), Ok(bytes.to_vec())));
        let mut files = self.files.borrow().clone();
        if self.given.piped().is_none() {
            files.insert(self.path.to_owned());
        }
        let read = |path: PathBuf| {
            let bytes = std::fs::read(&path).with_context(|| format!("{}: cannot read it", path.display()));
            (path.display().to_string(), bytes)
        };
        piped.chain(files.into_iter().map(read))
    }

    /// Refuses to write over a file that was read.
    pub fn check_outputs(&self, Target { output, stats, .. }: &Target) -> anyhow::Result<()> {
        let mut beside = aov::files(self.arguments, output);
        if !is_stdout(output) {
            beside.push(checkpoint_path(output));
        }
        let mut written = beside.iter().chain([output]).chain(stats).filter(|file| !is_stdout(file));
        Ok(written.try_for_each(|file| bilux::formats::check_not_read(file, &self.files.borrow()))?)
    }

    /// Makes the job for a scene, with everything that the command line says about it.
    pub fn job(&self, scene: &SceneBuilder, wanted: Wanted) -> anyhow::Result<Job> {
        let arguments = self.arguments;
        let request = self.request(wanted)?;
        // From one picture of a turntable to the next only the camera moves.
        let (mut own, mut shared) = (Built::default(), self.built.borrow_mut());
        let built = if arguments.turntable.is_some() { &mut *shared } else { &mut own };
        let job = Job::with_built(scene, request, built)?;
        aov::check_job(arguments, &job)?;
        if let Some([x, y, width, height]) = arguments.crop {
            let s = job.settings();
            let fits = |at: u32, side: u32, most: u32| {
                side > 0 && at.checked_add(side).is_some_and(|end| end <= most)
            };
            if !fits(x, width, s.width) || !fits(y, height, s.height) {
                let size = format!("{}x{}", s.width, s.height);
                return Err(usage::wrong(anyhow!(
                    "--crop {x},{y},{width},{height}: the window must contain pixels and lie within the picture, \
                     which is {size}"
                )));
            }
        }
        Ok(job)
    }

    /// Request of the command line for a picture.
    fn request(&self, Wanted { user, series, output }: Wanted) -> anyhow::Result<JobRequest> {
        let (arguments, common) = (self.arguments, self.common);
        // A path is drawn into the picture that is shown, even if only a part of it is rendered.
        let is_whole = arguments.replay.is_some() || !arguments.is_part();
        let is_shown = is_whole && format_of_path(self.arguments.named(output))?.for_display;
        let denoised = if is_shown { Denoised::ForDisplay } else { Denoised::IfAsked };
        let mut request = JobRequest::from(user)
            .in_series(series.clone())
            .max_memory(common.max_memory)
            .begun_at(self.begun.get())
            .layers(&aov::kept(arguments))
            .denoised(denoised);
        if common.sandbox {
            request = request.sandboxed();
        }
        if let Some((from, to)) = arguments.samples {
            request = request.samples(from..to);
        }
        if let Some([x, y, width, height]) = arguments.crop {
            request = request.crop(Window { x, y, width, height });
        }
        Ok(if arguments.stats.is_some() { request.counting_work() } else { request })
    }

    /// The job with the next and the previous pose of a scene whose meshes move, as far as layers of motion need them.
    pub fn with_other_poses(&self, job: Job, scene: &SceneBuilder, wanted: Wanted) -> anyhow::Result<Job> {
        let layers = aov::layers(self.arguments);
        let needs = |is_needed: fn(Aov) -> bool| layers.iter().copied().any(is_needed);
        if !scene.inventory.moves() {
            return Ok(job);
        }
        let (time, frame) = (job.settings().time, 1.0 / job.settings().fps);
        let pose = |time: f32| {
            let mut posed = self.read(time, false)?;
            posed.movement = scene.movement.clone();
            self.job(&posed, wanted)
        };
        let job = if needs(Aov::needs_next) { job.moving_to(&pose(time + frame)?) } else { job };
        Ok(if needs(Aov::needs_previous) { job.moving_from(&pose(time - frame)?) } else { job })
    }
}
