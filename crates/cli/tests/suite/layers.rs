//! Layers for compositors, what pictures say about themselves, folders that are compared, and scenes that are explained.

use bilux::pictures::{Picture, WriteOptions, read};
use bilux::transport::aovs::Aov;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// The names of all layers of the table but some.
fn layers_without(left_out: &[Aov]) -> String {
    let aovs = Aov::layers().filter(|aov| !left_out.contains(aov));
    aovs.map(|aov| aov.row().entry.name).collect::<Vec<_>>().join(",")
}

fn run(folder: &Path, command: &str) -> Output {
    let mut bilux = Command::new(env!("CARGO_BIN_EXE_bilux"));
    bilux.current_dir(folder).args(command.split_whitespace()).output().unwrap()
}

#[track_caller]
fn done(folder: &Path, command: &str) -> String {
    let output = run(folder, command);
    assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A ball and a lamp over a floor.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let scene = "[camera]\nposition = [0, 2, 6]\nlook_at = [0, 0.5, 0]\npixel_aspect = 1.25\n\n\
        [[model]]\nshape = \"floor\"\nname = \"ground\"\n\n\
        [[model]]\nshape = \"sphere\"\nname = \"ball\"\ntranslate = [0, 1, 0]\n\n\
        [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [2, 4, 3]\n\n\
        [[light]]\nkind = \"environment\"\ngroup = \"the sky\"\nradiance = 0.2\n";
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    folder
}

fn opened(path: &Path, name: &str) -> Picture {
    read(path.join(name)).unwrap()
}

/// Every layer of a picture comes through a merge of its parts, to the bit.
fn assert_same_in_parts(path: &Path, render: &str) {
    done(path, &format!("{render} -o whole.exr"));
    for (part, crop) in [("a.exr", "0,0,32,10"), ("b.exr", "0,10,32,14")] {
        done(path, &format!("{render} -o {part} --crop {crop}"));
    }
    done(path, "merge a.exr b.exr -o merged.exr -q");
    let (whole, merged) = (opened(path, "whole.exr"), opened(path, "merged.exr"));
    let layers = whole.channels().iter().filter(|channel| channel.name.contains('.'));
    assert!(layers.clone().count() > 40);
    for channel in layers {
        let bits = |samples: &[f32]| samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>();
        let other = merged.channel(&channel.name).unwrap_or_else(|| panic!("{} is lost", channel.name));
        assert!(bits(&channel.samples) == bits(other), "{}", channel.name);
    }
    assert_eq!(whole.integer_planes().len(), 5);
    for plane in whole.integer_planes() {
        assert_eq!(merged.integer_plane(&plane.name), Some(&plane.samples[..]), "{}", plane.name);
    }
    for (key, value) in &whole.metadata {
        assert_eq!(merged.metadata.get(key), Some(value), "{key}");
    }
    assert!(whole.metadata.contains_key("pixelAspectRatio"));
    assert_eq!(whole.metadata["bilux.group_the_sky"], "the sky");
}

#[test]
fn layers_of_parts_are_those_of_the_whole() {
    let folder = folder();
    let path = folder.path();
    // Splats have no variance that can be divided by parts, and accelerators have costs of their own.
    let for_all = layers_without(&[Aov::Variance, Aov::Nodes, Aov::Tests]);
    let base = format!("render scene.toml -i bdpt --size 32x24 --spp 4 -q --aov {for_all}");
    done(path, &format!("{base} -o bdpt.exr --threads 1"));
    done(path, &format!("{base} -o again.exr --threads 3 --accel brute"));
    assert!(fs::read(path.join("bdpt.exr")).unwrap() == fs::read(path.join("again.exr")).unwrap());
    assert_same_in_parts(path, &base);
    assert_same_in_parts(
        path,
        &format!("render scene.toml -i path --size 32x24 --spp 4 -q --aov {}", layers_without(&[])),
    );
    // Half of the samples are not what the settings would make.
    done(path, "render scene.toml -i path --size 32x24 --spp 4 -q --samples 0..2 -o half.exr");
    done(path, "merge half.exr -o half.png -q --partial");
    assert!(!opened(path, "half.png").metadata.contains_key("bilux.settings"));
}

