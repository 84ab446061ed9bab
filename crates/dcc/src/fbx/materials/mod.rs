//! Materials: Phong and Lambert, and the shaders of Maya, 3ds Max and Arnold, as `principled`.

mod classic;
mod draft;
mod shaders;
mod textures;
mod worn;

use super::document::display_name;
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::appearance::fitting::fitted;
use bilux_import::appearance::principled_draft::PrincipledDraft;
use bilux_import::input::reading::{Reading, default_material};
use bilux_import::input::sink::Sink;
use bilux_scene::Spec;
use draft::Draft;
use std::collections::HashMap;
use textures::Textures;
pub(super) use worn::Worn;

/// The materials that have been added to the scene.
#[derive(Default)]
pub(super) struct Materials<'d> {
    used: HashMap<Worn<'d>, usize>,
    textures: Textures,
}

impl<'d> Materials<'d> {
    /// The index of a material in the scene.
    pub(super) fn index(
        &mut self,
        worn: Worn<'d>,
        posed: &Posed<'d>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<usize, FormatError> {
        if let Some(&index) = self.used.get(&worn) {
            return Ok(index);
        }
        reading.budget.take::<(Worn, Spec, [u8; 1024])>(1, posed.document.file())?;
        let spec = match worn.material {
            None if worn.texture.is_none() => default_material(),
            material => {
                let inner = PrincipledDraft::new(
                    Spec::new("default", "principled"),
                    reading,
                    sink,
                    posed.document.file(),
                );
                let mut draft = Draft::new(inner, worn, posed, &mut self.textures);
                if let Some(index) = material {
                    let object = posed.document.object(index);
                    draft.inner.spec = Spec::new(&display_name(object.name), "principled");
                    draft.inner.spec.span = object.node.at();
                    let properties = posed.properties(index);
                    if !shaders::fill(&properties, &mut draft)? {
                        classic::fill(&properties, &mut draft)?;
                    }
                } else {
                    draft.colour("base_color", bilux_math::Rgb::WHITE, worn.texture)?;
                }
                let spec = draft.inner.spec;
                fitted(spec, &mut sink.diagnostics)
            }
        };
        let index = sink.scene.add_material(spec);
        self.used.insert(worn, index);
        Ok(index)
    }
}
