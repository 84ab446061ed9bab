//! The shared pbrt scenes against the pictures that came with them, which another renderer made, in red, green and blue
//! as we do. Means of blocks of pixels are compared, channel by channel.
//!
//! The headers of the files were edited since: the pictures' depths are their own. The picture of the Cornell box has
//! all light; that of Veach's plates has direct light alone. Its plates have a microfacet distribution without long
//! tails and reflect about a third of what the file states, so only their colour is compared, which follows from their
//! refractive index.
#![allow(clippy::print_stdout, reason = "a test that skips says so")]

use bilux::pictures::Picture;
use bilux::prelude::*;
use std::path::{Path, PathBuf};

/// Maximum relative difference of the mean of a channel.
const MAX_OFF: f64 = 0.02;

fn shared(scene: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes/pbrt").join(scene);
    if !folder.is_dir() {
        println!("skipped: there is no folder ../shared/scenes/pbrt/{scene}");
        return None;
    }
    Some(folder)
}

/// Rows of pixels.
struct Pixels {
    width: usize,
    height: usize,
    colours: Vec<Rgb>,
}

impl Pixels {
    fn of(picture: &Picture) -> Pixels {
        Pixels { width: picture.width(), height: picture.height(), colours: picture.to_rgb().unwrap() }
    }

    /// The mean of a region, whose ends are fractions of the sides: left, right, top, bottom.
    fn mean(&self, [left, right, top, bottom]: [f64; 4]) -> [f64; 3] {
        let columns = (left * self.width as f64) as usize..(right * self.width as f64) as usize;
        let rows = (top * self.height as f64) as usize..(bottom * self.height as f64) as usize;
        let count = (columns.len() * rows.len()) as f64;
        let mut sum = [0.0; 3];
        for colour in rows.flat_map(|y| columns.clone().map(move |x| self.colours[y * self.width + x])) {
            (0..3).for_each(|c| sum[c] += f64::from(colour[c]));
        }
        sum.map(|s| s / count)
    }
}

/// The picture that came with a scene, in as many columns as ours: each pixel is the mean of a block.
fn reference(folder: &Path, width: usize) -> Pixels {
    let picture = bilux::pictures::read(folder.join("TungstenRender.exr")).unwrap();
    let fine = Pixels::of(&picture.into_linear());
    let side = fine.width / width;
    let height = fine.height / side;
    let block = |i: usize| {
        let (x, y) = (i % width * side, i / width * side);
        let all = (0..side * side).map(|k| fine.colours[(y + k / side) * fine.width + x + k % side]);
        all.sum::<Rgb>() / (side * side) as f32
    };
    Pixels { width, height, colours: (0..width * height).map(block).collect() }
}

/// Our picture of a scene, after `change` has modified it.
fn ours(folder: &Path, settings: &[(&str, Value)], change: impl Fn(&mut SceneBuilder)) -> Pixels {
    let mut scene = bilux::load(&folder.join("scene-v4.pbrt"), &Default::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    change(&mut scene);
    let mut all = Parameters::default();
    settings.iter().for_each(|(key, value)| all.set(key, value.clone()));
    Pixels::of(&Job::new(&scene, &all).unwrap().render(&Quiet).unwrap().picture().unwrap())
}

fn cornell_box(folder: &Path, change: impl Fn(&mut SceneBuilder)) -> Pixels {
    let settings = [
        ("size", "64x64".into()),
        ("spp", Value::Integer(144)),
        ("max_depth", Value::Integer(32)),
        // With the box filter, no light of one block comes from another.
        ("filter", "box".into()),
        ("integrator", "path".into()),
    ];
    ours(folder, &settings, change)
}

fn plates(folder: &Path, change: impl Fn(&mut SceneBuilder)) -> Pixels {
    let settings = [
        ("size", "160x90".into()),
        ("spp", Value::Integer(64)),
        ("max_depth", Value::Integer(1)),
        ("filter", "box".into()),
        ("integrator", "path".into()),
    ];
    ours(folder, &settings, change)
}

/// The maximum relative difference of the mean of any channel.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] / b[c] - 1.0).abs()).fold(0.0, f64::max)
}

const WHOLE: [f64; 4] = [0.0, 1.0, 0.0, 1.0];

