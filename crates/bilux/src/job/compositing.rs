//! Layers for compositors that are made once the picture is there: which objects cover what, and the light in parts.

use crate::job::Subject;
use crate::job::labels;
use crate::{Error, Job, Outcome};
use bilux_math::Rgb;
use bilux_pictures::cryptomatte::Cryptomatte;
use bilux_pictures::{Picture, PictureError};
use bilux_scene::{Scene, SceneBuilder};
use bilux_transport::aovs::Aov;
use bilux_transport::mattes::mattes;
use bilux_transport::{Film, LightDivision, Progress, RenderSettings, Stop, light_parts};
use std::collections::{BTreeMap, HashMap};

/// The maximum number of groups of lights: each is a picture of its own.
pub const MAX_GROUPS: usize = 64;

/// The group of what shines without being a light of the scene.
const OTHERS: &str = "others";
/// The name of that group where fire and other media shine.
const MEDIA: &str = "media";

/// Layers besides those that rendering itself gives.
pub struct ExtraLayers(Picture);

impl ExtraLayers {
    /// Checks, before any work, that the layers can be made.
    ///
    /// # Errors
    /// If the integrator cannot divide its light, there are too many groups of lights, or only some samples are taken.
    pub fn check(job: &Job, wanted: &[Aov]) -> Result<(), Error> {
        if wanted.iter().any(|aov| aov.needs_all_samples()) && job.render.samples != (0..job.render.spp) {
            return Err(Error::Settings(format!(
                "parts and costs of the light need all samples: leave out the range of samples, or the layers {}",
                Aov::names_that_need_all_samples()
            )));
        }
        let Some(aov) = wanted.iter().find(|aov| aov.is_light()) else { return Ok(()) };
        if !job.integrator().has_light_parts() {
            let others: Vec<&str> = bilux_transport::integrators::with_light_parts().collect();
            return Err(Error::Settings(format!(
                "the integrator '{}' cannot divide its light into parts ({}): choose one of {}",
                job.settings.integrator.entry.name,
                aov.layer().unwrap_or_default(),
                others.join(", ")
            )));
        }
        let groups = LightGroups::of(job.scene()).names.len();
        if wanted.contains(&Aov::Groups) && groups > MAX_GROUPS {
            return Err(Error::Settings(format!(
                "the scene has {groups} groups of lights, and each takes a picture of its own; the maximum is \
                 {MAX_GROUPS}: give lights the same 'group' in the scene file"
            )));
        }
        Ok(())
    }

    /// The wanted layers that are made after the picture, of the samples that it has. `None` if that was interrupted, as the
    /// picture may have been.
    ///
    /// # Errors
    /// As [`ExtraLayers::check`]; or if memory is short.
    pub fn of(
        job: &Job,
        outcome: &Outcome,
        wanted: &[Aov],
        progress: &dyn Progress,
    ) -> Result<Option<ExtraLayers>, Error> {
        let film = &outcome.rendered.film;
        let window = film.window();
        let mut layers = Picture::new(window.width as usize, window.height as usize)?;
        let mut settings = RenderSettings { stop: Stop::default(), ..job.render.clone() };
        if let Some(reached) = outcome.rendered.reached {
            (settings.spp, settings.samples) = (reached.spp, 0..reached.spp);
        }
        if wanted.contains(&Aov::Samples) {
            let count = |i| {
                let (x, y) = window.position(i);
                film.samples(x, y) as f32
            };
            push_single(&mut layers, Aov::Samples, (0..window.pixels()).map(count).collect())?;
        }
        if wanted.iter().any(|aov| aov.is_matte())
            && !push_mattes(job, &mut layers, &settings, wanted, progress)?
        {
            return Ok(None);
        }
        if wanted.iter().any(|aov| aov.is_light())
            && (outcome.rendered.cancelled || !push_light(job, &mut layers, &settings, wanted, progress)?)
        {
            return Ok(None);
        }
        if wanted.iter().any(|aov| aov.is_work())
            && (outcome.rendered.cancelled || !push_work(job, &mut layers, &settings, wanted, progress)?)
        {
            return Ok(None);
        }
        Ok(Some(ExtraLayers(layers)))
    }

