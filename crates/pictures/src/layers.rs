//! The layers of a picture: channels whose names share what precedes the last dot.

use crate::picture::qualified;
use crate::{Channel, Picture, PictureError};

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
        let has_colours = |layer: &str| self.layer(layer).is_some_and(|l| l.rgb_planes().is_some());
        let coloured: Vec<&str> = self.layers().into_iter().filter(|layer| has_colours(layer)).collect();
        let chosen = match (name, &coloured[..]) {
            (None, _) if self.rgb_planes().is_some() => return Ok(self),
            (None, [only]) => Some((*only).to_owned()),
            (None, _) => None,
            (Some(name), layers) => fitting(name, layers).map(str::to_owned),
        };
        let layer = chosen.as_deref().and_then(|chosen| self.layer(chosen));
        let (Some(layer), Some(chosen)) = (layer, chosen) else {
            let known: Vec<String> = coloured.iter().map(|&layer| layer.to_owned()).collect();
            return Err(PictureError::NoLayer { name: name.map(str::to_owned), known });
        };
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

    #[test]
    fn the_only_layer_with_colours_stands_in_for_the_main_picture() {
        let mut picture = of(&["glow"]);
        picture.push_channel("depth.Z", vec![7.0]).unwrap();
        let main = picture.with_main(None).unwrap();
        assert_eq!(main.rgb(0, 0), Rgb::BLACK);
        assert!(main.warnings[0].contains("'glow'"), "{:?}", main.warnings);
        let error = of(&["a", "b"]).with_main(None).unwrap_err().to_string();
        assert!(error.contains("a, b"), "{error}");
    }
}
