//! Paths that are followed many at a time bring the same light, bit for bit, as paths that are followed one by one; and
//! so do light subpaths, photons' gathering, and pairs of subpaths from both ends.

use crate::common::{
    ball, built, diffuse, effort, floor, integrator, look, mixed, put, shoot, sky, still_life,
};
use crate::many_lights::{mesh_of_lamps, painted_lamps, screen};
use bilux_gallery::GENERATORS;
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::{Rgb, Transform, Vec2, Vec3};
use bilux_scene::texture::Texture;
use bilux_scene::{AccelChoice, Counters, CpuLevel, Mesh, Object, Ray, Scene, SceneBuilder, Spec, Value};
use bilux_transport::{Film, LightSubpaths, Merging, Photons, PixelIntegrator, RenderSettings, Splats, Task};
use std::sync::Arc;

/// An integrator that does not say that many of its paths can be followed at once.
struct OneByOne(Box<dyn PixelIntegrator>);

impl PixelIntegrator for OneByOne {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.0.radiance(ray, task)
    }

    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        self.0.light_subpaths().map(|_| self as &dyn LightSubpaths)
    }
}

impl LightSubpaths for OneByOne {
    fn splats(&self) -> bool {
        self.0.splats()
    }

    fn merging(&self) -> Option<&Merging> {
        self.0.merging()
    }

    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        self.0.sample(ray, is_wanted, photons, task, splats)
    }
}

/// The integrators that follow many paths at once.
const QUEUED: [&str; 5] = ["path", "light", "bdpt", "sppm", "vcm"];

fn settings() -> RenderSettings {
    RenderSettings { threads: 2, seed: 3, ..RenderSettings::new(37, 29, 6) }
}

fn one_by_one(scene: &Scene, name: &str, settings: &RenderSettings) -> (Film, Counters) {
    let rendered = shoot(scene, &OneByOne(integrator(name)), settings);
    (rendered.film, rendered.counters)
}

fn assert_same(name: &str, scene: &Scene) {
    assert_same_with(name, scene, &settings());
}

fn assert_same_with(name: &str, scene: &Scene, settings: &RenderSettings) {
    assert_these_same_with(&QUEUED, name, scene, settings);
}

fn assert_these_same_with(queued: &[&str], name: &str, scene: &Scene, settings: &RenderSettings) {
    for queued in queued.iter().copied() {
        let together = shoot(scene, &*integrator(queued), settings);
        let (film, counters) = one_by_one(scene, queued, settings);
        let same = film.to_rgb().iter().zip(together.film.to_rgb()).filter(|(a, b)| **a == *b).count();
        let pixels = film.to_rgb().len();
        assert!(film == together.film, "{name}, {queued}: {same} of {pixels} pixels are the same");
        assert_eq!(counters, together.counters, "{name}, {queued}");
    }
}

/// Many samples of a tile: as paths end, others begin, so that paths of different lengths are shaded together.
#[test]
fn queues_that_are_refilled_give_the_same() {
    let settings = RenderSettings { threads: 2, seed: 5, ..RenderSettings::new(18, 16, 32) };
    let mut holes = mixed();
    let lace = diffuse(0.8f32).with("opacity", 0.5f32);
    put(&mut holes, "lace", ball(Vec3::new(0.0, 0.5, 1.0), 0.5, 8, true), lace);
    assert_same_with("mixed", &built(&mixed()), &settings);
    assert_same_with("holes", &built(&holes), &settings);
    // A path that takes the place of another has a wavelength of its own, which flint reveals.
    let mut flint = mixed();
    let glass = Spec::new("", "dielectric").with("eta", 1.728f32).with("dispersion", 0.7f32);
    put(&mut flint, "flint", ball(Vec3::new(0.0, 0.5, 1.0), 0.5, 8, true), glass);
    assert_same_with("flint", &built(&flint), &settings);
    let spec = Spec::new("", "cornell");
    assert_same_with("cornell", &built(&bilux_gallery::generate(&spec).unwrap()), &settings);
}

#[test]
fn every_built_in_scene_is_the_same() {
    for (turn, row) in GENERATORS.iter().step_by(effort(2, 1)).enumerate() {
        let spec = Spec::new("", row.entry.name);
        let mut builder = bilux_gallery::generate(&spec).unwrap();
        if builder.cameras.is_empty() {
            look(&mut builder, Vec3::new(2.0, 2.0, 5.0), Vec3::ZERO, 40.0);
        }
        if builder.lights.is_empty() {
            sky(&mut builder, 1.0);
        }
        // In the short form with one of the integrators, in turn.
        let scene = built(&builder);
        let follows = |name: &&str| {
            let integrator = integrator(name);
            integrator.follows_media(&scene) && (integrator.sees_glow() || !scene.has_glowing_media())
        };
        let names: Vec<&str> = QUEUED.into_iter().filter(follows).collect();
        let one = turn % names.len();
        let queued = &names[effort(one..one + 1, 0..names.len())];
        assert_these_same_with(queued, row.entry.name, &scene, &settings());
    }
}

