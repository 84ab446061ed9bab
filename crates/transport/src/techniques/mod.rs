//! The techniques that find paths, and what one technique contributes before its MIS weight.
//!
//! Everything is computed for `N` sets of techniques at once, one number per set. The first set weights the light. The others are rivals
//! whose weights `auto` compares with its own; where there are none, `N` is 1 and they cost nothing.

pub(crate) mod mis;
pub(crate) mod optical_path;

use crate::techniques::optical_path::{OpticalPath, PathPoint};
use bilux_math::{Rgb, Vec2, Vec3};
use std::ops::{Add, Mul};

/// One number per set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PerSet<const N: usize>(pub(crate) [f32; N]);

/// The number of samples of each technique per camera subpath. Light sampling (s = 1) and hitting an emitter by chance
/// (s = 0) always count one each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TechniqueCounts<const N: usize = 1> {
    /// Light subpaths that are connected with the camera (t = 1).
    pub(crate) splats: PerSet<N>,
    /// Light subpaths whose vertices are connected with those of the camera subpath (s, t > 1).
    pub(crate) connections: PerSet<N>,
    /// η: light subpaths that a merged vertex counts, times the area of merging.
    /// All of them count as independent, although they share one camera subpath [Grittmann 2021]: see docs/adr/0012-both-ends.md.
    pub(crate) eta: PerSet<N>,
    /// η of beams that cross in a medium: light subpaths whose beams are kept, times the width of merging, in metres.
    pub(crate) beams: PerSet<N>,
    /// Media of a larger extinction in any channel, per metre, have points in place of beams: light subpaths have many short ones there.
    pub(crate) densest: f32,
    /// Light subpaths whose points in those media are merged.
    pub(crate) points: PerSet<N>,
    /// The merging radius, in metres; that of points may be [smaller](crate::media::ball::Ball).
    pub(crate) radius: f32,
    /// Light subpaths are connected with the camera, and merged, also where they come straight from a light: on surfaces, and in
    /// media with [equiangular points](crate::media::equiangular). In other media they always are.
    ///
    /// A few lights do not need this: a point on each is sampled with next to no noise, and against that the balance
    /// heuristic gives photons too much weight. In other media, close to a light, such a point is noise.
    pub(crate) direct: bool,
    /// Light subpaths are connected with the camera also where they come straight from a light into media with equiangular points, and not merged
    /// there: some lamp shines into a cone. Of what is lit in a narrow one, points on rays find little, and splats find all.
    pub(crate) splats_cones: bool,
}

/// By which techniques light subpaths find light that comes straight from a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DirectLight {
    /// They are connected with the camera.
    pub(crate) splats: bool,
    /// They are merged with camera subpaths.
    pub(crate) merges: bool,
}

impl DirectLight {
    /// By all that they have.
    pub(crate) const ALL: DirectLight = DirectLight { splats: true, merges: true };
    pub(crate) const NONE: DirectLight = DirectLight { splats: false, merges: false };

    /// By those that these are not.
    pub(crate) fn others(self) -> DirectLight {
        DirectLight { splats: !self.splats, merges: !self.merges }
    }
}

/// The [origin](Contribution::origin), where light is sorted by lights, of what comes from none of them: from media, and from surfaces that are
/// not sampled.
pub(crate) const NO_LIGHT: u16 = u16::MAX;

/// Contribution of one technique for one path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contribution<const N: usize = 1> {
    /// Light of the path, over the density with which one camera subpath finds it by this technique.
    pub(crate) light: Rgb,
    /// Frequency with which this technique finds it.
    pub(crate) own: PerSet<N>,
    /// Frequency with which all other techniques find it.
    pub(crate) others: PerSet<N>,
    /// A factor on its weight, for the sake of the other technique that a camera subpath has for finding a light:
    /// [`power_factor`].
    pub(crate) power_factor: f32,
    /// The cell in which its light subpath began: [`crate::light::emission::Start::cell`]; without a light subpath, the
    /// [number](crate::light::emission::light_number) of the light.
    pub(crate) origin: u16,
}

