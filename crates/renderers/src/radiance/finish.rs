//! Finishes a scene after all files are read.

use super::sources;
use super::world::World;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::sink::Sink;
use bilux_scene::SceneBuilder;
use bilux_scene::cameras::CameraSpec;
use std::sync::Arc;

/// The scene of a world.
pub(super) fn finish(
    mut world: World,
    cameras: Vec<CameraSpec>,
    file: &Arc<str>,
) -> Result<SceneBuilder, FormatError> {
    for (object, at) in std::mem::take(&mut world.polygons).objects(&world.materials) {
        world.object(object, &at)?;
    }
    sources::finish(&mut world)?;
    if world.objects.is_empty() && world.lights.is_empty() {
        world.diagnostics.note("there is nothing to render in this file", || whole_file(file));
    }
    let has_light = world.has_glow || !world.lights.is_empty();
    let World { objects, lights, materials, textures, diagnostics, .. } = world;
    let scene = SceneBuilder {
        // Files of furniture and the like have no light of their own.
        describes_all_light: has_light,
        environment_unspecified: !has_light,
        exposure_unspecified: true,
        unit: 1.0,
        objects,
        lights,
        cameras,
        materials,
        textures,
        ..SceneBuilder::default()
    };
    let mut sink = Sink { scene, diagnostics };
    share_trees(&mut sink.scene);
    Ok(sink.finish())
}
