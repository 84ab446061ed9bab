//! The top level over the trees of a scene, and the sheets that were found with it, kept from one build to the next.

use super::parts::SceneParts;
use super::sheets::Sheets;
use crate::geometry::accel_choice::AccelChoice;
use crate::kept::Place;
use bilux_accel::Instance;
use bilux_accel::instancing::TwoLevel;
use bilux_math::motion::Motion;
use std::sync::Arc;

/// Top level and sheets of the last build, with what they were made from.
#[derive(Clone, Default)]
pub(crate) struct Top(Option<Known>);

#[derive(Clone)]
struct Known {
    parts: Arc<SceneParts>,
    shutter: [f32; 2],
    is_list: bool,
    accelerator: Arc<TwoLevel>,
    sheets: Option<Sheets>,
}

impl Top {
    /// The top level of a scene, and its sheets, for a shutter interval.
    pub(super) fn of(
        &mut self,
        parts: &Arc<SceneParts>,
        accel: &AccelChoice,
        shutter: [f32; 2],
    ) -> (Arc<TwoLevel>, Option<Sheets>) {
        let is_list = accel.name.starts_with("brute");
        let known = self.0.take().filter(|known| {
            known.shutter.map(f32::to_bits) == shutter.map(f32::to_bits)
                && known.is_list == is_list
                && has_same_instances(&known.parts, parts)
        });
        let (accelerator, sheets) = match known {
            Some(known) if has_same_sides(&known.parts, parts) => (known.accelerator, known.sheets),
            known => {
                let top = || Arc::new(parts.geometry.top_level(accel, shutter));
                let accelerator = known.map_or_else(top, |known| known.accelerator);
                let sheets = Sheets::find(parts, &*accelerator, shutter[0]);
                (accelerator, sheets)
            }
        };
        let (parts, kept) = (parts.clone(), sheets.clone());
        self.0 = Some(Known { parts, shutter, is_list, accelerator: accelerator.clone(), sheets: kept });
        (accelerator, sheets)
    }
}

/// True when the trees are the same, and in the same places. Those that move are never said to be.
fn has_same_instances(a: &SceneParts, b: &SceneParts) -> bool {
    let (a, b) = (a.geometry.instances(), b.geometry.instances());
    let same = |(a, b): (&Instance, &Instance)| {
        Arc::ptr_eq(&a.accelerator, &b.accelerator) && is_same_place(&a.motion, &b.motion)
    };
    a.len() == b.len() && a.iter().zip(b).all(same)
}

/// True when the same surfaces are visible from the same sides.
fn has_same_sides(a: &SceneParts, b: &SceneParts) -> bool {
    if !a.hides_backs && !b.hides_backs {
        return true;
    }
    let (ours, theirs) = (a.geometry.objects(), b.geometry.objects());
    let sides = |parts: &SceneParts| {
        parts.passes.iter().map(|passes| [passes.is_one_sided, passes.hides_from_camera]).collect::<Vec<_>>()
    };
    ours.len() == theirs.len()
        && sides(a) == sides(b)
        && ours
            .iter()
            .zip(theirs)
            .all(|(a, b)| Arc::ptr_eq(&a.mesh, &b.mesh) && is_same_place(&a.motion, &b.motion))
}

fn is_same_place(a: &Motion, b: &Motion) -> bool {
    let of = |motion: &Motion| motion.static_transform().and_then(|_| Place::of(motion));
    matches!((of(a), of(b)), (Some(a), Some(b)) if a == b)
}
