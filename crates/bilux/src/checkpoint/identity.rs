//! Identity of a picture: all that it depends on, line by line, so that a message can say what is different.

use crate::Job;
use crate::encoding::hash_what_is_seen;
use crate::settings::Settings;
use bilux_scene::SceneBuilder;
use bilux_transport::RenderSettings;

/// Names and values of all that a picture's samples depend on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Identity(pub(super) Vec<(String, String)>);

/// Longer values are cut in messages.
const MAX_SHOWN: usize = 40;

impl Identity {
    /// Identity of a job's picture.
    pub fn of(job: &Job) -> Identity {
        let mut identity = of_settings(&job.settings, &job.render);
        let hash = hash_what_is_seen(job.completed_scene(), &[], "");
        identity.add("the scene, its files, or camera and studio around it", &hash.to_string());
        identity
    }

    /// Adds a line. Line breaks become spaces.
    pub fn add(&mut self, name: &str, value: &str) {
        self.0.push((name.replace(['\n', '='], " "), value.replace('\n', " ")));
    }

    /// Lines that differ in another identity, as text: the value there, and the value here.
    pub fn differences(&self, other: &Identity) -> Vec<String> {
        let value_in = |lines: &Identity, name: &str| {
            let line = lines.0.iter().find(|(other, _)| other == name);
            line.map_or_else(|| "unknown".to_owned(), |(_, value)| value.clone())
        };
        let mut names: Vec<&String> = self.0.iter().chain(&other.0).map(|(name, _)| name).collect();
        let mut seen = std::collections::HashSet::new();
        names.retain(|name| seen.insert(*name));
        let differ = names.into_iter().filter_map(|name| {
            let (here, there) = (value_in(self, name), value_in(other, name));
            let is_hash = |text: &str| text.len() == 64 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
            let shown = |text: &str| text.chars().take(MAX_SHOWN).collect::<String>();
            match here == there {
                true => None,
                false if is_hash(&here) || is_hash(&there) => Some(name.clone()),
                false => Some(format!("{name} ({} there, {} here)", shown(&there), shown(&here))),
            }
        });
        differ.collect()
    }

    /// The lines as text.
    pub fn to_text(&self) -> String {
        self.0.iter().map(|(name, value)| format!("{name}={value}\n")).collect()
    }

    /// Reads [`Identity::to_text`].
    pub fn from_text(text: &str) -> Identity {
        let split =
            |line: &str| line.split_once('=').map(|(name, value)| (name.to_owned(), value.to_owned()));
        Identity(text.lines().filter_map(split).collect())
    }
}

/// Identity of a job's picture, without the scene.
pub(crate) fn of_settings(settings: &Settings, render: &RenderSettings) -> Identity {
    let mut identity = Identity::default();
    let mut add = |name: &str, value: String| identity.add(name, &value);
    add("version", env!("CARGO_PKG_VERSION").to_owned());
    add("size", format!("{}x{}", settings.width, settings.height));
    add("integrator", settings.integrator.entry.name.to_owned());
    let nothing = SceneBuilder::default();
    let parameters = hash_what_is_seen(&nothing, &[&settings.integrator_parameters], "");
    add("parameters of the integrator", parameters.to_string());
    add("seed", settings.seed.to_string());
    add("max depth", settings.max_depth.to_string());
    add("camera", settings.camera.clone());
    add("time", settings.time.to_string());
    add("shutter", settings.shutter.to_string());
    if settings.readout != 0.0 {
        add("readout", settings.readout.to_string());
    }
    add("filter", settings.filter.clone());
    add("pixel anchor", if settings.corner_anchor { "corner" } else { "centre" }.to_owned());
    add("culling", format!("{:?}", settings.accel.query.culling));
    add("texture filtering", settings.filters_textures.to_string());
    add("first sample", render.samples.start.to_string());
    add("crop", render.crop.map_or_else(|| "none".to_owned(), |crop| crop.to_string()));
    add("intervals", render.interval.to_string());
    identity
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_named_with_both_values() {
        let lines = |seed: &str, scene: char| {
            let mut identity = Identity::default();
            identity.add("seed", seed);
            identity.add("scene", &scene.to_string().repeat(64));
            identity
        };
        let (one, other) = (lines("1", 'a'), lines("2", 'b'));
        assert_eq!(one.differences(&one), Vec::<String>::new());
        assert_eq!(one.differences(&other), ["seed (2 there, 1 here)", "scene"]);
        assert_eq!(Identity::from_text(&one.to_text()), one);
        let mut more = one.clone();
        more.add("new", "x");
        assert_eq!(more.differences(&one), ["new (unknown there, x here)"]);
    }
}
