//! `bilux info`: what is in a scene.

use crate::arguments::{Common, Info};
use crate::commands::DONE;
use crate::commands::shared::given::Given;
use crate::commands::shared::reading::check_choices;
use crate::commands::shared::reading::read_options_with;
use crate::commands::shared::reading::report_notes;
use crate::commands::shared::reading::report_warnings;
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::output::counted;
use crate::process::{output, usage};
use bilux::formats::ReadOptions;
use bilux::memory::Memory;
use bilux::scene::media::{BLOCK_VOXELS, Grid};
use bilux::scene::{Mesh, SceneBuilder, Texture};
use serde_json::json;
use std::collections::HashSet;
use std::sync::Arc;

pub fn run(arguments: &Info, common: &Common) -> anyhow::Result<u8> {
    let options = read_options_with(common, &arguments.posed.choices, arguments.posed.at);
    let options = ReadOptions { validate: true, ..options };
    let given = Given::open(&arguments.scene, &arguments.posed.input_format, common)?;
    SandboxPaths::default().reading_scene(Given::place(&arguments.scene)).enter(common)?;
    let scene = given.scene(&options)?;
    check_choices(&scene, &arguments.posed.choices).map_err(usage::wrong)?;
    if arguments.json {
        output::print(serde_json::to_string_pretty(&as_json(&scene))?)?;
    } else {
        output::print(as_text(&scene))?;
        report_warnings(&scene.warnings, common)?;
        report_notes(&scene.notes, common);
    }
    Ok(DONE)
}

/// The meshes; one that several objects share is counted once.
fn meshes(scene: &SceneBuilder) -> Vec<&Mesh> {
    let mut seen = HashSet::new();
    let meshes = scene.objects.iter().map(|object| &object.mesh);
    meshes.filter(|mesh| seen.insert(Arc::as_ptr(mesh))).map(|mesh| &**mesh).collect()
}

fn as_json(scene: &SceneBuilder) -> serde_json::Value {
    let bounds = scene.bounds(0.0);
    let own = meshes(scene);
    let memory = Memory::of_scene(scene);
    json!({
        "meshes": own.len(),
        "vertices": own.iter().map(|m| m.positions.len()).sum::<usize>(),
        "triangles": scene.objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>(),
        "points": scene.objects.iter().map(|o| o.mesh.points.len()).sum::<usize>(),
        "lines": scene.objects.iter().map(|o| o.mesh.lines.len()).sum::<usize>(),
        "instances": scene.objects.iter().filter(|o| o.instanced).count(),
        "moving": scene.objects.iter().filter(|o| !o.motion.is_still()).count(),
        "bounds": if bounds.is_empty() { json!(null) } else {
            let in_file = |p: bilux::math::Vec3| match scene.origin {
                bilux::math::DVec3::ZERO => json!(p.to_array()),
                origin => json!((p.as_dvec3() + origin).to_array()),
            };
            json!({ "min": in_file(bounds.min), "max": in_file(bounds.max) })
        },
        "written_by": scene.written_by,
        "metres_per_unit": metres(scene),
        "up": up(scene),
        "objects": scene.objects.iter().map(|o| json!({
            "name": o.name, "triangles": o.mesh.triangles.len(), "points": o.mesh.points.len(),
            "lines": o.mesh.lines.len(), "material": o.material,
            "normals": !o.mesh.normals.is_empty(), "uvs": !o.mesh.uvs.is_empty(),
            "vertex_colours": !o.mesh.vertex_kd.is_empty(),
        })).collect::<Vec<_>>(),
        "materials": scene.materials.iter().map(|m| json!({ "name": m.name, "kind": m.kind })).collect::<Vec<_>>(),
        "textures": scene.textures.iter().map(|t| json!({
            "name": t.name, "width": t.width(), "height": t.height(), "bytes": t.image.size(),
        })).collect::<Vec<_>>(),
        "grids": scene.grids().iter().map(|grid| json!({
            "name": grid.name(), "size": grid.size(), "stored_voxels": stored_voxels(grid), "maximum": grid.maximum(),
            "bytes": grid.bytes(),
        })).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|l| json!({ "name": l.name, "kind": l.kind })).collect::<Vec<_>>(),
        "cameras": scene.cameras.iter().map(|c| json!({
            "name": c.spec.name, "kind": c.spec.kind, "keyframes": c.keyframes.len(),
        })).collect::<Vec<_>>(),
        "animations": scene.inventory.animations.iter().map(|a| json!({
            "name": a.name, "seconds": a.seconds, "plays": a.plays,
        })).collect::<Vec<_>>(),
        "variants": scene.inventory.variants,
        "skins": scene.inventory.skins,
        "memory": {
            "meshes": memory.meshes, "textures": memory.textures, "coarser_textures_at_most": memory.levels,
            "grids": memory.grids,
            "trees_at_most": memory.trees,
        },
        "warnings": scene.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "notes": scene.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// The line about the program that wrote the file.
fn author(scene: &SceneBuilder) -> String {
    match scene.written_by.as_str() {
        "" => String::new(),
        program => format!("written by {program}\n"),
    }
}

fn as_text(scene: &SceneBuilder) -> String {
    let bounds = scene.bounds(0.0);
    let own = meshes(scene);
    let names = |names: Vec<String>| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let spec = |s: &bilux::scene::Spec| {
        if s.name.is_empty() { s.kind.clone() } else { format!("{} ({})", s.name, s.kind) }
    };
    let size = bounds.extent();
    format!(
        "{}{}triangles  {} in {} ({} with {}; {} instanced, {} moving)\n\
         bounds     {:?} to {:?}, {} x {} x {} {}\n\
         materials  {}\n\
         textures   {}\n\
         {}lights     {}\n\
         cameras    {}\n\
         memory     {}{}",
        author(scene),
        strokes(scene),
        scene.objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>(),
        counted(scene.objects.len(), "object", "objects"),
        counted(own.len(), "mesh", "meshes"),
        counted(own.iter().map(|m| m.positions.len()).sum::<usize>(), "vertex", "vertices"),
        scene.objects.iter().filter(|o| o.instanced).count(),
        scene.objects.iter().filter(|o| !o.motion.is_still()).count(),
        (bounds.min.as_dvec3() + scene.origin).to_array().map(|c| c as f32),
        (bounds.max.as_dvec3() + scene.origin).to_array().map(|c| c as f32),
        size.x,
        size.y,
        size.z,
        unit(scene),
        names(scene.materials.iter().map(spec).collect()),
        names(scene.textures.iter().map(|t| texture(t)).collect()),
        grids(scene),
        names(scene.lights.iter().map(spec).collect()),
        names(scene.cameras.iter().map(|c| spec(&c.spec)).collect()),
        memory(&Memory::of_scene(scene)),
        choices(scene),
    )
}

fn metres(scene: &SceneBuilder) -> f64 {
    if scene.unit > 0.0 { scene.unit } else { 1.0 }
}

fn unit(scene: &SceneBuilder) -> &'static str {
    let known = [(1.0, "m"), (0.001, "mm"), (0.01, "cm"), (0.0254, "in"), (0.3048, "ft")];
    known.iter().find(|(metres_of, _)| *metres_of == metres(scene)).map_or("", |(_, name)| name)
}

/// The up axis, as the format defines it.
fn up(scene: &SceneBuilder) -> &'static str {
    let (bilux::scene::UpHint::Is(axis) | bilux::scene::UpHint::Usually(axis)) = scene.up;
    axis.name()
}