#[test]
fn what_a_picture_says_makes_it_again() {
    let folder = folder();
    let path = folder.path();
    done(
        path,
        "render scene.toml -o first.png --size 24x16 --spp 3 --seed 7 -i path --exposure 0.5 --noise 0.0001 -q",
    );
    let first = opened(path, "first.png");
    assert!(first.metadata["Software"].starts_with("Bilux "));
    let options = &first.metadata["bilux.settings"];
    assert!(
        options.contains("seed=7") && options.contains("exposure=0.5") && !options.contains(" noise="),
        "{options}"
    );
    done(path, &format!("render scene.toml -o again.png -q {options}"));
    // What the first says of its noise, the second does not know.
    let again = opened(path, "again.png");
    assert_eq!(first.to_rgb(), again.to_rgb());
    assert_eq!(options, &again.metadata["bilux.settings"]);
}

#[test]
fn layers_that_cannot_be_made_are_refused_before_the_work() {
    let folder = folder();
    let path = folder.path();
    for (options, said) in [
        ("-i sppm --aov direct", "auto, path, bdpt, vcm"),
        ("-i path --samples 0..1 --spp 2 --aov groups", "all samples"),
        ("-i path --samples 0..1 --spp 2 --aov rays", "all samples"),
        ("--replay 1,1,0 --aov rays", "writes no layers"),
    ] {
        let output = run(path, &format!("render scene.toml -o out.exr --size 8x8 {options}"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(said), "{options}: {error}");
        assert!(!path.join("out.exr").exists());
    }
}

#[test]
fn costs_are_layers_and_heat_maps() {
    let folder = folder();
    let path = folder.path();
    let base = "render scene.toml -i path --size 32x24 --spp 4 -q --aov rays,path_length,nodes,tests";
    done(path, &format!("{base} -o a.png --threads 1 --stats a.json"));
    done(path, &format!("{base} -o b.png --threads 3"));
    done(path, &format!("{base} -o kd.png --accel kd"));
    assert!(fs::read(path.join("a.layers.exr")).unwrap() == fs::read(path.join("b.layers.exr")).unwrap());
    let (bvh, kd) = (opened(path, "a.layers.exr"), opened(path, "kd.layers.exr"));
    for same in ["rays.mean", "path_length.mean"] {
        assert_eq!(bvh.channel(same).unwrap(), kd.channel(same).unwrap(), "{same}");
    }
    assert_ne!(bvh.channel("nodes.mean"), kd.channel("nodes.mean"));
    // All rays of the picture are in the layer, and nothing else.
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(path.join("a.json")).unwrap()).unwrap();
    let rays: f64 = bvh.channel("rays.mean").unwrap().iter().map(|&mean| f64::from(mean) * 4.0).sum();
    assert_eq!(Some(rays.round() as u64), stats["rays"].as_u64(), "{stats}");

    done(path, "convert a.layers.exr -o rays.png --heat-map rays -q");
    done(path, "convert a.layers.exr -o scaled.png --heat-map rays.mean --heat-max 1000 -q");
    let brightest = |name: &str| {
        let colours = opened(path, name).to_rgb().unwrap();
        colours.iter().map(|colour| colour.luminance()).fold(0.0, f32::max)
    };
    assert!(brightest("rays.png") > 0.9, "the maximum is pale yellow");
    assert!(brightest("scaled.png") < 0.1, "of 1000 it is little");
    for (options, status, said) in [
        ("a.layers.exr -o x.png --heat-map rayz", 2, "did you mean 'rays'?"),
        ("a.layers.exr -o x.png --heat-map rays.men", 2, "did you mean 'rays.mean'?"),
        ("a.layers.exr -o x.png --heat-map rays --heat-max 0", 2, "larger than 0"),
        ("scene.toml -o x.obj --heat-map rays", 2, "of a picture"),
    ] {
        let output = run(path, &format!("convert {options}"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(status) && error.contains(said), "{options}: {error}");
    }
}

#[test]
fn a_replayed_sample_is_drawn_into_the_picture() {
    let folder = folder();
    let path = folder.path();
    let base = "render scene.toml -i path --size 64x48 --spp 4 -q";
    let words = done(path, &format!("{base} --replay 32,20,0"));
    assert!(words.contains("pixel 32,20 sample 0") && words.contains("radiance"), "{words}");
    assert_eq!(fs::read_dir(path).unwrap().count(), 1, "without a name there is no picture");
    done(path, &format!("{base} -o plain.png"));
    assert_eq!(done(path, &format!("{base} --replay 32,20,0 -o drawn.png")), words);
    let (plain, drawn) = (opened(path, "plain.png"), opened(path, "drawn.png"));
    let (plain, drawn) = (plain.to_rgb().unwrap(), drawn.to_rgb().unwrap());
    let changed = plain.iter().zip(&drawn).filter(|(a, b)| a != b).count();
    assert!((20..1500).contains(&changed), "{changed} pixels of 3072 are drawn on");
    // In a crop it is where it was in the whole.
    done(path, &format!("{base} --replay 32,20,0 --crop 16,8,32,24 -o part.png"));
    let part = opened(path, "part.png").to_rgb().unwrap();
    let same = (0..32 * 24).filter(|i| part[*i] == drawn[(8 + i / 32) * 64 + 16 + i % 32]).count();
    assert!(same > 32 * 24 * 9 / 10, "{same} pixels of {}", 32 * 24);
    let output = run(path, &format!("{base} --replay 99,0,0 -o wrong.png"));
    assert!(output.status.code() == Some(2) && !path.join("wrong.png").exists());
    assert_eq!(run(path, "render scene.toml").status.code(), Some(2), "without --replay a name is needed");
}

#[test]
fn crops_have_their_place_in_the_whole() {
    let folder = folder();
    let path = folder.path();
    let base = "render scene.toml -i path --size 32x24 --spp 2 -q --aov depth";
    done(path, &format!("{base} -o whole.exr"));
    done(path, &format!("{base} -o part.exr --crop 9,5,16,18"));
    let (whole, part) = (opened(path, "whole.exr"), opened(path, "part.exr"));
    assert_eq!((part.width(), part.height()), (32, 24), "as compositors show it");
    for (i, (a, b)) in whole.to_rgb().unwrap().into_iter().zip(part.to_rgb().unwrap()).enumerate() {
        let is_within = (9..25).contains(&(i % 32)) && (5..23).contains(&(i / 32));
        assert!(if is_within { a == b } else { b.max_channel() == 0.0 }, "pixel {i}");
    }
    // Converted, it stays what it is; compared, it lies over the whole.
    done(path, "convert part.exr -o part.png -q");
    assert_eq!((opened(path, "part.png").width(), opened(path, "part.png").height()), (16, 18));
    done(path, "convert part.exr -o again.exr -q");
    assert_eq!(opened(path, "again.exr").to_rgb(), part.to_rgb());
    done(path, "compare part.exr again.exr --max-error 0");
    assert_eq!(run(path, "compare part.exr whole.exr --max-error 0").status.code(), Some(1));
}

#[test]
fn folders_are_compared_in_pairs() {
    let folder = folder();
    let path = folder.path();
    for (name, seed) in [("new", 1), ("old", 2)] {
        fs::create_dir(path.join(name)).unwrap();
        done(
            path,
            &format!("render scene.toml -o {name}/noisy.png --size 24x16 --spp 1 -i path -q --seed {seed}"),
        );
        done(path, &format!("render scene.toml -o {name}/same.png --size 24x16 --spp 1 -i path -q"));
    }
    fs::write(path.join("new/notes.txt"), "no picture").unwrap();
    let table = done(path, "compare new old");
    let rows: Vec<&str> = table.lines().map(|line| line.split_whitespace().next().unwrap()).collect();
    assert_eq!(rows, ["picture", "noisy.png", "same.png"], "the worst first");
    assert_eq!(run(path, "compare new old --max-flip 0.0001").status.code(), Some(1));
    let json = String::from_utf8(run(path, "compare new old --json").stdout).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        (json["pairs"][1]["name"].as_str(), json["pairs"][1]["max"].as_f64()),
        (Some("same.png"), Some(0.0))
    );

    fs::copy(path.join("new/same.png"), path.join("new/<b>&.png")).unwrap();
    let output = run(path, "compare new old --html page.html");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.code() == Some(2) && error.contains("<b>&.png: there is no such picture"),
        "{error}"
    );
    let page = fs::read_to_string(path.join("page.html")).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 6);
    assert!(page.contains("&lt;b&gt;&amp;.png") && !page.contains("<b>&"), "names of strangers stay text");

    fs::create_dir(path.join("empty")).unwrap();
    for wrong in ["new empty", "new new/same.png", "new old --heat-map heat.png"] {
        assert_eq!(run(path, &format!("compare {wrong}")).status.code(), Some(2), "{wrong}");
    }
}