#[test]
fn every_kind_of_surface_and_light_is_the_same() {
    assert_same("mixed", &built(&mixed()));
    assert_same("still life", &built(&still_life()));
    assert_same("faint lights", &built(&crate::faint_lights::lamps(6.0, true)));
    let mut one_sided = mixed();
    let material = diffuse(Rgb::new(0.6, 0.3, 0.2)).with("visible_sides", "front");
    put(&mut one_sided, "one-sided", ball(Vec3::new(0.2, 0.5, 1.2), 0.5, 8, true), material.clone());
    put(&mut one_sided, "shell", ball(Vec3::new(0.2, 0.5, 1.2), 0.4999, 8, false), material);
    assert_same("one-sided", &built(&one_sided));
    let mut holes = mixed();
    let lace = diffuse(0.8f32).with("opacity", 0.5f32);
    put(&mut holes, "lace", ball(Vec3::new(0.0, 0.5, 1.0), 0.5, 8, true), lace);
    assert_same("holes", &built(&holes));
    let mut many = mixed();
    for i in 0..7 {
        let panel = Spec::new("", "rect").with("position", Vec3::new(i as f32 - 3.0, 2.5, -1.0));
        let panel = panel.with("edge_u", Vec3::X * 0.4).with("edge_v", Vec3::Z * 0.4);
        many.lights.push(panel.with("intensity", 1.0 + i as f32));
    }
    assert_same("many lights", &built(&many));
    let mut black = SceneBuilder::default();
    put(&mut black, "floor", floor(0.0, 3.0), diffuse(0.0f32));
    put(&mut black, "ball", ball(Vec3::Y, 1.0, 8, true), diffuse(Rgb::new(0.0, 1.0, 0.0)));
    sky(&mut black, 1.0);
    look(&mut black, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0), 40.0);
    assert_same("black", &built(&black));
}

/// Each sample has a time of its own, at which its light subpath begins too.
#[test]
fn what_moves_while_the_shutter_is_open_is_the_same() {
    let scene = crate::common::moving().build(&AccelChoice::default(), [0.0, 1.0], 1.0).unwrap();
    assert_same("moving", &scene);
}

#[test]
fn every_kind_of_shape_is_the_same() {
    // Points and lines have the material of the triangles, and no colours of their own.
    let mut strokes = mixed();
    let mesh = ball(Vec3::new(0.3, 0.6, 1.2), 0.5, 6, true);
    let bare = Mesh { triangles: Vec::new(), normals: Vec::new(), ..(*mesh).clone() };
    let (points, lines) = ((0..bare.positions.len() as u32).collect(), vec![[0, 5], [7, 20], [3, 30]]);
    put(&mut strokes, "cloud", Arc::new(Mesh { points, lines, ..bare }), diffuse(0.6f32));
    put(&mut strokes, "both", Arc::new(Mesh { lines: vec![[1, 9]], ..(*mesh).clone() }), diffuse(0.4f32));
    assert_same("points and lines", &built(&strokes));
    let mut instances = mixed();
    put(&mut instances, "copy", mesh, diffuse(Rgb::new(0.2, 0.7, 0.4)));
    let copy = instances.objects.pop().unwrap();
    for i in 0..3 {
        let place = Transform::translate(Vec3::X * (i as f32 - 1.0)).unwrap();
        instances.objects.push(Object { instanced: true, ..copy.clone() }.placed(place));
    }
    assert_same("instances", &built(&instances));
}

/// Textures of 4x4 texels, with everything from nothing to all of it.
fn texture(seed: u64, is_data: bool) -> Arc<Texture> {
    let number = |i: usize, k: u64| unit_f32(hash_words([seed, i as u64, k]) as u32);
    let texel = |i: usize| {
        Rgb::new(number(i, 0), number(i, 1), number(i, 2)).map(|c| (c * 1.5 - 0.25).clamp(0.0, 1.0))
    };
    Arc::new(Texture::new("numbers", 4, 4, (0..16).map(texel).collect(), is_data))
}

