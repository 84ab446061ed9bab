//! The layers of a picture: channels whose names share what precedes the last dot.

use crate::picture::qualified;
use crate::{Channel, Picture, PictureError};
use std::ops::Range;

/// The channels that belong to no layer.
const MAIN: [&str; 5] = ["R", "G", "B", "Y", "A"];

impl Picture {
    /// The names of the layers other than the main picture, each once, in order of appearance.
    pub fn layers(&self) -> Vec<&str> {
        let names = self.channels.iter().map(|c| &c.name[..]);
        let names = names.chain(self.integer_planes().iter().map(|plane| &plane.name[..]));
        let mut layers = Vec::new();
        for layer in names.filter_map(|name| name.rsplit_once('.')).map(|(layer, _)| layer) {
            if !layers.contains(&layer) {
                layers.push(layer);
            }
        }
        layers
    }

    /// The main picture without its layers and texts: `R`, `G`, `B` and `Y` as far as present, and `A`.
    pub fn main(&self) -> Picture {
        let mut picture = self.like();
        let main = self.channels.iter().filter(|c| MAIN.contains(&&c.name[..]));
        picture.channels.extend(main.cloned());
        picture
    }

    /// Some rows of the same.
    pub(crate) fn main_rows(&self, rows: Range<usize>) -> Picture {
        let mut picture = self.like_rows(rows.len());
        let samples = rows.start * self.width()..rows.end * self.width();
        for channel in self.channels.iter().filter(|c| MAIN.contains(&&c.name[..])) {
            let samples = channel.samples[samples.clone()].to_vec();
            picture.channels.push(Channel { name: channel.name.clone(), samples });
        }
        picture
    }

    /// One layer as a picture of its own, without its name as a prefix; `None` if there is no such layer.
    pub fn layer(&self, layer: &str) -> Option<Picture> {
        let prefix = qualified(layer, "");
        let mut picture = self.like();
        for channel in &self.channels {
            if let Some(name) = channel.name.strip_prefix(&prefix).filter(|name| !name.contains('.')) {
                picture.channels.push(Channel { name: name.to_owned(), samples: channel.samples.clone() });
            }
        }
        (!picture.channels.is_empty()).then_some(picture)
    }

    /// The picture with one of its layers as the main picture, in place of its own; the other layers stay.
    ///
    /// `name` can leave out what precedes a dot, and differ in upper and lower case, as long as only one layer fits.
    /// `None` stands for the main picture, or if there is none, for the only layer that has colours, with a warning.
    ///
    /// # Errors
    /// [`PictureError::NoLayer`], with the layers that there are.
    pub fn with_main(self, name: Option<&str>) -> Result<Picture, PictureError> {
        if name.is_none() && self.rgb_planes().is_some() {
            return Ok(self);
        }
        let coloured: Vec<&str> =
            self.layers().into_iter().filter(|layer| self.layer_has_colours(layer)).collect();
        let chosen = match (name, &coloured[..]) {
            (None, [only]) => Some((*only).to_owned()),
            (None, _) => None,
            (Some(name), layers) => fitting(name, layers).map(str::to_owned),
        };
        let layer = chosen.as_deref().and_then(|chosen| self.layer(chosen));
        let (Some(mut layer), Some(chosen)) = (layer, chosen) else {
            let known: Vec<String> = coloured.iter().map(|&layer| layer.to_owned()).collect();
            return Err(PictureError::NoLayer { name: name.map(str::to_owned), known });
        };
        layer.channels.iter_mut().for_each(|channel| channel.name = short(&channel.name).to_owned());
        let mut picture = self;
        picture.channels.retain(|channel| !MAIN.contains(&&*channel.name));
        picture.channels.splice(..0, layer.channels);
        if name.is_none() {
            picture
                .warnings
                .push(format!("it has no main picture: its only layer with colours, '{chosen}', is used"));
        }
        Ok(picture)
    }

