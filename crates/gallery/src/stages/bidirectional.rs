//! A room for bidirectional path tracing, after Veach's: a spotlight that faces the wall, a lamp in a covered shade,
//! and a glass egg on a table. [Veach 1997]

use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::interior::furniture;
use crate::modelling::parts::{joined, moved, placed, turned};
use bilux_math::Vec3;
use bilux_math::registry::Entry;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        source: "Veach 1997",
        ..about(
            "bidirectional",
            "a lamp that faces the wall, a lamp in a covered shade, a glass egg on a table",
        )
    },
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.5);
    room(&mut stage);
    stand(&mut stage);
    spot(&mut stage);
    let wood = stage.glossy("cherry", [0.42, 0.19, 0.09], 0.06, 80.0);
    stage.put("table", round_table(), wood);
    let glass = stage.glass("glass", [0.6, 0.25, 0.3]);
    stage.put("egg", egg(), glass);
    let cloth = stage.diffuse("cloth", [0.22, 0.30, 0.50]);
    stage.put("armchair", placed(&furniture::armchair(2), (Vec3::Y, -38.0), [1.15, 0.0, -0.75]), cloth);
    stage.put("feet", placed(&furniture::feet(2), (Vec3::Y, -38.0), [1.15, 0.0, -0.75]), wood);
    stage.seen([0.35, 1.55, 3.2], [0.0, 0.93, -0.4], 40.0)
}

fn room(stage: &mut Stage) {
    let plaster = stage.diffuse("plaster", [0.68, 0.66, 0.60]);
    let warm = stage.diffuse("side wall", [0.62, 0.40, 0.28]);
    let floor = stage.diffuse("floor", [0.45, 0.36, 0.27]);
    stage.put(
        "walls",
        boxes(&[
            [[-2.1, 0.0, -1.9], [2.1, 2.5, -1.8]],
            [[2.0, 0.0, -1.8], [2.1, 2.5, 3.6]],
            [[-2.1, 0.0, 3.5], [2.1, 2.5, 3.6]],
            [[-2.1, 2.5, -1.9], [2.1, 2.6, 3.6]],
        ]),
        plaster,
    );
    stage.put("wall", boxes(&[[[-2.1, 0.0, -1.8], [-2.0, 2.5, 3.5]]]), warm);
    stage.put("floor", boxes(&[[[-2.1, -0.1, -1.9], [2.1, 0.0, 3.6]]]), floor);
}

/// A floor lamp; its shade is open at the top, and closed at the bottom except for a ring.
fn stand(stage: &mut Stage) {
    let brass = stage.glossy("brass", [0.30, 0.20, 0.07], 0.4, 70.0);
    let at = [-1.35, 0.0, -1.1];
    stage.put("stand", moved(&furniture::lamp_stand(2), at), brass);
    let paint = stage.diffuse("shade", [0.58, 0.50, 0.38]);
    let up = [at[0], 1.60, at[2]];
    stage.put("shade", moved(&furniture::shade(2), up), paint);
    let cover = [[0.0, -0.085], [0.15, -0.085], [0.155, -0.09], [0.15, -0.095], [0.0, -0.095]];
    stage.put("cover", moved(&turned(&cover, 40, 1), up), paint);
    let bulb = stage.glowing("bulb", [420.0, 320.0, 210.0]);
    stage.put("bulb", shapes::icosphere(Vec3::new(up[0], 1.585, up[2]), 0.045, 3), bulb);
}

/// Two tubes on the ceiling rail: one lights the wall, the other shines down at the egg.
fn spot(stage: &mut Stage) {
    let black = stage.diffuse("black", [0.04, 0.04, 0.045]);
    let tube = tube();
    let lamp = stage.glowing("spot", [900.0, 830.0, 720.0]);
    let disc = shapes::disc(Vec3::new(0.0, -0.02, 0.0), 0.042, 24);
    // One points down and slightly back; the other points straight at the back wall.
    for (turn, at) in [((Vec3::X, 7.0), [-0.15, 2.28, 0.05]), ((Vec3::X, 62.0), [0.95, 2.22, -0.7])] {
        stage.put("tube", placed(&tube, turn, at), black);
        stage.put("lamp", placed(&disc_with_normals(&disc), turn, at), lamp);
    }
    let rail = [[-0.6, 2.44, 0.03], [1.3, 2.47, 0.07]];
    stage.put(
        "rail",
        boxes(&[
            rail,
            [[-0.165, 2.3, 0.04], [-0.135, 2.44, 0.06]],
            [[0.935, 2.25, -0.72], [0.965, 2.5, -0.69]],
        ]),
        black,
    );
}

fn disc_with_normals(disc: &Mesh) -> Mesh {
    Mesh { normals: disc.smooth_normals(), ..disc.clone() }
}

/// A tube, closed at the top and open at the bottom.
fn tube() -> Mesh {
    let outline = [
        [0.0, 0.06],
        [0.05, 0.06],
        [0.05, 0.06],
        [0.05, -0.10],
        [0.05, -0.10],
        [0.045, -0.10],
        [0.045, -0.10],
        [0.045, 0.0],
        [0.045, 0.0],
        [0.0, 0.0],
    ];
    joined(outline.windows(2).map(|pair| turned(pair, 32, 1)).filter(|m| !m.triangles.is_empty()))
}

fn round_table() -> Mesh {
    let leg = [
        [0.0, 0.68],
        [0.03, 0.68],
        [0.04, 0.5],
        [0.028, 0.3],
        [0.05, 0.12],
        [0.22, 0.03],
        [0.23, 0.0],
        [0.0, 0.0],
    ];
    let top = [[0.0, 0.72], [0.48, 0.72], [0.50, 0.705], [0.50, 0.69], [0.48, 0.68], [0.0, 0.68]];
    moved(&joined([turned(&leg, 28, 4), turned(&top, 72, 3)]), [-0.15, 0.0, -0.1])
}

/// An egg, 24 cm long, lying on its side.
fn egg() -> Mesh {
    let mut egg = shapes::icosphere(Vec3::ZERO, 0.115, 5);
    for p in &mut egg.positions {
        // One end is blunt.
        let narrow = 1.0 - 1.2 * p.x;
        *p = Vec3::new(p.x * 1.4, p.y * narrow, p.z * narrow);
    }
    egg.normals = egg.smooth_normals();
    let lowest = egg.positions.iter().map(|p| p.y).fold(0.0, f32::min);
    placed(&egg, (Vec3::Y, 28.0), [-0.15, 0.7202 - lowest, -0.05])
}
