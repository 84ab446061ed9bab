//! The sets of techniques that are compared.

use crate::photons::Merging;
use crate::techniques::TechniqueCounts;

/// A set of techniques, as well as those that a camera subpath has on its own.
pub(super) struct Set {
    pub(super) name: &'static str,
    /// Name as a parameter value.
    pub(super) techniques: &'static str,
    pub(super) splats: bool,
    pub(super) connections: bool,
    /// Light subpaths per pixel whose photons are merged with; 0 without merging.
    pub(super) photons: f32,
}

/// The sets to choose from, the simplest first.
pub(super) const SETS: [Set; 8] = [
    Set { name: "path", techniques: "path", splats: false, connections: false, photons: 0.0 },
    Set { name: "path and light", techniques: "path-light", splats: true, connections: false, photons: 0.0 },
    Set { name: "bdpt", techniques: "bdpt", splats: true, connections: true, photons: 0.0 },
    Set {
        name: "path and few photons",
        techniques: "path-few",
        splats: false,
        connections: false,
        photons: FEW,
    },
    Set {
        name: "path and photons",
        techniques: "path-photons",
        splats: false,
        connections: false,
        photons: 1.0,
    },
    Set {
        name: "path, light and few photons",
        techniques: "path-light-few",
        splats: true,
        connections: false,
        photons: FEW,
    },
    Set {
        name: "path, light and photons",
        techniques: "path-light-photons",
        splats: true,
        connections: false,
        photons: 1.0,
    },
    Set { name: "vcm", techniques: "vcm", splats: true, connections: true, photons: 1.0 },
];

/// Light subpaths per pixel of the sets with few photons: enough where they go where they are useful.
const FEW: f32 = 0.25;

impl Set {
    pub(super) fn merges(&self) -> bool {
        self.photons > 0.0
    }

    /// Restricts settings that merge with all light subpaths to the techniques of this set.
    pub(super) fn merging(&self, merging: Merging) -> Merging {
        Merging {
            radius: if self.merges() { merging.radius } else { 0.0 },
            part: merging.part * self.photons,
            techniques: TechniqueCounts {
                direct: merging.techniques.direct,
                splats_cones: merging.techniques.splats_cones,
                ..TechniqueCounts::with_splats_and_connections(self.splats, self.connections)
            },
            ..merging
        }
    }
}

/// All values of the parameter `techniques`.
pub(super) const TECHNIQUES: [&str; 1 + SETS.len()] = {
    let mut techniques = ["auto"; 1 + SETS.len()];
    let mut i = 0;
    while i < SETS.len() {
        techniques[1 + i] = SETS[i].techniques;
        i += 1;
    }
    techniques
};

/// One set for the techniques of the pilot itself, and one for each set that is compared.
pub(super) const SET_COUNT: usize = 1 + SETS.len();

/// The fraction of the mean below which noise is not visible.
pub(super) const DARK: f64 = 0.3;
