//! The graphics state, which applies to the following directives.

use super::parameters::Parameter;
use bilux_import::appearance::spectra::colours::ColourSpace;
use bilux_math::DMat4;
use std::sync::Arc;

/// The transforms from the current space to world space, at the start and the end time.
///
/// Before `WorldBegin`, they map from it to camera space.
pub(super) type Matrices = [DMat4; 2];

/// The material of a shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum MaterialKey {
    /// No material was set.
    #[default]
    Default,
    /// By its index.
    Index(usize),
    /// By its name, which may be defined later in the file.
    Named(Arc<str>),
}

/// The targets of attributes.
pub(super) const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// The graphics state.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) matrices: Matrices,
    /// Which of the two matrices transforms apply to: the start, the end.
    pub(super) is_active: [bool; 2],
    pub(super) reverses: bool,
    pub(super) space: ColourSpace,
    pub(super) material: MaterialKey,
    /// The index of the current area light.
    pub(super) area_light: Option<usize>,
    /// The names of the interior and the exterior medium; empty for none.
    pub(super) media: [Arc<str>; 2],
    /// The attributes for each of [`TARGETS`].
    pub(super) attributes: [Arc<Vec<Parameter>>; 5],
}

impl State {
    pub(super) fn new() -> State {
        State { matrices: [DMat4::IDENTITY; 2], is_active: [true; 2], ..State::default() }
    }

    /// Changes the active matrices.
    pub(super) fn change(&mut self, change: impl Fn(DMat4) -> DMat4) {
        for (matrix, _) in self.matrices.iter_mut().zip(self.is_active).filter(|(_, active)| *active) {
            *matrix = change(*matrix);
        }
    }

    /// The attributes for one of [`TARGETS`].
    pub(super) fn attributes_of(&self, target: &str) -> Arc<Vec<Parameter>> {
        let index = TARGETS.iter().position(|known| *known == target);
        index.map(|i| self.attributes[i].clone()).unwrap_or_default()
    }
}
