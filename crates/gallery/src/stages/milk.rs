//! Milk: a drop falls into a glass of it, in the light of a window.

use super::puffs::clouds;
use super::{Stage, about, at, boxes};
use crate::GeneratorEntry;
use crate::interior::tableware;
use crate::modelling::implicit::{Cone, Cut, soft_max, soft_min};
use crate::modelling::parts::{chance, moved, turned};
use bilux_math::glam::UVec3;
use bilux_math::transcendental::{atan2, exp, sin_cos};
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec, Value};
use std::f32::consts::{FRAC_PI_2, TAU};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("milk", "a drop that falls into a glass of milk, skim milk and cookies, before a window"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.2);
    stage.deep(24);
    table(&mut stage);
    let glass = stage.material(
        Spec::new("glass", "dielectric")
            .with("eta", 1.5f32)
            .with("absorption", Rgb::new(1.2, 0.5, 0.8))
            .with("priority", Value::Integer(2)),
    );
    // Reduced scattering and absorption per metre. [Jensen 2001, figure 5]
    let whole = stage.liquid("whole milk", [2550.0, 3210.0, 3770.0], [1.1, 2.4, 14.0]);
    let skim = stage.liquid("skim milk", [700.0, 1220.0, 1900.0], [1.4, 2.5, 14.2]);
    let tall = Tumbler { radius: 0.036, height: 0.102, level: 0.091, splash: true };
    let low = Tumbler { radius: 0.034, height: 0.078, level: 0.058, splash: false };
    for (tumbler, place) in [(tall, [-0.015, 0.0, 0.03]), (low, [-0.115, 0.0, -0.075])] {
        stage.put("tumbler", moved(&tumbler.mesh(), place), glass);
        let milk = if tumbler.splash { whole } else { skim };
        stage.put("milk", moved(&tumbler.milk(), place), milk);
    }
    cookies(&mut stage);
    stage.panel("window", [-0.92, 0.44, -0.52], [[0.5, 0.0, -0.56], [0.0, 0.8, 0.0]], [15.0, 13.6, 11.6]);
    stage.light(Spec::new("room", "environment").with("radiance", Rgb::new(0.30, 0.32, 0.36)));
    stage.seen([0.06, 0.215, 0.60], [0.012, 0.062, 0.0], 24.0)
}

impl Stage {
    /// A liquid in glass, with scattering and absorption per metre.
    fn liquid(&mut self, name: &str, scattering: [f32; 3], absorption: [f32; 3]) -> usize {
        self.material(
            Spec::new(name, "dielectric")
                .with("eta", 1.35f32)
                .with("scattering", Rgb::from_array(scattering))
                .with("absorption", Rgb::from_array(absorption))
                .with("priority", Value::Integer(1)),
        )
    }
}

/// A straight glass of milk that stands on y = 0, in metres.
struct Tumbler {
    /// The outer radius.
    radius: f32,
    height: f32,
    /// Height of the milk's surface.
    level: f32,
    /// Whether a drop has just fallen into it.
    splash: bool,
}

/// Thickness of the wall and of the bottom.
const WALL: f32 = 0.0022;
const BOTTOM: f32 = 0.009;

impl Tumbler {
    /// Up the inside from the middle of the bottom, over the rim, and down the outside.
    fn mesh(&self) -> Mesh {
        let inner = self.radius - WALL;
        let mut outline = vec![[0.0, BOTTOM]];
        let mut arc = |middle: [f32; 2], radius: f32, from: f32, to: f32| {
            outline.extend((0..=12).map(|k| {
                let (sin, cos) = sin_cos(FRAC_PI_2 * (from + (to - from) * k as f32 / 12.0));
                [middle[0] + radius * cos, middle[1] + radius * sin]
            }));
        };
        arc([inner - 0.008, BOTTOM + 0.008], 0.008, -1.0, 0.0);
        arc([self.radius - 0.5 * WALL, self.height - 0.5 * WALL], 0.5 * WALL, 2.0, 0.0);
        arc([self.radius - 0.004, 0.0045], 0.004, 0.0, -1.0);
        outline.push([0.0, 0.0005]);
        turned(&outline, 128, 1)
    }

    /// The milk, which reaches a little into the glass: that comes first where both are.
    fn milk(&self) -> Mesh {
        let (level, splash) = (self.level, self.splash);
        let edge = self.radius - 0.5 * WALL;
        let top = if splash { level + 0.045 } else { level + 0.004 };
        let cut = Cut {
            bounds: Aabb {
                min: at(-edge - 0.002, BOTTOM - 0.003, -edge - 0.002),
                max: at(edge + 0.002, top, edge + 0.002),
            },
            cells: if splash { UVec3::new(80, 100, 80) } else { UVec3::new(52, 52, 52) },
            finer: at(0.0, if splash { 0.6 } else { 0.8 }, 0.0),
        };
        let bowl = move |p: Vec3| {
            let across = (p.x * p.x + p.z * p.z).sqrt();
            // The corner below is as round as that of the glass.
            let (r, y) = ((across - (edge - 0.009)).max(0.0), (BOTTOM + 0.008 - p.y).max(0.0));
            let within = if r > 0.0 && y > 0.0 {
                (r * r + y * y).sqrt() - 0.009
            } else {
                (across - edge).max(BOTTOM - 0.001 - p.y)
            };
            // It climbs up the glass.
            let rise = 0.0016 * exp(((across - (self.radius - WALL)) / 0.0016).min(0.0));
            (within, across, 0.8 * (p.y - level - rise))
        };
        if !splash {
            return cut.mesh("milk", move |p| bowl(p).0.max(bowl(p).2));
        }
        let crown = Crown::new(level);
        cut.mesh("milk", move |p| {
            let (within, across, above) = bowl(p);
            let ripple = 0.0007 * sin_cos((across - 0.012) * TAU / 0.009).0 * exp(-across / 0.02);
            let surface = soft_min(above - ripple, crown.distance(p), 0.003);
            soft_max(within, surface, 0.0005)
        })
    }
}

