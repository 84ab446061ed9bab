//! A door ajar: light enters through a narrow gap from the next room, which has the only light. [Veach 1997]

use super::tiles::Tiles;
use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::modelling::parts::{between, joined, moved, placed, rounded, turned};
use crate::teapot::Teapot;
use bilux_math::Vec3;
use bilux_math::registry::Entry;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        source: "Veach 1997",
        ..about("door-ajar", "three teapots in a dark room, and a door ajar to a bright one")
    },
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// The wall with the door, from front to back, and the edges of the door.
const WALL: [f32; 2] = [-1.6, -1.72];
const DOOR: [f32; 2] = [-0.95, -0.05];
const DOOR_HEIGHT: f32 = 2.05;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.5);
    rooms(&mut stage);
    door(&mut stage);
    floor(&mut stage);
    table(&mut stage);
    stage.panel("lamp", [0.3, 2.545, -3.1], [[1.2, 0.0, 0.0], [0.0, 0.0, 0.9]], [640.0, 560.0, 450.0]);
    stage.seen([0.55, 1.38, 2.75], [0.0, 0.95, -0.9], 40.0)
}

/// Two rooms with one wall between them.
fn rooms(stage: &mut Stage) {
    let plaster = stage.diffuse("plaster", [0.70, 0.69, 0.68]);
    let bright = stage.diffuse("bright plaster", [0.78, 0.72, 0.60]);
    let [front, back] = WALL;
    let [left, right] = DOOR;
    let (x, top) = (2.2, 2.55);
    stage.put(
        "walls",
        boxes(&[
            [[-x, 0.0, back], [left, top, front]],
            [[right, 0.0, back], [x, top, front]],
            [[left, DOOR_HEIGHT, back], [right, top, front]],
            [[-x - 0.1, 0.0, back], [-x, top, 3.2]],
            [[x, 0.0, back], [x + 0.1, top, 3.2]],
            [[-x, 0.0, 3.1], [x, top, 3.2]],
            [[-x - 0.1, top, back], [x + 0.1, top + 0.1, 3.2]],
        ]),
        plaster,
    );
    stage.put(
        "next room",
        boxes(&[
            [[-x - 0.1, 0.0, -4.6], [-x, top, back]],
            [[x, 0.0, -4.6], [x + 0.1, top, back]],
            [[-x, 0.0, -4.6], [x, top, -4.5]],
            [[-x - 0.1, top, -4.6], [x + 0.1, top + 0.1, back]],
        ]),
        bright,
    );
}

/// The door, ajar by a hand's breadth into the next room, with its frame and knob.
fn door(stage: &mut Stage) {
    let paint = stage.glossy("paint", [0.34, 0.42, 0.40], 0.05, 40.0);
    let [left, right] = DOOR;
    let width = right - left;
    let panel =
        |x0: f32, y0: f32, x1: f32, y1: f32| rounded(between([x0, y0, -0.01], [x1, y1, 0.028]), 0.008, 2);
    let leaf = joined([
        rounded(between([0.0, 0.008, -0.02], [width - 0.01, DOOR_HEIGHT - 0.008, 0.02]), 0.004, 1),
        panel(0.12, 0.18, width - 0.13, 0.85),
        panel(0.12, 1.02, width - 0.13, 1.88),
    ]);
    // The hinges are on the left.
    stage.put("door", placed(&leaf, (Vec3::Y, 22.0), [left + 0.005, 0.0, WALL[1] + 0.02]), paint);
    let brass = stage.metal("brass", 0.3);
    let knob = turned(
        &[[0.0, 0.09], [0.022, 0.085], [0.028, 0.065], [0.012, 0.045], [0.010, 0.0], [0.0, 0.0]],
        28,
        3,
    );
    let knob = placed(&knob, (Vec3::X, 90.0), [width - 0.07, 0.98, 0.02]);
    stage.put("knob", placed(&knob, (Vec3::Y, 22.0), [left + 0.005, 0.0, WALL[1] + 0.02]), brass);
    let front = WALL[0];
    let frame = [
        [[left - 0.09, 0.0, front], [left, DOOR_HEIGHT, front + 0.025]],
        [[right, 0.0, front], [right + 0.09, DOOR_HEIGHT, front + 0.025]],
        [[left - 0.09, DOOR_HEIGHT, front], [right + 0.09, DOOR_HEIGHT + 0.09, front + 0.025]],
    ];
    let skirting = [
        [[-2.2, 0.0, front], [left - 0.09, 0.11, front + 0.018]],
        [[right + 0.09, 0.0, front], [2.2, 0.11, front + 0.018]],
    ];
    stage.put("frame", boxes(&[&frame[..], &skirting].concat()), paint);
}

