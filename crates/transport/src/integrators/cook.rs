//! `cook`: distributed ray tracing. It spreads the rays of `whitted` over pixel, gloss, translucency, area lights, lens
//! and time. With every extent zero it equals `whitted`, to the bit.

use super::{CameraSpread, IntegratorEntry, PixelIntegrator};
use crate::classic::{self, CUTOFF, FRESNEL, RayTree, SHADOW_RULE, SHADOWS, SPECULAR};
use crate::sampling::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{Ray, Reader};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "cook",
        summary: "distributed ray tracing: soft shadows, gloss, translucency, depth of field, motion blur",
        source: "Cook 1984",
        parameters: &[
            SPECULAR,
            FRESNEL,
            SHADOW_RULE,
            SHADOWS,
            CUTOFF,
            extent("extent", "factor on all the fractions below"),
            extent("pixel", "fraction of the pixel filter that samples cover"),
            extent("gloss", "fraction of the materials' gloss that reflected rays cover"),
            extent("translucency", "fraction of the materials' translucency that refracted rays cover"),
            extent("lights", "fraction of the area lights' size"),
            extent("lens", "fraction of the camera's aperture that is open"),
            extent("shutter", "fraction of the shutter time that is open"),
        ],
    },
    covers: "L(D|G)?(S|G)*E",
    classic: true,
    default_spp: 64,
    build: |reader| Ok(Box::new(Cook::new(reader))),
};

const fn extent(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: 0.0, max: 1.0 }, default: "1" }
}

struct Cook {
    tree: RayTree,
    spread: CameraSpread,
}

impl Cook {
    fn new(reader: &Reader) -> Cook {
        let extent = |key| reader.number("extent") * reader.number(key);
        let mut tree = classic::ray_tree(reader);
        tree.local.light_extent = extent("lights");
        tree.gloss_extent = extent("gloss");
        tree.translucency_extent = extent("translucency");
        let spread =
            CameraSpread { pixel: extent("pixel"), lens: extent("lens"), shutter: extent("shutter") };
        Cook { tree, spread }
    }
}

impl PixelIntegrator for Cook {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.tree.intensity(task, ray)
    }

    fn camera_spread(&self) -> CameraSpread {
        self.spread
    }
}
