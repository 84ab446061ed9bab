//! The light of a picture in parts: what scatters at most once and the rest, and the light of each group of lights.
//!
//! The samples of the picture are taken once more, along the same paths, and every piece of light goes to the films of the
//! parts that it belongs to. So the parts add up to the picture, but for the steps of the films.

use crate::bidirectional::BothEnds;
use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::{TILE, Window};
use crate::film::{Film, scale_exponent};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::passes::layers::Strategy;
use crate::passes::photon_tracing::iterations;
use crate::photons::{Merging, Photons};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::{Iterations, Splats};
use crate::sampling::task::{FoundLight, Record, Task};
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use crate::techniques::optical_path::{LengthBins, OpticalPath, PathPoint};
use crate::techniques::{Contribution, LightPathVisitor, Tally, Technique};
use bilux_math::parallel::{install, try_for_each};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Camera, Scene, Tracer};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Edges of the longest paths of direct light: the light scatters once.
const DIRECT_EDGES: u32 = 2;

/// Division of the light of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightDivision {
    /// By scattering events: what a path brings after at most one of them, or after more.
    pub by_events: bool,
    /// By lights: the group of each light of the scene. Empty if light is not divided so.
    pub groups: Vec<u32>,
    /// The number of groups. What shines without being a light of the scene is in the last.
    pub group_count: u32,
    /// By the optical length of paths, from where the camera's ray begins. Only connected paths have one: integrators that merge photons
    /// find all light outside of the intervals.
    pub by_length: Option<LengthBins>,
}

/// The parts.
pub struct LightParts {
    /// Light that scatters at most once on its way, and the rest, if they were asked for.
    pub by_events: Option<[Film; 2]>,
    /// The light of each group.
    pub groups: Vec<Film>,
    /// The light of each interval of lengths, and last what is outside of them: too long, too short, or from infinity.
    pub by_length: Vec<Film>,
}

impl dyn PixelIntegrator {
    /// True when its light can be divided into parts ([`light_parts`]), or that of whatever it chooses.
    pub fn has_light_parts(&self) -> bool {
        self.chooser().is_some() || self.has_strategies() || self.reports_light()
    }
}

/// Takes the requested samples again, and divides their light. `None` when it was cancelled, or the integrator has no parts
/// ([`has_light_parts`](trait.PixelIntegrator.html)).
///
/// # Errors
/// As [`crate::render()`].
pub fn light_parts(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    division: &LightDivision,
    progress: &dyn Progress,
) -> Result<Option<LightParts>, RenderError> {
    settings.check()?;
    let pool = threads(settings)?;
    let plan = install(&pool, || integrator.plan(scene, camera, &settings.for_planning()));
    let integrator = plan.as_ref().map_or(integrator, |plan| &*plan.integrator);
    if !integrator.has_light_parts() {
        return Ok(None);
    }
    let whole = Window::whole(settings.width, settings.height);
    let tiles = if integrator.splats() { whole } else { settings.window() }.tiles(TILE);
    progress.begin(settings.sample_count(integrator));
    let sums = Sums::new(scene, settings, division)?;
    for samples in iterations(integrator, &settings.samples) {
        install(&pool, || {
            let rays = || integrator.camera_rays(scene, camera, settings).by_light();
            let photons = sums.photons(integrator, &rays(), &whole.tiles(TILE), samples.start)?;
            let mut eye = rays();
            eye.photons = photons.as_ref();
            try_for_each(&tiles, |tile| sums.add_tile(integrator, &eye, *tile, &samples, progress))
        })?;
    }
    if progress.is_cancelled() { Ok(None) } else { Ok(Some(sums.parts(integrator)?)) }
}

/// Light that was found so far.
struct Sums<'a> {
    settings: &'a RenderSettings,
    division: &'a LightDivision,
    scale: i32,
    /// The light of each part, in the pixel of the camera subpath.
    films: Mutex<Vec<Film>>,
    /// The splats of each part.
    splats: Mutex<Vec<Iterations>>,
}

impl LightDivision {
    /// The number of parts: two by events, one for each group, one for each interval of lengths, and one for all other lengths.
    fn count(&self) -> usize {
        self.by_length.map_or(self.first_length(), |bins| self.first_length() + bins.count as usize + 1)
    }

    fn first_group(&self) -> usize {
        if self.by_events { 2 } else { 0 }
    }

    fn first_length(&self) -> usize {
        self.first_group() + self.group_count as usize
    }

    /// The parts of light of a light, along a path of so many edges and this length.
    fn parts(&self, edges: u32, light: Option<usize>, length: f64) -> impl Iterator<Item = usize> {
        let by_events = self.by_events.then_some(usize::from(edges > DIRECT_EDGES));
        let group = light.and_then(|light| self.groups.get(light).copied());
        let last = self.group_count.checked_sub(1);
        let group = group.or(last).map(|group| self.first_group() + group as usize);
        let by_length = self.by_length.map(|bins| self.first_length() + bins.of(length));
        by_events.into_iter().chain(group).chain(by_length)
    }
}