/// A technique: subpaths of `s` vertices from the light and of `t` from the camera, both end points included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Technique {
    /// Their last vertices are connected. With s = 0 the camera subpath hits an emitter by chance, with s = 1 a point
    /// on a light is sampled, and with t = 1 a light subpath is connected with the camera.
    Connected { s: u32, t: u32 },
    /// Their last vertices are merged into one, or where their last rays cross.
    Merged { s: u32, t: u32 },
}

/// A step that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A ray of a light subpath, and the work where it arrives.
    Light,
    /// A ray of a camera subpath, and the work where it arrives.
    Camera,
    /// A vertex of a light subpath is connected with the camera.
    Seen,
    /// A point on a light is sampled.
    Picked,
    /// Two vertices are connected.
    Connected,
    /// Photons around a vertex are looked up.
    Lookup,
    /// Beams across a ray are looked up.
    Across,
}

/// Receives contributions.
pub(crate) trait Tally<const N: usize> {
    /// Announces steps that are about to be taken.
    #[inline(always)]
    fn spend(&mut self, _step: Step, _count: usize) {}

    /// Announces a vertex of the camera subpath, before what it contributes.
    #[inline(always)]
    fn reach(&mut self, _place: impl FnOnce() -> PathPoint) {}

    /// Announces a vertex of the light subpath, after so many events; the first one with what came before it.
    #[inline(always)]
    fn reach_from_light(
        &mut self,
        _depth: u32,
        _start: impl FnOnce() -> OpticalPath,
        _place: impl FnOnce() -> PathPoint,
    ) {
    }

    /// Announces a connection from a point in a direction, for a distance in metres unless that is infinite, before what it contributes.
    #[inline(always)]
    fn join(&mut self, _from: Vec3, _direction: Vec3, _distance: Option<f32>) {}

    /// Adds to the pixel of the camera subpath.
    fn add_sample(&mut self, technique: Technique, found: &Contribution<N>);
    /// Adds at a point of the film's plane (the film is 0..1 on both axes), as an integral over the whole film.
    fn add_splat(&mut self, film: Vec2, technique: Technique, found: &Contribution<N>);
}

/// The weighted light of a sample in its own pixel; splats are left out.
#[derive(Clone, Copy, Default)]
pub(crate) struct PixelSum(pub(crate) Rgb);

impl Tally<1> for PixelSum {
    fn add_sample(&mut self, _technique: Technique, found: &Contribution) {
        self.0 += found.weighted();
    }
    fn add_splat(&mut self, _film: Vec2, _technique: Technique, _found: &Contribution) {}
}

/// Receives the light subpaths' connections with the camera while they are traced, tile by tile on all threads.
pub(crate) trait LightPathVisitor<const N: usize>: Sync {
    type Tally: Tally<N>;
    /// Makes the tally for one tile.
    fn tally(&self) -> Self::Tally;
    /// The next light subpath belongs to this pixel's sample.
    fn begin(_tally: &mut Self::Tally, _x: u32, _y: u32, _sample: u32) {}
    /// Takes what the camera sees of a tile's light subpaths.
    fn take(&self, tile: usize, tally: Self::Tally);
}

impl TechniqueCounts {
    /// Camera subpaths alone.
    pub(crate) const CAMERA: TechniqueCounts = TechniqueCounts {
        splats: PerSet([0.0]),
        connections: PerSet([0.0]),
        eta: PerSet([0.0]),
        beams: PerSet([0.0]),
        densest: 0.0,
        points: PerSet([0.0]),
        radius: 0.0,
        direct: true,
        splats_cones: false,
    };
    /// With or without splats, and with or without connections.
    pub(crate) fn with_splats_and_connections(splats: bool, connections: bool) -> TechniqueCounts {
        TechniqueCounts {
            splats: PerSet([f32::from(splats)]),
            connections: PerSet([f32::from(connections)]),
            ..TechniqueCounts::CAMERA
        }
    }

    /// True where each camera subpath has a light subpath of its own.
    pub(crate) fn begins_at_lights(&self) -> bool {
        self.splats != PerSet::ZERO || self.connections != PerSet::ZERO
    }

    /// All techniques except merging.
    pub(crate) const BOTH_ENDS: TechniqueCounts =
        TechniqueCounts { splats: PerSet([1.0]), connections: PerSet([1.0]), ..TechniqueCounts::CAMERA };
}

