//! Writes intensity distributions beside scenes.

use super::ies;
use crate::output::writing::Writing;
use bilux_scene::IntensityDistribution;
use std::sync::Arc;

/// The file name of a distribution next to the scene, written on first use.
pub fn file_of(distribution: &Arc<IntensityDistribution>, writing: &mut Writing) -> String {
    let known = writing.distributions.iter().find(|(known, _)| Arc::ptr_eq(known, distribution));
    if let Some((_, name)) = known {
        return name.clone();
    }
    let number = writing.distributions.len() + 1;
    let name = writing.add_numbered("lamp", number, "ies", ies::write(distribution));
    writing.distributions.push((distribution.clone(), name.clone()));
    name
}