impl<'a> Sums<'a> {
    fn new(
        scene: &Scene,
        settings: &'a RenderSettings,
        division: &'a LightDivision,
    ) -> Result<Sums<'a>, FilmError> {
        let scale = scale_exponent(scene);
        let film = |_| Film::windowed(settings.width, settings.height, settings.window(), scale);
        let films = (0..division.count()).map(film).collect::<Result<_, _>>()?;
        Ok(Sums { settings, division, scale, films: Mutex::new(films), splats: Mutex::default() })
    }

    /// The photons of an iteration, if there are any. Where their light subpaths are connected with the camera, the splats are kept.
    fn photons(
        &self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays,
        tiles: &[Window],
        iteration: u32,
    ) -> Result<Option<Photons>, FilmError> {
        let Some(merging) = integrator.merging() else { return Ok(None) };
        let splats = Merging::splats_photons(merging);
        if splats {
            self.make_room_for_splats()?;
        }
        let techniques = |counts: &_| merging.techniques(counts);
        let visitor = splats.then_some(self);
        Ok(Some(Photons::trace(eye, merging, tiles, iteration, techniques, visitor, None).0))
    }

    fn make_room_for_splats(&self) -> Result<(), FilmError> {
        let mut splats = self.splats.lock().unwrap_or_else(PoisonError::into_inner);
        while splats.len() < self.division.count() {
            splats.push(Iterations::new(self.settings.window().pixels(), usize::MAX)?);
        }
        Ok(())
    }

    fn add_tile(
        &self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays,
        tile: Window,
        samples: &Range<u32>,
        progress: &dyn Progress,
    ) -> Result<(), FilmError> {
        let mut tracer = Tracer::new(eye.context.scene, false);
        let wanted = tile.intersection(&self.settings.window());
        let mut films = vec![Film::part(self.scale); self.division.count()];
        films.iter_mut().for_each(|film| film.restart(wanted));
        let photons = eye.photons;
        let both_ends = integrator.light_subpaths().and_then(|subpaths| subpaths.both_ends(photons));
        let mut tally = self.tally();
        for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)) {
            if progress.is_cancelled() {
                return Ok(());
            }
            let is_wanted = wanted.index(x, y).is_some();
            for sample in samples.clone() {
                tally.begin(x, y, sample);
                tally.take(integrator, eye, both_ends.as_ref(), &mut tracer, is_wanted);
                if is_wanted {
                    tally.add_to(&mut films);
                }
            }
        }
        progress.advance(tile.pixels() as u64 * samples.len() as u64, tracer.counters.rays);
        let mut all = self.films.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter_mut().zip(&films).for_each(|(film, part)| film.absorb(part));
        drop(all);
        if integrator.splats() {
            self.make_room_for_splats()?;
            self.take(0, tally);
        }
        Ok(())
    }

    fn parts(self, integrator: &dyn PixelIntegrator) -> Result<LightParts, FilmError> {
        let mut films = self.films.into_inner().unwrap_or_else(PoisonError::into_inner);
        let splats = self.splats.into_inner().unwrap_or_else(PoisonError::into_inner);
        let splats_photons = integrator.merging().is_some_and(Merging::splats_photons);
        if integrator.splats() || splats_photons {
            for (film, splats) in films.iter_mut().zip(splats) {
                film.add_iterations(splats, self.settings.samples.len() as u32)?;
            }
        }
        let by_length = films.split_off(self.division.first_length());
        let groups = films.split_off(self.division.first_group());
        let by_events = <[Film; 2]>::try_from(films).ok();
        Ok(LightParts { by_events, groups, by_length })
    }
}

impl<'a> LightPathVisitor<1> for Sums<'a> {
    type Tally = PartTally<'a>;

    fn tally(&self) -> PartTally<'a> {
        let splats = Splats::new(self.settings, self.settings.window(), self.scale);
        let (division, count) = (self.division, self.division.count());
        let (here, found) = (vec![Rgb::BLACK; count], Vec::new());
        let lengths = division.by_length.map(|_| Lengths::default());
        PartTally {
            division,
            place: [0; 3],
            sum: Rgb::BLACK,
            here,
            splats: vec![splats; count],
            found,
            lengths,
        }
    }

    fn begin(tally: &mut PartTally<'a>, x: u32, y: u32, sample: u32) {
        tally.begin(x, y, sample);
    }

    fn take(&self, _tile: usize, mut tally: PartTally<'a>) {
        let mut sums = self.splats.lock().unwrap_or_else(PoisonError::into_inner);
        for (sum, splats) in sums.iter_mut().zip(&mut tally.splats) {
            sum.take(&mut splats.deposits);
        }
    }
}

/// The light of one sample, part by part.
struct PartTally<'a> {
    division: &'a LightDivision,
    /// Column, row and index of the sample.
    place: [u32; 3],
    /// All light in the sample's own pixel.
    sum: Rgb,
    here: Vec<Rgb>,
    splats: Vec<Splats<'a>>,
    /// Memory for what a path finds.
    found: Vec<FoundLight>,
    /// The subpaths, if light is divided by lengths.
    lengths: Option<Lengths>,
}