#[test]
fn scenes_are_explained() {
    let folder = folder();
    let path = folder.path();
    let text = done(path, "explain scene.toml --set size=32x24");
    assert!(text.contains("What auto found") && text.contains("it renders with '"), "{text}");
    let json: serde_json::Value =
        serde_json::from_str(&done(path, "explain scene.toml --set size=32x24 --json")).unwrap();
    assert_eq!(json["measures"]["lights"], 2);
    assert!(json["choice"]["candidates"].as_array().unwrap().len() > 4);
    let dark = "[[model]]\nshape = \"sphere\"\n";
    fs::write(path.join("dark.toml"), dark).unwrap();
    let text = done(path, "explain dark.toml --set size=32x24 --set integrator=path");
    assert!(text.contains("the integrator is 'path'"), "{text}");
}

/// A matt floor under 683 lx from the zenith shows 1,000 of a scale up to that with its colour, in both units, and the scale below.
#[test]
fn heat_maps_have_photometric_units_and_a_scale() {
    let folder = folder();
    let path = folder.path();
    let scene = "[camera]\nkind = \"orthographic\"\nposition = [0, 1, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, 1]\nheight = 0.1\n\
                 [[material]]\nname = \"grey\"\nkind = \"diffuse\"\nreflectance = [0.25, 0.5, 0.75]\n[[model]]\nshape = \"floor\"\nmaterial = \"grey\"\n\
                 [[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nirradiance = \"500 lx\"\n";
    fs::write(path.join("lit.toml"), scene).unwrap();
    done(path, "render lit.toml -i path -o lit.exr --size 120x20 --spp 1 -q --aov albedo --denoise=off");
    let ramp = |share: f32| bilux::pictures::metrics::ramp(share).to_array();
    let luminance = 500.0 / std::f32::consts::PI * (0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722 * 0.75);
    for (unit, most, shown) in [("lx", 1000.0, 500.0), ("cd/m2", 100.0, luminance), ("lx", 2000.0, 500.0)] {
        done(
            path,
            &format!("convert lit.exr -o map.png --heat-map luminance --unit {unit} --heat-max {most} -q"),
        );
        let map = opened(path, "map.png");
        assert_eq!((map.width(), map.height()), (120, 20 + 10 + 9), "{unit}");
        let found = map.rgb(60, 10).to_array();
        let near = |wanted: [f32; 3]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.006);
        assert!(near(ramp(shown / most)), "{unit}: {found:?} for {:?}", ramp(shown / most));
        // Planted bugs: without the lumens of a watt, and without π.
        assert!(!near(ramp(shown / most / 683.0)) && !near(ramp(shown / most / std::f32::consts::PI)));
        let end = map.rgb(119, 25).to_array();
        assert!(end.iter().zip(ramp(1.0)).all(|(a, b)| (a - b).abs() < 0.006), "{end:?}");
        assert!((0..120).any(|x| map.rgb(x, 34).r > 0.9), "numbers below the scale");
    }
    let said = run(path, "convert lit.exr -o map.png --heat-map luminance --unit lx");
    assert!(String::from_utf8_lossy(&said.stderr).contains("pale yellow is 500 and more"), "{said:?}");
    // A meter below the same light needs no albedo, and no surface.
    let [eye, meter] = [
        "orthographic\"\nposition = [0, 1, 0]\nlook_at = [0, 0, 0]",
        "irradiance\"\nposition = [0, 0.5, 0]\nlook_at = [0, 1, 0]",
    ];
    fs::write(path.join("meter.toml"), scene.replace(eye, meter)).unwrap();
    done(path, "render meter.toml -o meter.exr --size 8x8 --spp 1 -q --denoise=off");
    let said = run(path, "convert meter.exr -o map.png --heat-map luminance --unit lx");
    assert!(String::from_utf8_lossy(&said.stderr).contains("pale yellow is 500 and more"), "{said:?}");
    done(path, "render lit.toml -i path -o bare.exr --size 8x8 --spp 1 -q --denoise=off");
    for (options, said) in [
        ("lit.exr -o x.png --heat-map luminance --unit lumen", "possible values: cd/m2, lx"),
        ("lit.exr -o x.png --unit lx", "--heat-map"),
        ("lit.exr -o x.png --heat-map albedo --unit lx", "only luminance has photometric units"),
        ("map.png -o x.png --heat-map luminance --unit cd/m2", "a picture for displays"),
        ("bare.exr -o x.png --heat-map luminance --unit lx", "--aov albedo"),
    ] {
        let output = run(path, &format!("convert {options}"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(said), "{options}: {error}");
    }
}

