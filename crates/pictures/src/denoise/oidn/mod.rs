//! `oidn`: Open Image Denoise, loaded at run time if its library is found; nothing is linked. Where there is time,
//! albedo and normals are denoised first by themselves, and then passed as clean features. [Áfra 2025]

mod effort;
mod library;
mod places;
mod python;
mod shared;

use super::builtin::Builtin;
use super::noisy::{self, Noisy, Source};
use super::task::{Denoiser, DenoiserEntry, Task};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use effort::Effort;
use library::{Device, Filter};
use std::sync::Arc;
use std::thread::JoinHandle;

pub(super) const ENTRY: DenoiserEntry = DenoiserEntry {
    entry: Entry {
        name: "oidn",
        summary: "Open Image Denoise 2: a trained neural network, if its library is installed",
        source: "Áfra 2025",
        parameters: &[],
    },
    time: |task| Effort::within(task.time, task.pixels(), task.thread_count()).1,
    is_library: true,
    find,
};

/// Loads the library, unless it is already loaded. Whether it was found is reported when it is requested.
pub(super) fn load(threads: usize) {
    let _ = shared::device(threads, true);
}

fn find(task: &Task) -> Result<Box<dyn Denoiser>, String> {
    let device = shared::device(task.threads, !task.sandboxed)?;
    let (effort, _) = Effort::within(task.time, task.pixels(), task.thread_count());
    Ok(Box::new(Oidn {
        device: device.clone(),
        effort,
        threads: task.threads,
        ahead: PendingFilters::begin(task, device, effort),
    }))
}

/// On smaller pictures the network changes the brightness.
const MIN_SIDE: usize = 16;

struct Oidn {
    device: Arc<Device>,
    effort: Effort,
    threads: usize,
    ahead: PendingFilters,
}

/// The filters for a picture: for albedo and normals, where they are denoised, and for light.
struct Filters {
    albedo: Option<Filter>,
    normal: Option<Filter>,
    light: Filter,
}

impl Filters {
    fn new(
        device: &Arc<Device>,
        size: (usize, usize),
        effort: Effort,
        [albedo, normal]: [bool; 2],
    ) -> Result<Filters, String> {
        let feature = |input| Filter::new(device, size, &Effort::for_feature(input));
        let cleans = |there: bool| effort.cleans() && there;
        let inputs: &[&str] = match (albedo, normal) {
            (true, true) => &["color", "albedo", "normal"],
            (true, false) => &["color", "albedo"],
            // Normals help only together with albedo.
            (false, _) => &["color"],
        };
        Ok(Filters {
            albedo: cleans(albedo).then(|| feature(&["albedo"])).transpose()?,
            normal: cleans(albedo && normal).then(|| feature(&["normal"])).transpose()?,
            light: Filter::new(device, size, &effort.for_light(inputs))?,
        })
    }

    /// Sets a feature as an auxiliary input of the light filter, denoised first if there is a filter for that.
    fn take_feature(&mut self, name: &str, pixels: &mut dyn Iterator<Item = [f32; 3]>) -> Result<(), String> {
        let filter = if name == "albedo" { &mut self.albedo } else { &mut self.normal };
        let Some(to) = self.light.input(name) else { return Ok(()) };
        match filter {
            Some(filter) => {
                filter.input(name).into_iter().flatten().zip(pixels).for_each(|(to, pixel)| *to = pixel);
                to.copy_from_slice(filter.run()?);
            }
            None => to.iter_mut().zip(pixels).for_each(|(to, pixel)| *to = pixel),
        }
        Ok(())
    }
}

/// Filters that are prepared on a separate thread while the picture is rendered; `None` where its size is not known.
struct PendingFilters(std::sync::Mutex<Option<JoinHandle<Option<Filters>>>>, (usize, usize));

impl PendingFilters {
    fn begin(task: &Task, device: Arc<Device>, effort: Effort) -> PendingFilters {
        let size = task.size;
        let worth_it = size.0.min(size.1) >= MIN_SIDE;
        let prepare = move || Filters::new(&device, size, effort, [true; 2]).ok();
        // Without a thread they are made when they are needed.
        let begin = || std::thread::Builder::new().spawn(prepare).ok();
        PendingFilters(std::sync::Mutex::new(worth_it.then(begin).flatten()), size)
    }

    /// The filters, if they suit this picture; they can be taken only once.
    fn take(&self, size: (usize, usize), features: [bool; 2]) -> Option<Filters> {
        let thread = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take()?;
        let filters = thread.join().ok().flatten()?;
        (size == self.1 && features == [true; 2]).then_some(filters)
    }
}

impl Denoiser for Oidn {
    fn describe(&self) -> String {
        self.device.describe()
    }

    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError> {
        let size = source.size();
        if size.0.min(size.1) < MIN_SIDE {
            return Builtin::new(self.threads)?.denoise(source);
        }
        let mut noisy = source.rows(0..size.1)?;
        let coverage = noisy.take_coverage();
        if let Some(coverage) = &coverage {
            noisy.extend(coverage);
        }
        let failed = |what: String| PictureError::NoDenoiser { what: format!("Open Image Denoise: {what}") };
        let features = [noisy.albedo.is_some(), noisy.normal.is_some()];
        let filters = match self.ahead.take(size, features) {
            Some(filters) => Ok(filters),
            None => Filters::new(&self.device, size, self.effort, features),
        };
        let mut sum: Vec<Rgb> = reserved("denoising", noisy.pixels())?;
        sum.resize(noisy.pixels(), Rgb::BLACK);
        filters.and_then(|mut filters| add_layers(&mut filters, &noisy, &mut sum)).map_err(failed)?;
        noisy::multiply(&mut sum, coverage.as_deref());
        Ok(sum)
    }
}

/// Adds each layer after denoising it.
fn add_layers(filters: &mut Filters, noisy: &Noisy, sum: &mut [Rgb]) -> Result<(), String> {
    if let Some(albedo) = &noisy.albedo {
        filters.take_feature("albedo", &mut albedo.iter().map(|c| c.to_array()))?;
    }
    if let Some(normal) = &noisy.normal {
        filters.take_feature("normal", &mut normal.iter().copied())?;
    }
    for layer in &noisy.layers {
        let to = filters.light.input("color").into_iter().flatten();
        to.zip(&layer.colour).for_each(|(to, colour)| *to = colour.to_array());
        let smooth = filters.light.run()?;
        sum.iter_mut().zip(smooth).for_each(|(sum, &pixel)| *sum += Rgb::from_array(pixel));
    }
    Ok(())
}
