//! The Cornell box, in metres: positions and sizes as measured [Cornell 1998]; the colours and the light are ours,
//! close to the measured spectra but a little brighter and less yellow.

use crate::{GeneratorEntry, integer};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::typed::cameras::Perspective;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec};
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "cornell",
        summary: "the Cornell box with its two blocks, 0.55 m wide",
        source: "Cornell 1998",
        parameters: &[],
    },
    triangles: |_| 0,
    generate: |_| {
        let (mut room, white) = empty_room();
        let short = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
        let tall = [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]];
        for (name, corners, height) in [("short block", short, 165.0), ("tall block", tall, 330.0)] {
            room.objects.push(Object::new(name, Arc::new(block(corners, height)), white));
        }
        Ok(room)
    },
};

pub(super) const SPHERES: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "cornell-spheres",
        summary: "the Cornell box with a mirror and a glass sphere",
        source: "Cornell 1998",
        parameters: &[integer("level", "subdivision of the spheres: 20 · 4^level triangles", 0, 7, "5")],
    },
    triangles: |reader| 40 << (2 * reader.integer("level")),
    generate: |reader| {
        let (mut room, _) = empty_room();
        let mirror = room.add_material(Spec::new("mirror", "mirror"));
        let glass = room.add_material(Spec::new("glass", "dielectric"));
        let level = reader.integer("level") as u32;
        for (name, middle, material) in [
            ("mirror sphere", Vec3::new(390.0, 100.0, 370.0), mirror),
            ("glass sphere", Vec3::new(170.0, 100.0, 190.0), glass),
        ] {
            let sphere = shapes::icosphere(middle * MILLIMETRE, 100.0 * MILLIMETRE, level);
            room.objects.push(Object::new(name, Arc::new(sphere), material));
        }
        Ok(room)
    },
};

const MILLIMETRE: f32 = 0.001;

/// Floor, ceiling, three walls, the light and the camera; also returns the index of the white wall material.
fn empty_room() -> (SceneBuilder, usize) {
    let mut room = SceneBuilder::default();
    let diffuse = |name: &str, colour: Rgb| Spec::new(name, "diffuse").with("reflectance", colour);
    let white = room.add_material(diffuse("white", Rgb::new(0.725, 0.71, 0.68)));
    let red = room.add_material(diffuse("red", Rgb::new(0.63, 0.065, 0.05)));
    let green = room.add_material(diffuse("green", Rgb::new(0.14, 0.45, 0.091)));
    let (w, h, d) = (552.8, 548.8, 559.2);
    let walls = [
        ("floor", [[w, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, d], [549.6, 0.0, d]], white),
        ("back wall", [[549.6, 0.0, d], [0.0, 0.0, d], [0.0, h, d], [556.0, h, d]], white),
        ("green wall", [[0.0, 0.0, d], [0.0, 0.0, 0.0], [0.0, h, 0.0], [0.0, h, d]], green),
        ("red wall", [[w, 0.0, 0.0], [549.6, 0.0, d], [556.0, h, d], [556.0, h, 0.0]], red),
    ];
    for (name, corners, material) in walls {
        room.objects.push(Object::new(name, Arc::new(polygon(name, &corners)), material));
    }
    room.objects.push(Object::new("ceiling", Arc::new(ceiling(h, d)), white));
    room.lights.push(
        Spec::new("lamp", "rect")
            .with("position", Vec3::new(278.0, h, 279.5) * MILLIMETRE)
            .with("edge_u", Vec3::X * 130.0 * MILLIMETRE)
            .with("edge_v", Vec3::Z * 105.0 * MILLIMETRE)
            .with("radiance", Rgb::new(26.0, 21.0, 14.0))
            .with("classic", Rgb::new(0.9, 0.8, 0.6)),
    );
    room.lights.push(Spec::new("ambient", "ambient").with("colour", 0.25f32));
    let eye = Perspective::new("front")
        .position(Vec3::new(278.0, 273.0, -800.0) * MILLIMETRE)
        .look_at(Vec3::new(278.0, 273.0, 0.0) * MILLIMETRE)
        .fov(39.3077f32);
    room.add_camera(eye);
    (room, white)
}

/// The ceiling around the hole that the light fills: a panel in front of it would light the gap behind itself.
fn ceiling(height: f32, depth: f32) -> Mesh {
    let (xs, zs) = ([0.0, 213.0, 343.0, 556.0], [0.0, 227.0, 332.0, depth]);
    let cells = (0..9u32).filter(|&cell| cell != 4).map(|cell| (cell / 3) * 4 + cell % 3);
    Mesh {
        name: "ceiling".to_owned(),
        positions: xs.iter().flat_map(|&x| zs.map(|z| Vec3::new(x, height, z) * MILLIMETRE)).collect(),
        triangles: cells.flat_map(|a| [[a, a + 4, a + 5], [a, a + 5, a + 1]]).collect(),
        ..Mesh::default()
    }
}

/// A flat polygon as a fan, its corners in millimetres.
fn polygon(name: &str, corners: &[[f32; 3]]) -> Mesh {
    Mesh {
        name: name.to_owned(),
        positions: corners.iter().map(|&c| Vec3::from(c) * MILLIMETRE).collect(),
        triangles: (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]).collect(),
        ..Mesh::default()
    }
}

/// An upright block over a four-cornered base (x and z in millimetres, clockwise from above), closed.
fn block(base: [[f32; 2]; 4], height: f32) -> Mesh {
    let at = |y: f32| base.map(|[x, z]| Vec3::new(x, y, z) * MILLIMETRE);
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for i in 0..4 {
        let j = (i + 1) % 4;
        triangles.extend([[i, j, j + 4], [i, j + 4, i + 4]]);
    }
    Mesh { name: "block".to_owned(), positions: [at(0.0), at(height)].concat(), triangles, ..Mesh::default() }
}