/// Plastic, metal and everything between, smooth in places, with normal maps, emission and colours at vertices.
fn opaque_bases() -> SceneBuilder {
    let mut scene = mixed();
    scene.textures.extend([texture(1, false), texture(2, true), texture(3, true), texture(4, true)]);
    let principled = || Spec::new("", "principled");
    let textured = || {
        principled()
            .with("base_color", Value::Texture(0))
            .with("base_metalness", Value::Texture(1))
            .with("specular_roughness", Value::Texture(2))
    };
    let mesh = ball(Vec3::new(0.3, 0.5, 1.3), 0.5, 6, true);
    let uvs = mesh.positions.iter().map(|p| Vec2::new(p.x * 2.0, p.y * 2.0)).collect();
    let vertex_kd =
        mesh.positions.iter().map(|p| Rgb::from_array((*p * 0.4 + Vec3::splat(0.5)).to_array())).collect();
    let mesh = Mesh { uvs, ..(*mesh).clone() };
    let moved = |x: f32, mesh: &Mesh| {
        let positions = mesh.positions.iter().map(|p| *p + Vec3::X * x).collect();
        Arc::new(Mesh { positions, ..mesh.clone() })
    };
    put(&mut scene, "textured", moved(0.0, &mesh), textured());
    let bumpy = textured().with("normal", Value::Texture(3)).with("normal_scale", 2.0f32);
    put(&mut scene, "bumpy", moved(1.1, &mesh), bumpy.clone());
    put(&mut scene, "glowing", moved(-1.1, &mesh), bumpy.with("emission", Rgb::new(0.2, 0.1, 0.4)));
    let painted = Mesh { vertex_kd, ..mesh.clone() };
    put(&mut scene, "painted", moved(2.2, &painted), principled().with("specular_roughness", 0.4f32));
    let shiny = principled().with("base_metalness", 1.0f32).with("specular_roughness", 0.04f32);
    put(&mut scene, "shiny", moved(-2.2, &mesh), shiny);
    let dark = principled().with("base_color", 0.0f32).with("specular_weight", 0.0f32);
    put(&mut scene, "dark", ball(Vec3::new(0.0, 0.2, 2.2), 0.2, 5, true), dark);
    put(&mut scene, "faceted", ball(Vec3::new(0.6, 0.2, 2.2), 0.2, 5, false), textured());
    scene
}

#[test]
fn plastic_and_metal_are_the_same() {
    let scene = opaque_bases();
    assert_same("opaque bases", &built(&scene));
    let mut absorbs = scene.clone();
    let tinted = Spec::new("tinted", "dielectric").with("absorption", Rgb::new(2.0, 0.3, 0.1));
    put(&mut absorbs, "around", ball(Vec3::new(0.3, 0.5, 1.3), 0.7, 8, true), tinted);
    assert_same("opaque bases in glass", &built(&absorbs));
    let shallow = RenderSettings { max_depth: 2, ..settings() };
    assert_same_with("opaque bases, few bounces", &built(&scene), &shallow);
}

/// Mirrors and smooth glass on meshes so coarse that many directions about interpolated normals end on the wrong side.
///
/// Where one is as clear as air, media overlap, and no paths are shaded together.
fn smooth_lobes(has_air: bool) -> SceneBuilder {
    let mut scene = mixed();
    let (mirror, glass) = (|| Spec::new("", "mirror"), || Spec::new("", "dielectric"));
    let tint = Rgb::new(0.9, 0.6, 0.2);
    let kinds = [
        mirror().with("reflectance", tint),
        mirror().with("reflectance", 0.0f32),
        glass().with("tint", tint),
        glass().with("eta", 1.0f32 / 1.5),
        glass().with("thin", true).with("tint", tint),
        glass().with("eta", 1.0f32),
    ];
    for (i, kind) in kinds.into_iter().take(if has_air { 6 } else { 5 }).enumerate() {
        let centre = Vec3::new(0.9 * i as f32 - 2.2, 0.4, 1.3);
        put(&mut scene, "coarse", ball(centre, 0.4, 3, true), kind.clone());
        put(&mut scene, "flat", ball(centre + Vec3::new(0.4, 0.0, 0.7), 0.25, 4, false), kind);
    }
    scene
}

#[test]
fn mirrors_and_smooth_glass_are_the_same() {
    assert_same("smooth, and air", &built(&smooth_lobes(true)));
    let scene = smooth_lobes(false);
    assert!(built(&scene).has_clear_media(), "or they are not shaded together");
    assert_same("smooth", &built(&scene));
    let shallow = RenderSettings { max_depth: 3, ..settings() };
    assert_same_with("smooth, few bounces", &built(&scene), &shallow);
    // Roulette begins within the glass.
    let deep = RenderSettings { max_depth: 40, ..settings() };
    assert_same_with("smooth, many bounces", &built(&scene), &deep);
}

