//! Skin: a piglet in the straw, lit from behind, whose ears glow red.

use super::{Stage, about, at, boxes};
use crate::GeneratorEntry;
use crate::modelling::implicit::{Cone, Cut, ellipsoid, soft_max, soft_min};
use crate::modelling::parts::{chance, joined, placed, sharp};
use bilux_math::glam::UVec3;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};
use std::f32::consts::TAU;

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("piglet", "a piglet in the straw, whose ears glow against the sun"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// Stalks of straw.
const STALKS: u32 = 1400;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.0);
    stable(&mut stage);
    // Light travels 1/(1.09 + .013), 1/(1.59 + .070) and 1/(1.79 + .145) mm. [Jensen 2001, figure 5: skin2]
    let skin = stage.material(
        Spec::new("skin", "principled")
            .with("subsurface_weight", 1.0f32)
            .with("subsurface_color", Rgb::new(0.63, 0.44, 0.34))
            .with("subsurface_radius", 0.000_907f32)
            .with("subsurface_radius_scale", Rgb::new(1.0, 0.664, 0.57))
            .with("specular_ior", 1.4f32)
            .with("specular_roughness", 0.42f32),
    );
    stage.put("piglet", body(), skin);
    let horn = stage.material(
        Spec::new("horn", "principled")
            .with("base_color", Rgb::new(0.16, 0.09, 0.06))
            .with("specular_roughness", 0.3f32),
    );
    stage.put("hooves", hooves(), horn);
    let black = stage.material(
        Spec::new("eye", "principled")
            .with("base_color", Rgb::new(0.012, 0.008, 0.006))
            .with("specular_roughness", 0.06f32),
    );
    stage.put("eyes", joined(sides().map(|side| shapes::icosphere(eye(side), EYE, 4))), black);
    // The sun through a hatch, and daylight through the door.
    stage.panel("sun", [-0.55, 0.95, -1.0], [[0.34, 0.0, -0.19], [0.19, 0.26, 0.2]], [175.0, 122.0, 74.0]);
    stage.panel("door", [1.5, 0.9, 1.3], [[0.5, 0.0, -0.6], [0.0, 1.0, 0.0]], [3.6, 3.8, 4.2]);
    stage.light(Spec::new("room", "environment").with("radiance", Rgb::new(0.10, 0.09, 0.08)));
    let mut scene = stage.seen([0.30, 0.27, 0.92], [0.0, 0.165, 0.05], 24.0);
    if let Some(camera) = scene.cameras.first_mut() {
        camera.spec.parameters.set("aperture", 0.008f32);
        camera.spec.parameters.set("focus", 0.78f32);
    }
    scene
}

fn sides() -> [f32; 2] {
    [-1.0, 1.0]
}

const HEAD: Vec3 = at(0.0, 0.213, 0.105);
const EYE: f32 = 0.0085;

/// The middle of an eye.
fn eye(side: f32) -> Vec3 {
    at(0.0375 * side, 0.232, 0.1555)
}

/// Body of the piglet, which stands along z and looks towards positive z.
fn body() -> Mesh {
    let cut = Cut {
        bounds: Aabb { min: at(-0.125, -0.004, -0.245), max: at(0.125, 0.345, 0.225) },
        cells: UVec3::new(88, 108, 120),
        finer: at(0.0, 0.45, 0.4),
    };
    // It is the same on both sides.
    cut.mesh("piglet", |p| piglet(at(p.x.abs(), p.y, p.z)).min(tail(p)))
}

fn piglet(p: Vec3) -> f32 {
    let cone = |from: Vec3, to: Vec3, radius: [f32; 2]| Cone { from, to, radius }.distance(p);
    let round = |middle: Vec3, radii: Vec3| ellipsoid(p - middle, radii);
    let trunk = soft_min(
        round(at(0.0, 0.150, -0.075), at(0.080, 0.083, 0.125)),
        round(at(0.0, 0.155, 0.02), at(0.066, 0.072, 0.070)),
        0.05,
    );
    let front = soft_min(
        cone(at(0.040, 0.115, 0.030), at(0.043, 0.052, 0.036), [0.034, 0.0195]),
        cone(at(0.043, 0.052, 0.036), at(0.044, 0.014, 0.040), [0.0185, 0.0165]),
        0.012,
    );
    let hind = soft_min(
        cone(at(0.045, 0.125, -0.130), at(0.052, 0.058, -0.152), [0.048, 0.0215]),
        cone(at(0.052, 0.058, -0.152), at(0.053, 0.014, -0.142), [0.0195, 0.017]),
        0.012,
    );
    let standing = soft_min(trunk, soft_min(front, hind, 0.02), 0.03);
    let whole = soft_min(standing, head(p), 0.030);
    soft_min(whole, ear(p), 0.016)
}

