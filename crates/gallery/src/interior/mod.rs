//! A furnished room in daylight, mostly lit indirectly: triangles of every size, from walls to the pages of books.

mod books;
pub(super) mod furniture;
pub(super) mod soft;
pub(super) mod tableware;

use crate::modelling::parts::{between, chance, joined, moved, placed, rounded, sharp, turned};
use crate::teapot::Teapot;
use crate::{GeneratorEntry, integer};
use bilux_math::registry::Entry;
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::typed::cameras::Perspective;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use furniture::TABLE;
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "interior",
        summary: "a furnished room by daylight, most of it lit indirectly",
        source: "",
        parameters: &[integer(
            "detail",
            "tessellation of round objects: 1 makes 84,000 triangles, 2 makes 239,000, 3 makes 478,000",
            1,
            6,
            "1",
        )],
    },
    triangles: |reader| 50_000 * (reader.integer("detail") as u64).pow(2),
    generate: |reader| {
        let n = reader.integer("detail") as u32;
        let mut room = Room { scene: SceneBuilder::default() };
        room.scene.materials = MATERIALS.iter().map(material).collect();
        room.shell(n);
        room.dining(n);
        room.library(n);
        room.corner(n);
        Ok(room.finish())
    },
};

/// Name, diffuse and specular reflectance, exponent.
const MATERIALS: &[(&str, [f32; 3], f32, f32)] = &[
    ("plaster", [0.74, 0.71, 0.65], 0.0, 1.0),
    ("ceiling", [0.82, 0.81, 0.79], 0.0, 1.0),
    ("oak", [0.42, 0.25, 0.12], 0.05, 60.0),
    ("light oak", [0.50, 0.32, 0.17], 0.05, 60.0),
    ("dark oak", [0.34, 0.19, 0.09], 0.05, 60.0),
    ("walnut", [0.20, 0.105, 0.055], 0.06, 80.0),
    ("paint", [0.76, 0.76, 0.74], 0.04, 40.0),
    ("porcelain", [0.80, 0.80, 0.78], 0.08, 300.0),
    ("glaze", [0.10, 0.24, 0.36], 0.10, 300.0),
    ("terracotta", [0.55, 0.24, 0.13], 0.0, 1.0),
    ("orange", [0.85, 0.36, 0.04], 0.05, 30.0),
    ("brass", [0.42, 0.28, 0.09], 0.35, 90.0),
    ("iron", [0.05, 0.05, 0.055], 0.12, 60.0),
    ("wax", [0.86, 0.82, 0.70], 0.0, 1.0),
    ("linen", [0.70, 0.52, 0.34], 0.0, 1.0),
    ("wool", [0.42, 0.12, 0.10], 0.0, 1.0),
    ("velvet", [0.09, 0.22, 0.20], 0.0, 1.0),
    ("leaf", [0.10, 0.27, 0.07], 0.05, 30.0),
    ("red cloth", [0.40, 0.07, 0.06], 0.02, 20.0),
    ("blue cloth", [0.07, 0.12, 0.30], 0.02, 20.0),
    ("green cloth", [0.09, 0.22, 0.12], 0.02, 20.0),
    ("black cloth", [0.05, 0.05, 0.05], 0.02, 20.0),
    ("ochre cloth", [0.55, 0.36, 0.10], 0.02, 20.0),
    ("grey cloth", [0.45, 0.43, 0.40], 0.02, 20.0),
    ("paper", [0.78, 0.74, 0.64], 0.0, 1.0),
];

/// The materials of the books, in the order in which `books` returns the meshes.
const CLOTHS: [&str; books::COLOURS + 1] =
    ["red cloth", "blue cloth", "green cloth", "black cloth", "ochre cloth", "grey cloth", "paper"];

/// Half the room's width and depth, and its height.
const HALF: [f32; 2] = [3.0, 2.4];
const HEIGHT: f32 = 2.7;
/// The window in the wall at -x: its extent along z, then upwards.
const WINDOW: [[f32; 2]; 2] = [[-1.0, 1.0], [0.75, 2.25]];

fn material(&(name, kd, ks, exponent): &(&str, [f32; 3], f32, f32)) -> Spec {
    let spec = if ks == 0.0 { Spec::new(name, "diffuse") } else { Spec::new(name, "phong") };
    if ks == 0.0 {
        return spec.with("reflectance", Rgb::from_array(kd));
    }
    let spec = spec.with("kd", Rgb::from_array(kd)).with("ks", ks);
    spec.with("exponent", exponent).with("reflectivity", 0.0f32)
}

