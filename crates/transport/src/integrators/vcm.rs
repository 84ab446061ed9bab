//! `vcm`: vertex connection and merging. All ways of `bdpt`, and one more: a vertex of a camera path and one of a light
//! path that lie next to each other count as one, at the price of a little blur that goes away with the iterations. So
//! light is found that passes mirrors or glass at both ends. [Georgiev 2012; Hachisuka 2012]

use super::bdpt::Bdpt;
use super::{IntegratorEntry, PixelIntegrator};
use crate::bidirectional::Merging;
use crate::splats::Splats;
use crate::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "vcm",
        summary: "vertex connection and merging: as bdpt, and photons where neither end can see the other",
        source: "Georgiev 2012",
        parameters: &[
            super::ROULETTE_DEPTH,
            super::merging::radius(0.0),
            super::merging::ALPHA,
            super::merging::LIGHT_PATHS,
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| Ok(Box::new(Vcm { bdpt: Bdpt::new(reader), merging: super::merging::read(reader) })),
};

struct Vcm {
    bdpt: Bdpt,
    merging: Merging,
}

impl PixelIntegrator for Vcm {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.bdpt.radiance(ray, task)
    }

    fn splats(&self) -> bool {
        true
    }

    fn merging(&self) -> Option<&Merging> {
        (self.merging.radius > 0.0).then_some(&self.merging)
    }

    fn roulette_depth(&self) -> u32 {
        self.bdpt.roulette_depth()
    }

    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        self.bdpt.sample(ray, is_wanted, task, splats)
    }
}