/// In cd/m², 683 times the luminance of the channels' light and of its errors, which add up; the mean has those of all pixels.
#[test]
fn values_of_a_plan_have_the_errors_of_their_own_pixels() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let light = [[2.0, 1.0, 4.0], [0.3; 3], [1.0; 3]];
    let errors = [[0.2, 0.1, 0.4], [0.01; 3], [0.03; 3]];
    let mut plan = Picture::from_rgb(3, 1, light.map(bilux::math::Rgb::from_array).to_vec()).unwrap();
    for (channel, name) in ["R", "G", "B"].iter().enumerate() {
        let variances = errors.map(|error: [f32; 3]| error[channel] * error[channel]).to_vec();
        plan.push_channel(format!("variance.{name}"), variances).unwrap();
    }
    bilux::pictures::write(path.join("plan.exr"), &plan, &WriteOptions::default()).unwrap();
    let said = run(path, "convert plan.exr -o plan.csv --heat-map luminance --unit cd/m2");
    let said = String::from_utf8_lossy(&said.stderr).into_owned();
    // 683 (0.2126 · 2 + 0.7152 · 1 + 0.0722 · 4) = 976.1, and a tenth of that.
    for wanted in ["Lm 621 ± 33 cd/m2", "Lmin 205 ± 6.8 cd/m2", "Lmax 976 ± 98 cd/m2"] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
}