struct Room {
    scene: SceneBuilder,
}

impl Room {
    fn put(&mut self, name: &str, material: &str, mesh: Mesh) {
        let material = MATERIALS.iter().position(|m| m.0 == material).unwrap_or(0);
        self.scene.objects.push(Object::new(name, Arc::new(mesh), material));
    }

    /// Floor, walls with a window, ceiling, and the daylight outside.
    fn shell(&mut self, n: u32) {
        let [x, z] = HALF;
        self.boards(n);
        let slab = |low: [f32; 3], high: [f32; 3]| sharp(between(low, high));
        let [[z0, z1], [y0, y1]] = WINDOW;
        self.put(
            "walls",
            "plaster",
            joined([
                slab([-x, 0.0, -z - 0.1], [x, HEIGHT, -z]),
                slab([-x, 0.0, z], [x, HEIGHT, z + 0.1]),
                slab([x, 0.0, -z], [x + 0.1, HEIGHT, z]),
                slab([-x - 0.2, 0.0, -z - 0.1], [-x, HEIGHT, z0]),
                slab([-x - 0.2, 0.0, z1], [-x, HEIGHT, z + 0.1]),
                slab([-x - 0.2, 0.0, z0], [-x, y0, z1]),
                slab([-x - 0.2, y1, z0], [-x, HEIGHT, z1]),
            ]),
        );
        self.put("ceiling", "ceiling", slab([-x - 0.2, HEIGHT, -z - 0.1], [x + 0.1, HEIGHT + 0.1, z + 0.1]));
        let bar = |low: [f32; 3], high: [f32; 3]| rounded(between(low, high), 0.005, n);
        let (a, b) = (-x - 0.13, -x - 0.07);
        let middle = 0.5 * (z0 + z1);
        self.put(
            "woodwork",
            "paint",
            joined([
                bar([a, y0, z0], [b, y0 + 0.06, z1]),
                bar([a, y1 - 0.06, z0], [b, y1, z1]),
                bar([a, y0 + 0.06, z0], [b, y1 - 0.06, z0 + 0.06]),
                bar([a, y0 + 0.06, z1 - 0.06], [b, y1 - 0.06, z1]),
                bar([a, y0 + 0.06, middle - 0.03], [b, y1 - 0.06, middle + 0.03]),
                bar([a, y1 - 0.5, z0 + 0.06], [b, y1 - 0.46, middle - 0.03]),
                bar([a, y1 - 0.5, middle + 0.03], [b, y1 - 0.46, z1 - 0.06]),
                bar([-x - 0.06, y0 - 0.03, z0 - 0.08], [-x + 0.16, y0, z1 + 0.08]),
                bar([-x, 0.0, -z], [x, 0.11, -z + 0.015]),
                bar([-x, 0.0, -z + 0.02], [-x + 0.015, 0.11, z]),
                bar([x - 0.015, 0.0, -z + 0.02], [x, 0.11, z]),
            ]),
        );
        self.curtains(n);
        self.pictures(n);
    }

    fn boards(&mut self, n: u32) {
        let [x, z] = HALF;
        let mut planks = [const { Vec::new() }; 3];
        const ROWS: u32 = 32;
        let broad = 2.0 * z / ROWS as f32;
        for row in 0..ROWS {
            let (near, mut left, mut k) = (row as f32 * broad - z, -x, row * 100);
            while left < x {
                k += 1;
                let right = (left + 0.9 + 1.3 * chance(61, k)).min(x);
                let plank = between([left, -0.02, near], [right - 0.0012, 0.0, near + broad - 0.0012]);
                planks[(chance(62, k) * 3.0) as usize].push(if n == 1 {
                    sharp(plank)
                } else {
                    rounded(plank, 0.0015, 1)
                });
                left = right;
            }
        }
        for (planks, wood) in planks.into_iter().zip(["oak", "light oak", "dark oak"]) {
            self.put("floor", wood, joined(planks));
        }
        let below = sharp(between([-x - 0.2, -0.1, -z - 0.1], [x + 0.1, -0.025, z + 0.1]));
        self.put("floor", "walnut", below);
    }