/// Their vertices go down the tree of a mesh together; alone, and as one of many lights.
#[test]
fn meshes_of_many_triangles_or_pieces_are_the_same() {
    for (name, scene) in
        [("lamps", mesh_of_lamps(3.0)), ("painted lamps", painted_lamps(1.0)), ("screen", screen(1.0))]
    {
        assert_same(name, &built(&scene));
        let mut many = scene;
        for i in 0..4 {
            let lamp = Spec::new("", "point").with("position", Vec3::new(i as f32 - 1.5, 1.0, 1.0));
            many.lights.push(lamp.with("intensity", 0.2f32));
        }
        assert_same(&format!("{name} and others"), &built(&many));
    }
}

#[test]
fn environment_maps_are_the_same() {
    let map = |map: usize| Spec::new("", "environment").with("radiance", Value::Texture(map));
    let mut scene = opaque_bases();
    scene.lights = vec![map(0)];
    assert_same("a map", &built(&scene));
    scene.lights.push(Spec::new("", "point").with("position", Vec3::Y * 3.0).with("intensity", 3.0f32));
    scene.lights.push(map(3).with("backdrop", true));
    assert_same("a map, a lamp and a backdrop", &built(&scene));
}

#[test]
fn every_kind_of_medium_is_the_same() {
    let glass = |name: &str| Spec::new(name, "dielectric");
    let (absorbing, tinted) =
        (Rgb::new(0.1, 0.6, 2.0), glass("tinted").with("absorption", Rgb::new(2.0, 0.3, 0.1)));
    let mut absorbs = mixed();
    put(&mut absorbs, "tinted", ball(Vec3::new(0.0, 0.6, 1.5), 0.6, 8, true), tinted.clone());
    assert_same("absorption", &built(&absorbs));
    // The camera, the light and a diffuse ball are inside a block that absorbs.
    let mut inside = mixed();
    let block = glass("block").with("eta", 1.0f32).with("absorption", absorbing * 0.05);
    put(&mut inside, "block", ball(Vec3::ZERO, 40.0, 6, false), block);
    assert_same("inside", &built(&inside));
    // Water in a glass, each with a priority; they overlap.
    let mut nested = mixed();
    let (centre, water) =
        (Vec3::new(0.1, 0.7, 1.3), glass("water").with("eta", 1.33f32).with("absorption", absorbing));
    put(&mut nested, "glass", ball(centre, 0.6, 8, true), tinted.with("priority", 2));
    put(&mut nested, "water", ball(centre + Vec3::X * 0.2, 0.6, 8, true), water.with("priority", 1));
    assert_same("nested", &built(&nested));
    // All is in a block of the higher priority, so shadow rays pass the surface of the water.
    let mut hidden = mixed();
    let block = glass("block").with("eta", 1.0f32).with("absorption", absorbing * 0.05).with("priority", 2);
    put(&mut hidden, "block", ball(Vec3::ZERO, 40.0, 6, false), block);
    let water = glass("water").with("eta", 1.33f32).with("absorption", absorbing).with("priority", 1);
    put(&mut hidden, "water", ball(centre, 0.9, 8, true), water);
    assert_same("hidden surfaces", &built(&hidden));
    // A lamp in a frosted ball: light samples cross its surface.
    let mut frosted = mixed();
    let rough = glass("frosted").with("absorption", absorbing).with("roughness", 0.4f32);
    put(&mut frosted, "frosted", ball(centre, 0.6, 8, true), rough);
    frosted.lights.push(Spec::new("", "point").with("position", centre).with("intensity", 3.0f32));
    assert_same("frosted", &built(&frosted));
    let mut prism = mixed();
    put(&mut prism, "flint", ball(centre, 0.6, 8, true), glass("flint").with("dispersion", 0.05f32));
    assert_same("dispersion", &built(&prism));
}

#[test]
fn every_level_of_instructions_gives_the_same() {
    for queued in QUEUED {
        let at = |cpu_level: CpuLevel| {
            let mut accel = AccelChoice::default();
            accel.options.cpu_level = cpu_level;
            let scene = |of: SceneBuilder| of.build(&accel, [0.0, 0.0], 1.0).unwrap();
            [opaque_bases(), smooth_lobes(false)]
                .map(|of| shoot(&scene(of), &*integrator(queued), &settings()).film)
        };
        let truth =
            [opaque_bases(), smooth_lobes(false)].map(|of| one_by_one(&built(&of), queued, &settings()).0);
        for level in CpuLevel::ALL {
            assert!(at(level) == truth, "{queued}, {}", level.name());
        }
    }
}
