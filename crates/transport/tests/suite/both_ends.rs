//! Light traced from both ends: `light` and `bdpt` against `path`, wherever they find the same paths.

use crate::common::statistics::{
    UNLIKELY, agreement, assert_like_path, assert_like_path_in_turn, blocks, difference, recorded,
};
use crate::common::{
    ball, built, diffuse, effort, floor, integrator, look, mixed, put, quad, shoot, sky, still_life,
    without_mirrors,
};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{
    CameraSample, Goniometer, IntensityDistribution, Object, Ray, Scene, SceneBuilder, Spec, Texture, Value,
};
use bilux_transport::{
    FILTERS, Filter, LightSubpaths, Photons, PixelIntegrator, RenderSettings, Splats, Task, Window,
    integrators,
};
use std::f32::consts::PI;
use std::sync::Arc;

#[test]
fn every_kind_of_light_gives_the_same_from_both_ends() {
    let lights = [
        Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 4.0f32),
        Spec::new("", "spot").with("position", Vec3::new(1.0, 3.0, 2.0)).with("intensity", 20.0f32),
        Spec::new("", "directional").with("direction", Vec3::new(0.3, -1.0, -0.4)),
        Spec::new("", "environment").with("radiance", 0.5f32).with("ground", 0.1f32).with("zenith", 1.0f32),
        Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32),
        sphere(Vec3::new(-0.5, 2.5, 0.0), 0.3),
        lamp(Vec3::new(-0.3, 2.5, 1.0)),
    ];
    for (turn, light) in lights.into_iter().enumerate() {
        let name = light.kind.clone();
        assert_like_path_in_turn(turn, &name, &built(&without_mirrors(light)), &["light", "bdpt"]);
    }
}

/// A lamp whose light is of a measured kind: other in each half plane, and none above it.
fn lamp(position: Vec3) -> Spec {
    let (azimuths, polar) = (vec![0.0, 40.0, 200.0, 360.0], vec![0.0, 25.0, 60.0, 110.0]);
    let candela = (0..16).map(|i| (700 * ((5 * i + 3) % 11)) as f32).collect();
    let made = IntensityDistribution::new("odd", Goniometer::C, azimuths, polar, candela).unwrap();
    Spec::new("", "luminaire").with("position", position).with("distribution", Arc::new(made))
}

