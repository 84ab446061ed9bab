//! The vertices of subpaths.

use crate::film::limits::Events;
use crate::media::Media;
use crate::media::ball::Ball;
use crate::media::equiangular::{Approach, Lit};
use crate::media::interaction::{Interaction, MediumPoint};
use crate::photons::grid::PhotonPosition;
use crate::photons::{MediumPhoton, Photon, PhotonWalk};
use crate::sampling::task::Context;
use crate::techniques::PerSet;
use crate::techniques::mis::Partial;
use crate::techniques::optical_path::OpticalPath;
use bilux_math::{Rgb, Vec3};
use bilux_scene::Scene;

/// A vertex of a subpath.
pub(crate) struct Vertex<const N: usize = 1> {
    pub(crate) at: Interaction,
    /// The direction that the subpath came from, a unit vector.
    pub(crate) wo: Vec3,
    /// Throughput: what arrives, over the density of having come here.
    pub(crate) beta: Rgb,
    /// The densities of walks in each channel over their mean.
    pub(crate) odds: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events before this vertex.
    pub(crate) depth: u32,
    /// Events up to and including this one, as far as they limit paths.
    pub(super) events: Events,
    /// Whether it is among those that are connected at all.
    pub(super) is_kept: bool,
    /// The cell in which its light subpath began: [`crate::light::emission::Start::cell`].
    pub(crate) origin: u16,
    /// The subpath carries a single wavelength, whatever is here.
    pub(super) came_split: bool,
    /// The media on the side of `wo`.
    pub(super) media: Media,
    /// The density of arriving, per area or volume, over that over solid angle over the squared distance.
    pub(super) arriving: f32,
    /// The ball in which it is merged with photons, if it is a point of a dense medium.
    pub(super) ball: Option<Ball>,
    /// The light that its light subpath comes from, if it comes straight from there.
    pub(super) straight_from: Option<usize>,
    /// Approach of a camera subpath's ray, where [equiangular points](crate::media::equiangular) may be.
    pub(super) approach: Option<Approach>,
}

impl<const N: usize> Vertex<N> {
    /// The number of vertices of the subpath up to here, including the one on the light or at the camera.
    pub(crate) fn count(&self) -> u32 {
        count(self.depth)
    }

    /// Events up to and including this one, as far as they limit paths.
    pub(crate) fn events(&self) -> Events {
        self.events
    }

    /// True where it can be connected.
    pub(crate) fn is_open(&self) -> bool {
        self.is_kept && !self.at.is_delta()
    }

    /// The number of panes through which it samples lights, if it is on a surface: they count against the depth.
    pub(super) fn panes(&self, context: &Context) -> u32 {
        if self.at.is_in_medium() || !context.scene.has_panes() {
            return 0;
        }
        context.max_depth.saturating_sub(self.events.counted)
    }

    /// True where a path through here carries a single wavelength.
    pub(super) fn is_split(&self) -> bool {
        self.came_split || self.at.splits()
    }

    /// This vertex of a light subpath, where camera subpaths may find it as an [equiangular point](crate::media::equiangular). `factor` turns how
    /// often it is connected with its light into what counts beyond it.
    pub(super) fn lit(&self, factor: f32) -> Option<Lit<N>> {
        let (light, connected) = (self.straight_from?, self.partial.connected * factor);
        self.at.is_equiangular().then(|| Lit { light, p: self.at.p(), connected })
    }

    /// Frequency with which camera subpaths that come here from this point find this as an equiangular point, over the density
    /// with which their walks arrive.
    pub(super) fn lit_from(&self, scene: &Scene, from: Vec3) -> PerSet<N> {
        let Some(lit) = self.lit(1.0) else { return PerSet::ZERO };
        let distance = lit.p.distance(from);
        lit.picked(scene, (lit.p - from) / distance, distance)
    }

    /// Start of its light subpath, if this is its first vertex.
    pub(super) fn start(&self, scene: &Scene) -> OpticalPath {
        let p = self.at.p();
        let is_infinite = |light: usize| scene.lights()[light].light.is_infinite();
        if self.straight_from.is_some_and(is_infinite) {
            return OpticalPath::from_infinity(p);
        }
        OpticalPath::from(p + self.wo * self.at.t())
    }

    /// The photon that is stored for merging on a surface; `None` in a medium.
    pub(crate) fn photon(&self) -> Option<(PhotonPosition, Photon<N>)> {
        let surface = self.at.surface()?;
        let counted = self.events.counted - 1;
        let uncounted = self.depth - counted;
        let position = PhotonPosition::new(surface.p, counted, uncounted, self.came_split, self.origin);
        let (wo, n_geom, beta) = (self.wo, surface.n_geom, self.beta);
        Some((
            position,
            Photon { wo, n_geom, beta, connected: self.partial.connected, d_vc: self.partial.d_vc },
        ))
    }

    /// The photon that is stored for merging in a dense medium, of a sample whose distances have this channel.
    pub(crate) fn medium_photon(
        &self,
        scene: &Scene,
        channel: u8,
    ) -> Option<(PhotonPosition, MediumPhoton<N>)> {
        let (Interaction::Medium(MediumPoint { p, is_inside, .. }), Some(ball)) = (self.at, self.ball) else {
            return None;
        };
        let (object, _) = self.media.scattering(scene)?;
        let counted = self.events.counted - u32::from(!is_inside);
        let Vertex { wo, beta, odds, partial, events, .. } = *self;
        let walk = PhotonWalk { odds, channel };
        let straight_from = self.straight_from.map(|light| light as u32);
        Some((
            PhotonPosition::new(p, counted, self.depth - counted, self.came_split, self.origin),
            MediumPhoton { wo, beta, partial, events, object, straight_from, walk, radius: ball.radius },
        ))
    }

    /// The media in which light travels on along `direction`.
    pub(crate) fn media_towards(&self, scene: &Scene, direction: Vec3) -> Media {
        self.media.towards(scene, &self.at, self.wo, direction)
    }
}

/// The number of vertices of a subpath up to the one after `depth` scattering events: this one, one per event, and
/// the one on the light or at the camera.
pub(crate) fn count(depth: u32) -> u32 {
    depth + 2
}

/// The fraction of the vertices of light subpaths that are kept for connections, at this number of an event in a row in media: all of
/// the first, then fewer and fewer, which count for more. Some walks through milk have ten thousand events.
pub(super) fn kept_share(number: u32) -> f32 {
    const ALL: u32 = 64;
    if number <= ALL { 1.0 } else { ALL as f32 / number as f32 }
}
