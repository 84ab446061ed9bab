//! Context that all prims are added to.

use crate::layers::value::Text;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_scene::Mesh;

/// The material of a surface, and what it needs of the surface.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Worn {
    /// Index of a material of the scene.
    pub(crate) index: usize,
    /// The primvars that its textures are placed by.
    pub(crate) uvs: [Option<Text>; 2],
    pub(crate) uses_colours: bool,
    pub(crate) uses_opacities: bool,
    /// The bits of the colour of meshes that have none, if it uses theirs.
    pub(crate) without_colours: Option<[u32; 3]>,
    /// True if it depends on a direction on the surface.
    pub(crate) has_direction: bool,
}

/// The read, and the scene so far.
pub(crate) struct Context<'r, 'o> {
    pub(crate) reading: &'r mut Reading<'o>,
    pub(crate) sink: Sink,
    /// Whether there are lamps, some of which are meshes.
    pub(crate) has_lamps: bool,
}

impl Context<'_, '_> {
    /// Adds what a material needs.
    pub(crate) fn finish_mesh(&mut self, mesh: &mut Mesh, _: &Worn) -> Result<(), FormatError> {
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "a mesh has positions that are infinite or not numbers (NaN); they are kept";
            let at = bilux_import::bytes::text::whole_file(&mesh.name.as_str().into());
            self.sink.diagnostics.note(what, || at);
        }
        Ok(())
    }
}
