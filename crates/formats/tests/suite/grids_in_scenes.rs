//! Grids in scenes: files of grids as models, densities in TOML, and the media of pbrt.

use crate::{refusal, warnings};
use bilux_formats::{ReadOptions, read, read_bytes};
use bilux_math::Vec3;
use bilux_scene::media::{BLOCK, DENSITIES, Grid};
use bilux_scene::{Axis, SceneBuilder, Spec, UpHint, Value};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file that the OpenVDB library wrote, or numpy: a ball whose middle is at 1 and whose border is at 0.
fn corpus(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/scene_vdb").join(name)
}

fn density(spec: &Spec) -> &Arc<Grid> {
    match spec.parameters.find("density") {
        Some((Value::Grid(grid), _)) => grid,
        other => panic!("{other:?}"),
    }
}

/// The grid of the material of an object, at a point of the world.
fn at(scene: &SceneBuilder, object: usize, world: [f32; 3]) -> f32 {
    let object = &scene.objects[object];
    let local = object.motion.at(0.0).inverted().point(Vec3::from(world));
    density(&scene.materials[object.material]).value(local)
}

#[track_caller]
fn close(found: f32, wanted: f32) {
    assert!((found - wanted).abs() <= 1e-3 * wanted.abs().max(1.0), "{found} for {wanted}");
}