    /// Adds them, and their metadata, to a picture of the same window.
    ///
    /// # Errors
    /// If the picture has a different size, or already has such layers.
    pub fn push(&self, picture: &mut Picture) -> Result<(), Error> {
        for channel in self.0.channels() {
            picture.push_channel(channel.name.clone(), channel.samples.clone())?;
        }
        picture.metadata.extend(self.0.metadata.clone());
        Ok(())
    }
}

/// Adds a layer that has a single channel.
fn push_single(layers: &mut Picture, aov: Aov, samples: Vec<f32>) -> Result<(), PictureError> {
    aov.channel_names().zip([samples]).try_for_each(|(name, samples)| layers.push_channel(name, samples))
}

/// False if it was interrupted.
fn push_work(
    job: &Job,
    layers: &mut Picture,
    settings: &RenderSettings,
    wanted: &[Aov],
    progress: &dyn Progress,
) -> Result<bool, Error> {
    let with_accel = wanted.iter().any(|aov| aov.is_accel_work());
    let (scene, camera) = (job.scene(), job.camera());
    let work = bilux_transport::work(scene, camera, job.renders(), settings, with_accel, progress)?;
    let Some(work) = work else { return Ok(false) };
    for (aov, samples) in [
        (Aov::Rays, work.rays),
        (Aov::PathLength, work.path_length),
        (Aov::Nodes, work.nodes),
        (Aov::Tests, work.tests),
    ] {
        if wanted.contains(&aov) {
            push_single(layers, aov, samples)?;
        }
    }
    Ok(true)
}

/// False if it was interrupted.
fn push_mattes(
    job: &Job,
    layers: &mut Picture,
    settings: &RenderSettings,
    wanted: &[Aov],
    progress: &dyn Progress,
) -> Result<bool, Error> {
    let (mut named, mut of_objects): (Vec<Cryptomatte>, Vec<Vec<u32>>) = Default::default();
    for aov in wanted.iter().filter(|aov| aov.is_matte()) {
        let mut matte = Cryptomatte::new(aov.layer().unwrap_or_default());
        of_objects.push(job.subject.names(*aov).iter().map(|name| matte.add(name)).collect());
        named.push(matte);
    }
    let (scene, camera, integrator) = (job.scene(), job.camera(), job.renders());
    let planes = mattes(scene, camera, integrator, settings, &of_objects, settings.spp, progress)?;
    let Some(planes) = planes else { return Ok(false) };
    for (matte, pixels) in named.iter().zip(&planes) {
        matte.push(layers, pixels)?;
    }
    Ok(true)
}

/// Adds layers of parts of the light. False if it was interrupted.
fn push_light(
    job: &Job,
    layers: &mut Picture,
    settings: &RenderSettings,
    wanted: &[Aov],
    progress: &dyn Progress,
) -> Result<bool, Error> {
    ExtraLayers::check(job, wanted)?;
    let by_events = wanted.contains(&Aov::Direct) || wanted.contains(&Aov::Indirect);
    let mut division = LightDivision { by_events, ..LightDivision::default() };
    let groups = LightGroups::of(job.scene());
    if wanted.contains(&Aov::Groups) {
        division.groups.clone_from(&groups.of_lights);
        division.group_count = groups.names.len() as u32;
    }
    let (scene, camera) = (job.scene(), job.camera());
    let parts = light_parts(scene, camera, job.renders(), settings, &division, progress)?;
    let Some(parts) = parts else { return Ok(false) };
    let mut push = |layer: &str, film: &Film| -> Result<(), Error> {
        let window = film.window();
        let light = |i| {
            let (x, y) = window.position(i);
            film.pixel(x, y)
        };
        let pixels: Vec<Rgb> = (0..window.pixels()).map(light).collect();
        Ok(layers.push_rgb(layer, &pixels)?)
    };
    for (film, aov) in parts.by_events.iter().flatten().zip([Aov::Direct, Aov::Indirect]) {
        if let Some(layer) = aov.layer().filter(|_| wanted.contains(&aov)) {
            push(layer, film)?;
        }
    }
    let named = groups.layers();
    for (film, (layer, _)) in parts.groups.iter().zip(&named) {
        push(layer, film)?;
    }
    if wanted.contains(&Aov::Groups) {
        layers.metadata.extend(named.into_iter().map(|(layer, name)| (format!("bilux.{layer}"), name)));
    }
    Ok(true)
}

