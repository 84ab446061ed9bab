//! `Volume`: smoke, clouds and fire, whose fields are grids in other files. [OpenUSD, UsdVol]

use crate::geometry::meshes::{Part, name_of};
use crate::geometry::primvars::{Interpolation, Primvar};
use crate::layers::value::Text;
use crate::scene::Scene;
use crate::shading::{self, Filling};
use crate::stage::Stage;
use crate::stage::context::Context;
use crate::stage::transforms;
use bilux_import::FormatError;
use bilux_import::appearance::filling::{Density, Medium, Temperature, fill};
use bilux_import::tables::grids::box_of;
use bilux_math::{Aabb, DMat4, Rgb, Vec3};
use bilux_scene::media::Grid;
use bilux_scene::{Mesh, Spec};
use std::sync::Arc;

/// Single-scattering albedo of a volume without a material: the one that OpenUSD's own renderer takes.
const ALBEDO: f32 = 0.18;
/// Temperatures of which none is above this one are in other units than kelvins.
const COLDEST_FIRE: f32 = 500.0;

/// A grid of a volume.
struct Field {
    /// Purpose of the grid.
    name: Text,
    prim: u32,
}

impl Scene<'_, '_> {
    /// The box around a volume, filled with what its fields and its material say; none, with a note, without a density.
    pub(crate) fn volume(&mut self, stage: &Stage, prim: u32) -> Result<Option<Part>, FormatError> {
        let fields = fields(stage, prim, &mut self.context);
        let bound = shading::bound(stage, prim, &self.lineage);
        let said = fields.iter().flat_map(|field| stage.said(field.prim)).collect();
        let key = (stage.said(prim).collect(), bound, said);
        if let Some(known) = self.volumes.get(&key) {
            return Ok(known.clone());
        }
        let made = filled(stage, prim, &fields, bound, &mut self.context)?;
        self.volumes.insert(key, made.clone());
        Ok(made)
    }
}

/// The fields of a volume that can be read.
fn fields(stage: &Stage, prim: u32, context: &mut Context) -> Vec<Field> {
    let mut fields = Vec::new();
    for relationship in stage.names(prim, "field:") {
        let name = Text::from(&relationship["field:".len()..]);
        let Some(target) = stage.targets(prim, &relationship).into_iter().next() else { continue };
        match stage.named(&target).map(|field| (field, &*stage.prim(field).type_name)) {
            Some((field, "OpenVDBAsset")) => fields.push(Field { name, prim: field }),
            Some((field, kind)) => {
                let what = format!("fields of volumes of type {kind}");
                context.sink.diagnostics.not_shown(&what, || stage.at(field));
            }
            None => {
                let what = format!("the field '{name}' of a volume is {target}, and there is no such prim");
                context.sink.diagnostics.note(&what, || stage.at(prim));
            }
        }
    }
    fields
}