#[test]
fn a_file_of_grids_is_smoke_of_a_known_thickness_in_the_box_of_its_voxels() {
    for name in ["blosc.vdb", "zip.vdb", "zip_32.nvdb", "zip_N.nvdb", "blosc_4.nvdb"] {
        let scene = read(&corpus(name), &ReadOptions::default()).unwrap();
        assert_eq!(warnings(&scene), "", "{name}");
        let [object] = &scene.objects[..] else { panic!("{name}") };
        let material = &scene.materials[object.material];
        assert_eq!(material.kind, "interface");
        // Voxels from 3, 2, 5 on, 9 along each side and 1/8 apart; the corners of the ball's box are empty, but its sides are not.
        let bounds = object.mesh.bounds();
        let slack = Vec3::splat(0.13);
        assert!(bounds.min.cmpge(Vec3::new(2., 1., 4.) / 8.0 - 1e-5).all(), "{name}: {bounds:?}");
        assert!(bounds.max.cmple(Vec3::new(12., 11., 14.) / 8.0 + 1e-5).all(), "{name}: {bounds:?}");
        assert!((bounds.extent() - Vec3::splat(10.0 / 8.0)).abs().cmple(slack).all(), "{name}: {bounds:?}");
        let grid = density(material);
        close(grid.value(Vec3::new(7., 6., 9.) / 8.0), 1.0);
        // Outwards on all sides.
        let middle = bounds.centre();
        for triangle in &object.mesh.triangles {
            let [a, b, c] = triangle.map(|v| object.mesh.positions[v as usize]);
            assert!((b - a).cross(c - a).dot(a - middle) > 0.0);
        }
        let [scattering, absorption] = ["scattering", "absorption"].map(|key| material.number(key).unwrap());
        close(scattering / (scattering + absorption), 0.98);
        // The means over ways as wide as a block.
        let blocks = grid.size().map(|side| side.div_ceil(BLOCK));
        let mut most = 0.0f64;
        for axis in 0..3 {
            let [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
            for (a, b) in (0..blocks[u]).flat_map(|a| (0..blocks[v]).map(move |b| (a, b))) {
                let mut sum = 0.0;
                for (i, j, along) in (0..512)
                    .map(|i| (i / 64, i / 8 % 8, i % 8))
                    .flat_map(|(i, j, k)| (0..blocks[axis]).map(move |block| (i, j, block * 8 + k)))
                {
                    let mut place = [0; 3];
                    (place[u], place[v], place[axis]) = (a * 8 + i, b * 8 + j, along);
                    if (0..3).all(|axis| place[axis] < grid.size()[axis]) {
                        sum += f64::from(grid.voxel(place));
                    }
                }
                most = most.max(sum / 64.0 / 8.0);
            }
        }
        close((scattering + absorption) * most as f32, 12.0);
        assert!(scene.notes.iter().any(|note| note.message.contains("optical thickness of 12")), "{name}");
    }
}

#[test]
fn the_up_axis_is_that_of_the_program_and_other_grids_are_named() {
    let scene = read(&corpus("blosc.vdb"), &ReadOptions::default()).unwrap();
    assert_eq!(scene.up, UpHint::Is(Axis::Z), "from Blender");
    let scene = read(&corpus("zip_32.nvdb"), &ReadOptions::default()).unwrap();
    assert_eq!(scene.up, UpHint::Usually(Axis::Y));
    let scene = read(&corpus("halves_two_grids.vdb"), &ReadOptions::default()).unwrap();
    assert!(
        warnings(&scene).contains("more than the picture shows: the grid 'temperature'"),
        "{}",
        warnings(&scene)
    );
    let vectors = std::fs::read(corpus("broken_vectors.vdb")).unwrap();
    let message = read_bytes(&vectors, "", None, "x.vdb", &ReadOptions::default()).unwrap_err().to_string();
    let wanted = "the grid 'velocity' of 'x.vdb' has the type 'vec3s'";
    assert!(message.starts_with("x.vdb: ") && message.contains(wanted), "{message}");
}

#[test]
fn toml_scenes_name_a_file_and_a_grid_in_it() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(corpus("halves_two_grids.vdb"), folder.path().join("smoke.vdb")).unwrap();
    let scene = |density: &str| {
        let text = format!(
            "[[material]]\nname = \"a\"\nkind = \"interface\"\nscattering = 2\ndensity = {density}\n\
             [[model]]\nshape = \"box\"\nmaterial = \"a\"\n"
        );
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        read(&path, &ReadOptions::default())
    };
    // The ball of the density has 8 voxels along each side, that of the temperature 6.
    for (text, middle) in [
        ("{ grid = \"smoke.vdb\" }", [6.5, 5.5, 8.5]),
        ("{ grid = \"smoke.vdb\", name = \"density\" }", [6.5, 5.5, 8.5]),
        ("{ grid = \"smoke.vdb\", name = \"temperature\" }", [5.5, 4.5, 7.5]),
    ] {
        let scene = scene(text).unwrap();
        let grid = density(&scene.materials[0]);
        let value = |p: Vec3| grid.value(p / 8.0);
        let [low, high] = [-0.5, 0.5].map(|by| value(Vec3::from(middle) + Vec3::X * by));
        close(low, high);
        assert!(low > 0.9 && value(Vec3::from(middle) + Vec3::X * 3.5) < 0.5, "{text}: {low}");
    }
    for (text, wanted) in [
        ("{ grid = \"smoke.vdb\", name = \"flame\" }", "has no grid 'flame', but density, temperature"),
        ("{ grid = \"none.vdb\" }", "there is no file 'none.vdb'"),
        ("{ grid = \"scene.toml\" }", "no file of grids"),
        ("{ name = \"density\" }", "grid (a file)"),
    ] {
        let message = scene(text).unwrap_err().to_string();
        assert!(message.contains("scene.toml") && message.contains(wanted), "{message}");
    }
}

fn world(text: &str) -> Result<SceneBuilder, String> {
    let text = format!("Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n{text}");
    crate::read_text("pbrt", text).map_err(|error| error.to_string())
}

