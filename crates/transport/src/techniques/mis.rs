//! Terms that a subpath carries along for the weights of its techniques.

use crate::film::limits::MAX_CONNECTED_ROW;
use crate::techniques::{DirectLight, PerSet, TechniqueCounts};

/// The recursive part of the MIS weights. [Georgiev 2012]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partial<const N: usize = 1> {
    /// dVCM: 1 over the density of the last step, times the density of connecting there instead.
    pub(crate) d_vcm: f32,
    /// dVCM times the number of techniques that connect there.
    pub(crate) connected: PerSet<N>,
    /// dVCM times the number of techniques that connect there with the camera.
    pub(crate) splatted: PerSet<N>,
    /// Frequency with which [merging](crate::media::interaction::Interaction::merged) counts this vertex.
    pub(crate) merged: PerSet<N>,
    /// dVC: what connections and merging count together, summed over the steps before.
    pub(crate) d_vc: PerSet<N>,
    /// In a medium, the part of it that counts however many events there follow one another: [`Partial::in_row`].
    pub(crate) settled: PerSet<N>,
    /// The part of it that does not count if an emitter is hit next, since light subpaths leave direct light to others.
    pub(crate) except_direct: PerSet<N>,
}

/// Factors that turn densities over solid angle into those of arriving, per area or per volume, times the squared distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// At the end: the cosine at a surface, or the density of an event in a medium, times the probability of coming so far.
    pub(crate) forward: f32,
    /// At the start: likewise, but without the cosine at a surface, which the subpath has counted when it left.
    pub(crate) back: f32,
}

impl<const N: usize> Partial<N> {
    /// The start of a camera subpath, before any vertex.
    pub(crate) const START: Partial<N> = Partial {
        d_vcm: 0.0,
        connected: PerSet::ZERO,
        splatted: PerSet::ZERO,
        merged: PerSet::ZERO,
        d_vc: PerSet::ZERO,
        settled: PerSet::ZERO,
        except_direct: PerSet::ZERO,
    };

    /// A light subpath that leaves its light under the cosine `cos`. `pdf_direct` does not yet know the point that
    /// would sample the light.
    pub(crate) fn of_light(pdf_direct: f32, pdf_emission: f32, cos: f32, is_delta: bool) -> Partial<N> {
        let d_vc = if is_delta { 0.0 } else { cos / pdf_emission };
        Partial { d_vcm: pdf_direct / pdf_emission, d_vc: PerSet::ONE * d_vc, ..Partial::START }
    }

    /// A camera subpath at its first vertex, given the density over area or volume of arriving there, and what merging counts
    /// there.
    pub(crate) fn of_camera(pdf: f32, techniques: &TechniqueCounts<N>, merged: PerSet<N>) -> Partial<N> {
        let d_vcm = 1.0 / pdf;
        Partial { d_vcm, splatted: techniques.splats * d_vcm, merged, ..Partial::START }
    }

    /// Arrives from the distance √`distance2`, by an [edge](Edge), where `connections` techniques connect the last vertex with
    /// this one, and merging counts `merged`.
    pub(crate) fn arrive(&mut self, distance2: f32, edge: Edge, connections: PerSet<N>, merged: PerSet<N>) {
        self.pass(distance2, edge);
        self.connected = connections * self.d_vcm;
        self.splatted = PerSet::ZERO;
        self.merged = merged;
    }

    /// After arriving at the event of this number in a row in media, counted from 1; `leaves_medium` unless it is the first.
    ///
    /// Two points of a medium are connected only in short rows, so what counts is known where a row ends, or becomes too long.
    #[inline]
    pub(crate) fn in_row(&mut self, number: u32) {
        if number == 1 {
            self.settled = self.d_vc;
        } else if number > MAX_CONNECTED_ROW {
            (self.d_vc, self.connected) = (self.settled, PerSet::ZERO);
        }
    }