impl Subject {
    /// Names of each object and each sphere of the scene in a matte.
    pub(crate) fn names(&self, aov: Aov) -> Vec<String> {
        let geometry = self.scene.geometry();
        let count = geometry.objects().len() + geometry.spheres().len();
        let objects = (0..count as u32).map(|object| match self.source.objects.get(object as usize) {
            Some(_) => object_name(&self.source, object as usize),
            None => match self.scene.light_of(object).map(|light| &*light.name) {
                None | Some("") => "light".to_owned(),
                Some(name) => name.to_owned(),
            },
        });
        match aov {
            Aov::CryptoMaterial => {
                (0..count as u32).map(|i| self.material_name(geometry.material_of(i))).collect()
            }
            Aov::CryptoInstance => {
                let objects: Vec<String> = objects.collect();
                let numbers = labels::numbers(&objects);
                objects.iter().zip(numbers).map(|(name, number)| format!("{name}#{number}")).collect()
            }
            _ => objects.collect(),
        }
    }

    fn material_name(&self, material: u32) -> String {
        match self.source.materials.get(material as usize).map(|spec| &*spec.name) {
            None => "light".to_owned(),
            Some("") => format!("material {material}"),
            Some(name) => name.to_owned(),
        }
    }
}

fn object_name(scene: &SceneBuilder, object: usize) -> String {
    let given = &scene.objects[object];
    let names = [&given.name, &given.mesh.name];
    let name = names.into_iter().find(|name| !name.is_empty()).cloned();
    name.unwrap_or_else(|| format!("object {object}"))
}

/// The groups of a scene's lights.
struct LightGroups {
    /// The group of each light.
    of_lights: Vec<u32>,
    /// In order of the first light of each.
    names: Vec<String>,
}

impl LightGroups {
    fn of(scene: &Scene) -> LightGroups {
        let (mut of_lights, mut names) = (Vec::new(), Vec::<String>::new());
        let mut known: HashMap<&str, u32> = HashMap::new();
        for (i, light) in scene.lights().iter().enumerate() {
            let group = *known.entry(&light.group).or_insert_with(|| {
                let unnamed = || format!("light {}", i + 1);
                names.push(if light.group.is_empty() { unnamed() } else { light.group.clone() });
                names.len() as u32 - 1
            });
            of_lights.push(group);
        }
        let shines =
            |i: usize| scene.geometry().objects()[i].gives_light && scene.light_index_of(i as u32).is_none();
        // The last group gets what belongs to no light.
        let others = match (0..scene.geometry().objects().len()).any(shines) || names.is_empty() {
            _ if scene.has_glowing_media() => Some(MEDIA),
            true => Some(OTHERS),
            false => None,
        };
        names.extend(others.map(str::to_owned));
        LightGroups { of_lights, names }
    }

    /// The name of the layer of each group, with the group's own name. Layers have only letters, digits and underscores,
    /// which every compositor takes.
    fn layers(&self) -> Vec<(String, String)> {
        let mut taken: BTreeMap<String, usize> = BTreeMap::new();
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let layer = |name: &String| {
            let stem: String = name.chars().map(plain).take(100).collect();
            let count = taken.entry(stem.to_lowercase()).or_default();
            *count += 1;
            let layer = if *count == 1 { format!("group_{stem}") } else { format!("group_{stem}__{count}") };
            (layer, name.clone())
        };
        self.names.iter().map(layer).collect()
    }
}
