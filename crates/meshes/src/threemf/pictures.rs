//! The pictures of textures, each decoded once.

use super::model::Model;
use super::package::Package;
use bilux_import::FormatError;
use bilux_import::input::images::SampleMeaning;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_math::Rgb;
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The colours of a picture, and its alpha if some of it is not opaque.
pub(super) type Picture = (Arc<Texture>, Option<Arc<Texture>>);

/// Pictures by their index; `None` for one that cannot be read.
#[derive(Default)]
pub(super) struct Pictures {
    /// Paths of the pictures' files in the archive.
    files: Vec<Option<PathBuf>>,
    images: HashMap<(usize, bool), Option<Arc<Image>>>,
    textures: HashMap<usize, Picture>,
}

impl Pictures {
    /// The pictures of a model in a package.
    pub(super) fn of(model: &Model, package: &Package) -> Pictures {
        let files = model.pictures.iter().map(|picture| {
            let from = super::package::resolved("", &picture.path);
            Some(package.path(package.member(&from)?))
        });
        Pictures { files: files.collect(), ..Pictures::default() }
    }

    /// The texture of a picture; a magenta checker, with a warning, if it cannot be read.
    pub(super) fn texture(
        &mut self,
        index: usize,
        model: &Model,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Picture, FormatError> {
        if let Some(known) = self.textures.get(&index) {
            return Ok(known.clone());
        }
        let picture = &model.pictures[index];
        let made = match self.image(index, false, model, reading, sink)? {
            None => (Arc::new(Texture::missing(&picture.path)), None),
            Some(image) => {
                let has_alpha = is_see_through(&image);
                let name = picture.path.trim_start_matches('/');
                let texture =
                    Texture { wrap: picture.wrap, filter: picture.filter, ..Texture::of(name, image, false) };
                let alpha = Texture { channel: Some(Channel::A), is_data: true, ..texture.clone() };
                (Arc::new(texture), has_alpha.then(|| Arc::new(alpha)))
            }
        };
        self.textures.insert(index, made.clone());
        Ok(made)
    }

    /// A channel of a picture as numbers.
    pub(super) fn numbers(
        &mut self,
        index: usize,
        channel: Channel,
        factor: f32,
        model: &Model,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Texture, FormatError> {
        let picture = &model.pictures[index];
        Ok(match self.image(index, true, model, reading, sink)? {
            None => Texture { is_data: true, ..Texture::missing(&picture.path) },
            Some(image) => Texture {
                wrap: picture.wrap,
                filter: picture.filter,
                channel: Some(channel),
                factor: Rgb::grey(factor),
                ..Texture::of(picture.path.trim_start_matches('/'), image, true)
            },
        })
    }

    fn image(
        &mut self,
        index: usize,
        is_data: bool,
        model: &Model,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Option<Arc<Image>>, FormatError> {
        if let Some(known) = self.images.get(&(index, is_data)) {
            return Ok(known.clone());
        }
        let picture = &model.pictures[index];
        let path = self.files.get(index).cloned().flatten();
        let read = |reading: &mut Reading| {
            let Some(path) = path else {
                let message = format!("the file does not contain the picture '{}'", picture.path);
                return Err(FormatError::malformed(message, picture.at.clone()));
            };
            let bytes = reading.load(&path)?;
            let means = if is_data { SampleMeaning::Numbers } else { SampleMeaning::SrgbColours };
            let hint = path.extension().and_then(|extension| extension.to_str());
            let image = reading.decode(&bytes, hint, None, means, &picture.path, &picture.at);
            reading.release(bytes);
            image.map(Arc::new)
        };
        let image = match read(reading) {
            Ok(image) => Some(image),
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let what = format!("a texture is replaced by a magenta checker: {}", error.without_place());
                sink.diagnostics.note(&what, || picture.at.clone());
                None
            }
        };
        self.images.insert((index, is_data), image.clone());
        Ok(image)
    }
}

/// True if some texel is not opaque.
fn is_see_through(image: &Image) -> bool {
    match &image.texels {
        Texels::Bytes(texels) => texels.iter().any(|[.., alpha]| *alpha < 255),
        Texels::Floats { alpha, .. } => alpha.iter().any(|alpha| *alpha < 1.0),
        Texels::Formula(_) => false,
    }
}
