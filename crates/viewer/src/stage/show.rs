//! Picture that is shown: denoised or not, or one of its layers as colours.

use super::visits;
use crate::catalogue::{LAYERS, VISITS};
use bilux::math::Rgb;
use bilux::math::hash::hash_words;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::pictures::{ColourSpace, Picture, WriteOptions};
use bilux::transport::Window;
use bilux::transport::aovs::{AOVS, Aov};
use bilux::{Error, Job, Outcome, Surfaces};

/// The layers that denoisers look at.
pub(super) const FOR_DENOISERS: [Aov; 4] = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Variance];

/// Kind of picture that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// The picture.
    Picture,
    /// A layer of it.
    Layer(Aov),
    /// A heat map of what the accelerator does for the ray of each pixel.
    Visits,
}

impl Shown {
    /// Kind of this name: `picture`, a layer of [`AOVS`], or [`VISITS`].
    pub(super) fn named(name: &str) -> Option<Shown> {
        match name {
            "picture" => return Some(Shown::Picture),
            VISITS => return Some(Shown::Visits),
            _ => {}
        }
        let row = AOVS.iter().find(|row| row.entry.name == name && LAYERS.contains(&row.aov))?;
        Some(Shown::Layer(row.aov))
    }

    /// Name of the kind.
    pub(super) fn name(self) -> &'static str {
        match self {
            Shown::Picture => "picture",
            Shown::Visits => VISITS,
            Shown::Layer(aov) => aov.row().entry.name,
        }
    }

    /// The picture to show of an outcome, and how it is written.
    ///
    /// # Errors
    /// If memory is short, or the denoiser fails.
    pub(super) fn of(
        self,
        job: &Job,
        outcome: &Outcome,
        denoiser: Option<&DenoiserChoice>,
    ) -> Result<(Picture, WriteOptions), Error> {
        if self == Shown::Visits {
            return Ok((visits::picture(job)?, WriteOptions::default()));
        }
        if let Shown::Layer(aov) = self
            && let Some(colours) = colours(aov, outcome)
        {
            let Window { width, height, .. } = outcome.rendered.film.window();
            let mut picture = Picture::from_rgb(width as usize, height as usize, colours)?;
            // These are no light: they are shown as they are.
            if aov != Aov::Albedo {
                picture.colour_space = ColourSpace::Srgb;
            }
            return Ok((picture, WriteOptions::default()));
        }
        let picture = match denoiser {
            Some(denoiser) => outcome.denoised(denoiser)?,
            None => outcome.picture()?,
        };
        let options = job.write_options_for(&picture)?;
        Ok((picture, options))
    }
}

/// A layer as colours from 0 to 1; `None` if there is none, as after an interrupt.
fn colours(aov: Aov, outcome: &Outcome) -> Option<Vec<Rgb>> {
    let Surfaces { features, labels, .. } = &outcome.surfaces;
    let plane = |name: &str| labels.as_ref().and_then(|labels| labels.channel(name));
    match aov {
        Aov::Normal => {
            let (x, y, z) = (plane("normal.X")?, plane("normal.Y")?, plane("normal.Z")?);
            let normals = x.iter().zip(y).zip(z).map(|((x, y), z)| Rgb::new(*x, *y, *z));
            Some(normals.map(|normal| normal * 0.5 + Rgb::grey(0.5)).collect())
        }
        Aov::Depth => plane("depth.Z").map(|depth| {
            // The nearest surface is white, the background black.
            let nearest = depth.iter().copied().fold(f32::INFINITY, f32::min);
            depth.iter().map(|depth| Rgb::grey((nearest / depth).clamp(0.0, 1.0))).collect()
        }),
        Aov::Ids => {
            let ids = labels.as_ref().and_then(|labels| labels.integer_plane("id.object"));
            ids.map(|ids| ids.iter().map(|&id| colour_of(id)).collect())
        }
        _ => features.as_ref().map(|features| features.albedo.clone()),
    }
}

/// A colour that tells an object from others; black for none.
fn colour_of(id: u32) -> Rgb {
    if id == 0 {
        return Rgb::BLACK;
    }
    let hash = hash_words([u64::from(id)]);
    let channel = |shift: u32| 0.2 + 0.75 * ((hash >> shift) & 0xff) as f32 / 255.0;
    Rgb::new(channel(0), channel(8), channel(16))
}
