//! From a prim `Material` to `principled`.

use super::draft::{Draft, Shaded};
use super::network::{Input, kind, resolve};
use super::{materialx, preview};
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_scene::Spec;

/// The outputs that can have a surface, the first one before the others.
const OUTPUTS: [&str; 4] =
    ["outputs:mtlx:surface", "outputs:surface", "outputs:out", "outputs:arnold:surface"];

/// The material of a prim; `None`, with a note, if it has no surface that is read.
pub(crate) fn material(
    stage: &Stage,
    prim: u32,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<Option<Shaded>, FormatError> {
    let mut unknown = Vec::new();
    for output in OUTPUTS {
        let Input::Node(shader, _) = resolve(stage, prim, output, &mut reading.budget)? else { continue };
        let id = kind(stage, shader, &mut reading.budget)?;
        let name = id.strip_prefix("ND_").unwrap_or(&id);
        let read: fn(&mut Draft) -> Result<(), FormatError> = match name {
            _ if name.starts_with("UsdPreviewSurface") => preview::preview,
            _ if name.starts_with("standard_surface") => materialx::standard,
            _ if name.starts_with("open_pbr_surface") => materialx::open_pbr,
            _ => {
                unknown.push(id);
                continue;
            }
        };
        let path = &stage.prim(prim).path;
        let name = path.rsplit('/').next().unwrap_or_default();
        let spec = Spec { span: stage.at(shader), ..Spec::new(name, "principled") };
        let shaded = Shaded {
            spec,
            uvs: [None, None],
            uses_colours: false,
            uses_opacities: false,
            without_colours: None,
            has_direction: false,
            displacement: None,
        };
        let mut draft = Draft { shaded, stage, shader, reading, sink };
        read(&mut draft)?;
        return Ok(Some(draft.shaded));
    }
    let what = match unknown.first() {
        Some(id) => format!("materials with the surface '{id}'"),
        None => "materials without a surface".to_owned(),
    };
    sink.diagnostics.not_shown(&what, || stage.at(prim));
    Ok(None)
}