    /// True if a layer has red, green and blue, or luminance, which Y is unless it is a coordinate.
    fn layer_has_colours(&self, layer: &str) -> bool {
        let prefix = qualified(layer, "");
        let components: Vec<&str> =
            self.channels.iter().filter_map(|c| c.name.strip_prefix(&prefix)).map(short).collect();
        let has = |component: &str| components.contains(&component);
        ["R", "G", "B"].into_iter().all(has) || (has("Y") && !["R", "G", "B", "X", "Z"].into_iter().any(has))
    }
}

/// The usual name of a component of a colour, which some programs spell out.
fn short(component: &str) -> &str {
    match component {
        "red" => "R",
        "green" => "G",
        "blue" => "B",
        "alpha" => "A",
        other => other,
    }
}

/// The layer that a name means: the one of this name, or the only one that ends with it after a dot.
fn fitting<'l>(name: &str, layers: &[&'l str]) -> Option<&'l str> {
    let only = |fits: &dyn Fn(&str) -> bool| {
        let mut fitting = layers.iter().filter(|layer| fits(layer));
        fitting.next().filter(|_| fitting.next().is_none()).copied()
    };
    let lower = name.to_lowercase();
    only(&|layer| layer == name)
        .or_else(|| only(&|layer| layer.to_lowercase() == lower))
        .or_else(|| only(&|layer| layer.to_lowercase().ends_with(&format!(".{lower}"))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;

    fn of(layers: &[&str]) -> Picture {
        let mut picture = Picture::new(1, 1).unwrap();
        for (i, layer) in layers.iter().enumerate() {
            picture.push_rgb(layer, &[Rgb::grey(i as f32)]).unwrap();
        }
        picture
    }

    #[test]
    fn a_layer_can_be_named_in_short() {
        let picture = of(&["", "ViewLayer.Combined", "ViewLayer.Diffuse", "Other.Diffuse"]);
        for (name, found) in [
            (None, Some(0.0)),
            (Some("ViewLayer.Combined"), Some(1.0)),
            (Some("combined"), Some(1.0)),
            (Some("viewlayer.diffuse"), Some(2.0)),
            (Some("Diffuse"), None),
            (Some("View"), None),
        ] {
            let main = picture.clone().with_main(name).ok();
            assert_eq!(main.as_ref().map(|picture| picture.rgb(0, 0).r), found, "{name:?}");
            // All layers stay.
            assert!(main.is_none_or(|picture| picture.layers().len() == 3));
        }
    }

    /// Normals, motion and depth, as renderers write them beside a picture, are no colours.
    #[test]
    fn the_only_layer_with_colours_stands_in_for_the_main_picture() {
        let mut picture = of(&["glow"]);
        for channel in ["depth.Z", "Normal.X", "Normal.Y", "Normal.Z", "Motion.X", "Motion.Y"] {
            picture.push_channel(channel, vec![7.0]).unwrap();
        }
        let main = picture.with_main(None).unwrap();
        assert_eq!(main.rgb(0, 0), Rgb::BLACK);
        assert!(main.warnings[0].contains("'glow'"), "{:?}", main.warnings);
        let mut spelt_out = Picture::new(1, 1).unwrap();
        for (channel, sample) in [("sky.blue", 3.0), ("sky.green", 2.0), ("sky.red", 1.0), ("sky.alpha", 0.5)]
        {
            spelt_out.push_channel(channel, vec![sample]).unwrap();
        }
        let main = spelt_out.with_main(Some("sky")).unwrap();
        assert_eq!((main.rgb(0, 0), main.alpha_at(0, 0)), (Rgb::new(1.0, 2.0, 3.0), 0.5));
        let mut luminance = Picture::new(1, 1).unwrap();
        luminance.push_channel("mask.Y", vec![0.5]).unwrap();
        assert_eq!(luminance.with_main(None).unwrap().rgb(0, 0), Rgb::grey(0.5));
        let error = of(&["a", "b"]).with_main(None).unwrap_err().to_string();
        assert!(error.contains("a, b"), "{error}");
    }
}