/// The lengths of the subpaths of a sample.
#[derive(Default)]
struct Lengths {
    camera: Option<OpticalPath>,
    /// Vertices of the camera subpath so far.
    vertices: u32,
    /// The light subpath up to each of its vertices.
    light: Vec<OpticalPath>,
    /// The connection that contributes next.
    join: Option<(Vec3, Vec3, Option<f32>)>,
}

impl Lengths {
    /// The length of a path that a technique has found; infinite if there is none.
    fn of(&self, technique: Technique) -> f64 {
        let Technique::Connected { s, t } = technique else { return f64::INFINITY };
        let from_light = |s: u32| self.light.get(s as usize - 2);
        let joined = |way: &OpticalPath| {
            self.join.map(|(from, towards, distance)| way.length_by(from, towards, distance))
        };
        let length = match (s, t) {
            // The camera subpath ends on the light, or escapes, which is no vertex.
            (0, t) => self.camera.filter(|_| t == self.vertices).map(|way| way.length()),
            (1, _) => self.camera.as_ref().and_then(joined),
            (s, 1) => from_light(s).and_then(joined),
            (s, _) => self.camera.as_ref().and_then(joined).zip(from_light(s)).map(|(a, b)| a + b.length()),
        };
        length.unwrap_or(f64::INFINITY)
    }
}

impl PartTally<'_> {
    fn begin(&mut self, x: u32, y: u32, sample: u32) {
        (self.place, self.sum) = ([x, y, sample], Rgb::BLACK);
        self.here.fill(Rgb::BLACK);
        self.splats.iter_mut().for_each(|splats| splats.begin(x, y, sample));
    }

    /// Takes the sample.
    fn take<'s>(
        &mut self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays<'s>,
        both_ends: Option<&BothEnds>,
        tracer: &mut Tracer<'s>,
        is_wanted: bool,
    ) {
        let [x, y, sample] = self.place;
        let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
        if let Some(both_ends) = both_ends {
            if let Some(lengths) = &mut self.lengths {
                (lengths.camera, lengths.vertices) = (Some(OpticalPath::from(ray.origin.into())), 1);
                lengths.light.clear();
            }
            let mut task = Task { context: &eye.context, tracer, sample: &mut state };
            both_ends.sample(&ray, is_wanted, &mut task, self);
        } else if is_wanted && !ray.is_nowhere() {
            self.found.clear();
            let found = Some(std::mem::take(&mut self.found));
            let way = self.lengths.as_ref().map(|_| OpticalPath::from(ray.origin.into()));
            state.record = Some(Box::new(Record { found, way, ..Record::default() }));
            let mut task = Task { context: &eye.context, tracer, sample: &mut state };
            self.sum = integrator.radiance(&ray, &mut task);
            self.found = state.record.and_then(|record| record.found).unwrap_or_default();
            for FoundLight { edges, light, radiance, length, .. } in &self.found {
                self.division.parts(*edges, *light, *length).for_each(|part| self.here[part] += *radiance);
            }
        }
    }

    /// The length of a path, if light is divided by it.
    fn length(&self, technique: Technique) -> f64 {
        self.lengths.as_ref().map_or(f64::INFINITY, |lengths| lengths.of(technique))
    }

    /// Adds the sample to the films. One that is not finite is left out of all parts, as out of the picture.
    fn add_to(&self, films: &mut [Film]) {
        let [x, y, sample] = self.place;
        for (film, &light) in films.iter_mut().zip(&self.here) {
            film.add(x, y, sample, if self.sum.is_finite() { light } else { self.sum });
        }
    }
}

impl Tally<1> for PartTally<'_> {
    fn reach(&mut self, place: impl FnOnce() -> PathPoint) {
        if let Some(Lengths { camera: Some(way), vertices, .. }) = &mut self.lengths {
            way.reach(place());
            *vertices += 1;
        }
    }

    fn reach_from_light(
        &mut self,
        depth: u32,
        start: impl FnOnce() -> OpticalPath,
        place: impl FnOnce() -> PathPoint,
    ) {
        if let Some(Lengths { light, .. }) = &mut self.lengths {
            let before = light.last().copied().filter(|_| depth > 0);
            let mut way = before.unwrap_or_else(start);
            way.reach(place());
            light.push(way);
        }
    }

    fn join(&mut self, from: Vec3, direction: Vec3, distance: Option<f32>) {
        if let Some(lengths) = &mut self.lengths {
            lengths.join = Some((from, direction, distance));
        }
    }

    fn add_sample(&mut self, technique: Technique, found: &Contribution) {
        let (edges, light) = (Strategy::of(technique).edges, found.weighted());
        let length = self.length(technique);
        self.sum += light;
        let parts = self.division.parts(edges, found.light_index(), length);
        parts.for_each(|part| self.here[part] += light);
    }

    fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution) {
        let (edges, light) = (Strategy::of(technique).edges, found.weighted());
        let length = self.length(technique);
        let parts = self.division.parts(edges, found.light_index(), length);
        parts.for_each(|part| self.splats[part].add(film, light));
    }
}
