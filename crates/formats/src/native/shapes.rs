//! Built-in shapes, which need no file. All are placed around the origin.

use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, Reader};

/// A row of [`SHAPES`].
#[derive(Clone, Copy, Debug)]
pub struct ShapeEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// Builds the mesh from its parameters.
    pub build: fn(&Reader) -> Mesh,
}

/// Every value of `shape` in a `[[model]]`.
pub static SHAPES: &[ShapeEntry] = &[
    ShapeEntry {
        entry: Entry {
            name: "floor",
            summary: "a horizontal square that faces up",
            source: "",
            parameters: &[length("side", "length of a side", "10")],
        },
        build: |reader| shapes::floor(Vec3::ZERO, reader.number("side")),
    },
    ShapeEntry {
        entry: Entry {
            name: "quad",
            summary: "a parallelogram that faces the direction of u × v",
            source: "",
            parameters: &[
                vector("u", "one edge, as a vector", "1 0 0"),
                vector("v", "the other edge, as a vector", "0 1 0"),
            ],
        },
        build: |reader| shapes::quad(Vec3::ZERO, reader.vector("u"), reader.vector("v")),
    },
    ShapeEntry {
        entry: Entry {
            name: "disc",
            summary: "a horizontal disc that faces up",
            source: "",
            parameters: &[length("radius", "radius", "1"), pieces("around", "triangles", "64")],
        },
        build: |reader| shapes::disc(Vec3::ZERO, reader.number("radius"), reader.integer("around") as u32),
    },
    ShapeEntry {
        entry: Entry {
            name: "box",
            summary: "a closed box",
            source: "",
            parameters: &[vector("size", "lengths along x, y and z", "1 1 1")],
        },
        build: |reader| {
            let half = reader.vector("size").abs() * 0.5;
            shapes::cuboid(Aabb { min: -half, max: half })
        },
    },
    ShapeEntry {
        entry: Entry {
            name: "prism",
            summary: "a closed upright prism, with its first edge along x",
            source: "",
            parameters: &[
                length("radius", "distance from the centre to its edges", "1"),
                length("height", "height", "1"),
                pieces("sides", "sides", "3"),
            ],
        },
        build: |reader| {
            let (radius, height) = (reader.number("radius"), reader.number("height"));
            shapes::prism(Vec3::ZERO, radius, height, reader.integer("sides") as u32)
        },
    },
    ShapeEntry {
        entry: Entry {
            name: "sphere",
            summary: "a sphere, with texture coordinates",
            source: "",
            parameters: &[
                length("radius", "radius", "1"),
                pieces("around", "quadrilaterals along the equator", "96"),
                pieces("along", "quadrilaterals from pole to pole", "48"),
            ],
        },
        build: |reader| {
            let (around, along) = (reader.integer("around") as u32, reader.integer("along") as u32);
            shapes::uv_sphere(Vec3::ZERO, reader.number("radius"), around, along)
        },
    },
    ShapeEntry {
        entry: Entry {
            name: "torus",
            summary: "a ring around the y axis",
            source: "",
            parameters: &[
                length("radius", "distance from the centre to the middle of the tube", "1"),
                length("tube", "radius of the tube", "0.3"),
                pieces("around", "quadrilaterals along the ring", "96"),
                pieces("along", "quadrilaterals around the tube", "48"),
            ],
        },
        build: |reader| {
            let (around, along) = (reader.integer("around") as u32, reader.integer("along") as u32);
            shapes::torus(Vec3::ZERO, reader.number("radius"), reader.number("tube"), around, along)
        },
    },
];

const fn length(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    let kind = ParameterKind::Number { min: 1e-6, max: 1e6 };
    Parameter { name, summary, unit: "m", kind, default }
}

const fn vector(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "m", kind: ParameterKind::Vector, default }
}

const fn pieces(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Integer { min: 3, max: 2048 }, default }
}