/// A lamp that moves over a floor from left to right while the shutter is open lights both halves alike, in a single iteration
/// too: each light subpath has a time of its own.
#[test]
fn a_lamp_that_moves_lights_both_sides_of_its_way() {
    let scene = crate::common::moving().build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    for name in ["path", "light", "bdpt", "vcm", "sppm"] {
        let settings = RenderSettings::new(32, 32, 1);
        let film = shoot(&scene, &*integrator(name), &settings).film;
        let half = |first: u32| {
            let pixels = (0..32).flat_map(|y| (first..first + 16).map(move |x| (x, y)));
            pixels.map(|(x, y)| film.pixel(x, y).g).sum::<f32>()
        };
        let (left, right) = (half(0), half(16));
        assert!(left > 1.0 && (0.75..1.33).contains(&(left / right)), "{name}: {left} and {right}");
    }
    let path = blocks(&scene, integrator("path"), 0);
    for (i, name) in ["light", "bdpt"].into_iter().enumerate() {
        let p = agreement(name, &path, &blocks(&scene, integrator(name), 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{name}: p = {p}");
    }
}

#[test]
fn one_sided_lights_illuminate_only_their_front() {
    let panel = |edge_u: Vec3, sides: &str| {
        let spec = Spec::new("", "rect").with("position", Vec3::new(0.5, 3.2, 0.5)).with("radiance", 8.0f32);
        built(&without_mirrors(spec.with("edge_u", edge_u).with("sides", sides)))
    };
    // Its front faces down, like that of a light in a ceiling.
    assert_like_path("light in front", &panel(Vec3::X, "front"), &["light", "bdpt", "vcm"]);
    let settings = RenderSettings::new(16, 16, 16);
    let lit = |scene: &Scene, name: &str| shoot(scene, &*integrator(name), &settings).film.to_rgb();
    let [front, both] = ["front", "both"].map(|sides| lit(&panel(Vec3::X, sides), "path"));
    assert!(front == both, "what is in front of it is lit otherwise than by both sides");
    // Turned up it lights nothing.
    for name in ["path", "light", "bdpt", "vcm", "sppm", "auto"] {
        let brightest = |sides: &str| {
            let pixels = lit(&panel(-Vec3::X, sides), name);
            pixels.iter().map(|pixel| pixel.max_channel()).fold(0.0, f32::max)
        };
        assert_eq!(brightest("front"), 0.0, "{name}");
        assert!(brightest("both") > 0.0, "{name}");
    }
}

fn sphere(position: Vec3, radius: f32) -> Spec {
    Spec::new("", "sphere").with("position", position).with("radius", radius).with("intensity", 10.0f32)
}

#[test]
fn spheres_that_touch_what_they_light_give_the_same_from_both_ends() {
    let places = [
        ("resting on the floor", Vec3::new(0.2, 0.4, 1.0), 0.4),
        ("sunk into the floor", Vec3::new(0.2, 0.1, 1.0), 0.4),
        ("around most of it", Vec3::new(-1.5, 1.0, -1.5), 1.8),
        ("small, behind the ball and close to the floor", Vec3::new(-1.0, 0.03, -1.2), 0.005),
    ];
    for (turn, (name, position, radius)) in places.into_iter().enumerate() {
        assert_like_path_in_turn(
            turn,
            name,
            &built(&without_mirrors(sphere(position, radius))),
            &["light", "bdpt"],
        );
    }
}

#[test]
fn spheres_in_glass_and_mirrors_look_the_same_from_both_ends() {
    let mut builder = without_small_lights(mixed());
    builder.lights.retain(|light| light.kind != "rect");
    builder.lights.extend([sphere(Vec3::new(-1.5, 2.5, 0.5), 0.6), sphere(Vec3::new(1.4, 0.3, 1.0), 0.3)]);
    let bulb = Spec::new("", "dielectric").with("absorption", Rgb::new(0.5, 0.2, 0.1));
    put(&mut builder, "bulb", ball(Vec3::new(1.4, 0.3, 1.0), 0.5, 10, true), bulb);
    assert_like_path("glass and mirrors", &built(&builder), &["bdpt"]);
}

#[test]
fn spheres_and_photons_agree() {
    let scene = built(&without_mirrors(sphere(Vec3::new(-0.5, 2.0, 0.5), 0.5)));
    let path = blocks(&scene, integrator("path"), 0);
    for (i, name) in ["vcm", "sppm"].into_iter().enumerate() {
        let found = blocks(&scene, with_radius(name, 0.01), 100 * (i as u64 + 1));
        let case = format!("path and {name}");
        let p = agreement(&case, &path, &found);
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

/// A panel over a ball of some material, and a diffuse one.
fn panel_over(material: Spec) -> SceneBuilder {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let mut builder = without_mirrors(panel);
    let last = builder.materials.len() - 1;
    builder.materials[last] = material;
    sky(&mut builder, 0.2);
    builder
}

#[test]
fn layered_surfaces_look_the_same_from_both_ends() {
    let principled = || Spec::new("", "principled").with("base_color", Rgb::new(0.7, 0.3, 0.2));
    let metal = principled().with("base_metalness", 1.0f32).with("specular_roughness", 0.3f32);
    let coated = principled().with("specular_roughness", 0.5f32).with("coat_weight", 0.8f32);
    let clear = principled().with("transmission_weight", 1.0f32).with("specular_roughness", 0.3f32);
    let surfaces = [
        ("plastic", principled().with("specular_roughness", 0.2f32)),
        ("metal", metal.with("specular_roughness_anisotropy", 0.6f32)),
        ("coated", coated.with("coat_roughness", 0.2f32).with("coat_color", Rgb::new(0.9, 0.7, 0.6))),
        ("clear", clear.clone().with("transmission_color", Rgb::new(0.6, 0.9, 0.8))),
        ("velvet", principled().with("fuzz_weight", 0.9f32).with("fuzz_roughness", 0.4f32)),
        ("clay", principled().with("base_diffuse_roughness", 1.0f32)),
        ("leaf", principled().with("diffuse_transmission_weight", 0.6f32)),
        ("oily", principled().with("thin_film_weight", 1.0f32).with("base_metalness", 0.6f32)),
        ("oily glass", clear.clone().with("thin_film_weight", 1.0f32).with("thin_film_ior", 1.8f32)),
        ("clear in part", clear.with("transmission_weight", 0.5f32)),
    ];
    for (turn, (name, material)) in surfaces.into_iter().enumerate() {
        assert_like_path_in_turn(turn, name, &built(&panel_over(material)), &["light", "bdpt", "vcm"]);
    }
}

#[test]
fn rough_metal_and_glass_look_the_same_from_both_ends() {
    let brushed = Spec::new("", "conductor").with("metal", "copper").with("roughness", 0.5f32);
    let brushed = brushed.with("anisotropy", 0.7f32).with("rotation", 30.0f32);
    let frosted = Spec::new("", "dielectric").with("roughness", 0.5f32);
    let frosted = frosted.with("absorption", Rgb::new(0.5, 0.2, 0.1));
    let pane = Spec::new("", "dielectric").with("roughness", 0.6f32).with("thin", true);
    for (name, material) in [("brushed copper", brushed), ("frosted glass", frosted), ("frosted pane", pane)]
    {
        let scene = built(&panel_over(material));
        assert_like_path(name, &scene, &["light", "bdpt"]);
        let path = blocks(&scene, integrator("path"), 0);
        let case = format!("{name}: path and vcm");
        let p = agreement(&case, &path, &blocks(&scene, with_radius("vcm", 0.01), 300));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

/// Waves in both directions as a normal map.
fn waves() -> Texture {
    let texels = (0..64).map(|i| {
        let lean = |k: i32| 0.5 + 0.45 * bilux_math::transcendental::sin_cos(k as f32 * PI / 4.0).0;
        Rgb::new(lean(i % 8), lean(i / 8), 0.75)
    });
    Texture::new("", 8, 8, texels.collect(), true)
}

#[test]
fn normal_maps_look_the_same_from_both_ends() {
    let satin = Spec::new("", "conductor").with("metal", "silver").with("roughness", 0.6f32);
    let frosted = Spec::new("", "dielectric").with("roughness", 0.6f32);
    let bumps_below_a_coat =
        Spec::new("", "principled").with("coat_weight", 1.0f32).with("coat_roughness", 0.4f32);
    let coat_with_bumps = bumps_below_a_coat.clone().with("coat_normal", Value::Texture(0));
    let surfaces = [
        ("matte", diffuse(0.8f32)),
        ("satin", satin),
        ("frosted", frosted),
        ("bumps below a coat", bumps_below_a_coat),
        ("a coat with bumps", coat_with_bumps.with("normal_scale", 0.3f32)),
    ];
    for (turn, (name, material)) in surfaces.into_iter().enumerate() {
        let mut builder = panel_over(material.with("normal", Value::Texture(0)));
        builder.textures.push(Arc::new(waves()));
        for (object, tiles) in [(0, 1.0), (3, 3.0)] {
            let object = &mut builder.objects[object];
            let mut mesh = (*object.mesh).clone();
            mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x + 0.3 * p.y, p.z - p.y) * tiles).collect();
            object.mesh = Arc::new(mesh);
        }
        builder.materials[0].parameters.set("normal", Value::Texture(0));
        // The camera is low above the floor, where many normals face away.
        builder.cameras.clear();
        look(&mut builder, Vec3::new(0.0, 0.6, 4.0), Vec3::new(0.0, 0.4, 0.0), 40.0);
        assert_like_path_in_turn(turn, name, &built(&builder), &["light", "bdpt"]);
    }
}

#[test]
fn normals_that_face_away_look_the_same_from_both_ends() {
    let satin = Spec::new("", "phong").with("kd", 0.3f32).with("ks", 0.5f32).with("exponent", 20.0f32);
    let plastic = Spec::new("", "principled").with("base_color", Rgb::new(0.7, 0.3, 0.2));
    let surfaces = [
        ("matte", diffuse(0.8f32)),
        ("satin", satin.with("reflectivity", 0.0f32)),
        ("plastic", plastic.clone().with("specular_roughness", 0.3f32)),
        ("coated", plastic.with("coat_weight", 0.8f32).with("coat_roughness", 0.3f32)),
    ];
    for (turn, (name, material)) in surfaces.into_iter().enumerate() {
        let mut builder = panel_over(material);
        builder.objects.truncate(2);
        let last = builder.materials.len() - 1;
        for x in [-0.8, 0.8] {
            let coarse = ball(Vec3::new(x, 0.7, 0.3), 0.7, 3, true);
            builder.objects.push(Object::new("coarse", coarse, last));
        }
        assert_like_path_in_turn(turn, name, &built(&builder), &["light", "bdpt"]);
        let path = blocks(built(&builder), integrator("path"), 0);
        let case = format!("{name}: path and vcm");
        let p = agreement(&case, &path, &blocks(built(&builder), with_radius("vcm", 0.01), 300));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

#[test]
fn a_picture_of_the_sky_gives_the_same_from_both_ends() {
    let texels = (0..32 * 16).map(|i| {
        let (x, y) = (i % 32, i / 32);
        let sun = if (12..14).contains(&x) && y == 4 { 40.0 } else { 0.0 };
        Rgb::new(0.3, 0.4, 0.6) * (1.0 - y as f32 / 16.0) + Rgb::new(1.0, 0.8, 0.5) * sun
    });
    let picture = Texture::new("", 32, 16, texels.collect(), false);
    let light = Spec::new("", "environment").with("radiance", Value::Texture(0)).with("rotation", 20.0f32);
    let mut builder = without_mirrors(light);
    builder.textures.push(Arc::new(picture));
    assert_like_path("picture", &built(&builder), &["light", "bdpt"]);
}

#[test]
fn a_mixture_with_a_mirror_in_it_looks_the_same_from_both_ends() {
    let mixed = |builder: &mut SceneBuilder, a: Spec, b: Spec, amount: f32| {
        let (a, b) = (builder.add_material(a), builder.add_material(b));
        let spec = Spec::new("", "mix").with("a", Value::Material(a)).with("b", Value::Material(b));
        spec.with("amount", amount)
    };
    let mut builder = panel_over(Spec::new("", "mirror"));
    let gold = Spec::new("", "conductor").with("metal", "gold").with("roughness", 0.5f32);
    let enamel = mixed(&mut builder, diffuse(Rgb::new(0.1, 0.4, 0.7)), Spec::new("", "mirror"), 0.3);
    let ball = builder.objects.last().unwrap().material;
    builder.materials[ball] = mixed(&mut builder, gold, enamel, 0.6);
    // The inner mix is a material of its own.
    let inner = builder.materials.len() - 1;
    assert_eq!(builder.materials[inner].kind, "mix");
    let scene = built(&builder);
    assert_like_path("enamel", &scene, &["bdpt"]);
    let path = blocks(&scene, integrator("path"), 0);
    let case = "enamel: path and vcm";
    let p = agreement(case, &path, &blocks(&scene, with_radius("vcm", 0.01), 300));
    assert!(p > UNLIKELY, "{case}: p = {p}");
}

/// No camera subpath finds the light that a mirror reflects from a light without extent.
fn without_small_lights(mut builder: SceneBuilder) -> SceneBuilder {
    builder.lights.retain(|light| !["point", "spot", "directional"].contains(&light.kind.as_str()));
    builder
}

#[test]
fn mirrors_and_glass_under_many_lights_look_the_same_from_both_ends() {
    assert_like_path("mixed", &built(&without_small_lights(mixed())), &["bdpt"]);
    assert_like_path("still life", &built(&without_small_lights(still_life())), &["bdpt"]);
}

#[test]
fn light_paths_find_what_mirrors_make_of_small_lights() {
    // A floor and a point light in front of a mirror: lit by the light, and by its image behind the mirror.
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    let mirror = Spec::new("", "mirror").with("reflectance", 1.0f32);
    put(&mut builder, "mirror", quad(Vec3::new(-9.0, 0.0, -1.0), Vec3::X * 18.0, Vec3::Y * 9.0), mirror);
    builder.lights.push(Spec::new("", "point").with("position", Vec3::Y).with("intensity", 1.0f32));
    look(&mut builder, Vec3::new(0.5, 4.0, 0.6), Vec3::new(0.5, 0.0, 0.5), 20.0);
    let scene = built(&builder);
    let settings = RenderSettings::new(16, 16, 256);
    // Mean radiance over the film, from a point light of unit intensity.
    let lit_by = |light: Vec3| {
        let at = |i: usize| {
            let film = Vec2::new((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5) / 16.0;
            let ray = scene.cameras()[0].1.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 });
            let p = Vec3::from(ray.at(-ray.origin[1] / ray.direction[1]));
            let distance2 = light.distance_squared(p);
            0.5 / PI * light.y / (distance2 * distance2.sqrt())
        };
        (0..256).map(at).sum::<f32>() / 256.0
    };
    let (by_point, by_image) = (lit_by(Vec3::Y), lit_by(Vec3::new(0.0, 1.0, -2.0)));
    for (name, wanted, tolerance) in
        [("path", by_point, 2e-3), ("bdpt", by_point + by_image, 0.01), ("light", by_point + by_image, 0.02)]
    {
        let pixels = shoot(&scene, &*integrator(name), &settings).film.to_rgb();
        let found = pixels.iter().map(|pixel| pixel.g).sum::<f32>() / 256.0;
        assert!((found / wanted - 1.0).abs() < tolerance, "{name}: {found}, not {wanted}");
    }
    // Otherwise the test could not distinguish one from the other.
    assert!(by_image > 0.05 * by_point);
}

#[test]
fn many_lights_of_which_one_is_chosen() {
    let mut builder = without_mirrors(Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)));
    for i in 0..6 {
        let place = Vec3::new(i as f32 * 0.6 - 1.5, 1.5 + 0.1 * i as f32, 1.0);
        let light_spec = Spec::new("", "rect").with("position", place).with("intensity", 1.0 + i as f32);
        builder.lights.push(light_spec.with("edge_u", Vec3::X * 0.2).with("edge_v", Vec3::Z * 0.2));
    }
    sky(&mut builder, 0.2);
    assert_like_path("many lights", &built(&builder), &["light", "bdpt"]);
}

#[test]
fn lenses_and_cameras_without_perspective() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let mut builder = without_mirrors(panel);
    let seen = |kind: &str| {
        let spec = Spec::new("eye", kind);
        spec.with("position", Vec3::new(0.0, 2.0, 5.0)).with("look_at", Vec3::new(0.0, 0.5, 0.0))
    };
    let lens = seen("perspective").with("fov", 40.0f32).with("aperture", 0.3f32).with("focus", 4.0f32);
    let shifted =
        seen("perspective").with("shift_y", 0.2f32).with("pixel_aspect", 1.4f32).with("skew", 0.2f32);
    let barrel =
        seen("opencv").with("k1", -0.4f32).with("k2", 0.1f32).with("p1", 0.02f32).with("s1", 0.03f32);
    // It sees nothing in its corners.
    let folding = seen("opencv").with("k1", -0.9f32).with("fx", 480.0f32);
    let fisheye = seen("opencv-fisheye").with("k1", -0.1f32).with("fx", 200.0f32).with("fy", 170.0f32);
    let wide = seen("fisheye").with("mapping", "equisolid").with("fov", 200.0f32);
    let around = seen("panorama").with("position", Vec3::new(0.0, 1.2, 0.8));
    let cylinder = around.clone().with("mapping", "cylindrical").with("fov_x", 200.0f32);
    let cube = around.clone().with("mapping", "cube");
    for spec in [wide, around, cylinder, cube] {
        let name = format!("{} {:?}", spec.kind, spec.parameters.find("mapping"));
        builder.cameras = vec![CameraSpec { spec, keyframes: Vec::new() }];
        assert_like_path(&name, &built(&builder), &["light", "bdpt"]);
    }
    for spec in [lens, seen("orthographic").with("height", 3.0f32), shifted, barrel, folding, fisheye] {
        let name = spec.kind.clone();
        builder.cameras = vec![CameraSpec { spec, keyframes: Vec::new() }];
        assert_like_path(&name, &built(&builder), &["light", "bdpt"]);
    }
}

#[test]
fn tilted_lenses_with_blades_and_pairs_of_eyes() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let mut builder = without_mirrors(panel);
    let seen = |kind: &str| {
        let spec = Spec::new("eye", kind);
        spec.with("position", Vec3::new(0.0, 2.0, 5.0)).with("look_at", Vec3::new(0.0, 0.5, 0.0))
    };
    let lens = seen("perspective").with("fov", 40.0f32).with("aperture", 0.4f32).with("blades", 5);
    let tilted = lens.with("focus_tilt_x", 30.0f32).with("focus_tilt_y", 50.0f32);
    let pair =
        tilted.clone().with("stereo", "side-by-side").with("eye_distance", 1.0f32).with("aperture", 0.2f32);
    let around =
        Spec::new("eye", "panorama").with("position", Vec3::new(0.0, 1.2, 0.8)).with("stereo", "over-under");
    for (name, spec) in
        [("tilted", tilted), ("pair", pair), ("turning eyes", around.with("eye_distance", 0.6f32))]
    {
        builder.cameras = vec![CameraSpec { spec, keyframes: Vec::new() }];
        assert_like_path(name, &built(&builder), &["light", "bdpt"]);
    }
}

#[test]
fn every_filter_spreads_splats_as_it_spreads_samples() {
    // A bright edge, blurred by the filter.
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "half",
        quad(Vec3::new(-4.0, -4.0, 0.0), Vec3::X * 4.0, Vec3::Y * 8.0),
        diffuse(0.8f32),
    );
    sky(&mut builder, 1.0);
    builder.lights[0] = Spec::new("", "directional").with("direction", -Vec3::Z);
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 60.0);
    let scene = built(&builder);
    for row in FILTERS {
        let profile = |name: &str, spp| {
            let settings = RenderSettings { filter: Filter::new(row), ..RenderSettings::new(8, 8, spp) };
            let case = format!("{}, {name}", row.entry.name);
            let found = recorded(&case, "profile", (&scene, &*integrator(name), &settings), |pixels| {
                let column = |x: usize| (0..8).map(|y| pixels[y * 8 + x].g).sum::<f32>() / 8.0;
                (2..6).map(|x| f64::from(column(x))).collect()
            });
            [0, 1, 2, 3].map(|i| found[i] as f32)
        };
        let (path, light) = (profile("path", 256), profile("light", 1 << 12));
        for (a, b) in path.into_iter().zip(light) {
            assert!((a - b).abs() < 0.04 * path[0], "{}: {path:?} and {light:?}", row.entry.name);
        }
    }
}

