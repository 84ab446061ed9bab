//! The light of one tile, technique by technique.

use crate::film::window::Window;
use crate::sampling::splats::Splats;
use crate::schedule::settings::RenderSettings;
use crate::techniques::{Contribution, Tally, Technique};
use bilux_math::{Rgb, Vec2};
use std::collections::BTreeMap;
use std::fmt;

/// Edges of the longest paths whose techniques have pictures.
pub const MAX_EDGES: u32 = 8;

/// A technique for paths of one length. Ordered by length, then connections before merging, then by vertices from the
/// light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Strategy {
    /// Edges of its paths, one more than their scattering events.
    pub edges: u32,
    /// True where the last vertices of both subpaths are merged, false where an edge connects them.
    pub merges: bool,
    /// Vertices from the light, including the one on the light.
    pub s: u32,
}

impl Strategy {
    /// Vertices from the camera, including the one at the camera.
    pub fn t(&self) -> u32 {
        self.edges + 1 + u32::from(self.merges) - self.s
    }

    pub(crate) fn of(technique: Technique) -> Strategy {
        match technique {
            Technique::Connected { s, t } => Strategy { edges: s + t - 1, merges: false, s },
            Technique::Merged { s, t } => Strategy { edges: s + t - 2, merges: true, s },
        }
    }
}

impl fmt::Display for Strategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s{}-t{}{}", self.s, self.t(), if self.merges { "-merged" } else { "" })
    }
}

/// Weighted and unweighted.
pub(crate) type Both<T> = [T; 2];

/// Light that all techniques find in a tile.
pub(crate) struct Layers<'a> {
    settings: &'a RenderSettings,
    scale_exponent: i32,
    /// The requested part of the tile.
    pub(crate) window: Window,
    /// The current sample: column, row and index.
    place: [u32; 3],
    pub(crate) here: BTreeMap<Strategy, Vec<Both<Rgb>>>,
    pub(crate) there: BTreeMap<Strategy, Both<Splats<'a>>>,
}

impl<'a> Layers<'a> {
    pub(crate) fn new(settings: &'a RenderSettings, tile: Window, scale_exponent: i32) -> Layers<'a> {
        let window = tile.intersection(&settings.window());
        let (here, there) = (BTreeMap::new(), BTreeMap::new());
        Layers { settings, scale_exponent, window, place: [0; 3], here, there }
    }

    pub(crate) fn begin(&mut self, x: u32, y: u32, sample: u32) {
        self.place = [x, y, sample];
        self.there.values_mut().flatten().for_each(|splats| splats.begin(x, y, sample));
    }
}

impl Tally<1> for Layers<'_> {
    fn add_sample(&mut self, technique: Technique, found: &Contribution) {
        let (strategy, [x, y, _]) = (Strategy::of(technique), self.place);
        let Some(index) = self.window.index(x, y).filter(|_| strategy.edges <= MAX_EDGES) else { return };
        let pixels = self.window.pixels();
        let light = &mut self.here.entry(strategy).or_insert_with(|| vec![[Rgb::BLACK; 2]; pixels])[index];
        light[0] += found.weighted();
        light[1] += found.light * (1.0 / found.own.0[0]);
    }

    fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution) {
        let strategy = Strategy::of(technique);
        if strategy.edges > MAX_EDGES {
            return;
        }
        let (settings, [x, y, sample]) = (self.settings, self.place);
        let splats = self.there.entry(strategy).or_insert_with(|| {
            let mut splats = Splats::new(settings, settings.window(), self.scale_exponent);
            splats.begin(x, y, sample);
            [splats.clone(), splats]
        });
        // Here every pixel has a light subpath that is splatted, even where fewer make the picture.
        splats[0].add(film, found.weighted() * found.own.0[0]);
        splats[1].add(film, found.light);
    }
}