/// The crown that a drop throws up: a thin wall, with threads that end in beads.
struct Crown {
    level: f32,
    threads: Vec<Cone>,
}

/// Threads of the crown, and its radius at the surface.
const THREADS: u32 = 19;
const CROWN: f32 = 0.0125;

impl Crown {
    fn new(level: f32) -> Crown {
        let mut threads = Vec::new();
        for k in 0..THREADS {
            let angle = TAU * (k as f32 + 0.5 * chance(31, k)) / THREADS as f32;
            let (sin, cos) = sin_cos(angle);
            let out = |radius: f32, height: f32| at(radius * cos, level + height, radius * sin);
            let tall = 0.0040 + 0.0065 * chance(32, k);
            let foot = out(CROWN + 0.0032, 0.0105);
            let tip = out(CROWN + 0.0036 + 0.55 * tall, 0.0110 + tall);
            threads.push(Cone { from: foot, to: tip, radius: [0.00125, 0.00075] });
            let bead = 0.0013 + 0.0008 * chance(33, k);
            threads.push(Cone { from: tip, to: tip + at(0.0, 0.0002, 0.0), radius: [bead, bead] });
            if chance(34, k) > 0.45 {
                let drop = tip + (tip - foot).normalize() * (0.0035 + 0.004 * chance(35, k));
                let size = 0.0008 + 0.0008 * chance(36, k);
                threads.push(Cone { from: drop, to: drop + at(0.0, 0.0002, 0.0), radius: [size, size] });
            }
        }
        // The drop that follows.
        let drop = at(0.0005, level + 0.034, 0.0);
        threads.push(Cone { from: drop, to: drop + at(0.0, 0.0003, 0.0), radius: [0.0038, 0.0037] });
        Crown { level, threads }
    }

    /// The distance; below the surface, which hides the rest, hardly less.
    fn distance(&self, p: Vec3) -> f32 {
        if p.y < self.level - 0.006 {
            return self.level - p.y;
        }
        let across = (p.x * p.x + p.z * p.z).sqrt();
        let height = (p.y - self.level).clamp(0.0, 0.012);
        let middle = CROWN + 26.0 * height * height;
        let scallop = 0.0012 * sin_cos(THREADS as f32 * atan2(p.z, p.x)).1;
        let wall = (0.85 * (across - middle).abs() - 0.0012 + 0.03 * height)
            .max(0.9 * (p.y - self.level - 0.0100 - scallop));
        self.threads.iter().fold(wall, |d, thread| soft_min(d, thread.distance(p), 0.0011))
    }
}

/// Planks, and a wall behind.
fn table(stage: &mut Stage) {
    let shades = [[0.16, 0.085, 0.045], [0.125, 0.066, 0.035], [0.185, 0.10, 0.055]];
    for (shade, colour) in shades.into_iter().enumerate() {
        let wood = stage.material(
            Spec::new("wood", "principled")
                .with("base_color", Rgb::from_array(colour))
                .with("specular_roughness", 0.32f32),
        );
        let planks = (0..18u32).filter(|k| (chance(50, *k) * 3.0) as usize == shade).map(|k| {
            let z = -0.75 + 0.085 * k as f32;
            [[-1.5, -0.03, z], [1.5, 0.0, z + 0.0838]]
        });
        stage.put("planks", boxes(&planks.collect::<Vec<_>>()), wood);
    }
    let plaster = stage.diffuse("wall", [0.055, 0.085, 0.10]);
    stage.put("wall", boxes(&[[[-3.0, -0.5, -1.4], [3.0, 2.5, -1.3]]]), plaster);
}

/// Three cookies on a plate.
fn cookies(stage: &mut Stage) {
    let china = stage.material(
        Spec::new("china", "principled")
            .with("base_color", Rgb::new(0.62, 0.66, 0.68))
            .with("specular_roughness", 0.12f32),
    );
    stage.put("plate", moved(&tableware::plate(4), [0.14, 0.0, -0.10]), china);
    let dough = stage.diffuse("dough", [0.56, 0.33, 0.15]);
    let chocolate = stage.material(
        Spec::new("chocolate", "principled")
            .with("base_color", Rgb::new(0.06, 0.028, 0.015))
            .with("specular_roughness", 0.35f32),
    );
    for (k, middle) in
        [at(0.108, 0.0155, -0.105), at(0.175, 0.0155, -0.08), at(0.140, 0.031, -0.09)].into_iter().enumerate()
    {
        let bumpy = |d: Vec3| {
            let radii = at(0.036, 0.0085, 0.036);
            (1.0 + 0.10 * clouds(d * 3.0, 4, 40 + k as u64)) / (d / radii).length()
        };
        stage.put("cookie", shapes::blob(middle, 5, bumpy), dough);
        for chip in 0..7u32 {
            let index = 10 * k as u32 + chip;
            let (sin, cos) = sin_cos(TAU * (chip as f32 + 0.6 * chance(60, index)) / 7.0);
            let r = 0.006 + 0.021 * chance(61, index);
            let top = middle + at(r * cos, 0.0074 * (1.0 - (r / 0.036) * (r / 0.036)).sqrt(), r * sin);
            let lump = |d: Vec3| 0.0036 * (1.0 + 0.4 * clouds(d * 1.3, 2, u64::from(index)));
            stage.put("chip", shapes::blob(top, 2, lump), chocolate);
        }
    }
}