/// Regions of the Cornell box: the walls, the floor, both boxes, the light.
const IN_THE_BOX: [[f64; 4]; 8] = [
    [0.02, 0.1, 0.25, 0.6],
    [0.9, 0.98, 0.25, 0.7],
    [0.3, 0.7, 0.15, 0.4],
    [0.3, 0.7, 0.02, 0.05],
    [0.1, 0.45, 0.95, 1.0],
    [0.3, 0.45, 0.45, 0.9],
    [0.5, 0.7, 0.7, 0.95],
    // Whole pixels of our picture.
    [26.0 / 64.0, 37.0 / 64.0, 5.0 / 64.0, 6.0 / 64.0],
];

/// Regions of the plates' scene without plates: the wall, the floor, the middle of the large light.
const AROUND_THE_PLATES: [[f64; 4]; 5] = [
    [0.0, 0.3, 0.0, 0.3],
    [0.75, 1.0, 0.0, 0.6],
    [0.0, 0.1, 0.85, 1.0],
    [0.3, 0.7, 0.96, 1.0],
    [0.63, 0.68, 0.15, 0.25],
];

/// Regions in which the plates are bright.
const ON_THE_PLATES: [[f64; 4]; 4] =
    [[0.62, 0.68, 0.38, 0.48], [0.62, 0.68, 0.54, 0.6], [0.46, 0.54, 0.68, 0.73], [0.4, 0.6, 0.82, 0.87]];

/// The maximum difference over all regions.
fn greatest(a: &Pixels, b: &Pixels, parts: &[[f64; 4]]) -> f64 {
    parts.iter().map(|part| apart(a.mean(*part), b.mean(*part))).fold(0.0, f64::max)
}

/// Chromaticity alone: each channel over the sum of all.
fn hue(c: [f64; 3]) -> [f64; 3] {
    let sum: f64 = c.iter().sum();
    c.map(|channel| channel / sum)
}

#[test]
fn the_cornell_box_agrees_with_its_picture() {
    let Some(folder) = shared("cornell-box") else { return };
    let reference = reference(&folder, 64);
    let found = cornell_box(&folder, |_| {});
    let whole = apart(found.mean(WHOLE), reference.mean(WHOLE));
    assert!(whole < 0.005, "the whole differs by {whole}");
    let parts = greatest(&found, &reference, &IN_THE_BOX);
    assert!(parts < MAX_OFF, "a part differs by {parts}");
}

#[test]
fn a_light_or_a_wall_that_is_5_percent_off_would_not() {
    let Some(folder) = shared("cornell-box") else { return };
    let reference = reference(&folder, 64);
    let scaled = |kind: &'static str, by: f64| {
        cornell_box(&folder, move |scene| {
            for spec in &mut scene.materials {
                for (key, value, _) in &mut spec.parameters.0 {
                    if let (true, Value::List(list)) = (key == kind, value) {
                        for channel in list {
                            if let Value::Number(x) = channel {
                                *x *= by;
                            }
                        }
                    }
                }
            }
        })
    };
    for (key, by) in [("emission", 1.05), ("reflectance", 0.95)] {
        let off = apart(scaled(key, by).mean(WHOLE), reference.mean(WHOLE));
        assert!(off > MAX_OFF, "{key}: {off}");
    }
}

#[test]
fn veachs_plates_agree_with_their_picture_in_light_and_colour() {
    let Some(folder) = shared("veach-mis") else { return };
    let reference = reference(&folder, 160);
    let found = plates(&folder, |_| {});
    let around = greatest(&found, &reference, &AROUND_THE_PLATES);
    assert!(around < MAX_OFF, "around the plates a part differs by {around}");
    for part in ON_THE_PLATES {
        let off = apart(hue(found.mean(part)), hue(reference.mean(part)));
        assert!(off < 0.005, "{part:?}: the colour differs by {off}");
    }
    let wrong = plates(&folder, |scene| {
        for spec in &mut scene.materials {
            if let Some((_, value, _)) = spec.parameters.0.iter_mut().find(|(key, ..)| key == "k") {
                *value = Rgb::new(3.9, 2.1, 2.0).into();
            }
        }
    });
    let off = ON_THE_PLATES.map(|part| apart(hue(wrong.mean(part)), hue(reference.mean(part))));
    assert!(off.iter().any(|off| *off > 0.02), "another metal would be seen: {off:?}");
}

/// Renders a scene from text.
fn of_text(format: &str, text: &str, size: &str, spp: i64) -> Pixels {
    let scene = bilux::formats::read_bytes(text.as_bytes(), format, None, "scene", &Default::default());
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let mut all = Parameters::default();
    for (key, value) in [("size", size), ("integrator", "path"), ("filter", "box")] {
        all.set(key, value);
    }
    all.set("spp", Value::Integer(spp));
    Pixels::of(&Job::new(&scene, &all).unwrap().render(&Quiet).unwrap().picture().unwrap())
}

