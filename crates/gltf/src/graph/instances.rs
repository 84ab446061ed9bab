//! `EXT_mesh_gpu_instancing`: one node with many instances.

use crate::document::data::DataReader;
use crate::graph::nodes::Placed;
use crate::graph::place::compose;
use bilux_import::FormatError;
use bilux_math::DMat4;

/// The transforms of a mesh's instances, each computed on demand.
pub(crate) struct Instances {
    count: usize,
    node: DMat4,
    translations: Option<Vec<[f32; 3]>>,
    rotations: Option<Vec<[f32; 4]>>,
    scales: Option<Vec<[f32; 3]>>,
}

impl Instances {
    /// The world transforms of a node's mesh: one, or as many as the extension lists.
    pub(crate) fn read<'d>(
        placed: &Placed<'d>,
        data: &mut DataReader<'d, '_>,
    ) -> Result<Instances, FormatError> {
        let Some(extension) = placed.node.extension("EXT_mesh_gpu_instancing") else {
            return Ok(Instances::once(placed.world));
        };
        let attributes = extension.need("attributes")?;
        let mut count = None;
        for (key, index) in attributes.entries() {
            let here = data.accessor(index)?.count;
            if count.is_some_and(|count| count != here) {
                return Err(index.error("all instance attributes must have the same number of elements"));
            }
            count = Some(here);
            if !matches!(key, "TRANSLATION" | "ROTATION" | "SCALE") {
                data.note("an instance attribute is not used", || index.at());
            }
        }
        let count = count.unwrap_or(0);
        let translations = attributes.get("TRANSLATION").map(|index| data.attribute::<3>(index, None));
        let rotations = attributes.get("ROTATION").map(|index| data.attribute::<4>(index, None));
        let scales = attributes.get("SCALE").map(|index| data.attribute::<3>(index, None));
        let (translations, rotations, scales) =
            (translations.transpose()?, rotations.transpose()?, scales.transpose()?);
        Ok(Instances { count, node: placed.world, translations, rotations, scales })
    }

    /// A single instance.
    pub(crate) fn once(node: DMat4) -> Instances {
        Instances { count: 1, node, translations: None, rotations: None, scales: None }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = DMat4> {
        let pick3 = |list: &Option<Vec<[f32; 3]>>, i: usize, default: f64| {
            list.as_ref().map_or([default; 3], |list| list[i].map(f64::from))
        };
        let is_plain = self.translations.is_none() && self.rotations.is_none() && self.scales.is_none();
        (0..self.count).map(move |i| {
            if is_plain {
                return self.node;
            }
            let rotation =
                self.rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |list| list[i].map(f64::from));
            let local = compose(pick3(&self.translations, i, 0.0), rotation, pick3(&self.scales, i, 1.0));
            // A degenerate transform is reported where the instance is placed.
            self.node * local.unwrap_or(DMat4::ZERO)
        })
    }
}