    /// Goes along an edge; where it ends infinitely far away, densities stay over solid angle, and `distance2` is 1.
    #[inline]
    pub(crate) fn pass(&mut self, distance2: f32, edge: Edge) {
        self.d_vcm *= distance2 / edge.forward;
        let ratio = edge.back / edge.forward;
        self.d_vc = self.d_vc * ratio;
        self.settled = self.settled * ratio;
        self.except_direct = self.except_direct * ratio;
    }

    /// Leaves under the cosine `cos` (1 in a medium), with the forward and reverse densities; `None` for a delta event. `direct` is
    /// how light subpaths [find direct light](crate::media::interaction::Interaction::direct_light) here; `row` is the number of events in a row in
    /// media, up to this one; `sine` is that of the [angle](crate::media::interaction::Interaction::sine) here.
    pub(crate) fn leave(
        &mut self,
        cos: f32,
        sine: f32,
        pdfs: Option<(f32, f32)>,
        direct: DirectLight,
        row: u32,
    ) {
        match pdfs {
            None => {
                self.d_vcm = 0.0;
                self.d_vc = (self.d_vc + self.except_direct) * cos;
                self.except_direct = PerSet::ZERO;
            }
            Some((pdf, pdf_back)) => {
                let merged = self.merged * sine;
                let found = |by: DirectLight| match by {
                    DirectLight::NONE => PerSet::ZERO,
                    by => self.found(merged, by) * (cos / pdf),
                };
                let [always, except_direct] = [found(direct), found(direct.others())];
                if row > 0 {
                    let connected = if row == 1 { self.connected } else { PerSet::ZERO };
                    let settled = (self.settled + self.except_direct) * pdf_back + connected;
                    self.settled = settled * (cos / pdf) + always;
                }
                self.d_vc =
                    ((self.d_vc + self.except_direct) * pdf_back + self.connected) * (cos / pdf) + always;
                self.except_direct = except_direct;
                self.d_vcm = 1.0 / pdf;
            }
        }
    }

    /// The sum over all techniques that move this subpath's vertices to the other side, relative to the current one.
    ///
    /// The other side would find this subpath's end with density `pdf_area`, and from there the vertex before it with
    /// `pdf_back`. `sine` is that of the [angle](crate::media::interaction::Interaction::sine) there.
    pub(crate) fn others(&self, pdf_area: f32, pdf_back: f32, sine: f32) -> PerSet<N> {
        (self.merged * sine + self.before(pdf_back)) * pdf_area
    }

    /// Sum of [`Partial::others`] where the vertex on the other side is on a light.
    pub(crate) fn others_of_direct(
        &self,
        pdf_area: f32,
        pdf_back: f32,
        sine: f32,
        direct: DirectLight,
    ) -> PerSet<N> {
        if direct == DirectLight::ALL {
            return self.others(pdf_area, pdf_back, sine);
        }
        let found = self.found(self.merged * sine, direct);
        (found + self.connected + (self.d_vc + self.except_direct) * pdf_back) * pdf_area
    }

    /// Frequency with which the techniques of `direct` find the vertex, where `merged` is how often merging does.
    fn found(&self, merged: PerSet<N>, direct: DirectLight) -> PerSet<N> {
        let counted = |counts: PerSet<N>, is_one| if is_one { counts } else { PerSet::ZERO };
        counted(merged, direct.merges) + counted(self.splatted, direct.splats)
    }

    /// Sum of [`Partial::others`] over the density of finding this vertex, without merging here.
    pub(crate) fn before(&self, pdf_back: f32) -> PerSet<N> {
        self.connected + self.splatted + (self.d_vc + self.except_direct) * pdf_back
    }

    /// [`Partial::before`], at a point of a medium that is the event of this number in a row, where the whole path has a `row` of so
    /// many: between the points of long ones nothing is connected.
    pub(crate) fn before_crossing(mut self, pdf_back: f32, number: u32, row: u32) -> PerSet<N> {
        self.in_row(number);
        if row > MAX_CONNECTED_ROW {
            self.d_vc = self.settled;
            if number > 1 {
                self.connected = PerSet::ZERO;
            }
        }
        self.before(pdf_back)
    }
}