    fn curtains(&mut self, n: u32) {
        let [[z0, z1], [_, y1]] = WINDOW;
        let (x, y) = (-HALF[0] + 0.12, y1 + 0.12);
        let curtain = soft::curtain(n);
        let mirrored = placed(&curtain, (Vec3::Y, 180.0), [x, y, z1 + 0.38]);
        self.put("curtains", "linen", joined([moved(&curtain, [x, y, z0 - 0.38]), mirrored]));
        let rod = [[0.0, 1.5], [0.02, 1.49], [0.02, 1.46], [0.011, 1.45], [0.011, -1.45], [0.02, -1.46]];
        let rod = turned(&[&rod[..], &[[0.02, -1.49], [0.0, -1.5]]].concat(), 8 * n, n);
        self.put("curtain rod", "brass", placed(&rod, (Vec3::X, 90.0), [x, y + 0.02, 0.5 * (z0 + z1)]));
    }

    fn pictures(&mut self, n: u32) {
        let back = -HALF[1];
        let spots = [("ochre cloth", -1.75, 1.62, 0.36, 0.27), ("blue cloth", -0.98, 1.60, 0.22, 0.30)];
        for (colour, x, y, w, h) in spots {
            let canvas = between([x - w, y - h, back], [x + w, y + h, back + 0.012]);
            self.put("picture", colour, sharp(canvas));
            let bar = |x0: f32, y0: f32, x1: f32, y1: f32| {
                rounded(between([x0, y0, back], [x1, y1, back + 0.028]), 0.008, n + 1)
            };
            let frame = [
                bar(x - w - 0.03, y - h - 0.03, x + w + 0.03, y - h),
                bar(x - w - 0.03, y + h, x + w + 0.03, y + h + 0.03),
                bar(x - w - 0.03, y - h, x - w, y + h),
                bar(x + w, y - h, x + w + 0.03, y + h),
            ];
            self.put("frame", "brass", joined(frame));
        }
    }

    /// The table laid for tea, with its chairs, on a rug, under a lamp.
    fn dining(&mut self, n: u32) {
        let (x, z) = (0.35, -0.15);
        self.put("rug", "wool", moved(&soft::rug(n), [x, 0.0, z]));
        let ground = 0.012;
        self.put("table", "walnut", moved(&furniture::table(n), [x, ground, z]));
        let seats = [
            [-0.45, -0.68, 4.0],
            [0.48, -0.66, -3.0],
            [-0.47, 0.74, 176.0],
            [0.52, 0.92, 197.0],
            [-1.22, 0.02, 86.0],
            [1.25, -0.05, -97.0],
        ];
        let (chair, cushion) = (furniture::chair(n), furniture::cushion(n));
        for [dx, dz, turn] in seats {
            let at = |mesh: &Mesh| placed(mesh, (Vec3::Y, turn), [x + dx, ground, z + dz]);
            self.put("chair", "oak", at(&chair));
            self.put("cushion", "velvet", at(&cushion));
        }
        self.tea(n, [x, ground + TABLE, z]);
        let lamp = [x, 1.72, z];
        self.put("pendant", "iron", moved(&furniture::pendant(n), lamp));
    }

    fn tea(&mut self, n: u32, [x, y, z]: [f32; 3]) {
        let (plate, cup) = (tableware::plate(n), tableware::cup(n));
        let places = [[-0.45, -0.29], [0.48, -0.29], [-0.45, 0.29], [0.48, 0.29]];
        for (k, [dx, dz]) in places.into_iter().enumerate() {
            self.put("plate", "porcelain", moved(&plate, [x + dx, y, z + dz]));
            let by = [x + dx + 0.19, y, z + dz * 0.8];
            self.put("cup", "glaze", placed(&cup, (Vec3::Y, 40.0 + 77.0 * k as f32), by));
        }
        let pot = Teapot { tessellation: 5 * n, height: 0.17, bottom: true }.mesh();
        self.put("teapot", "glaze", placed(&pot, (Vec3::Y, 200.0), [x + 0.05, y, z + 0.04]));
        let small = Teapot { tessellation: 5 * n, height: 0.11, bottom: true }.mesh();
        self.put("milk pot", "porcelain", placed(&small, (Vec3::Y, 20.0), [x + 0.24, y, z - 0.08]));
        self.put("bowl", "porcelain", moved(&tableware::bowl(n), [x - 0.42, y, z]));
        self.put("oranges", "orange", moved(&tableware::oranges(n), [x - 0.42, y, z]));
        for [dx, dz] in [[-0.16, 0.10], [-0.14, -0.13]] {
            let [stick, wax] = tableware::candle(n).map(|part| moved(&part, [x + dx, y, z + dz]));
            self.put("candlestick", "brass", stick);
            self.put("candle", "wax", wax);
        }
    }