/// A floor of albedo 1/2, evenly lit with an irradiance of 2, perhaps through a pane of index 1 above the camera: camera subpaths
/// find nothing of what comes through it.
fn evenly_lit(has_pane: bool, camera: &str) -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 1.6), diffuse(0.5f32));
    if has_pane {
        put(&mut builder, "pane", floor(1.0, 1.6), Spec::new("", "dielectric").with("eta", 1.0f32));
    }
    builder.lights.push(Spec::new("", "directional").with("direction", -Vec3::Y).with("irradiance", 2.0f32));
    let above = Spec::new("eye", camera).with("position", Vec3::Y * 0.9).with("look_at", Vec3::ZERO);
    let (size, value) = if camera == "perspective" { ("fov", 96.0f32) } else { ("height", 2.0) };
    builder.cameras = vec![CameraSpec::new(above.with("up", -Vec3::Z).with(size, value))];
    built(&builder)
}

/// A diffuse floor of albedo 1/2 under an irradiance of 2 has the radiance 1/pi, at the picture's edge and in its corners too.
/// Pixels there get light from beyond the film's edge, whichever end of its path found it.
#[test]
fn an_evenly_lit_picture_is_even_up_to_its_corners_with_every_filter() {
    const SIDE: u32 = 8;
    // Light subpaths bring some 240 splats to each pixel. These are five times the standard deviations of the means over pixels
    // inside (36), at the edge (24) and in the corners (4). With the light beyond the edge left out, the tent filter would lose
    // 1/8 at the edge and 15/64 in the corners.
    const NOISE: [f32; 3] = [0.055, 0.066, 0.16];
    let edges = |(x, y): (u32, u32)| [x, y].iter().filter(|at| [0, SIDE - 1].contains(at)).count();
    let kinds = [(false, "orthographic"), (true, "orthographic"), (true, "perspective")];
    for (i, (has_pane, camera)) in kinds.into_iter().enumerate() {
        let scene = evenly_lit(has_pane, camera);
        let of_filter = |row: usize| ["light", "bdpt", "vcm"].map(|name| (&FILTERS[row], name));
        // In the short form, each filter with each camera, and with each integrator once.
        let in_turn = |row: usize| effort((row + i) % 3..(row + i) % 3 + 1, 0..3);
        let cases = (0..FILTERS.len()).flat_map(|row| of_filter(row)[in_turn(row)].to_vec());
        for (row, name) in cases {
            let settings =
                RenderSettings { filter: Filter::new(row), ..RenderSettings::new(SIDE, SIDE, 1024) };
            let case = format!("{name}, {}, {camera}, pane: {has_pane}", row.entry.name);
            let mean = |all: &[Rgb], kind: usize| {
                let places = (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)).filter(|&at| edges(at) == kind);
                let pixels: Vec<f32> = places.map(|(x, y)| all[(y * SIDE + x) as usize].g * PI).collect();
                pixels.iter().sum::<f32>() / pixels.len() as f32
            };
            let rendered = (&scene, &*integrator(name), &settings);
            let means = recorded(&case, "means by edges", rendered, |all| {
                (0..NOISE.len()).map(|kind| f64::from(mean(all, kind))).collect()
            });
            for (kind, (noise, mean)) in NOISE.iter().zip(means).enumerate() {
                assert!((mean - 1.0).abs() < f64::from(*noise), "{case}: {mean} at {kind} edges");
            }
        }
    }
}