#[test]
fn grids_of_pbrt_stay_where_the_medium_is_whatever_the_shape() {
    let scene = world(
        r#"
        AttributeBegin
        Translate 10 0 0
        Scale 2 1 1
        MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 2 "integer ny" 1 "integer nz" 1
            "float density" [1 3] "point3 p0" [0 0 0] "point3 p1" [2 1 1]
            "rgb sigma_a" [.1 .2 .3] "rgb sigma_s" [1 2 3] "float scale" 2 "float g" .5
        AttributeEnd
        Material "interface"
        MediumInterface "smoke" ""
        AttributeBegin
        Translate 11 2 3
        Rotate 30 0 1 0
        Scale 5 6 7
        Shape "sphere"
        AttributeEnd
        Shape "sphere" "float radius" 30
        ObjectBegin "puff"
        Translate 1 2 3
        Shape "sphere"
        ObjectEnd
        AttributeBegin
        Scale 20 20 20
        ObjectInstance "puff"
        AttributeEnd"#,
    )
    .unwrap();
    assert_eq!((warnings(&scene).as_str(), scene.objects.len()), ("", 3));
    for object in 0..3 {
        let material = &scene.materials[scene.objects[object].material];
        assert_eq!(material.kind, "interface");
        close(material.colour("scattering").unwrap().g, 4.0);
        close(material.colour("absorption").unwrap().b, 0.6);
        close(material.number("scattering_anisotropy").unwrap(), 0.5);
        // The centres of voxels, between them, the border, where half is left, and beyond.
        let value = |x: f32| at(&scene, object, [10.0 + 2.0 * x, 0.5, 0.5]);
        close(value(0.5), 1.0);
        close(value(1.5), 3.0);
        close(value(1.0), 2.0);
        close(value(0.0), 0.5);
        close(value(2.0), 1.5);
        close(value(-0.6), 0.0);
        close(at(&scene, object, [11.0, 0.5, 1.6]), 0.0);
    }
}

#[test]
fn clouds_of_pbrt_are_those_of_their_formula() {
    let scene = world(
        r#"
        AttributeBegin
        Scale 2 2 2
        MakeNamedMedium "puff" "string type" "cloud" "float density" 1.5 "float wispiness" 0.5 "float frequency" 1.25
            "point3 p0" [0 .2 0] "point3 p1" [1 1 1] "rgb sigma_a" [.1 .2 .3] "rgb sigma_s" [1 2 3]
        AttributeEnd
        Material "interface"
        MediumInterface "puff" ""
        Shape "sphere""#,
    )
    .unwrap();
    assert_eq!(warnings(&scene), "");
    close(scene.materials[scene.objects[0].material].colour("scattering").unwrap().g, 2.0);
    // As in the tests of the formula.
    for (p, wanted) in [
        ([0.703, 0.452, 0.725], 0.2538),
        ([0.726, 0.422, 0.088], 0.1560),
        ([0.497, 0.921, 0.42], 0.0902),
        ([0.398, 0.639, 0.093], 0.0000),
    ] {
        let found = at(&scene, 0, p.map(|x: f32| 2.0 * x));
        assert!((found - wanted).abs() < 0.02, "{found} for {wanted}");
    }
    close(at(&scene, 0, [1.0, 0.39, 1.0]), 0.0);
    for (parameter, message) in [
        ("\"float frequency\" -1", "cloud.frequency is -1.0, but must be a number from 0 to 10000"),
        ("\"float density\" [1 2]", "one number"),
        ("\"point3 p1\" [1 0 1]", "no volume"),
    ] {
        let text = format!("MakeNamedMedium \"m\" \"string type\" \"cloud\" {parameter}");
        let found = world(&text).unwrap_err();
        assert!(found.contains(message), "{found}");
    }
}

