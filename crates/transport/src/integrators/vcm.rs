//! `vcm`: vertex connection and merging. It has all techniques of `bdpt`, and one more: a vertex of a camera subpath
//! and a nearby vertex of a light subpath are merged into one, at the cost of a little blur that vanishes with the
//! iterations. This finds light that passes through mirrors or glass at both ends. [Georgiev 2012; Hachisuka 2012]

use super::bdpt::of_camera_path;
use super::{IntegratorEntry, LightSubpaths, PixelIntegrator};
use crate::bidirectional::BothEnds;
use crate::light::emission::Guide;
use crate::photons::{MergeCounts, Merging, Photons};
use crate::sampling::task::Task;
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::Ray;
use std::sync::Arc;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "vcm",
        summary: "vertex connection and merging: bidirectional path tracing combined with photon mapping",
        source: "Georgiev 2012",
        parameters: &[
            super::ROULETTE_DEPTH,
            super::merging::radius(0.0),
            super::merging::ALPHA,
            super::merging::LIGHT_PATHS,
            super::merging::CONNECTIONS,
            super::merging::SPLATS,
            super::merging::DIRECT,
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        let (splats, connections) = (reader.bool("splats"), reader.bool("connections"));
        let techniques = TechniqueCounts::with_splats_and_connections(splats, connections);
        let mut merging = super::merging::read(reader, techniques);
        // Without merging it is `bdpt`.
        merging.techniques.direct = reader.bool("direct") || merging.radius == 0.0;
        Ok(Box::new(Vcm { merging, guide: None }))
    },
};

/// Vertex connection and merging, with the techniques of `merging`.
pub(super) struct Vcm {
    pub(super) merging: Merging,
    /// The guide that aims light subpaths.
    pub(super) guide: Option<Arc<Guide>>,
}

impl PixelIntegrator for Vcm {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        of_camera_path(ray, task, &self.unmerged())
    }

    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }
}

impl LightSubpaths for Vcm {
    fn splats(&self) -> bool {
        // Where photons are connected with the camera, that happens before the camera subpaths are traced.
        self.merging.techniques.begins_at_lights() && !self.merging.splats_photons()
    }

    fn merging(&self) -> Option<&Merging> {
        (self.merging.radius > 0.0).then_some(&self.merging)
    }

    fn guide(&self) -> Option<Arc<Guide>> {
        self.guide.clone()
    }

    fn both_ends<'a>(&self, photons: Option<&'a Photons>) -> Option<BothEnds<'a>> {
        let splats = !self.merging.splats_photons() && self.merging.techniques.splats != PerSet::ZERO;
        Some(match photons {
            Some(photons) => BothEnds::merging(photons, splats, self.merging.roulette_depth),
            None => self.unmerged(),
        })
    }
}

impl Vcm {
    fn unmerged(&self) -> BothEnds<'static> {
        BothEnds::new(self.merging.techniques(&MergeCounts::NONE), self.merging.roulette_depth)
    }
}