#[test]
fn coated_diffuse_reflects_what_two_layers_do() {
    let text = r#"
        LookAt 0 0 -5 0 0 0 0 1 0
        Camera "perspective" "float fov" 0.1
        WorldBegin
        LightSource "infinite" "rgb L" [1 1 1]
        Material "coateddiffuse" "rgb reflectance" [.5 .8 .2] "float roughness" 0
        Shape "sphere""#;
    let seen = of_text("pbrt", text, "8x8", 512).mean(WHOLE);
    // The boundary reflects 0.04 back outside, and 0.5964 of the uniform light from below. [Egan 1973]
    let of = |rho: f64| 0.04 + 0.96 * 0.4036 * rho / (1.0 - 0.5964 * rho);
    assert!(apart(seen, [of(0.5), of(0.8), of(0.2)]) < 0.01, "{seen:?}");
}

#[test]
fn boxes_balls_and_lights_are_the_same_as_from_our_own_format() {
    let theirs = r#"
        Scale -1 1 1
        LookAt 0 2 6  0 0.5 0  0 1 0
        Camera "perspective" "float fov" 40
        WorldBegin
        LightSource "point" "rgb I" [20 15 10] "point3 from" [2 4 2]
        LightSource "spot" "rgb I" [30 30 60] "point3 from" [-3 4 1] "point3 to" [0 0 0]
            "float coneangle" 25 "float conedeltaangle" 5
        LightSource "distant" "rgb L" [.3 .4 .3] "point3 from" [0 3 1] "point3 to" [0 0 0]
        LightSource "infinite" "rgb L" [.1 .1 .2]
        Material "diffuse" "rgb reflectance" [.6 .5 .4]
        Shape "bilinearmesh" "point3 P" [-4 0 4  4 0 4  -4 0 -4  4 0 -4]
        AttributeBegin
            Translate -1 .75 0
            Material "conductor" "spectrum eta" "metal-CuZn-eta" "spectrum k" "metal-CuZn-k" "float roughness" .0625
            Shape "sphere" "float radius" .75
        AttributeEnd
        AttributeBegin
            AreaLightSource "diffuse" "rgb L" [2 4 2]
            Translate 1 1.5 -1
            Shape "trianglemesh" "point3 P" [-.5 -.5 0  .5 -.5 0  .5 .5 0  -.5 .5 0] "integer indices" [0 1 2 0 2 3]
        AttributeEnd"#;
    let ours = r#"
        [camera]
        position = [0, 2, 6]
        look_at = [0, 0.5, 0]
        fov = 40
        [[light]]
        kind = "point"
        position = [2, 4, 2]
        intensity = [20, 15, 10]
        [[light]]
        kind = "spot"
        position = [-3, 4, 1]
        look_at = [0, 0, 0]
        intensity = [30, 30, 60]
        angle = 25
        inner_angle = 20
        [[light]]
        kind = "directional"
        direction = [0, -3, -1]
        irradiance = [0.3, 0.4, 0.3]
        [[light]]
        kind = "environment"
        radiance = [0.1, 0.1, 0.2]
        [[material]]
        name = "matte"
        kind = "diffuse"
        reflectance = [0.6, 0.5, 0.4]
        [[material]]
        name = "brass"
        kind = "conductor"
        metal = "brass"
        roughness = 0.5
        [[material]]
        name = "panel"
        kind = "diffuse"
        reflectance = [0.6, 0.5, 0.4]
        emission = [2, 4, 2]
        emission_sides = "front"
        [[model]]
        shape = "quad"
        u = [8, 0, 0]
        v = [0, 0, -8]
        material = "matte"
        [[model]]
        shape = "sphere"
        radius = 0.75
        around = 192
        along = 96
        translate = [-1, 0.75, 0]
        material = "brass"
        [[model]]
        shape = "quad"
        translate = [1, 1.5, -1]
        material = "panel""#;
    let (theirs, ours) = (of_text("pbrt", theirs, "48x48", 64), of_text("toml", ours, "48x48", 64));
    let sixths = (0..36).map(|i| {
        let (x, y) = (f64::from(i % 6) / 6.0, f64::from(i / 6) / 6.0);
        [x, x + 1.0 / 6.0, y, y + 1.0 / 6.0]
    });
    let parts: Vec<[f64; 4]> = sixths.collect();
    let off = greatest(&theirs, &ours, &parts);
    assert!(off < MAX_OFF, "a part differs by {off}");
}