#[test]
fn formulas_are_densities_of_toml_scenes_and_are_written_as_they_were_read() {
    let scene = |density: &str| {
        let text = format!(
            "[[material]]\nname = \"m\"\nkind = \"interface\"\nscattering = 1\ndensity = {density}\n\
             [[model]]\nshape = \"box\"\nmaterial = \"m\"\n"
        );
        read_bytes(text.as_bytes(), "toml", None, "x.toml", &ReadOptions::default())
            .map_err(|error| error.to_string())
    };
    let folder = tempfile::tempdir().unwrap();
    let place = "[0.1, 0, 0, 0, 0, 0.1, 0, -0.1, 0, 1, 2, 3]";
    let densities = [
        "{ kind = \"height\", falloff = 0.5, up = \"z\", from = [-1, -1, 0], to = [1, 1, 4] }".to_owned(),
        "{ kind = \"cloud\", frequency = 0.5, to = [1, 2, 1] }".to_owned(),
        format!("{{ kind = \"noise\", octaves = 2, low = 0.4, resolution = 16, place = {place} }}"),
    ];
    for row in DENSITIES {
        let kind = format!("kind = \"{}\"", row.entry.name);
        assert!(densities.iter().any(|density| density.contains(&kind)), "{kind} is not tried");
    }
    for density in densities {
        let first = scene(&density).unwrap();
        let path = folder.path().join("written.toml");
        bilux_formats::write(&path, &first, &Default::default()).unwrap();
        let written = std::fs::read_to_string(&path).unwrap();
        assert!(written.contains("density = { kind = "), "{written}");
        assert_eq!(written.contains("place = "), density.contains("place = "), "{written}");
        let second = read(&path, &ReadOptions::default()).unwrap();
        let [first, second] = [&first, &second].map(density_of);
        assert_eq!(first, second);
        assert!(first.maximum() > 0.3, "{first:?}");
    }
    let height = scene("{ kind = \"height\", falloff = 0.5, to = [1, 4, 1] }").unwrap();
    close(density_of(&height).value(Vec3::new(0.5, 1.0, 0.5)), 0.135_335_28);
    for (density, message) in [
        ("{ kind = \"fog\" }", "there is no density 'fog' (known: cloud, noise, height)"),
        ("{ kind = \"cloud\", frequenzy = 1 }", "did you mean 'frequency'"),
        ("{ kind = \"cloud\", frequency = nan }", "cloud.frequency"),
        ("{ kind = \"noise\", resolution = 2048 }", "voxels are more than 134217728"),
        ("{ kind = \"noise\", resolution = 5000 }", "0 to 2048"),
        ("{ }", "grid (a file), or kind (cloud, noise, height)"),
    ] {
        let found = scene(density).unwrap_err();
        assert!(found.contains(message), "{found}");
    }
}

fn density_of(scene: &SceneBuilder) -> &Arc<Grid> {
    density(&scene.materials[scene.objects[0].material])
}

#[test]
fn media_of_pbrt_emit_light_times_their_absorption() {
    let scene = world(
        r#"
        MakeNamedMedium "fire" "string type" "uniformgrid" "integer nx" 2 "float density" [1 2] "rgb Le" [3 2 1]
            "float Lescale" [4 0] "rgb sigma_s" [0 0 0]
        MakeNamedMedium "glow" "string type" "homogeneous" "rgb Le" [3 2 1] "float Lescale" 5
        Material "interface"
        MediumInterface "fire" ""
        Shape "sphere"
        MediumInterface "glow" ""
        Shape "sphere"
        Material "dielectric"
        Shape "sphere""#,
    )
    .unwrap();
    let materials: Vec<&Spec> = (0..3).map(|i| &scene.materials[scene.objects[i].material]).collect();
    close(materials[0].colour("medium_emission").unwrap().r, 3.0);
    let Some((Value::Grid(factor), _)) = materials[0].parameters.find("medium_emission_grid") else {
        panic!()
    };
    close(factor.value(Vec3::new(0.25, 0.5, 0.5)), 4.0);
    close(factor.value(Vec3::new(0.75, 0.5, 0.5)), 0.0);
    close(materials[1].colour("medium_emission").unwrap().b, 5.0);
    assert!(warnings(&scene).contains("a medium that varies or emits light is supported only in interfaces"));
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
}

