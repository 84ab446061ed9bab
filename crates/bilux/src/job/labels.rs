//! Labels of pictures, and silhouettes of their objects.

use crate::job::Subject;
use crate::settings::Settings;
use crate::{Error, Job};
use bilux_pictures::Picture;
use bilux_transport::Progress;
use bilux_transport::aovs::Aov;
use bilux_transport::labels::{Moment, Silhouette, Wanted, labels, silhouettes};
use std::collections::{BTreeSet, HashMap};

/// The beginning of the keys of metadata that name categories.
const CATEGORY: &str = "bilux.category.";

impl Job {
    /// The labels that are wanted, if any, and the names of their numbers as metadata; `None` also if it was stopped.
    pub(crate) fn labels(&self, progress: &dyn Progress) -> Result<Option<Picture>, Error> {
        let aovs: Vec<Aov> = self.request.layers.iter().copied().filter(|aov| aov.is_label()).collect();
        if aovs.is_empty() {
            return Ok(None);
        }
        let frame = 1.0 / self.settings.fps;
        let needs = |is_needed: fn(Aov) -> bool| aovs.iter().copied().any(is_needed);
        let Subject { next_pose, previous_pose, .. } = &self.subject;
        let at = |pose: &Option<_>, is_needed, frames: f32| {
            let time = self.settings.time + frames * frame;
            let pose = pose.as_deref().unwrap_or(&self.subject);
            let settings = Settings { time, shutter: 0.0, ..self.settings.clone() };
            needs(is_needed).then(|| (pose.at_time_of(&settings), time))
        };
        let [next, previous] =
            [at(next_pose, Aov::needs_next, 1.0), at(previous_pose, Aov::needs_previous, -1.0)];
        let named = self.subject.names(Aov::CryptoObject);
        let (categories, names) = self.categories(named.len());
        let wanted = Wanted {
            aovs: &aovs,
            instances: &numbers(&named),
            categories: &categories,
            next: next.as_ref().map(moment),
            previous: previous.as_ref().map(moment),
        };
        let found = labels(self.scene(), self.camera(), &self.render, &wanted, progress)?;
        Ok(found.map(|mut picture| {
            if aovs.contains(&Aov::Category) {
                let named = names
                    .into_iter()
                    .zip(1..)
                    .map(|(name, number): (_, u32)| (format!("{CATEGORY}{number}"), name));
                picture.metadata.extend(named);
            }
            picture
        }))
    }

    /// The silhouettes of groups of objects ([`silhouettes`]); each group is a list of indices of objects.
    ///
    /// # Errors
    /// If a group has an object that there is not, two have the same, or the picture with its margin is too large.
    pub fn silhouettes(
        &self,
        groups: &[Vec<usize>],
        margin: u32,
        progress: &dyn Progress,
    ) -> Result<Option<Vec<Silhouette>>, Error> {
        let mut of_objects = vec![None; self.subject.source.objects.len()];
        for (group, objects) in groups.iter().enumerate() {
            for &object in objects {
                let count = of_objects.len();
                let slot = of_objects.get_mut(object).ok_or_else(|| {
                    Error::Settings(format!(
                        "there is no object {object}: the scene has {count}, counted from 0"
                    ))
                })?;
                if slot.replace(group as u32).is_some_and(|other| other != group as u32) {
                    let message = format!("object {object} is in two groups: its mask can belong to one");
                    return Err(Error::Settings(message));
                }
            }
        }
        let (scene, camera) = (self.scene(), self.camera());
        Ok(silhouettes(scene, camera, &self.render, &of_objects, groups.len(), margin, progress)?)
    }

    /// The number of the category of each of `count` objects and spheres, and the names of all categories in order.
    fn categories(&self, count: usize) -> (Vec<u32>, Vec<String>) {
        let of =
            |object: usize| self.subject.source.objects.get(object).map_or("", |object| &*object.category);
        let names: BTreeSet<&str> = (0..count).map(of).filter(|name| !name.is_empty()).collect();
        let numbers: HashMap<&str, u32> = names.iter().copied().zip(1..).collect();
        let of_objects = (0..count).map(|object| numbers.get(of(object)).copied().unwrap_or_default());
        (of_objects.collect(), names.into_iter().map(str::to_owned).collect())
    }
}

fn moment((pose, time): &(Subject, f32)) -> Moment<'_> {
    Moment { scene: &pose.scene, camera: &*pose.camera, time: *time }
}

/// For each name its number among those that are the same, from 1.
pub(crate) fn numbers(names: &[String]) -> Vec<u32> {
    let mut seen: HashMap<&str, u32> = HashMap::new();
    let mut numbers = Vec::with_capacity(names.len());
    for name in names {
        let number = seen.entry(name).or_default();
        *number += 1;
        numbers.push(*number);
    }
    numbers
}

/// Adds the wanted ones of these labels, and their metadata, to a picture of the same window.
///
/// # Errors
/// If the picture has a different size, or already has such layers.
pub(crate) fn push(labels: &Picture, wanted: &[Aov], picture: &mut Picture) -> Result<(), Error> {
    let is_wanted = |channel: &str| {
        let layer = channel.split('.').next();
        wanted.iter().any(|aov| aov.layer() == layer)
    };
    for channel in labels.channels().iter().filter(|channel| is_wanted(&channel.name)) {
        picture.push_channel(channel.name.clone(), channel.samples.clone())?;
    }
    for plane in labels.integer_planes().iter().filter(|plane| is_wanted(&plane.name)) {
        picture.push_integer_plane(plane.name.clone(), plane.samples.clone())?;
    }
    picture.metadata.extend(labels.metadata.clone());
    Ok(())
}