fn head(p: Vec3) -> f32 {
    let cone = |from: Vec3, to: Vec3, radius: [f32; 2]| Cone { from, to, radius }.distance(p);
    let round = |middle: Vec3, radii: Vec3| ellipsoid(p - middle, radii);
    if p.distance(HEAD) > 0.2 {
        return p.distance(HEAD) - 0.13;
    }
    let skull = round(HEAD, at(0.061, 0.058, 0.064));
    let cheek = round(at(0.030, 0.192, 0.128), at(0.034, 0.032, 0.036));
    let muzzle = cone(at(0.0, 0.203, 0.140), at(0.0, 0.196, 0.196), [0.040, 0.0265]);
    let jaw = cone(at(0.0, 0.178, 0.130), at(0.0, 0.172, 0.180), [0.030, 0.0145]);
    let mut face = soft_min(soft_min(skull, cheek, 0.03), soft_min(muzzle, jaw, 0.012), 0.028);
    // The disc of the snout, with its nostrils.
    let disc = round(at(0.0, 0.1965, 0.204), at(0.0285, 0.0245, 0.0085));
    face = soft_min(face, disc, 0.006);
    let nostril = ellipsoid(p - at(0.0105, 0.1975, 0.2135), at(0.0048, 0.0072, 0.0075));
    face = soft_max(face, -nostril, 0.003);
    // The corner of the mouth.
    let mouth = cone(at(0.0, 0.1765, 0.197), at(0.0265, 0.1855, 0.168), [0.0012, 0.0016]);
    face = soft_max(face, -mouth, 0.004);
    // Lids around the eyes.
    let lid = p.distance(eye(1.0) - at(0.0018, 0.0, 0.0022)) - 0.0112;
    let socket = p.distance(eye(1.0)) - 1.03 * EYE;
    soft_max(soft_min(face, lid, 0.008), -socket, 0.0015)
}

/// An ear: a leaf of skin that curls forward.
fn ear(p: Vec3) -> f32 {
    const LENGTH: f32 = 0.088;
    let along = at(0.62, 0.77, 0.05).normalize();
    let facing = (at(0.25, -0.30, 1.0) - along * along.dot(at(0.25, -0.30, 1.0))).normalize();
    let across = along.cross(facing);
    let q = p - at(0.033, 0.252, 0.088);
    if q.length() > LENGTH + 0.05 {
        return q.length() - LENGTH - 0.02;
    }
    let (u, v, w) = (q.dot(across), q.dot(along), q.dot(facing));
    let t = (v / LENGTH).clamp(0.0, 1.0);
    let half = 0.0285 * (1.0 - t * t) * (1.0 + 0.75 * t);
    let curl = 7.0 * u * u + 2.4 * v * v - 0.004;
    let thickness = 0.0036 - 0.0016 * t;
    let outline = 0.75 * (u.abs() - half).max(v - LENGTH).max(-v - 0.022);
    soft_max(0.8 * ((w - curl).abs() - thickness), outline, 0.003)
}

/// A curl of the tail.
fn tail(p: Vec3) -> f32 {
    if p.z > -0.14 {
        return p.z + 0.18;
    }
    let points = (0..=14).map(|k| {
        let t = k as f32 / 14.0;
        let (sin, cos) = sin_cos(1.25 * TAU * t);
        at(0.014 * sin * (0.4 + 0.6 * t), 0.190 + 0.014 * (1.0 - cos) + 0.006 * t, -0.190 - 0.034 * t)
    });
    let points: Vec<Vec3> = points.collect();
    points.windows(2).enumerate().fold(f32::INFINITY, |d, (k, ends)| {
        let thick = |k: usize| 0.0062 - 0.003 * k as f32 / 14.0;
        let cone = Cone { from: ends[0], to: ends[1], radius: [thick(k), thick(k + 1)] };
        soft_min(d, cone.distance(p), 0.002)
    })
}

/// Two toes a foot.
fn hooves() -> Mesh {
    let feet = [[0.044, 0.043], [0.053, -0.139]];
    let toes = feet.into_iter().flat_map(|[x, z]| {
        sides().into_iter().flat_map(move |side| sides().map(|toe| [side * x + 0.0078 * toe, z]))
    });
    joined(toes.map(|[x, z]| {
        let toe = |d: Vec3| {
            let radii = at(0.0095, 0.0175, 0.0175);
            1.0 / (d / radii).length()
        };
        let mut toe = shapes::blob(at(x, 0.0075, z), 3, toe);
        toe.positions.iter_mut().for_each(|p| p.y = p.y.max(0.0005));
        toe.normals = toe.smooth_normals();
        toe
    }))
}

/// A corner with straw on the ground and boards behind.
fn stable(stage: &mut Stage) {
    let earth = stage.diffuse("earth", [0.16, 0.11, 0.065]);
    stage.put("ground", shapes::floor(Vec3::ZERO, 8.0), earth);
    let boards = (0..24).map(|k| {
        let x = -2.4 + 0.2 * k as f32;
        let back = -1.55 + 0.02 * chance(70, k);
        [[x, 0.0, back - 0.03], [x + 0.193, 2.4, back]]
    });
    let oak = stage.diffuse("boards", [0.10, 0.065, 0.04]);
    stage.put("boards", boxes(&boards.collect::<Vec<_>>()), oak);
    let stalk = |k: u32| {
        let [a, b, c, d, e] = [1, 2, 3, 4, 5].map(|kind| chance(kind, k));
        let long = 0.05 + 0.09 * a;
        let mesh = sharp(Aabb { min: at(-0.0011, -0.0011, -long), max: at(0.0011, 0.0011, long) });
        let tilted = placed(&mesh, (Vec3::X, 24.0 * (b - 0.5)), [0.0; 3]);
        placed(
            &tilted,
            (Vec3::Y, 360.0 * c),
            [1.5 * (d - 0.5), 0.002 + 0.022 * chance(6, k), 1.9 * (e - 0.62)],
        )
    };
    let shades = [[0.62, 0.46, 0.20], [0.50, 0.36, 0.15], [0.70, 0.56, 0.30]];
    for (shade, colour) in shades.into_iter().enumerate() {
        let straw = stage.diffuse("straw", colour);
        let stalks = (0..STALKS).filter(|k| *k as usize % shades.len() == shade).map(stalk);
        stage.put("straw", joined(stalks), straw);
    }
}