/// Two point lamps of Φ/4π candela above a meter: in each pixel I cos³ / h², with the mean, the minimum and the uniformity of these.
#[test]
fn a_plan_of_lamps_adds_up_and_is_a_table() {
    let folder = folder();
    let path = folder.path();
    let lamps = [([-1.0, 2.6, 0.3], 1500.0), ([1.4, 2.4, -0.5], 900.0)];
    let light = |(p, lumens): &([f64; 3], f64)| {
        format!("[[light]]\nkind = \"point\"\nposition = {p:?}\nintensity = \"{lumens} lm\"\n")
    };
    let meter = "[[camera]]\nkind = \"irradiance\"\nposition = [0, 0.8, 0]\nlook_at = [0, 2, 0]\nup = [0, 0, -1]\nheight = 4\n\
                 [[model]]\nshape = \"floor\"\nside = 10\n";
    fs::write(path.join("meter.toml"), meter.to_owned() + &lamps.iter().map(light).collect::<String>())
        .unwrap();
    done(path, "render meter.toml -o plan.exr --size 24x16 --spp 64 -i path -q --denoise=off --aov variance");
    let at = |x: f64, z: f64| -> f64 {
        let of = |([px, py, pz], lumens): &([f64; 3], f64)| {
            let (height, away) = (py - 0.8, (px - x) * (px - x) + (pz - z) * (pz - z));
            let far2 = away + height * height;
            lumens / (4.0 * std::f64::consts::PI) * height / (far2 * far2.sqrt())
        };
        lamps.iter().map(of).sum()
    };
    let middle = |i: usize| at((i % 24) as f64 * 0.25 - 2.875, (i / 24) as f64 * 0.25 - 1.875);
    let all: Vec<f64> = (0..24 * 16).map(middle).collect();
    let (mean, least) = (all.iter().sum::<f64>() / 384.0, all.iter().copied().fold(f64::INFINITY, f64::min));
    let most = all.iter().copied().fold(0.0, f64::max);
    done(path, "convert plan.exr -o plan.csv --heat-map luminance --unit lx -q");
    let table = fs::read_to_string(path.join("plan.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        table.lines().map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
    assert!(rows.len() == 16 && rows.iter().all(|row| row.len() == 24));
    for (found, expected) in rows.iter().flatten().zip(&all) {
        assert!((found / expected - 1.0).abs() < 0.02, "{found} for {expected}");
    }
    let mut errors = Vec::new();
    for (factor, more) in [(1.0, ""), (0.25, " --maintenance-factor 0.25")] {
        let said = run(
            path,
            &format!("convert plan.exr -o plan.png --heat-map luminance --unit lx --contours 20,30{more}"),
        );
        let text = String::from_utf8_lossy(&said.stderr).into_owned();
        let number = |name: &str| -> f64 {
            let (_, rest) = text.split_once(&format!("{name} ")).unwrap_or_else(|| panic!("{name}: {text}"));
            rest.split([' ', ',', ';', '\n']).next().unwrap().parse().unwrap()
        };
        for (name, expected) in
            [("Em", factor * mean), ("Emin", factor * least), ("Emax", factor * most), ("U0", least / mean)]
        {
            assert!((number(name) / expected - 1.0).abs() < 0.02, "{name} is {expected}: {text}");
        }
        assert!(text.contains("maintenance") == (factor != 1.0), "{text}");
        let error = |name: &str| -> f64 {
            let (_, rest) = text.split_once(&format!("{name} ")).unwrap();
            let (_, rest) = rest.split_once("± ").unwrap_or_else(|| panic!("{name}: {text}"));
            rest.split(' ').next().unwrap().parse().unwrap()
        };
        errors.push(["Em", "Emax"].map(error));
    }
    // Errors are of what is shown, and the mean of 384 pixels has a smaller one than any of them.
    for (bare, maintained) in errors[0].iter().zip(&errors[1]) {
        assert!((maintained / bare / 0.25 - 1.0).abs() < 0.15, "{errors:?}");
    }
    assert!(errors[0][0] > 0.0 && errors[0][0] < errors[0][1] / 3.0, "{errors:?}");
    // The lines are where the picture without them has neighbours on both sides.
    done(path, "convert plan.exr -o bare.png --heat-map luminance --unit lx -q");
    done(path, "convert plan.exr -o lines.png --heat-map luminance --unit lx -q --contours 20,30");
    let (bare, lines) = (opened(path, "bare.png"), opened(path, "lines.png"));
    for i in 0..24 * 16 {
        let (x, y) = (i % 24, i / 24);
        let crosses = |j: usize| [20.0, 30.0].iter().any(|level| (all[i] < *level) != (all[j] < *level));
        let near = |j: usize| [20.0, 30.0].iter().any(|level| (all[j] / level - 1.0).abs() < 0.02);
        let beside: Vec<usize> =
            [(x < 23).then_some(i + 1), (y < 15).then_some(i + 24)].into_iter().flatten().collect();
        if !near(i) && !beside.iter().any(|j| near(*j)) {
            let is_drawn = bare.rgb(x, y) != lines.rgb(x, y);
            assert_eq!(is_drawn, beside.iter().any(|j| crosses(*j)), "{x}, {y}");
        }
    }
    for wrong in ["--maintenance-factor 1.2", "--maintenance-factor 0", "--contours 0"] {
        let output = run(path, &format!("convert plan.exr -o x.png --heat-map luminance --unit lx {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
}
