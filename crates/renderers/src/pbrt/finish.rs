//! Finishes a scene after all files are read: resolves names and adds everything to the scene.

use super::cameras::camera;
use super::document::Document;
use super::lights::light;
use super::loader::Loader;
use super::placing::Placer;
use super::shapes::ShapeCache;
use super::surfaces::Surfaces;
use bilux_import::FormatError;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::names::unknown;
use bilux_import::input::sink::Sink;
use bilux_scene::{SceneBuilder, Span};

/// The scene that a document describes, with the shapes that its files have in common.
pub(super) fn finish(
    document: &Document,
    shapes: ShapeCache,
    mut loader: Loader,
) -> Result<SceneBuilder, FormatError> {
    let settings = document.options.settings(&mut loader.diagnostics)?;
    let camera = camera(&document.options, &settings, &mut loader)?;
    let mut surfaces = Surfaces::new(document, settings.gain, loader);
    let mut lights = Vec::new();
    for (entity, to_world) in &document.lights {
        lights.extend(light(entity, to_world, &mut surfaces.light_maker())?);
    }
    let mut placer = Placer::new(surfaces, shapes, document.options.times, lights);
    for piece in &document.pieces {
        placer.place(piece, None)?;
    }
    for used in &document.instances {
        let Some(pieces) = document.objects.get(&used.object) else {
            let names = document.objects.keys().map(String::as_str);
            return Err(unknown("object", &used.object, names, &used.at));
        };
        for piece in pieces {
            placer.place(piece, Some(used))?;
        }
    }
    let Placer { surfaces, shapes, objects, lights, .. } = placer;
    let scene = SceneBuilder {
        describes_all_light: true,
        objects,
        lights,
        cameras: camera.into_iter().collect(),
        materials: surfaces.maker.in_scene,
        textures: surfaces.maker.textures.in_scene,
        settings: settings.parameters,
        warnings: shapes.warnings,
        notes: shapes.notes,
        ..SceneBuilder::default()
    };
    let mut sink = Sink { scene, diagnostics: surfaces.maker.textures.loader.diagnostics };
    share_trees(&mut sink.scene);
    set_shutter(&mut sink.scene, settings.shutter);
    if sink.scene.objects.is_empty() && sink.scene.lights.is_empty() && document.has_world {
        sink.diagnostics.note("there is nothing to render in this file", Span::default);
    }
    Ok(sink.finish())
}

/// Sets the shutter of the camera if anything moves.
fn set_shutter(scene: &mut SceneBuilder, [open, close]: [f32; 2]) {
    let moves = scene.objects.iter().any(|object| !object.motion.is_still())
        || scene.cameras.iter().any(|camera| !camera.keyframes.is_empty());
    if moves {
        scene.settings.set("time", open);
        scene.settings.set("shutter", (close - open).max(0.0));
    }
}