fn with_radius(name: &str, radius: f32) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", name).with("radius", radius)).unwrap()
}

#[test]
fn without_merging_vcm_is_bdpt_to_the_bit() {
    let (scene, settings) = (built(&still_life()), RenderSettings::new(24, 16, 4));
    let film = |integrator: &dyn PixelIntegrator| shoot(&scene, integrator, &settings).film;
    assert_eq!(film(&*with_radius("vcm", 0.0)), film(&*integrator("bdpt")));
}

#[test]
fn merging_agrees_with_path() {
    // Its blur is far below what these pictures can resolve.
    let scene = built(&without_mirrors(
        Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32),
    ));
    let path = blocks(&scene, integrator("path"), 0);
    let spec = |name: &str| Spec::new("", name).with("radius", 0.01f32);
    let unconnected = spec("vcm").with("connections", false);
    // Light subpaths for only a part of the pixels, connected with the camera on behalf of all.
    let few = unconnected.clone().with("light_paths", bilux_scene::Value::Integer(90));
    let unshown = spec("vcm").with("splats", false);
    let alone = unconnected.clone().with("splats", false);
    let switched = [unconnected, unshown, alone];
    let direct = switched.clone().map(|spec| spec.with("direct", true));
    let all = [spec("vcm"), spec("vcm").with("direct", true), spec("sppm"), few];
    for (i, spec) in all.iter().chain(&switched).chain(&direct).enumerate() {
        let found = blocks(&scene, integrators::build(spec).unwrap(), 100 * (i as u64 + 1));
        let case = format!("path and {}, {i}", spec.kind);
        let p = agreement(&case, &path, &found);
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

#[test]
fn merging_finds_what_mirrors_hide_at_both_ends() {
    // The floor under a small light in front of a mirror, itself seen in the mirror: lit by the light, and by its
    // image.
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    let mirror = Spec::new("", "mirror").with("reflectance", 1.0f32);
    put(&mut builder, "mirror", quad(Vec3::new(-9.0, 0.0, -1.0), Vec3::X * 18.0, Vec3::Y * 9.0), mirror);
    builder.lights.push(Spec::new("", "point").with("position", Vec3::Y).with("intensity", 1.0f32));
    let (seen, image) = (Vec3::new(0.5, 0.0, -0.5), Vec3::new(0.0, 1.0, -2.0));
    // Looks towards where the mirror shows that point.
    look(&mut builder, Vec3::new(0.5, 2.0, 2.5), Vec3::new(0.5, 0.0, -1.5), 4.0);
    let scene = built(&builder);
    let lit_by = |light: Vec3| {
        let distance2 = light.distance_squared(seen);
        0.5 / PI * light.y / (distance2 * distance2.sqrt())
    };
    let (by_light, by_image) = (lit_by(Vec3::Y), lit_by(image));
    let found = |integrator: &dyn PixelIntegrator| {
        let film = shoot(&scene, integrator, &RenderSettings::new(16, 16, 400)).film;
        film.to_rgb().iter().map(|pixel| pixel.g).sum::<f32>() / 256.0
    };
    for (name, wanted) in [("bdpt", by_light), ("vcm", by_light + by_image), ("sppm", by_light + by_image)] {
        let found = found(&*with_some_radius(name));
        assert!((found / wanted - 1.0).abs() < 0.04, "{name}: {found}, not {wanted}");
    }
    assert!(by_image > 0.2 * by_light, "{by_image} beside {by_light}");
}

fn with_some_radius(name: &str) -> Box<dyn PixelIntegrator> {
    if name == "bdpt" { integrator(name) } else { with_radius(name, 0.02) }
}

/// Camera subpaths that are a little too bright, next to splats that are right.
struct Wrong(Box<dyn PixelIntegrator>);

impl PixelIntegrator for Wrong {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.0.radiance(ray, task)
    }
    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }
}