fn filled(
    stage: &Stage,
    prim: u32,
    fields: &[Field],
    bound: Option<u32>,
    context: &mut Context,
) -> Result<Option<Part>, FormatError> {
    let said = match bound {
        Some(material) => shading::filling(stage, material, context)?,
        None => None,
    };
    let glows = said.is_none();
    let filling = match said {
        Some(filling) => filling,
        None => unstated(stage, prim, context)?,
    };
    let named = |name: &str| fields.iter().find(|field| &*field.name == name);
    let is_only = || fields.first().filter(|_| fields.len() == 1);
    let field = named(&filling.density).or_else(is_only);
    let density = match field {
        Some(field) => grid(stage, prim, field, context)?,
        None => None,
    };
    let Some(density) = density.filter(|density| density.maximum() > 0.0) else {
        let what = "a volume has no density: it is left out";
        context.sink.diagnostics.note(what, || stage.at(prim));
        return Ok(None);
    };
    let hot = named("temperature").filter(|hot| glows && field.is_some_and(|field| field.prim != hot.prim));
    let temperature = match hot {
        Some(hot) => grid(stage, prim, hot, context)?.filter(|grid| grid.maximum() > COLDEST_FIRE),
        None => None,
    };
    for other in fields.iter().filter(|other| field.is_none_or(|field| field.name != other.name)) {
        if temperature.is_none() || &*other.name != "temperature" {
            let what = format!("the field '{}' of volumes", other.name);
            context.sink.diagnostics.not_shown(&what, || stage.at(other.prim));
        }
    }
    let here = |grid: Arc<Grid>| Density { grid, to_world: DMat4::IDENTITY };
    let temperature = temperature.map(|grid| Temperature { grid: here(grid), scale: 1.0 });
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::from(density.size().map(|side| side as f32)) };
    let mesh = Mesh { name: name_of(stage, prim).to_owned(), ..box_of(&bounds, &density.to_object()) };
    let medium = Medium {
        absorption: filling.absorption,
        scattering: filling.scattering,
        anisotropy: filling.anisotropy,
        emission: temperature.as_ref().map_or(Rgb::BLACK, |hot| Rgb::grey(hot.brightest())),
        temperature,
        density: Some(here(density)),
        emission_grid: None,
    };
    let at = stage.at(bound.unwrap_or(prim));
    let name = name_of(stage, bound.unwrap_or(prim));
    let mut spec = Spec { span: at.clone(), ..Spec::new(name, "interface") };
    let Context { reading, sink, .. } = context;
    fill(&mut spec, &medium, &DMat4::IDENTITY, &at, (reading, &mut sink.diagnostics))?;
    let material = sink.scene.add_material(spec);
    reading.budget.take_bytes(mesh.size(), &stage.layers[0].name)?;
    Ok(Some(Part { mesh: Arc::new(mesh), material }))
}

/// Medium of a volume without a material, as in OpenUSD's own renderer: the density is the extinction.
fn unstated(stage: &Stage, prim: u32, context: &mut Context) -> Result<Filling, FormatError> {
    let budget = &mut context.reading.budget;
    let colour = Primvar::read(stage, prim, "primvars:displayColor", Interpolation::Constant, budget)?;
    let albedo = match colour {
        Some(colour) => Rgb::from_array(colour.values.floats::<3>(0)).clamp(0.0, 1.0),
        None => Rgb::grey(ALBEDO),
    };
    let what = "a volume without a material that is read has its density as extinction per unit of length, of which it \
                scatters its displayColor, or else .18";
    context.sink.diagnostics.remark(what, || stage.at(prim));
    let density = "density".into();
    Ok(Filling { absorption: Rgb::WHITE - albedo, scattering: albedo, anisotropy: 0.0, density })
}

/// The grid of a field in the space of the volume; `None`, with a note, if there is none.
///
/// A field below its volume has a place of its own; one elsewhere, which volumes can share, is where they are.
fn grid(
    stage: &Stage,
    volume: u32,
    field: &Field,
    context: &mut Context,
) -> Result<Option<Arc<Grid>>, FormatError> {
    let Context { reading, sink, .. } = context;
    let at = stage.at(field.prim);
    let name = stage.text(field.prim, "fieldName", &mut reading.budget)?.unwrap_or_default();
    let found = stage.found(field.prim, "filePath", &mut reading.budget)?;
    let file = found.as_ref().and_then(|found| found.value.text().map(|file| (found.layer, file)));
    let Some((layer, file)) = file.filter(|(_, file)| !file.is_empty()) else {
        let what = format!("the field '{}' of a volume names no file", field.name);
        sink.diagnostics.note(&what, || at);
        return Ok(None);
    };
    let folder = stage.layers[layer as usize].folder.as_deref();
    let message = match reading.grid_if_there(folder, (file, &name), &at) {
        Ok(Ok(grid)) => {
            let to_world = transforms::below(stage, field.prim, volume, &mut reading.budget)?;
            let density = Density { grid, to_world: to_world.unwrap_or(DMat4::IDENTITY) };
            return density.within(&DMat4::IDENTITY, &at, reading);
        }
        Ok(Err(message)) => message,
        Err(error @ FormatError::TooLarge { .. }) => return Err(error),
        Err(error) => error.without_place(),
    };
    sink.diagnostics.note(&message, || at);
    Ok(None)
}
