//! A scene is built from plain data, rejects errors, and answers ray queries.

use bilux_math::{Motion, MotionKey, Quat, Rgb, Transform, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{AccelChoice, CameraSample, Mesh, Object, SceneBuilder, SceneError, Spec, Tracer};
use std::sync::Arc;

fn floor() -> Arc<Mesh> {
    Arc::new(Mesh {
        positions: [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
            .map(|(x, z)| Vec3::new(x, 0.0, z))
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

fn builder() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let green = Spec::new("green", "diffuse").with("reflectance", Rgb::new(0.1, 0.7, 0.1));
    let material = builder.add_material(green);
    builder.objects.push(Object::new("floor", floor(), material));
    builder.lights.push(
        Spec::new("panel", "rect").with("position", Vec3::new(0.0, 2.0, 0.0)).with("intensity", 10.0f32),
    );
    let camera = Spec::new("eye", "perspective").with("position", Vec3::new(0.0, 1.0, 3.0));
    builder.cameras.push(CameraSpec { spec: camera, keyframes: Vec::new() });
    builder
}

#[test]
fn the_image_centre_shows_the_look_at_point() {
    let scene = builder().build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let sample = CameraSample { film: Vec2::splat(0.5), lens: Vec2::ZERO, time: 0.0 };
    let ray = scene.cameras()[0].1.ray(&sample);
    let surface = Tracer::new(&scene, false).closest(&ray).expect("the floor is there");
    assert!(surface.p.length() < 1e-5, "{}", surface.p);
    assert_eq!(surface.n_geom, Vec3::Y);
    assert_eq!(scene.material(&surface).classic(&surface).kd, Rgb::new(0.1, 0.7, 0.1));
}

#[test]
fn a_panel_is_a_light_and_does_not_block_its_own_light() {
    let scene = builder().build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let mut tracer = Tracer::new(&scene, false);
    let up = tracer.closest(&bilux_scene::Ray::new([0.1, 1.0, 0.1], [0.0, 1.0, 0.0])).unwrap();
    assert!(scene.light_of(up.object).is_some());
    let down = tracer.closest(&bilux_scene::Ray::new([0.1, 1.0, 0.1], [0.0, -1.0, 0.0])).unwrap();
    let to_beyond = down.spawn_to(Vec3::new(0.1, 3.0, 0.1));
    assert!(tracer.occluded(&to_beyond) && !tracer.blocked(&to_beyond));
}

#[test]
fn every_object_is_found_by_its_first_triangle() {
    let mut scene = builder();
    for i in 0..40 {
        // In the common tree, in trees of their own, and without triangles, in turns; far apart.
        let mesh = if i % 5 == 4 { Arc::new(Mesh::default()) } else { floor() };
        let object = Object { instanced: i % 3 == 1, ..Object::new("", mesh, 0) };
        let place = Transform::translate(Vec3::X * (10.0 * (i + 1) as f32)).unwrap();
        scene.objects.push(object.placed(place));
    }
    let scene = scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let (geometry, mut tracer) = (scene.geometry(), Tracer::new(&scene, false));
    for (index, object) in geometry.objects().iter().enumerate() {
        let first = geometry.first_primitive(index as u32);
        if object.mesh.triangles.is_empty() {
            continue;
        }
        let [a, b, c] = object.mesh.triangles[0].map(|i| object.mesh.positions[i as usize]);
        let middle = object.motion.at(0.0).point((a + b + c) / 3.0);
        let ray = bilux_scene::Ray::new((middle + Vec3::Y * 0.5).to_array(), [0.0, -1.0, 0.0]);
        let surface = tracer.closest(&ray).expect("the triangle is there");
        assert_eq!((surface.object, surface.primitive), (index as u32, first));
    }
}

#[test]
fn misspelt_names_suggest_the_nearest() {
    let mut wrong = builder();
    wrong.materials[0] = Spec::new("", "difuse");
    let error = wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap();
    assert!(error.to_string().contains("did you mean 'diffuse'?"), "{error}");
    wrong.materials[0] = Spec::new("", "diffuse").with("reflectence", 0.5f32);
    let error = wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0).err().unwrap();
    assert!(error.to_string().contains("did you mean 'reflectance'?"), "{error}");
    wrong.materials[0] = Spec::new("", "diffuse").with("reflectance", 1.5f32);
    assert!(matches!(
        wrong.build(&AccelChoice::default(), [0.0, 0.0], 1.0),
        Err(SceneError::BadValue { .. })
    ));
}

/// A scene with a single sphere light.
fn lone_sphere(position: Vec3, radius: f32) -> bilux_scene::Scene {
    let light_spec =
        Spec::new("", "sphere").with("position", position).with("radius", radius).with("radiance", 1.0f32);
    let builder = SceneBuilder { lights: vec![light_spec], ..SceneBuilder::default() };
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

#[test]
fn spheres_are_hit_precisely_from_any_distance() {
    for (centre, radius) in
        [(Vec3::ZERO, 1.0), (Vec3::new(700.0, -300.0, 800.0), 0.01), (Vec3::splat(5.0), 1e-3)]
    {
        let scene = lone_sphere(centre, radius);
        let mut tracer = Tracer::new(&scene, false);
        for (i, distance) in [0.0f32, 0.5, 1.5, 10.0, 1e3, 1e6].into_iter().enumerate() {
            let away = Vec3::new(1.0, 2.0, 0.5 * i as f32).normalize();
            let origin = centre + away * (distance * radius);
            let towards = centre + away.any_orthonormal_vector() * (0.3 * radius) - origin;
            let Some(hit) = tracer.closest(&bilux_scene::Ray::new(origin.to_array(), towards.to_array()))
            else {
                // A sphere this small may be missed where the precision of the ray's own numbers is too coarse.
                assert!(
                    radius * 0.1 < origin.abs().max_element() * f32::EPSILON,
                    "{centre}, {radius}: {distance}"
                );
                continue;
            };
            let out = hit.p.as_dvec3() - centre.as_dvec3();
            let off = (out.length() - f64::from(radius)).abs();
            assert!(off <= f64::from(hit.p_error.length()), "{off} and {:?}", hit.p_error);
            assert!(hit.n_geom.dot(out.as_vec3().normalize()) > 0.999);
            let is_inside = distance < 1.0;
            assert_eq!(hit.n_geom.dot(towards) > 0.0, is_inside, "{distance}");
            // It emits light only outwards.
            assert_eq!(scene.emission(&hit, -towards) == Rgb::BLACK, is_inside);
            assert!(tracer.closest(&hit.spawn(hit.n_geom)).is_none());
            let across = tracer.closest(&hit.spawn(-hit.n_geom)).expect("the far side");
            assert!((across.t / (2.0 * radius) - 1.0).abs() < 1e-2 + across.p_error.length() / radius);
        }
    }
}

#[test]
fn a_sphere_light_needs_a_size_and_a_strength() {
    let built = |spec: Spec| {
        let builder = SceneBuilder { lights: vec![spec], ..SceneBuilder::default() };
        builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).map(|_| ()).unwrap_err().to_string()
    };
    let sphere = || Spec::new("", "sphere");
    assert!(built(sphere().with("radius", 0.0f32).with("radiance", 1.0f32)).contains("above 0"));
    assert!(built(sphere().with("radius", 1e-30f32).with("radiance", 1.0f32)).contains("above 0"));
    assert!(built(sphere()).contains("'radiance' or 'intensity'"));
}

#[test]
fn the_single_tree_shortcut_matches_the_top_level() {
    let mut builder = builder();
    for (position, radius) in [(Vec3::new(0.3, 0.2, 0.0), 0.4), (Vec3::new(-0.5, 0.6, 0.4), 0.3)] {
        let light_spec = Spec::new("", "sphere").with("position", position).with("radius", radius);
        builder.lights.push(light_spec.with("radiance", 1.0f32));
    }
    let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    // The counting tracer uses the top level.
    let (mut plain, mut counting) = (Tracer::new(&scene, false), Tracer::new(&scene, true));
    let random = |i: u64| {
        let words = [0, 1, 2].map(|k| bilux_math::hash::hash_words([i, k]));
        Vec3::from(words.map(|w| (w >> 40) as f32 / (1u64 << 24) as f32 * 2.0 - 1.0))
    };
    let mut counts = [0; 2];
    for i in 0..10_000 {
        let mut ray = bilux_scene::Ray::new((random(3 * i) * 1.5).to_array(), random(3 * i + 1).to_array());
        for _ in 0..3 {
            let hits = [&mut plain, &mut counting].map(|tracer| tracer.closest(&ray));
            assert_eq!(plain.occluded(&ray), counting.occluded(&ray), "{ray:?}");
            let [a, b] = hits.map(|hit| hit.map(|hit| (hit.t.to_bits(), hit.primitive, hit.p)));
            assert_eq!(a, b, "{ray:?}");
            let Some(hit) = plain.closest(&ray) else { break };
            counts[usize::from(hit.primitive.instance == 1)] += 1;
            ray = hit.spawn(random(3 * i + 2));
            ray.t_max = 0.8;
        }
    }
    assert!(counts[0] > 500 && counts[1] > 500, "{counts:?}");
}

#[test]
fn typed_specs_equal_handwritten_specs() {
    use bilux_scene::typed::lights::Point;
    use bilux_scene::typed::materials::Dielectric;
    let typed: Spec = Dielectric::new("pane").eta(1.5).thin(true).priority(2).glass("none").into();
    let by_hand = Spec::new("pane", "dielectric").with("eta", 1.5).with("thin", true);
    assert_eq!(typed, by_hand.with("priority", bilux_scene::Value::Integer(2)).with("glass", "none"));
    let mut builder = SceneBuilder::default();
    builder.add_light(Point::new("bulb").position(Vec3::Y));
    assert_eq!(builder.lights, [Spec::new("bulb", "point").with("position", Vec3::Y)]);
}

/// A mix has the fire of either of its parts.
#[test]
fn mixes_glow_by_either_part() {
    let clear = Spec::new("clear", "interface").with("absorption", 0.5f32);
    let fire = clear.clone().with("medium_emission", 3.0f32);
    for (a, b, glows) in [(&fire, &clear, true), (&clear, &fire, true), (&clear, &clear, false)] {
        let mut builder = builder();
        let [a, b] = [a, b].map(|spec| bilux_scene::Value::Material(builder.add_material(spec.clone())));
        let mix = builder.add_material(Spec::new("", "mix").with("a", a).with("b", b).with("amount", 0.3f32));
        builder.objects[0].material = mix;
        let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        assert_eq!(scene.material_of(0).medium().unwrap().glow.is_some(), glows);
    }
}

/// A mix scatters as the part of it that scatters does, whichever that is.
#[test]
fn mixes_scatter_as_the_part_that_scatters() {
    let clear = Spec::new("clear", "dielectric").with("absorption", 0.5f32);
    let milk =
        Spec::new("milk", "dielectric").with("scattering", 4.0f32).with("scattering_anisotropy", 0.6f32);
    for (a, b) in [(&milk, &clear), (&clear, &milk)] {
        let mut builder = builder();
        let [a, b] = [a, b].map(|spec| bilux_scene::Value::Material(builder.add_material(spec.clone())));
        let mix = builder.add_material(Spec::new("", "mix").with("a", a).with("b", b).with("amount", 0.3f32));
        builder.objects[0].material = mix;
        let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let medium = scene.material_of(0).medium().unwrap();
        assert_eq!((medium.sigma_s, medium.sigma_a), (Rgb::grey(4.0), Rgb::grey(0.5)));
        assert_eq!(medium.phase.mean_cosine(), 0.6);
    }
}

/// Objects that are placed, and then move, are where both put them at each time while the shutter is open.
#[test]
fn what_is_placed_before_it_moves_is_seen_on_its_way() {
    let key = |time_seconds: f32, z: f32| MotionKey {
        time_seconds,
        translation: Vec3::Z * z,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    let place = Motion::still(Transform::translate(Vec3::X * 10.0).unwrap());
    let motion = place.then(&Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 8.0)]).unwrap());
    for instanced in [false, true] {
        let mut builder = builder();
        builder.objects.push(Object { motion: motion.clone(), instanced, ..Object::new("", floor(), 0) });
        let scene = builder.build(&AccelChoice::default(), [0.0, 1.0], 1.0).unwrap();
        for (time, now) in [(0.0, 0.0), (0.5, 4.0), (1.0, 8.0)] {
            for z in [0.0, 4.0, 8.0] {
                let down = bilux_scene::Ray::new([10.0, 1.0, z + 0.3], [0.0, -1.0, 0.0]);
                let seen = Tracer::new(&scene, false).closest(&bilux_scene::Ray { time, ..down });
                assert_eq!(seen.is_some(), z == now, "at {time} s, z = {z}, instanced: {instanced}");
            }
        }
    }
}

/// Rough glass spreads what it lets through as what it reflects, in the modes without transport; and each by as much as is stated.
#[test]
fn frosted_glass_spreads_both_of_its_rays() {
    let classic = |glass: Spec| {
        let mut builder = builder();
        builder.objects[0].material = builder.add_material(glass);
        let scene = builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let ray = bilux_scene::Ray::new([0.1, 1.0, 0.1], [0.0, -1.0, 0.0]);
        let surface = Tracer::new(&scene, false).closest(&ray).unwrap();
        let material = scene.material(&surface).classic(&surface);
        [material.gloss, material.translucency]
    };
    let [gloss, translucency] = classic(Spec::new("", "dielectric").with("roughness", 0.3f32));
    assert!(gloss > 0.01 && translucency == gloss, "{gloss}, {translucency}");
    let stated = Spec::new("", "dielectric").with("gloss", 4.0f32).with("translucency", 9.0f32);
    assert_eq!(classic(stated), [4f32, 9.0].map(f32::to_radians));
}
