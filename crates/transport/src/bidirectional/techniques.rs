//! Which ways of finding a path there are, and what one of them has found before it is weighted against the others.
//!
//! All of it is done for `N` sets of ways at once. The first is the one by which light is weighted. The others are
//! rivals, whose weights `auto` compares with its own; where there are none, `N` is 1 and they cost nothing.

use bilux_math::{Rgb, Vec2};
use std::ops::{Add, Mul};

/// A number for each of the sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f32; N]);

/// How many of each way there are for one camera path. A light that is picked (s = 1) and one that is met by
/// chance (s = 0) are always one each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TechniqueCounts<const N: usize = 1> {
    /// Light paths that are seen from the camera (t = 1).
    pub(crate) splats: Lanes<N>,
    /// Light paths whose vertices are joined with those of the camera path (s, t > 1).
    pub(crate) joins: Lanes<N>,
    /// η: light paths that a merged vertex counts, over area.
    pub(crate) eta: Lanes<N>,
    /// Light paths are also seen, and merged with, where they have come straight from a light. Few lights need no such help:
    /// a point on each is picked, with next to no noise, beside which the balance heuristic gives photons too much weight.
    pub(crate) direct: bool,
}

/// What one way has found of one path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contribution<const N: usize = 1> {
    /// Its light, over the density with which one camera path finds it in this way.
    pub(crate) light: Rgb,
    /// How often it is found in this way.
    pub(crate) own: Lanes<N>,
    /// How often in all others.
    pub(crate) others: Lanes<N>,
    /// What its weight is multiplied by, for the sake of the other way that a camera path has of finding a light: [`favour`].
    pub(crate) favour: f32,
    /// Where the light path began by which it was found: [`crate::emission::Start::cell`]; 0 where there was none.
    pub(crate) origin: u16,
}

/// Which way it was: subpaths of `s` vertices from the light and of `t` from the camera, both ends' own included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Technique {
    /// Their last vertices are joined. A light is met by chance with s = 0, a point on a light picked with s = 1, and a
    /// light path seen from the camera with t = 1.
    Joined { s: u32, t: u32 },
    /// Their last vertices count as one.
    Merged { s: u32, t: u32 },
}

/// A step that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A ray of a light path, and what is done where it arrives.
    Light,
    /// The same of a camera path.
    Camera,
    /// A light path's vertex is shown to the camera.
    Seen,
    /// A point on a light is picked.
    Picked,
    /// Two vertices are joined.
    Joined,
    /// Photons are looked for around a vertex.
    Lookup,
}

/// Takes what is found.
pub(crate) trait Tally<const N: usize> {
    /// Steps are about to be taken.
    #[inline(always)]
    fn spend(&mut self, _step: Step, _count: usize) {}

    /// In the pixel of the camera path.
    fn here(&mut self, technique: Technique, found: &Contribution<N>);
    /// At a point of the film (0..=1 on both axes), as an integral over the whole of it.
    fn there(&mut self, film: Vec2, technique: Technique, found: &Contribution<N>);
}

impl TechniqueCounts {
    /// Paths from the camera alone.
    pub(crate) const CAMERA: TechniqueCounts =
        TechniqueCounts { splats: Lanes([0.0]), joins: Lanes([0.0]), eta: Lanes([0.0]), direct: true };
    /// With light paths that are seen from the camera or not, and joined or not.
    pub(crate) fn beside_merging(splats: bool, joins: bool) -> TechniqueCounts {
        TechniqueCounts {
            splats: Lanes([f32::from(splats)]),
            joins: Lanes([f32::from(joins)]),
            ..TechniqueCounts::CAMERA
        }
    }

    /// True where each camera path has a light path of its own.
    pub(crate) fn begins_at_lights(&self) -> bool {
        self.splats != Lanes::ZERO || self.joins != Lanes::ZERO
    }

    /// All that need no merging.
    pub(crate) const BOTH_ENDS: TechniqueCounts =
        TechniqueCounts { splats: Lanes([1.0]), joins: Lanes([1.0]), ..TechniqueCounts::CAMERA };
}

impl<const N: usize> TechniqueCounts<N> {
    /// Single sets as lanes, alike in how they find direct light.
    pub(crate) fn together(mut sets: impl Iterator<Item = TechniqueCounts>) -> TechniqueCounts<N> {
        let mut all =
            TechniqueCounts { splats: Lanes::ZERO, joins: Lanes::ZERO, eta: Lanes::ZERO, direct: true };
        for k in 0..N {
            let Some(set) = sets.next() else { break };
            (all.splats.0[k], all.joins.0[k], all.eta.0[k]) = (set.splats.0[0], set.joins.0[0], set.eta.0[0]);
            all.direct = set.direct;
        }
        all
    }
}

impl<const N: usize> Contribution<N> {
    /// What is found in no other way.
    pub(crate) fn only(light: Rgb) -> Contribution<N> {
        Contribution { light, own: Lanes::ONE, others: Lanes::ZERO, favour: 1.0, origin: 0 }
    }

    /// The balance heuristic [Veach 1997, eq. 9.8], but for [`favour`].
    pub(crate) fn weighted(&self) -> Rgb {
        self.light * (self.favour / (self.own.0[0] + self.others.0[0]))
    }
}

/// A camera path finds a light in two ways by itself: it picks a point there, or meets it by chance. Beside all others they
/// count together as the balance heuristic has it; what falls to both is shared by the power heuristic [Veach 1997, eq. 9.17],
/// since the one of them is often so good that any part of the other is noise. This is by how much more or less that one
/// counts of which the other finds `other` times as much.
pub(crate) fn favour(other: f32) -> f32 {
    // By the inverse where squares of large numbers would overflow.
    if other <= 1.0 {
        (1.0 + other) / (1.0 + other * other)
    } else {
        let own = 1.0 / other;
        own * (1.0 + own) / (1.0 + own * own)
    }
}

impl<const N: usize> Lanes<N> {
    pub(crate) const ONE: Lanes<N> = Lanes([1.0; N]);
    pub(crate) const ZERO: Lanes<N> = Lanes([0.0; N]);
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Lanes<N>;
    #[inline(always)]
    fn add(mut self, other: Lanes<N>) -> Lanes<N> {
        for (x, y) in self.0.iter_mut().zip(other.0) {
            *x += y;
        }
        self
    }
}

impl<const N: usize> Mul<f32> for Lanes<N> {
    type Output = Lanes<N>;
    #[inline(always)]
    fn mul(mut self, factor: f32) -> Lanes<N> {
        for x in &mut self.0 {
            *x *= factor;
        }
        self
    }
}