/// As in scenes of pbrt whose smoke is a file of its own.
#[test]
fn parameters_after_an_include_belong_to_its_last_directive() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("smoke.pbrt", "Include \"inner.pbrt\"\n");
    write(
        "inner.pbrt",
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 # two\n\"float density\" [1 2] # end",
    );
    let scene = |more: &str| {
        write(
            "a.pbrt",
            &format!(
                "Camera \"perspective\"\nWorldBegin\nInclude \"smoke.pbrt\"\n{more}\nMaterial \"interface\"\n\
             MediumInterface \"m\" \"\"\nShape \"sphere\""
            ),
        );
        read(&folder.path().join("a.pbrt"), &ReadOptions::default()).map_err(|error| error.to_string())
    };
    let found = scene("  \"rgb sigma_s\" [3 4 5]\n  \"float scale\" 2").unwrap();
    let spec = &found.materials[found.objects[0].material];
    close(spec.colour("scattering").unwrap().b, 10.0);
    close(at(&found, 0, [0.75, 0.5, 0.5]), 2.0);
    let message = scene("  \"rgb sigma_s\" [3 4 5]\n  \"float scale\" two").unwrap_err();
    assert!(message.contains("a.pbrt:5:17"), "{message}");
    write("inner.pbrt", "WorldEnd");
    let message = scene("\n \"rgb sigma_s\" [3 4 5]").unwrap_err();
    assert!(message.contains("a.pbrt:5:2") && message.contains("a directive is expected"), "{message}");
}