impl<const N: usize> TechniqueCounts<N> {
    /// Packs single sets; they treat direct light alike.
    pub(crate) fn pack(mut sets: impl Iterator<Item = TechniqueCounts>) -> TechniqueCounts<N> {
        let mut all = TechniqueCounts {
            splats: PerSet::ZERO,
            connections: PerSet::ZERO,
            eta: PerSet::ZERO,
            beams: PerSet::ZERO,
            densest: 0.0,
            points: PerSet::ZERO,
            radius: 0.0,
            direct: true,
            splats_cones: false,
        };
        for k in 0..N {
            let Some(set) = sets.next() else { break };
            (all.splats.0[k], all.connections.0[k]) = (set.splats.0[0], set.connections.0[0]);
            (all.eta.0[k], all.beams.0[k]) = (set.eta.0[0], set.beams.0[0]);
            all.points.0[k] = set.points.0[0];
            (all.densest, all.radius, all.direct) = (set.densest, set.radius, set.direct);
            all.splats_cones = set.splats_cones;
        }
        all
    }

    /// Frequency with which beams that cross at a right angle count, over both walks having events there, in a channel of a
    /// medium of this extinction.
    #[inline]
    pub(crate) fn crossings(&self, sigma_t: Rgb, channel: u8) -> PerSet<N> {
        let sigma = sigma_t[usize::from(channel)];
        if self.has_beams_in(sigma_t) { self.beams * (1.0 / (sigma * sigma)) } else { PerSet::ZERO }
    }

    /// Whether there are beams in a medium of this extinction that is the same everywhere.
    #[inline]
    pub(crate) fn has_beams_in(&self, sigma_t: Rgb) -> bool {
        self.beams != PerSet::ZERO && sigma_t.max_channel() <= self.densest
    }
}

impl<const N: usize> Contribution<N> {
    /// A contribution that no other technique finds.
    pub(crate) fn only(light: Rgb) -> Contribution<N> {
        Contribution { light, own: PerSet::ONE, others: PerSet::ZERO, power_factor: 1.0, origin: NO_LIGHT }
    }

    /// MIS weight: the balance heuristic, except for [`power_factor`].
    pub(crate) fn mis_weight(&self) -> f32 {
        self.own.0[0] * (self.power_factor / (self.own.0[0] + self.others.0[0]))
    }

    /// Weighted by the balance heuristic [Veach 1997, eq. 9.8], except for [`power_factor`].
    pub(crate) fn weighted(&self) -> Rgb {
        self.light * (self.power_factor / (self.own.0[0] + self.others.0[0]))
    }

    /// Light of the scene that it comes from, where light is sorted by lights.
    pub(crate) fn light_index(&self) -> Option<usize> {
        (self.origin != NO_LIGHT).then_some(self.origin.into())
    }
}

/// The factor on the weight of one of the two techniques by which a camera subpath finds a light on its own, where the
/// other one finds the light `other` times as often.
///
/// A camera subpath samples a point on the light, or hits the light by chance. Against all other techniques these two
/// count together as in the balance heuristic. Their joint share is split by the power heuristic
/// [Veach 1997, eq. 9.17], since one of the two is often so good that any share of the other is noise.
pub(crate) fn power_factor(other: f32) -> f32 {
    // The inverse, where squares of large numbers would overflow.
    if other <= 1.0 {
        (1.0 + other) / (1.0 + other * other)
    } else {
        let own = 1.0 / other;
        own * (1.0 + own) / (1.0 + own * own)
    }
}

impl<const N: usize> PerSet<N> {
    pub(crate) const ONE: PerSet<N> = PerSet([1.0; N]);
    pub(crate) const ZERO: PerSet<N> = PerSet([0.0; N]);
}

impl<const N: usize> Add for PerSet<N> {
    type Output = PerSet<N>;
    #[inline(always)]
    fn add(mut self, other: PerSet<N>) -> PerSet<N> {
        for (x, y) in self.0.iter_mut().zip(other.0) {
            *x += y;
        }
        self
    }
}

impl<const N: usize> Mul<f32> for PerSet<N> {
    type Output = PerSet<N>;
    #[inline(always)]
    fn mul(mut self, factor: f32) -> PerSet<N> {
        for x in &mut self.0 {
            *x *= factor;
        }
        self
    }
}
