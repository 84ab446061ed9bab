//! A file of grids as a model: white smoke in the box of its voxels.

use super::{Catalogue, GRID_FORMATS, Listed, ReadSurface, Volume, format_of};
use crate::FormatError;
use crate::bytes::text::whole_file;
use crate::input::diagnostics::Diagnostics;
use crate::input::reading::{Reading, Source, plain_material};
use crate::input::sink::Sink;
use crate::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_math::{Aabb, Transform, Vec3};
use bilux_scene::media::{BLOCK, Grid};
use bilux_scene::{Axis, Mesh, Object, SceneBuilder, Spec, UpHint, Value, Warning};
use std::sync::Arc;

pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "vdb",
        summary: "smoke and clouds: OpenVDB, NanoVDB, numpy's .npy and Mitsuba's .vol",
        source: "Museth 2013",
        parameters: &[],
    },
    extensions: &["vdb", "nvdb", "vol", "npy"],
    capabilities: &["grids"],
    sniff: |bytes| GRID_FORMATS.iter().any(|row| (row.sniff)(bytes)),
    up: UpHint::Usually(Axis::Y),
    read: Some(ReadFormat::Binary(read)),
    write: None,
};

/// The optical thickness of the densest straight way along an axis.
const THICKNESS: f32 = 12.0;
/// Single-scattering albedo of the smoke.
const ALBEDO: f32 = 0.98;
/// The largest factor of a density.
const MOST: f32 = 1e6;

fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let format = format_of(source)?;
    let catalogue = (format.list)(source)?;
    let name: &str = source.name;
    let at = || whole_file(source.name);
    let listed = match (catalogue.named("", name), format.surface) {
        (Ok(listed), _) => listed,
        (Err(_), Some(surface)) if catalogue.grids.iter().any(|grid| grid.is_level_set) => {
            return surfaces(reading, source, &catalogue, surface);
        }
        (Err(message), _) => return Err(FormatError::malformed(message, at())),
    };
    let volume = reading.volume(format, source, listed)?;
    let complaints = volume.complaints();
    let Volume { grid, bounds, .. } = volume;
    let mut diagnostics = Diagnostics::default();
    for Listed { name, .. } in catalogue.grids.iter().filter(|other| other.index != listed.index) {
        diagnostics.not_shown(&format!("the grid '{name}'"), at);
    }
    let mut scene = SceneBuilder::default();
    let densest = densest_way(&grid);
    if densest <= 0.0 {
        return Err(FormatError::malformed("all its voxels are 0: there is nothing to see", at()));
    }
    let extinction = (THICKNESS / densest).min(MOST);
    let what =
        if listed.name.is_empty() { "the grid".to_owned() } else { format!("the grid '{}'", listed.name) };
    let message = format!(
        "{what} is shown as white smoke whose extinction is {extinction} times its values per unit of length, so that the \
         densest way along an axis has an optical thickness of {THICKNESS}: a TOML scene can say something else"
    );
    scene.notes.push(Warning { message, at: at() });
    reading.note_faults(&what, &complaints, &at());
    let stem = source.stem();
    let mesh = Arc::new(Mesh { name: stem.clone(), ..box_of(&bounds, &grid.to_object()) });
    let mut material = Spec::new("smoke", "interface");
    material.parameters.set("scattering", ALBEDO * extinction);
    material.parameters.set("absorption", (1.0 - ALBEDO) * extinction);
    material.parameters.set("density", Value::Grid(Arc::new(grid)));
    let material = scene.add_material(material);
    scene.objects.push(Object::new(&stem, mesh, material));
    if let Some(up) = catalogue.up {
        scene.up = up;
    }
    diagnostics.into_warnings(&mut scene);
    Ok(scene)
}

/// The surfaces of all level sets of a file, which has nothing that can be a density.
fn surfaces(
    reading: &mut Reading,
    source: &Source,
    catalogue: &Catalogue,
    surface: ReadSurface,
) -> Result<SceneBuilder, FormatError> {
    let at = || whole_file(source.name);
    let mut sink = Sink::for_bare_files();
    let material = sink.scene.add_material(plain_material(false, false));
    for listed in &catalogue.grids {
        let found = if listed.is_level_set { surface(source, listed, &mut reading.budget)? } else { None };
        let Some(mesh) = found else {
            sink.diagnostics.not_shown(&format!("the grid '{}'", listed.name), at);
            continue;
        };
        let what = "a level set is shown as its surface, by triangles as large as its voxels";
        sink.diagnostics.remark(what, at);
        let name = if listed.name.is_empty() { source.stem() } else { listed.name.clone() };
        sink.scene.objects.push(Object::new(&name, Arc::new(mesh), material));
    }
    if sink.scene.objects.is_empty() {
        let message = "no distance in it changes its sign: there is no surface to show";
        return Err(FormatError::malformed(message, at()));
    }
    if let Some(up) = catalogue.up {
        sink.scene.up = up;
    }
    Ok(sink.finish())
}

/// The largest integral of a grid along straight ways that are parallel to an axis of its voxels and as wide as a block, per unit of
/// length of the object.
pub(super) fn densest_way(grid: &Grid) -> f32 {
    let blocks = grid.size().map(|side| side.div_ceil(BLOCK));
    let mut columns = [[1, 2], [0, 2], [0, 1]].map(|[a, b]: [usize; 2]| vec![0.0f64; blocks[a] * blocks[b]]);
    for z in 0..blocks[2] {
        for y in 0..blocks[1] {
            for x in 0..blocks[0] {
                let Some(values) = grid.block([x, y, z]) else { continue };
                let sum: f64 = values.iter().map(|value| f64::from(*value)).sum();
                columns[0][y + blocks[1] * z] += sum;
                columns[1][x + blocks[0] * z] += sum;
                columns[2][x + blocks[0] * y] += sum;
            }
        }
    }
    let to_object = grid.to_object();
    let along = |axis: usize| {
        let step = f64::from(to_object.vector(Vec3::AXES[axis]).length());
        columns[axis].iter().copied().fold(0.0, f64::max) * step / (BLOCK * BLOCK) as f64
    };
    (0..3).map(along).fold(0.0, f64::max) as f32
}

/// A box with its faces outwards.
pub fn box_of(bounds: &Aabb, to_object: &Transform) -> Mesh {
    const FACES: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
        to_object.point(Vec3::new(pick(0), pick(1), pick(2)))
    };
    let mut triangles: Vec<[u32; 3]> =
        FACES.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    if to_object.mirrors() {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
}