/// The luminance of black bodies with a maximum of 1 comes from another program.
#[test]
fn temperatures_of_pbrt_are_those_of_black_bodies() {
    let scene = world(
        r#"
        MakeNamedMedium "fire" "string type" "uniformgrid" "integer nx" 2 "float density" [1 2]
            "float temperature" [850 1600] "float temperatureoffset" 100 "float temperaturescale" 2
        Material "interface"
        MediumInterface "fire" ""
        Shape "sphere""#,
    )
    .unwrap();
    assert_eq!(warnings(&scene), "");
    let spec = &scene.materials[scene.objects[0].material];
    let temperature = |spec: &Spec| match spec.parameters.find("temperature") {
        Some((Value::Grid(grid), _)) => grid.clone(),
        other => panic!("{other:?}"),
    };
    close(spec.colour("medium_emission").unwrap().g, 44.5226);
    close(temperature(spec).value(Vec3::new(0.25, 0.5, 0.5)), 750.0);
    close(temperature(spec).maximum(), 1500.0);
    close(spec.number("temperature_scale").unwrap(), 2.0);
    assert_eq!(spec.parameters.find("temperature_norm").unwrap().0, &Value::Text("peak".to_owned()));
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(corpus("halves_two_grids.vdb"), folder.path().join("fire.nvdb")).unwrap();
    let path = folder.path().join("a.pbrt");
    let file = |more: &str| {
        let text = format!(
            r#"Camera "perspective"
            WorldBegin
            MakeNamedMedium "m" "string type" "nanovdb" "string filename" "fire.nvdb" {more}
            Material "interface"
            MediumInterface "m" ""
            Shape "sphere""#
        );
        std::fs::write(&path, text).unwrap();
        read(&path, &ReadOptions::default()).unwrap()
    };
    let scene = file(r#""float temperaturescale" 3000 "float Lescale" 1.25"#);
    assert_eq!(warnings(&scene), "");
    let spec = &scene.materials[scene.objects[0].material];
    close(temperature(spec).maximum(), 1.0);
    close(spec.colour("medium_emission").unwrap().r, 1.25 * 44.5226);
    let scene = file(r#""string temperaturename" "heat" "string gridname" "temperature""#);
    let spec = &scene.materials[scene.objects[0].material];
    assert!(spec.parameters.find("temperature").is_none());
    close(density(spec).maximum(), 1.0);
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
}

#[test]
fn rgb_grids_of_pbrt_have_the_mean_of_their_colours() {
    let scene = world(
        r#"
        MakeNamedMedium "m" "string type" "rgbgrid" "integer nz" 2
            "rgb sigma_a" [0 0 0  1 2 3] "rgb sigma_s" [1 1 1  1 2 3] "float scale" 10
        Material "interface"
        MediumInterface "m" ""
        Shape "sphere""#,
    )
    .unwrap();
    assert!(warnings(&scene).contains("the colours of a medium of type 'rgbgrid' are the same everywhere"));
    let material = &scene.materials[scene.objects[0].material];
    let luminance = |r: f32, g: f32, b: f32| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let [first, second] = [1.0, luminance(2.0, 4.0, 6.0)];
    close(at(&scene, 0, [0.5, 0.5, 0.25]), first);
    close(at(&scene, 0, [0.5, 0.5, 0.75]), second);
    let (scattering, absorption) =
        (material.colour("scattering").unwrap(), material.colour("absorption").unwrap());
    close(scattering.b, 10.0 * 4.0 / (first + second));
    close(absorption.r, 10.0 / (first + second));
}

#[test]
fn nanovdb_media_of_pbrt_are_read_from_their_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(corpus("zip_32.nvdb"), folder.path().join("ball.nvdb")).unwrap();
    let path = folder.path().join("a.pbrt");
    let text = r#"Camera "perspective"
        WorldBegin
        LightSource "infinite"
        AttributeBegin
        Scale 8 8 8
        MakeNamedMedium "m" "string type" "nanovdb" "string filename" "ball.nvdb" "float LeScale" 0
        AttributeEnd
        Material "interface"
        MediumInterface "m" ""
        Shape "sphere" "float radius" 20"#;
    std::fs::write(&path, text).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    close(at(&scene, 0, [7.0, 6.0, 9.0]), 1.0);
    assert!(at(&scene, 0, [10.0, 6.0, 9.0]) < 0.7);
    let material = &scene.materials[scene.objects[0].material];
    close(material.colour("scattering").unwrap().r, 1.0);
    std::fs::write(&path, text.replace("ball.nvdb", "none.nvdb")).unwrap();
    let message = read(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("a.pbrt:6:") && message.contains("there is no file 'none.nvdb'"), "{message}");
}

#[test]
fn media_of_pbrt_that_cannot_be_are_refused_or_named() {
    let medium = |given: &str| {
        world(&format!(
            "MakeNamedMedium \"m\" {given}\nMaterial \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\""
        ))
    };
    for (given, wanted) in [
        (
            r#""string type" "uniformgrid" "integer nx" 3 "float density" [1 2]"#,
            "'density' has 2 values, but 'nx', 'ny' and 'nz' are 3, 1 and 1",
        ),
        (r#""string type" "uniformgrid" "integer nx" -1 "float density" [1 2]"#, "has 2 values"),
        (
            r#""string type" "uniformgrid" "integer nx" 2 "float density" [1 2] "point3 p1" [1 0 1]"#,
            "has no volume",
        ),
        (
            r#""string type" "rgbgrid" "integer nx" 2 "rgb sigma_a" [1 1 1 1 1 1] "rgb sigma_s" [1 1 1]"#,
            "different numbers of colours",
        ),
        (r#""string type" "nanovdb""#, "needs a 'filename'"),
    ] {
        let message = medium(given).unwrap_err();
        assert!(message.contains("scene.pbrt:4:") && message.contains(wanted), "{message}");
    }
    let scene = medium(
        r#""string type" "uniformgrid" "integer nx" 2 "float density" [1 -2] "float temperature" [1 1]"#,
    )
    .unwrap();
    assert!(warnings(&scene).contains("numbers of a grid that are negative"), "{}", warnings(&scene));
    let scene = medium(r#""string type" "clouds""#).unwrap();
    assert!(warnings(&scene).contains("a medium of type 'clouds' is not supported"), "{}", warnings(&scene));
    assert!(refusal("vdb", b"nothing").contains("no file of grids"));
}

#[test]
fn the_studio_shows_white_smoke_on_dark_ground() {
    let mut scene = read(&corpus("blosc.vdb"), &ReadOptions::default()).unwrap();
    bilux_scene::presets::complete(&mut scene, &Default::default());
    let ground = scene.objects.last().unwrap();
    assert!(ground.name != "blosc" && scene.objects.len() == 2 && scene.cameras.len() == 1);
    assert!(scene.materials[ground.material].colour("reflectance").unwrap().luminance() < 0.1);
    // z is up in the file, y in the world.
    let up = scene.objects[0].motion.at(0.0).vector(Vec3::Z);
    assert!((up - Vec3::Y).length() < 1e-5, "{up}");
}