    /// Two shelves full of books along the back wall.
    fn library(&mut self, n: u32) {
        let shelf = furniture::shelf(n);
        for (number, x) in [(0, 0.55), (1, 1.90)] {
            let at = [x, 0.0, -HALF[1] + 0.016];
            self.put("shelf", "walnut", moved(&shelf, at));
            for (books, cloth) in books::books(number, n).iter().zip(CLOTHS) {
                self.put("books", cloth, moved(books, at));
            }
        }
        let top = furniture::BOARDS[5];
        self.put("vase", "glaze", moved(&tableware::vase(2 * n), [1.0, top, -HALF[1] + 0.17]));
        self.put("bowl", "terracotta", moved(&tableware::bowl(n), [1.75, top, -HALF[1] + 0.17]));
    }

    /// An armchair, a lamp and a plant, by the window.
    fn corner(&mut self, n: u32) {
        let chair = |mesh: &Mesh| placed(mesh, (Vec3::Y, 38.0), [-2.0, 0.0, -1.35]);
        self.put("armchair", "velvet", chair(&furniture::armchair(n)));
        self.put("armchair feet", "walnut", chair(&furniture::feet(n)));
        let pillow = rounded(Aabb { min: Vec3::splat(-0.2), max: Vec3::new(0.2, 0.2, -0.08) }, 0.06, 3 * n);
        let pillow = placed(&pillow, (Vec3::X, -20.0), [0.04, 0.68, 0.05]);
        self.put("pillow", "ochre cloth", chair(&pillow));
        let lamp = [-2.68, 0.0, -2.06];
        self.put("lamp", "brass", moved(&furniture::lamp_stand(n), lamp));
        self.put("lampshade", "paper", moved(&furniture::shade(n), [lamp[0], 1.48, lamp[2]]));
        let pot = [-2.55, 0.0, 1.55];
        self.put("flower pot", "terracotta", moved(&tableware::pot(n), pot));
        self.put("plant", "leaf", moved(&soft::leaves(n), pot));
    }

    /// Light and camera.
    fn finish(mut self) -> SceneBuilder {
        let [[z0, z1], [y0, y1]] = WINDOW;
        let panel = |name: &str, at: Vec3, u: Vec3, v: Vec3, radiance: Rgb, classic: Rgb| {
            let spec = Spec::new(name, "rect").with("position", at).with("edge_u", u).with("edge_v", v);
            spec.with("radiance", radiance).with("classic", classic)
        };
        let window = Vec3::new(-HALF[0] - 0.22, 0.5 * (y0 + y1), 0.5 * (z0 + z1));
        let (u, v) = (Vec3::Z * (z1 - z0), Vec3::Y * (y1 - y0));
        let (day, warm) = (Rgb::new(11.0, 12.0, 13.5), Rgb::new(34.0, 22.0, 11.0));
        let lights = &mut self.scene.lights;
        lights.push(panel("daylight", window, u, v, day, Rgb::new(0.55, 0.57, 0.60)));
        let bulb = |at: [f32; 3]| (Vec3::from(at), Vec3::X * 0.07, Vec3::Z * 0.07);
        let dim = Rgb::new(0.12, 0.09, 0.05);
        for (name, at) in [("pendant", [0.35, 1.74, -0.15]), ("lamp", [-2.68, 1.49, -2.06])] {
            let (p, u, v) = bulb(at);
            lights.push(panel(name, p, u, v, warm, dim));
        }
        lights.push(Spec::new("ambient", "ambient").with("colour", 0.25f32));
        let eye = Perspective::new("door")
            .position(Vec3::new(2.75, 1.58, 2.15))
            .look_at(Vec3::new(-0.35, 0.92, -0.75))
            .fov(50.0);
        self.scene.add_camera(eye);
        self.scene.settings.set("size", Value::from("960x600"));
        self.scene
    }
}