/// The numbers of points and lines, on a line of their own; nothing if there are none.
fn strokes(scene: &SceneBuilder) -> String {
    let sum = |count: fn(&Mesh) -> usize| scene.objects.iter().map(|o| count(&o.mesh)).sum::<usize>();
    match (sum(|mesh| mesh.points.len()), sum(|mesh| mesh.lines.len())) {
        (0, 0) => String::new(),
        (points, lines) => format!("points     {points}; {}\n", counted(lines, "line", "lines")),
    }
}

/// The voxels of the blocks that are stored.
fn stored_voxels(grid: &Grid) -> usize {
    grid.stored_blocks() * BLOCK_VOXELS
}

/// The grids, on a line of their own; nothing if there are none.
fn grids(scene: &SceneBuilder) -> String {
    let text = |grid: &&Arc<Grid>| {
        let [x, y, z] = grid.size();
        let (stored, most) = (stored_voxels(grid), grid.maximum());
        format!("{} ({x}x{y}x{z}, {stored} voxels stored, at most {most})", grid.name())
    };
    let all: Vec<String> = scene.grids().iter().map(text).collect();
    if all.is_empty() { String::new() } else { format!("grids      {}\n", all.join(", ")) }
}

/// The memory that the scene holds, and what rendering adds.
fn memory(memory: &Memory) -> String {
    let mega = |bytes: u64| bytes as f64 / 1e6;
    let grids = match memory.grids {
        0 => String::new(),
        grids => format!(", {:.1} MB of grids", mega(grids)),
    };
    format!(
        "{:.1} MB of meshes, {:.1} MB of textures{grids}; at most {:.1} MB more to render, not counting the picture",
        mega(memory.meshes),
        mega(memory.textures),
        mega(memory.levels + memory.trees),
    )
}

/// The choices that the file offers, one per line; nothing if it offers none.
fn choices(scene: &SceneBuilder) -> String {
    let named = |(i, name): (usize, &String)| if name.is_empty() { i.to_string() } else { name.clone() };
    let all = |names: &[String]| names.iter().enumerate().map(named).collect::<Vec<_>>();
    let inventory = &scene.inventory;
    let animations = inventory.animations.iter().enumerate().map(|(i, a)| {
        let name = named((i, &a.name));
        format!("{name} ({} s{})", a.seconds, if a.plays { "" } else { ", not played" })
    });
    let rows = [
        ("animations", animations.collect()),
        ("variants  ", all(&inventory.variants)),
        ("skins     ", all(&inventory.skins)),
    ];
    let line = |(what, names): (&str, Vec<String>)| format!("\n{what} {}", names.join(", "));
    rows.into_iter().filter(|(_, names)| !names.is_empty()).map(line).collect()
}

fn texture(texture: &Texture) -> String {
    match texture.formula() {
        Some(_) => format!("{} (procedural)", texture.name),
        None => format!("{} ({}x{})", texture.name, texture.width(), texture.height()),
    }
}
