//! Whether a file's own light or the studio lights its picture.

use bilux::Series;
use bilux::math::{Aabb, Rgb, Vec3};
use bilux::prelude::*;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::mesh::shapes;
use bilux::scene::texture::Texture;
use std::sync::Arc;

/// A scene in a format that cannot describe its surroundings, such as glTF.
fn file() -> SceneBuilder {
    SceneBuilder { environment_unspecified: true, exposure_unspecified: true, ..SceneBuilder::default() }
}

fn put(scene: &mut SceneBuilder, mesh: Mesh, material: Spec) {
    let material = scene.add_material(material.with("visible_sides", "front"));
    scene.objects.push(Object::new("part", Arc::new(mesh), material));
}

fn clay(colour: f32) -> Spec {
    Spec::new("", "principled").with("base_color", Rgb::grey(colour))
}

fn glowing(emission: f32) -> Spec {
    clay(0.5).with("emission", Rgb::grey(emission)).with("emission_sides", "front")
}

fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    shapes::cuboid(Aabb { min: low, max: high })
}

/// A panel of two triangles; its front faces along `u × v`.
fn panel(middle: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let corner = |a: f32, b: f32| middle + u * a + v * b;
    Mesh {
        positions: vec![corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn settings() -> Parameters {
    let mut settings = Parameters::default();
    settings.set("size", "24x24");
    settings.set("spp", Value::Integer(16));
    settings.set("denoise", "off");
    settings
}

fn asked() -> JobRequest {
    JobRequest::from(&settings())
}

fn job(scene: &SceneBuilder) -> Job {
    Job::new(scene, &settings()).unwrap()
}

/// The luminance that a tenth of the pixels reach: the others may show nothing.
fn bright(job: &Job) -> f32 {
    let picture = job.render(&Quiet).unwrap().picture().unwrap();
    let mut seen: Vec<f32> = picture.to_rgb().unwrap().iter().map(|p| p.luminance()).collect();
    seen.sort_by(f32::total_cmp);
    seen[seen.len() * 9 / 10]
}

fn assert_decided(name: &str, scene: &SceneBuilder, by_studio: bool) {
    let job = job(scene);
    match job.notes() {
        [note] => assert_eq!(note.starts_with("the studio lights it"), by_studio, "{name}: {note}"),
        notes => assert!(notes.is_empty() && name == "a dim sign", "{name}: {notes:?}"),
    }
    let has_room = job.scene().lights().iter().any(|light| light.name == "room");
    assert_eq!(has_room, by_studio, "{name}");
    assert!(bright(&job) > 0.03, "{name} is dark: {}", bright(&job));
}

/// A body and two small lights at its front, like a car.
fn car(emission: f32) -> SceneBuilder {
    let mut scene = file();
    put(&mut scene, cuboid(Vec3::new(-0.5, 0.0, -1.0), Vec3::new(0.5, 0.6, 1.0)), clay(0.6));
    for x in [-0.35, 0.35] {
        put(&mut scene, panel(Vec3::new(x, 0.3, 1.001), Vec3::X * 0.05, Vec3::Y * 0.05), glowing(emission));
    }
    scene
}

#[test]
fn headlights_do_not_turn_the_studio_off() {
    assert_decided("a dim sign", &car(0.5), true);
    for emission in [1.0, 20.0] {
        assert_decided("a car", &car(emission), true);
    }
}

#[test]
fn emission_that_lights_next_to_nothing_is_sampled_rarely_beside_the_studio() {
    let faint = |scene: &SceneBuilder| {
        let job = job(scene);
        job.scene().lights().iter().filter(|light| light.is_faint).count()
    };
    assert_eq!(faint(&car(0.1)), 2, "both lamps, and none of the studio's lights");
    // Such lamps light the studio's ground, which is not measured.
    assert_eq!(faint(&car(20.0)), 0);
    // Nothing but emitters is seen.
    let mut cube = file();
    put(&mut cube, cuboid(Vec3::ZERO, Vec3::ONE), glowing(0.0005));
    assert_eq!(faint(&cube), 0);
    // The file describes its surroundings: nothing is measured.
    let mut outside = car(0.1);
    outside.lights.push(Spec::new("sky", "environment").with("radiance", 1.0f32));
    outside.environment_unspecified = false;
    assert_eq!(faint(&outside), 0);
}

/// A small lamp low above the floor of a large hall, seen from this place.
fn hall(radiance: f32, eye: Vec3) -> SceneBuilder {
    let mut hall = file();
    put(&mut hall, cuboid(Vec3::new(-9.0, -0.1, -9.0), Vec3::new(9.0, 0.0, 9.0)), clay(0.6));
    put(&mut hall, cuboid(Vec3::new(-9.0, 0.0, -9.0), Vec3::new(9.0, 6.0, -8.9)), clay(0.6));
    put(&mut hall, panel(Vec3::Y * 0.15, Vec3::X * 0.05, Vec3::Z * 0.05), glowing(radiance));
    let camera = Spec::new("eye", "perspective").with("position", eye).with("look_at", Vec3::ZERO);
    hall.cameras.push(CameraSpec::new(camera.with("fov", 40.0f32)));
    hall
}

#[test]
fn what_a_lamp_lights_close_to_the_camera_is_sampled_everywhere() {
    let of = |hall: &SceneBuilder| {
        let job = job(hall);
        let has_room = job.scene().lights().iter().any(|light| light.name == "room");
        (has_room, job.scene().lights().iter().filter(|light| light.is_faint).count())
    };
    // Much too weak for the hall, and much of the light in the picture.
    assert_eq!(of(&hall(2.0, Vec3::new(0.0, 1.2, 1.2))), (true, 0));
    // Twenty times as strong, it lights nothing that counts where the whole hall is seen: its area is what power is compared with.
    assert_eq!(of(&hall(40.0, Vec3::new(0.0, 8.0, 30.0))), (true, 1));
}

#[test]
fn scenes_of_emitters_only_get_the_studio() {
    let mut scene = file();
    for (i, strength) in [1.0, 2.0, 4.0, 8.0, 16.0].into_iter().enumerate() {
        let low = Vec3::new(i as f32 * 1.5, 0.0, 0.0);
        put(&mut scene, cuboid(low, low + Vec3::ONE), glowing(strength));
    }
    assert_decided("glowing cubes", &scene, true);
}

/// A square in front of the camera's eye with one colour, as glTF has it.
fn square(material: &str) -> SceneBuilder {
    let corners: [[f32; 3]; 4] = [[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]];
    let floats = corners.iter().flatten().flat_map(|x| x.to_le_bytes());
    let bytes: Vec<u8> = floats.chain([0u8, 1, 2, 0, 2, 3]).collect();
    let uri: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_materials_unlit"],"nodes":[{{"mesh":0}}],
        "scenes":[{{"nodes":[0]}}],"materials":[{{{material}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":6}}],
        "buffers":[{{"byteLength":54,"uri":"data:application/octet-stream,{uri}"}}]}}"#
    );
    bilux::formats::read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &Default::default()).unwrap()
}

#[test]
fn unlit_colours_are_shown_as_they_are() {
    let colour = r#""pbrMetallicRoughness":{"baseColorFactor":[1.0,0.2158605,0.0,1.0]}"#;
    let unlit = format!(r#"{colour},"extensions":{{"KHR_materials_unlit":{{}}}}"#);
    let unlit_job = job(&square(&unlit));
    let notes = unlit_job.notes();
    assert!(notes.iter().any(|note| note.starts_with("the whole model is unlit")), "{notes:?}");
    let picture = unlit_job.render(&Quiet).unwrap().picture().unwrap();
    let options = unlit_job.write_options_for(&picture).unwrap();
    let shown = bilux::pictures::tonemap::to_display(&picture, options.exposure, options.tone_map).unwrap();
    let middle = shown.to_rgb().unwrap()[12 * 24 + 12].map(|c| (c * 255.0).round());
    assert_eq!(middle, Rgb::new(255.0, 128.0, 0.0));
    let curve = |scene: &SceneBuilder| job(scene).write_options().unwrap().tone_map.entry.name;
    assert_eq!(curve(&square(colour)), "neutral", "a lit model");
    let mut mixed = square(&unlit);
    put(&mut mixed, cuboid(Vec3::NEG_ONE, Vec3::ONE), clay(0.5));
    assert_eq!(curve(&mixed), "neutral", "a model of which a part is lit");
}

/// A closed room, seen through the back of one of its walls, with a light below the ceiling.
fn closed_box(emission: f32) -> SceneBuilder {
    let mut scene = file();
    let mut walls = cuboid(Vec3::NEG_ONE, Vec3::ONE);
    walls.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    walls.normals.clear();
    put(&mut scene, walls, clay(0.7));
    put(&mut scene, panel(Vec3::Y * 0.99, Vec3::X * 0.3, Vec3::Z * 0.3), glowing(emission));
    let camera = Spec::new("", "perspective").with("position", Vec3::Z * 3.6).with("look_at", Vec3::ZERO);
    scene.cameras.push(CameraSpec { spec: camera.with("fov", 36.0f32), ..CameraSpec::default() });
    scene
}

#[test]
fn a_closed_box_is_lit_by_its_own_light() {
    let scene = closed_box(15.0);
    assert_decided("a box", &scene, false);
    assert_eq!(job(&scene).scene().lights().len(), 1, "nothing is added");
    // The same without a camera of its own.
    let bare = SceneBuilder { cameras: Vec::new(), ..scene };
    assert_decided("a box without a camera", &bare, false);
}

/// A bulb above a stand and a table.
fn lamp(emission: f32) -> SceneBuilder {
    let mut scene = file();
    put(&mut scene, panel(Vec3::ZERO, Vec3::Z, Vec3::X), clay(0.6));
    put(&mut scene, cuboid(Vec3::new(-0.05, 0.0, -0.05), Vec3::new(0.05, 0.6, 0.05)), clay(0.4));
    put(&mut scene, shapes::icosphere(Vec3::Y * 0.75, 0.1, 2), glowing(emission));
    scene
}

#[test]
fn a_bulb_lights_its_lamp_where_it_is_bright() {
    assert_decided("a weak bulb", &lamp(1.0), true);
    assert_decided("a bright bulb", &lamp(60.0), false);
}

#[test]
fn a_light_that_reaches_nothing_leaves_the_studio_on() {
    let mut scene = car(0.0);
    let light = Spec::new("mine", "directional").with("direction", Vec3::Y);
    scene.lights.push(light.with("irradiance", 3.0f32));
    assert_decided("light from below", &scene, true);
    assert_eq!(job(&scene).scene().lights().len(), 4, "the whole studio is there");
}

#[test]
fn the_decision_depends_only_on_the_scene() {
    let scene = lamp(12.0);
    let notes = [1, 2, 5].map(|threads| {
        let mut settings = Parameters::default();
        settings.set("size", "20x20");
        settings.set("threads", Value::Integer(threads));
        Job::new(&scene, &settings).unwrap().notes().to_vec()
    });
    assert!(notes[0].len() == 1 && notes.iter().all(|n| *n == notes[0]), "{notes:?}");
    // Formats that can describe a scene's surroundings have described them.
    let said = SceneBuilder { environment_unspecified: false, ..car(20.0) };
    assert!(job(&said).notes().is_empty());
}

/// A wall with a light on one side of it.
fn wall() -> SceneBuilder {
    let mut scene = file();
    put(&mut scene, cuboid(Vec3::new(-1.0, 0.0, -0.1), Vec3::new(1.0, 2.0, 0.1)), clay(0.6));
    put(&mut scene, shapes::icosphere(Vec3::new(0.0, 1.0, 0.6), 0.1, 2), glowing(60.0));
    scene
}

#[test]
fn all_pictures_of_a_turntable_are_lit_alike() {
    // Each for itself, they differ.
    let alone = [0, 180].map(|azimuth| {
        let mut settings = settings();
        settings.set("orbit", format!("{azimuth},15").as_str());
        Job::new(&wall(), &settings).unwrap().notes()[0].starts_with("the studio")
    });
    assert_eq!(alone, [false, true]);
    let series = Series::turntable(&wall(), &asked(), 6).unwrap();
    let jobs = [0, 1, 3].map(|i| {
        let series = series.turned(i, 6);
        Job::new(&wall(), asked().in_series(series)).unwrap()
    });
    for job in &jobs {
        assert_eq!(job.notes(), jobs[0].notes());
        assert!(job.notes()[0].starts_with("the studio lights it"), "{:?}", job.notes());
        assert!(job.scene().lights().iter().any(|light| light.name == "room"));
    }
    // A closed box has light enough on all sides.
    let inside = SceneBuilder { cameras: Vec::new(), ..closed_box(15.0) };
    let series = Series::turntable(&inside, &asked(), 6).unwrap();
    let job = Job::new(&inside, asked().in_series(series.turned(2, 6))).unwrap();
    assert_eq!(job.scene().lights().len(), 1, "{:?}", job.notes());
}

#[test]
fn all_frames_of_an_animation_are_lit_as_the_first() {
    // The light goes out, or on.
    for (first, then) in [(60.0, 0.2), (0.2, 60.0)] {
        let is_studio = |job: &Job| job.scene().lights().iter().any(|light| light.name == "room");
        let start = job(&lamp(first));
        let next = Job::new(&lamp(then), asked().in_series(start.series())).unwrap();
        assert_ne!(is_studio(&start), is_studio(&job(&lamp(then))));
        assert_eq!((is_studio(&next), next.notes()), (is_studio(&start), start.notes()));
    }
}

/// A shade that is open below, with a small bright bulb in it.
fn barn_lamp(metalness: f32) -> SceneBuilder {
    let mut scene = file();
    let shade = clay(0.8).with("base_metalness", metalness).with("specular_roughness", 0.25f32);
    let (low, high) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, 1.0));
    for (u, v, middle) in [
        (Vec3::X, Vec3::Z, Vec3::Y),
        (Vec3::X, Vec3::Y * 0.5, Vec3::new(0.0, 0.5, 1.0)),
        (Vec3::X, Vec3::Y * 0.5, Vec3::new(0.0, 0.5, -1.0)),
        (Vec3::Z, Vec3::Y * 0.5, Vec3::new(1.0, 0.5, 0.0)),
        (Vec3::Z, Vec3::Y * 0.5, Vec3::new(-1.0, 0.5, 0.0)),
    ] {
        let sheet = panel(middle.clamp(low, high), u, v);
        let material = scene.add_material(shade.clone());
        scene.objects.push(Object::new("shade", Arc::new(sheet), material));
    }
    put(&mut scene, shapes::icosphere(Vec3::Y * 0.4, 0.06, 2), glowing(100.0));
    scene
}

#[test]
fn metal_around_a_bulb_counts_by_what_it_reflects() {
    for (metalness, by_studio) in [(0.0, false), (1.0, true)] {
        let mut settings = settings();
        settings.set("orbit", "20,-60");
        let job = Job::new(&barn_lamp(metalness), &settings).unwrap();
        assert_eq!(job.notes()[0].starts_with("the studio lights it"), by_studio, "{:?}", job.notes());
    }
    // With a light in the file, metal has the studio's surroundings to reflect.
    let mut helmet = file();
    put(&mut helmet, shapes::icosphere(Vec3::Y, 1.0, 3), clay(0.8).with("base_metalness", 1.0f32));
    let sun = Spec::new("mine", "directional").with("direction", Vec3::new(-0.5, -1.0, -0.8));
    helmet.lights.push(sun.with("irradiance", 3.0f32));
    let job = job(&helmet);
    let lights: Vec<&str> = job.scene().lights().iter().map(|light| light.name.as_str()).collect();
    assert_eq!(lights, ["mine", "room"], "{:?}", job.notes());
}

/// A floor of albedo 1/2 below a panel of 1 m by 1 m, 1 m above it, seen from between them; the panel's emission, and more.
fn below_a_panel(emission: &str) -> SceneBuilder {
    let text = format!(
        "[camera]\nkind = \"orthographic\"\nposition = [0, 0.5, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, -1]\nheight = 0.02\n\
         [[material]]\nname = \"floor\"\nkind = \"diffuse\"\nreflectance = 0.5\n\
         [[material]]\nname = \"panel\"\nkind = \"diffuse\"\nreflectance = 0\n{emission}\n\
         [[model]]\nshape = \"floor\"\nside = 20\nmaterial = \"floor\"\n\
         [[model]]\nshape = \"floor\"\nside = 1\nmaterial = \"panel\"\ntranslate = [0, 1, 0]\n"
    );
    bilux::formats::read_bytes(text.as_bytes(), "toml", None, "a.toml", &Default::default()).unwrap()
}

/// The mean radiance of a picture.
fn mean(scene: &SceneBuilder) -> f32 {
    let mut settings = settings();
    settings.set("integrator", "path");
    settings.set("size", "8x8");
    settings.set("spp", Value::Integer(64));
    let picture = Job::new(scene, &settings).unwrap().render(&Quiet).unwrap().picture().unwrap();
    let seen = picture.to_rgb().unwrap();
    seen.iter().map(|p| p.g).sum::<f32>() / seen.len() as f32
}

/// The outgoing radiance of the floor for a panel of radiance 1: albedo / pi times four times the irradiance of a quarter above its
/// corner. [Howell 2010, C-11]
fn of_panel() -> f32 {
    let (half, over) = (0.5f32, 1.25f32.sqrt());
    let corner = half / over * bilux::math::transcendental::atan(half / over);
    0.5 / std::f32::consts::PI * 4.0 * corner
}

#[test]
fn what_toml_and_pbrt_say_of_light_is_all_the_light() {
    for (emission, radiance) in [
        ("emission = 0.9", 0.9),
        ("emission = 0.001", 0.001),
        ("emission = [0, 0.5, 0]", 0.5),
        ("emission = 0.09\nemission_scale = 10", 0.9),
        ("emission = { kind = \"checker\", a = 0.6, b = 0.6 }", 0.6),
        ("emission = 0", 0.0),
        ("emission = 5\nemission_scale = 0", 0.0),
        ("emission = { kind = \"checker\", a = 0, b = 0 }", 0.0),
    ] {
        let (found, expected) = (mean(&below_a_panel(emission)), radiance * of_panel());
        assert!((found - expected).abs() <= 0.03 * expected, "{emission}: {found} instead of {expected}");
    }
    let pbrt = |light: &str| {
        let text = format!(
            "LookAt 0 0.5 0  0 0 0  0 0 -1 Camera \"orthographic\" \"float screenwindow\" [-.01 .01 -.01 .01]\n\
             WorldBegin Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n\
             Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-10 0 -10 10 0 -10 10 0 10 -10 0 10]\n\
             Material \"diffuse\" \"rgb reflectance\" [0 0 0] {light} Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-.5 1 -.5 .5 1 -.5 .5 1 .5 -.5 1 .5]"
        );
        bilux::formats::read_bytes(text.as_bytes(), "pbrt", None, "a.pbrt", &Default::default()).unwrap()
    };
    let area =
        |l: f32| format!("AreaLightSource \"diffuse\" \"rgb L\" [{l} {l} {l}] \"bool twosided\" [true]");
    for (light, radiance) in [(area(0.5), 0.5), (area(0.01), 0.01), (area(0.0), 0.0), (String::new(), 0.0)] {
        let (found, expected) = (mean(&pbrt(&light)), radiance * of_panel());
        assert!((found - expected).abs() <= 0.03 * expected, "{light}: {found} instead of {expected}");
    }
    let note = job(&pbrt("")).notes()[0].clone();
    assert!(note.contains("no light") && note.contains("--preset studio"), "{note}");
    assert!(job(&below_a_panel("emission = 0.9")).notes().is_empty());
}

#[test]
fn what_the_studio_adds_is_said() {
    let mut bare = file();
    put(&mut bare, cuboid(Vec3::NEG_ONE, Vec3::ONE), clay(0.5));
    let all = "the studio lights it with a key light, a rim light and surroundings";
    assert!(job(&bare).notes()[0].starts_with(all), "{:?}", job(&bare).notes());
    bare.lights.push(Spec::new("sun", "directional").with("direction", Vec3::new(-0.5, -1.0, -0.8)));
    let notes = job(&bare).notes().to_vec();
    assert!(notes.len() == 1 && notes[0].contains("the studio adds surroundings"), "{notes:?}");
}

/// Beside a cube, a screen whose light is a texture: the studio lights what it does not reach, and one line tells all of it.
#[test]
fn a_bright_texture_that_lights_a_part_is_said_with_the_exposure() {
    let mut scene = file();
    put(&mut scene, cuboid(Vec3::NEG_ONE, Vec3::ONE), clay(0.5));
    scene.textures.push(Arc::new(Texture::new("", 1, 1, vec![Rgb::WHITE], false)));
    let screen = glowing(0.0).with("emission", Value::Texture(0)).with("emission_scale", 1000.0f32);
    // It faces the side that the camera sees a fifth of the picture of.
    put(&mut scene, panel(Vec3::X * 1.5, Vec3::Z * 0.3, Vec3::Y * 0.3), screen);
    let job = job(&scene);
    let notes = job.notes();
    assert!(job.studio_light().is_none() && notes.len() == 1, "{:?}: {notes:?}", job.studio_light());
    assert!(notes[0].contains("its own lights reach only") && notes[0].contains(" EV"), "{notes:?}");
    // A sign is none of what anybody wonders about, and is told with `-v` as what it is.
    let sign = car(0.5);
    let job = self::job(&sign);
    assert!(job.studio_light().is_some() && job.notes()[0].contains("reach only 0%"), "{:?}", job.notes());
}

/// A model below a sun of so many lux.
fn sunlit(lux: f32) -> SceneBuilder {
    let mut scene = file();
    put(&mut scene, cuboid(Vec3::NEG_ONE, Vec3::ONE), clay(0.5));
    let sun = Spec::new("sun", "directional").with("direction", Vec3::new(-0.5, -1.0, -0.8));
    scene.lights.push(sun.with("irradiance", lux));
    scene
}

/// The pixels of the model as a display shows them, and the exposure.
fn shown(scene: &SceneBuilder, user: &[(&str, Value)]) -> (Vec<f32>, f32, Vec<String>) {
    let mut settings = settings();
    user.iter().for_each(|(key, value)| settings.set(key, value.clone()));
    let job = Job::new(scene, &settings).unwrap();
    let picture = job.render(&Quiet).unwrap().picture().unwrap();
    let options = job.write_options_for(&picture).unwrap();
    let shown = bilux::pictures::tonemap::to_display(&picture, options.exposure, options.tone_map).unwrap();
    let pixels = shown.to_rgb().unwrap().iter().map(|p| p.g).collect();
    (pixels, options.exposure, job.notes().to_vec())
}

/// A picture of a model by its own light shows the model, in whatever units the light is, and as a model that is as bright as usual.
#[test]
fn own_light_of_any_brightness_is_exposed() {
    let usual = shown(&sunlit(3.0), &[]);
    assert_eq!(usual.1, 0.0, "{:?}", usual.2);
    for lux in [10_000.0, 1e5, 64.0] {
        let (pixels, exposure, notes) = shown(&sunlit(lux), &[]);
        // A quarter of a stop is where exposures are rounded.
        let wanted = -f64::from(bilux::math::transcendental::log2(lux / 3.0));
        assert!(
            (f64::from(exposure) - wanted).abs() < 1.5,
            "{lux} lux: {exposure} EV, and about {wanted} expected"
        );
        assert!(notes.len() == 1 && notes[0].contains(&format!("{exposure:+} EV")), "{notes:?}");
        assert!(notes[0].contains("--exposure 0"), "{notes:?}");
        let mean = |pixels: &[f32]| pixels.iter().sum::<f32>() / pixels.len() as f32;
        assert!(
            (mean(&pixels) - mean(&usual.0)).abs() < 0.15,
            "{lux} lux: {} and {}",
            mean(&pixels),
            mean(&usual.0)
        );
        let burnt = pixels.iter().filter(|p| **p > 0.99).count();
        assert!(burnt * 10 < pixels.len(), "{lux} lux: {burnt} pixels are white");
    }
}

#[test]
fn the_exposure_is_the_users_or_the_files_where_they_state_it() {
    let of = |user: &[(&str, Value)]| shown(&sunlit(10_000.0), user);
    for stated in [0.0, -3.0] {
        let (_, exposure, notes) = of(&[("exposure", Value::Number(stated))]);
        assert!(f64::from(exposure) == stated && !notes.iter().any(|note| note.contains("EV")), "{notes:?}");
    }
    let mut said = sunlit(10_000.0);
    said.settings.set("exposure", Value::Number(-9.0));
    assert_eq!(shown(&said, &[]).1, -9.0);
    // Formats that can state an exposure show light as it is.
    let described =
        SceneBuilder { environment_unspecified: false, exposure_unspecified: false, ..sunlit(10_000.0) };
    assert_eq!(shown(&described, &[]).1, 0.0);
    // Without the studio's surroundings (`--env none`) it is exposed too.
    let alone = SceneBuilder { environment_unspecified: false, ..sunlit(10_000.0) };
    let (_, exposure, notes) = shown(&alone, &[]);
    assert!(exposure < -8.0 && notes.len() == 1, "{exposure} EV, {notes:?}");
    // The radiance of the picture is that of the file's light, and the same for parts and any number of threads.
    let whole = of(&[]);
    assert_eq!(of(&[("threads", Value::Integer(2))]).1, whole.1);
    let job = Job::new(&sunlit(10_000.0), &settings()).unwrap();
    assert!(bright(&job) > 100.0, "{}", bright(&job));
}

/// Lamps that light next to nothing, where no studio helps: a picture shows the model as one that is as bright as usual does.
#[test]
fn light_that_is_next_to_nothing_is_exposed() {
    let alone = |lux: f32| SceneBuilder { environment_unspecified: false, ..sunlit(lux) };
    let mean = |pixels: &[f32]| pixels.iter().sum::<f32>() / pixels.len() as f32;
    let usual = mean(&shown(&alone(3.0), &[]).0);
    for lux in [0.02f32, 0.004, 1e-5] {
        let (pixels, exposure, notes) = shown(&alone(lux), &[]);
        let wanted = bilux::math::transcendental::log2(3.0 / lux);
        assert!((exposure - wanted).abs() < 1.5, "{lux} lux: {exposure} EV, and about {wanted} expected");
        assert!(notes.len() == 1 && notes[0].contains("too dim for a display"), "{notes:?}");
        assert!((mean(&pixels) - usual).abs() < 0.15, "{lux} lux: {} and {usual}", mean(&pixels));
    }
    // What no light reaches stays as it is.
    let mut away = alone(0.004);
    away.lights[0].parameters.set("direction", Vec3::Y);
    put(&mut away, panel(Vec3::new(0.0, -3.0, 0.0), Vec3::X * 50.0, Vec3::Z * -50.0), clay(0.5));
    assert_eq!(shown(&away, &[]).1, 0.0);
}

/// Surroundings get no brighter where the picture is not exposed.
#[test]
fn exposures_leave_the_classic_shading_alone() {
    let room = |lux: f32, integrator: &str| {
        let mut settings = settings();
        settings.set("integrator", integrator);
        let job = Job::new(&sunlit(lux), &settings).unwrap();
        let lights = &job.completed_scene().lights;
        let room = lights.iter().find(|light| light.name == "room").unwrap();
        (room.parameters.clone(), job.write_options().unwrap().exposure)
    };
    assert_eq!(room(10_000.0, "whitted"), room(3.0, "whitted"));
    assert_ne!(room(10_000.0, "path").0, room(3.0, "path").0);
}

#[test]
fn all_pictures_of_a_series_are_exposed_alike() {
    let first = job(&sunlit(10_000.0));
    let next = Job::new(&sunlit(100.0), asked().in_series(first.series())).unwrap();
    let exposure = |job: &Job| job.write_options().unwrap().exposure;
    assert!(exposure(&first) < -8.0);
    assert_eq!((exposure(&next), next.notes()), (exposure(&first), first.notes()));
}

/// A wall whose front gets 30 lux and whose back 10000: the exposure of all pictures is that of the brighter side, wherever the
/// turntable begins.
#[test]
fn no_picture_of_a_turntable_is_burnt_by_the_brighter_side() {
    let exposure = |front: f32, back: f32| {
        let mut scene = file();
        put(&mut scene, cuboid(Vec3::new(-1.0, 0.0, -0.1), Vec3::new(1.0, 2.0, 0.1)), clay(0.6));
        for (z, lux) in [(-1.0, front), (1.0, back)] {
            let sun = Spec::new("", "directional").with("direction", Vec3::new(0.0, -0.2, z));
            scene.lights.push(sun.with("irradiance", lux));
        }
        let series = Series::turntable(&scene, &asked(), 2).unwrap();
        let job = Job::new(&scene, asked().in_series(series.turned(0, 2))).unwrap();
        job.write_options().unwrap().exposure
    };
    let [begun_dim, begun_bright] = [exposure(30.0, 10_000.0), exposure(10_000.0, 30.0)];
    // White paper there has a radiance of 10000 / π, for which a display has about a half.
    let wanted = -bilux::math::transcendental::log2(2.0 * 10_000.0 / std::f32::consts::PI);
    assert!((begun_bright - wanted).abs() < 1.5, "{begun_bright}");
    assert!((begun_dim - begun_bright).abs() < 0.5, "{begun_dim} and {begun_bright}");
}

/// A sign that glows on both sides, on one of them 64 times as brightly: the exposure of all pictures is that of the brighter side,
/// wherever the turntable begins.
#[test]
fn no_picture_of_a_glowing_sign_is_burnt_by_its_brighter_side() {
    let exposure = |front: f32, back: f32| {
        let mut scene = file();
        for (z, glow) in [(0.05, front), (-0.05, back)] {
            put(&mut scene, panel(Vec3::new(0.0, 1.0, z), Vec3::X * z.signum(), Vec3::Y), glowing(glow));
        }
        let series = Series::turntable(&scene, &asked(), 2).unwrap();
        let job = Job::new(&scene, asked().in_series(series.turned(0, 2))).unwrap();
        job.write_options().unwrap().exposure
    };
    // An emitter that a display shows well has a radiance of 1.
    assert_eq!([exposure(64.0, 4096.0), exposure(4096.0, 64.0)], [-12.0; 2]);
}