fn floor(stage: &mut Stage) {
    let tiles = Tiles {
        corner: [-2.3, 0.0, 3.2],
        edges: [[4.6, 0.0, 0.0], [0.0, 0.0, -7.8]],
        counts: [12, 20],
        joint: 0.02,
        pattern: 600,
    };
    let (shades, ground) = tiles.meshes::<2>();
    for (mesh, colour) in shades.into_iter().zip([[0.42, 0.27, 0.18], [0.34, 0.21, 0.14]]) {
        let material = stage.diffuse("tiles", colour);
        stage.put("tiles", mesh, material);
    }
    let joints = stage.diffuse("joints", [0.25, 0.2, 0.16]);
    stage.put("joints", ground, joints);
}

/// Three teapots: copper, porcelain and glass.
fn table(stage: &mut Stage) {
    let wood = stage.glossy("walnut", [0.24, 0.13, 0.07], 0.06, 80.0);
    let leg = boxes(&[[[-0.03, 0.0, -0.03], [0.03, 0.70, 0.03]]]);
    let legs =
        [[-0.38, -0.85], [1.22, -0.85], [-0.38, -0.15], [1.22, -0.15]].map(|[x, z]| moved(&leg, [x, 0.0, z]));
    let top = rounded(between([-0.45, 0.70, -0.92], [1.29, 0.745, -0.08]), 0.012, 3);
    stage.put("table", joined(legs.into_iter().chain([top])), wood);
    let pot = Teapot { tessellation: 12, height: 0.3, bottom: true }.mesh();
    let copper = stage.metal("copper", 0.35);
    let china = stage.glossy("china", [0.74, 0.73, 0.70], 0.08, 200.0);
    let glaze = stage.glossy("glaze", [0.10, 0.24, 0.46], 0.10, 120.0);
    stage.put("copper teapot", placed(&pot, (Vec3::Y, -25.0), [-0.12, 0.745, -0.45]), copper);
    stage.put("china teapot", placed(&pot, (Vec3::Y, 20.0), [0.42, 0.745, -0.58]), china);
    stage.put("glazed teapot", placed(&pot, (Vec3::Y, 200.0), [0.93, 0.745, -0.38]), glaze);
    let canvas = stage.diffuse("canvas", [0.62, 0.34, 0.14]);
    stage.put("picture", boxes(&[[[0.38, 1.25, WALL[0]], [1.18, 1.85, WALL[0] + 0.02]]]), canvas);
    stage.put("picture", frame(), wood);
}

fn frame() -> Mesh {
    let bar = |x0: f32, y0: f32, x1: f32, y1: f32| {
        rounded(between([x0, y0, WALL[0]], [x1, y1, WALL[0] + 0.04]), 0.008, 2)
    };
    joined([
        bar(0.34, 1.21, 1.22, 1.25),
        bar(0.34, 1.85, 1.22, 1.89),
        bar(0.34, 1.25, 0.38, 1.85),
        bar(1.18, 1.25, 1.22, 1.85),
        shapes::icosphere(Vec3::new(0.78, 1.97, WALL[0] + 0.02), 0.012, 2),
    ])
}
