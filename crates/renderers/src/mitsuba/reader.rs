//! Converts files to a scene: it first reads all elements, then makes what they describe.

use super::bsdfs;
use super::document::Document;
use super::emitters::light;
use super::film;
use super::maker::{Maker, Tables};
use super::parser::{Parser, own_file};
use super::placing::Placer;
use super::sensors::cameras;
use super::textures;
use super::variables::Variables;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::includes::Includes;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_scene::{Parameters, SceneBuilder};
use std::path::Path;

/// Makers of what parts of a scene may contain.
const TABLES: Tables = Tables { texture: textures::make, material: bsdfs::material };

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    reading.has_variables = true;
    let mut parser = Parser {
        variables: Variables::new(&reading.options.definitions),
        reading,
        diagnostics: Diagnostics::default(),
        document: Document::default(),
        includes: Includes::of(own_file(source)),
    };
    parser.document.files.folder = source.folder.map(Path::to_owned);
    parser.scene(source)?;
    parser.variables.check_used(&whole_file(source.name))?;
    let Parser { reading, diagnostics, document, .. } = parser;
    let mut placer = Placer::new(Maker::new(reading, &document, TABLES, diagnostics));
    let mut seen = Seen::default();
    for part in &document.parts {
        seen.part(part, &mut placer)?;
    }
    finish(placer, seen, source)
}

/// Parts of a scene besides shapes.
#[derive(Default)]
struct Seen {
    cameras: Vec<bilux_scene::cameras::CameraSpec>,
    settings: Parameters,
    has_sensor: bool,
}

impl Seen {
    fn part(
        &mut self,
        part: &std::rc::Rc<super::plugin::Plugin>,
        placer: &mut Placer,
    ) -> Result<(), FormatError> {
        match part.tag {
            "shape" => placer.place(part)?,
            // Those of shapes are among the parts of the scene if several shapes refer to them.
            "emitter" if ["area", "directionalarea"].contains(&part.kind.as_str()) => {}
            "emitter" => {
                let made = light(&mut placer.maker, part)?;
                placer.lights.extend(made);
            }
            "sensor" => {
                if !std::mem::replace(&mut self.has_sensor, true) {
                    film::settings(&mut placer.maker, part, &mut self.settings)?;
                }
                let made = cameras(&mut placer.maker, part)?;
                placer.maker.reading.budget.take::<[Parameters; 8]>(made.len(), &part.at.file)?;
                self.cameras.extend(made);
            }
            "integrator" => film::depth(&mut placer.maker, part, &mut self.settings)?,
            // What others refer to.
            _ => {}
        }
        Ok(())
    }
}

fn finish(placer: Placer, seen: Seen, source: &Source) -> Result<SceneBuilder, FormatError> {
    let Placer { maker, shapes, objects, lights, .. } = placer;
    let scene = SceneBuilder {
        describes_all_light: true,
        objects,
        lights,
        cameras: seen.cameras,
        materials: maker.materials,
        textures: maker.in_scene,
        settings: seen.settings,
        warnings: shapes.warnings,
        notes: shapes.notes,
        ..SceneBuilder::default()
    };
    let mut sink = Sink { scene, diagnostics: maker.diagnostics };
    share_trees(&mut sink.scene);
    if sink.scene.objects.is_empty() && sink.scene.lights.is_empty() {
        sink.diagnostics.note("there is nothing to render in this file", || whole_file(source.name));
    }
    Ok(sink.finish())
}