impl LightSubpaths for Wrong {
    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        self.0.sample(ray, is_wanted, photons, task, splats) * 1.05
    }
}

#[test]
fn a_technique_with_a_wrong_weight_is_detected() {
    let scene = built(&without_small_lights(mixed()));
    let path = blocks(&scene, integrator("path"), 0);
    let wrong: Box<dyn PixelIntegrator> = Box::new(Wrong(integrator("bdpt")));
    let p = difference(&path, &blocks(&scene, wrong, 100));
    assert!(p < UNLIKELY, "camera paths that are too bright pass: p = {p}");
}

#[test]
fn a_crop_and_a_range_of_samples_show_the_same_splats() {
    let scene = built(&mixed());
    let unconnected = Spec::new("", "vcm").with("connections", false);
    for spec in ["light", "bdpt", "vcm", "auto"].map(|name| Spec::new("", name)).iter().chain([&unconnected])
    {
        let (name, integrator) = (&spec.kind, integrators::build(spec).unwrap());
        let whole = RenderSettings { threads: 2, ..RenderSettings::new(20, 18, 6) };
        let film = shoot(&scene, &*integrator, &whole).film;
        let window = Window { x: 5, y: 7, width: 9, height: 4 };
        let cropped = RenderSettings { crop: Some(window), threads: 1, ..whole.clone() };
        let part = shoot(&scene, &*integrator, &cropped).film;
        for i in 0..window.pixels() {
            let (x, y) = window.position(i);
            assert_eq!(film.pixel(x, y), part.pixel(x, y), "{name} at {x}, {y}");
        }
        let range = |samples| shoot(&scene, &*integrator, &RenderSettings { samples, ..whole.clone() }).film;
        let mut merged = range(0..2);
        merged.merge(&range(2..6)).unwrap();
        assert_eq!(merged.to_rgb(), film.to_rgb(), "{name}");
        let back = bilux_transport::Film::from_partial(&film.to_partial().unwrap()).unwrap();
        assert_eq!(back, film, "{name}");
    }
}
