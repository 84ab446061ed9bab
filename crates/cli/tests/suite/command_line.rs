//! The command line as users see it: exit statuses, messages, and the same bytes whatever the options that must not
//! change them.
#![allow(clippy::print_stderr, reason = "a test that skips says so")]

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn bilux(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder).arg("--quiet");
    command
}

/// A folder with a file of two teapots.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let generate = ["generate", "teapots", "--count", "2", "--set", "tessellation=3", "-o", "pots.asc"];
    bilux(folder.path()).args(generate).assert().success().stdout("");
    folder
}

fn render(folder: &Path, output: &str, more: &[&str]) -> Vec<u8> {
    let always = ["render", "pots.asc", "--size", "48x32", "-o", output];
    bilux(folder).args(always).args(more).assert().success().stdout("");
    std::fs::read(folder.join(output)).unwrap()
}

#[test]
fn one_picture_for_any_threads_and_any_accelerator() {
    let folder = folder();
    for integrator in ["cast", "whitted", "cook", "path"] {
        let base = ["-i", integrator, "--spp", "2", "--max-depth", "4"];
        let with = |more: &[&str]| render(folder.path(), "picture.pfm", &[&base, more].concat());
        let reference = with(&["--threads", "1"]);
        for threads in ["2", "7"] {
            assert!(with(&["--threads", threads]) == reference, "{integrator}, {threads} threads");
        }
        for row in bilux::accel::ACCELERATORS {
            assert!(with(&["--accel", row.entry.name]) == reference, "{integrator}, {}", row.entry.name);
        }
        for cpu in ["cpu=baseline", "cpu=sse4.2", "cpu=avx2", "cpu=avx512"] {
            let more = ["--accel", "brute-simd", "--set", cpu];
            assert!(with(&more) == reference, "{integrator}, {cpu}");
        }
        for option in ["bsp_split=fuchs", "bsp_group=objects", "early_out=false"] {
            let more = ["--accel", "bsp", "--set", option];
            assert!(with(&more) == reference, "{integrator}, {option}");
        }
    }
}

#[test]
fn partial_renders_merge_in_any_order() {
    let folder = folder();
    let path = folder.path();
    let settings = ["-i", "path", "--spp", "6"];
    let with = |output: &str, more: &[&str]| render(path, output, &[&settings, more].concat());
    with("a.exr", &["--samples", "0..1"]);
    with("b.exr", &["--samples", "1..4", "--crop", "0,0,20,32"]);
    with("c.exr", &["--samples", "1..4", "--crop", "20,0,28,32"]);
    with("d.exr", &["--samples", "4..6"]);
    let whole = with("whole.pfm", &[]);
    for order in [["a.exr", "b.exr", "c.exr", "d.exr"], ["c.exr", "d.exr", "a.exr", "b.exr"]] {
        bilux(path).arg("merge").args(order).args(["-o", "joined.pfm"]).assert().success();
        assert!(std::fs::read(path.join("joined.pfm")).unwrap() == whole, "{order:?}");
    }
    // The same samples twice would count double.
    let twice = bilux(path).args(["merge", "a.exr", "a.exr", "-o", "twice.pfm"]).assert().code(1);
    assert!(!path.join("twice.pfm").exists() && !twice.get_output().stderr.is_empty());
    // Another seed makes another picture.
    with("other.exr", &["--samples", "0..1", "--seed", "9"]);
    bilux(path).args(["merge", "other.exr", "d.exr", "-o", "mixed.pfm"]).assert().code(1);
}

#[test]
fn merged_layers_equal_those_of_the_whole() {
    let folder = folder();
    let path = folder.path();
    let settings = ["-i", "path", "--spp", "8", "--aov", "albedo,normal,depth,ids,variance"];
    let with = |output: &str, more: &[&str]| render(path, output, &[&settings, more].concat());
    with("a.exr", &["--crop", "0,0,20,32"]);
    with("b.exr", &["--samples", "0..4", "--crop", "20,0,28,32"]);
    with("c.exr", &["--samples", "4..8", "--crop", "20,0,28,32"]);
    with("whole.exr", &[]);
    bilux(path).args(["merge", "a.exr", "b.exr", "c.exr", "-o", "joined.exr"]).assert().success();
    let read = |name: &str| bilux::pictures::read(path.join(name)).unwrap();
    let (whole, joined) = (read("whole.exr"), read("joined.exr"));
    for name in ["albedo.G", "normal.Y", "depth.Z"] {
        assert_eq!(joined.channel(name).unwrap(), whole.channel(name).unwrap(), "{name}");
    }
    assert_eq!(joined.integer_plane("id.object").unwrap(), whole.integer_plane("id.object").unwrap());
    // Each half of the samples has its own estimate of the variance: the two agree in the mean, and exactly where there
    // is only one part.
    let of = |picture: &bilux::pictures::Picture, columns: std::ops::Range<usize>| -> f64 {
        let plane = picture.channel("variance.G").unwrap();
        let rows = plane.chunks(picture.width()).flat_map(|row| &row[columns.clone()]);
        rows.map(|&v| f64::from(v)).sum()
    };
    assert_eq!(of(&joined, 0..20), of(&whole, 0..20));
    let ratio = of(&joined, 20..48) / of(&whole, 20..48);
    assert!((0.5..2.0).contains(&ratio), "{ratio}");
}

#[test]
fn merged_parts_are_shown_as_the_whole_is() {
    let folder = folder();
    let path = folder.path();
    for look in ["--exposure auto", "--exposure=-1 --tonemap agx", "--background transparent --ground shadow"]
    {
        let look: Vec<&str> = look.split(' ').chain(["--spp", "3"]).collect();
        let with = |output: &str, more: &[&str]| render(path, output, &[&look, more].concat());
        let whole = with("whole.png", &[]);
        with("a.exr", &["--samples", "0..1"]);
        with("b.exr", &["--samples", "1..3"]);
        // What was merged once can be merged again.
        bilux(path).args(["merge", "b.exr", "a.exr", "-o", "sums.exr"]).assert().success();
        bilux(path).args(["merge", "sums.exr", "-o", "joined.png"]).assert().success();
        assert!(std::fs::read(path.join("joined.png")).unwrap() == whole, "{look:?}");
        assert!(render(path, "plain.png", &["--spp", "3"]) != whole, "{look:?} is not seen");
    }
}

#[test]
fn each_strategy_has_its_pictures_and_its_place_on_a_sheet() {
    let folder = folder();
    let path = folder.path();
    let settings = ["-i", "bdpt", "--spp", "2", "--max-depth", "2"];
    let alone = render(path, "pots.png", &settings);
    let beside = render(path, "pots.png", &[&settings[..], &["--aov", "strategies"]].concat());
    assert!(alone == beside, "the picture is another with --aov");
    let made = path.join("pots.strategies");
    let names = |end: &str| {
        let all =
            std::fs::read_dir(&made).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
        all.filter(|name| name.ends_with(end)).count()
    };
    assert!(names("-unweighted.exr") > 3 && names(".exr") == 2 * names("-unweighted.exr"));
    for sheet in ["weighted.png", "unweighted.png"] {
        let sheet = bilux::pictures::formats::read(made.join(sheet)).unwrap();
        assert!(
            sheet.width() >= 3 * 48 && sheet.height() >= 2 * 32,
            "{} x {}",
            sheet.width(),
            sheet.height()
        );
    }
    let with = |more: &[&str]| failing(path, 2, &[&["render", "pots.asc", "--spp", "1"], more].concat());
    let said = with(&["-i", "bdpt", "--aov", "strategy", "-o", "a.png"]);
    assert!(said.contains("'strategies'"), "{said}");
    let said = with(&["-i", "path", "--aov", "strategies", "-o", "a.png"]);
    assert!(said.contains("bdpt, vcm") && !path.join("a.png").exists(), "{said}");
    with(&["-i", "bdpt", "--aov", "strategies", "-o", "-"]);
}

#[test]
fn an_interval_is_written_next_to_the_picture() {
    let folder = folder();
    let path = folder.path();
    render(path, "pots.exr", &["--noise", "0.5", "--aov", "interval", "--stats", "took.json"]);
    let interval = bilux::pictures::formats::read(path.join("pots.interval.exr")).unwrap();
    assert_eq!((interval.width(), interval.height()), (48, 32));
    let half_widths = interval.channel("luminance").unwrap();
    assert!(half_widths.iter().all(|x| x.is_finite()) && half_widths.iter().any(|&x| x > 0.0));
    assert_eq!(interval.metadata["bilux.interval.confidence"], "0.95");
    let picture = bilux::pictures::formats::read(path.join("pots.exr")).unwrap();
    assert_eq!(picture.metadata["bilux.noise.noise_samples"], "in the mean");
    let stats = std::fs::read_to_string(path.join("took.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
    assert!(stats["reached"]["bias_at_most"].as_f64().unwrap() <= 0.125);
    let said = failing(path, 2, &["render", "pots.asc", "-i", "cast", "--aov", "interval", "-o", "a.png"]);
    assert!(said.contains("no confidence interval") && !path.join("a.png").exists(), "{said}");
}

/// Runs a command that must fail and returns what it prints.
fn failing(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let assert = bilux(folder).args(arguments).assert().code(code).stdout("");
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

#[test]
fn wrong_command_lines_exit_with_2_and_help() {
    let folder = folder();
    let say = |arguments: &[&str]| failing(folder.path(), 2, arguments);
    assert!(say(&["render", "pots.asc", "-i", "whited", "-o", "a.png"]).contains("did you mean 'whitted'?"));
    assert!(say(&["render", "pots.asc", "--accel", "bhv", "-o", "a.png"]).contains("did you mean 'bvh'?"));
    assert!(say(&["render", "pots.asc", "--set", "max_dept=3", "-o", "a.png"]).contains("'max_depth'"));
    assert!(say(&["render", "pots.asc", "--preset", "cours", "-o", "a.png"]).contains("'course'"));
    assert!(say(&["render", "pots.asc", "-o", "nowhere/a.png"]).contains("no folder"));
    assert!(say(&["render", "pots.asc", "-o", "a.pgn"]).contains("png"));
    assert!(say(&["render", "pots.asc", "--size", "5", "-o", "a.png"]).contains("write 5x5"));
    let crop = ["render", "pots.asc", "--crop", "40,0,20,10", "--size", "48x32", "-o", "a.png"];
    assert!(say(&crop).contains("--crop 40,0,20,10"));
    assert!(say(&["render", "pots.asc", "--samples", "0..1", "-o", "a.png"]).contains(".exr"));
    assert!(say(&["list", "material"]).contains("did you mean 'materials'?"));
    assert!(say(&["rendr", "pots.asc"]).contains("render"));
}

#[test]
fn the_help_of_bench_names_every_row_of_speed() {
    let assert = bilux(folder().path()).args(["bench", "speed", "--help"]).assert().code(0);
    let help = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    let rows = help.split("The rows to measure:").nth(1).and_then(|rest| rest.split('[').next()).unwrap();
    let rows: Vec<&str> =
        rows.split([',', ' ', '\n']).filter(|word| !word.is_empty() && *word != "and").collect();
    let names: Vec<&str> = bilux_bench::speed::MEASUREMENTS.iter().map(|m| m.name).collect();
    assert_eq!(rows, names, "{help}");
}

/// The names of the options of a benchmark that its help describes, other than those of every command.
fn options_of_bench(kind: &str) -> Vec<String> {
    let folder = folder();
    let assert = bilux(folder.path()).args(["bench", kind, "--help"]).assert().code(0);
    let help = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    let names = help.lines().filter_map(|line| {
        let option = line.trim_start();
        // What it means is indented further.
        let is_option = option.starts_with('-') && line.len() - option.len() < 8;
        let (_, rest) = option.split_once("--").filter(|_| is_option)?;
        rest.split([' ', '<', '.']).next().map(str::to_owned)
    });
    let common = "json quiet verbose progress help max-memory strict allow-outside sandbox";
    names.filter(|name| !common.split(' ').any(|common| common == name)).collect()
}

/// The help of a benchmark is about that benchmark, and what it would not heed is refused.
#[test]
fn each_benchmark_has_its_own_help_and_takes_no_other_options() {
    let sorted = |words: &str| {
        let mut words: Vec<String> = words.split(' ').map(str::to_owned).collect();
        words.sort();
        words
    };
    for (kind, options) in [
        ("render", "scenes integrators seconds reference-seconds seeds threads report make-references"),
        ("rays", "accel rays rounds against dump mesh hits"),
        ("paper", "size output"),
        ("load", "repeats"),
    ] {
        let mut described = options_of_bench(kind);
        described.sort();
        assert_eq!(described, sorted(options), "{kind}");
    }
    let folder = folder();
    let said = failing(folder.path(), 2, &["bench", "load", "--seeds", "3"]);
    assert!(said.contains("unexpected argument '--seeds'"), "{said}");
    // Options of every command and benchmark may stand before its name and behind it.
    let sizes = [["--json", "paper", "--size"], ["paper", "--json", "--size"]];
    for [first, second, third] in sizes {
        let said = failing(folder.path(), 2, &["bench", first, second, third, "5"]);
        assert!(said.contains("write 5x5"), "{said}");
    }
}

#[test]
fn work_that_fails_exits_with_1_and_leaves_no_file() {
    let folder = folder();
    let path = folder.path();
    assert!(failing(path, 1, &["render", "none.asc", "-o", "a.png"]).contains("none.asc"));
    std::fs::write(path.join("broken.asc"), "triangle\n0 0 0 0 0 1 0 0\n1 0 zero").unwrap();
    assert!(failing(path, 1, &["render", "broken.asc", "-o", "a.png"]).contains("broken.asc:3"));
    std::fs::write(path.join("empty.obj"), "").unwrap();
    failing(path, 1, &["render", "empty.obj", "-o", "a.png"]);
    assert!(!path.join("a.png").exists());
}

#[test]
fn compare_reports_by_its_exit_status() {
    let folder = folder();
    let path = folder.path();
    render(path, "a.png", &["-i", "whitted"]);
    render(path, "b.png", &["-i", "cast"]);
    let same = bilux(path).args(["compare", "a.png", "a.png", "--json", "--max-flip", "0"]).assert().code(0);
    let json: serde_json::Value = serde_json::from_slice(&same.get_output().stdout).unwrap();
    assert_eq!((json["rmse"].as_f64(), json["flip"].as_f64()), (Some(0.0), Some(0.0)));
    assert!(json["psnr"].is_null());
    let differ = ["compare", "a.png", "b.png", "--max-flip", "0", "--heat-map", "heat.png"];
    bilux(path).args(differ).assert().code(1);
    assert!(path.join("heat.png").exists());
    bilux(path).args(["compare", "a.png", "none.png"]).assert().code(2);
}

#[test]
fn an_interrupt_saves_what_there_is() {
    let folder = folder();
    let path = folder.path();
    let binary = assert_cmd::cargo::cargo_bin("bilux");
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        // Before the first sample there is nothing to save: a loaded machine needs longer for it.
        for seconds in [1.5, 6.0, 20.0] {
            let mut child = std::process::Command::new(&binary)
                .current_dir(path)
                .args(["render", "pots.asc", "--spp", "100000", "--quiet", "-o", "cut.png"])
                .spawn()
                .unwrap();
            std::thread::sleep(std::time::Duration::from_secs_f64(seconds));
            let id = child.id().to_string();
            assert!(std::process::Command::new("kill").args([signal, &id]).status().unwrap().success());
            assert_eq!(child.wait().unwrap().code(), Some(status));
            if path.join("cut.png").exists() {
                break;
            }
        }
        assert!(bilux::pictures::read(path.join("cut.png")).is_ok(), "{signal}");
        std::fs::remove_file(path.join("cut.png")).unwrap();
    }
}

#[test]
fn everything_that_can_be_listed_is_listed() {
    let folder = folder();
    let lists = "integrators accels visibility materials bsdfs lights cameras generators presets formats \
                 picture-formats tonemaps filters metrics settings";
    for what in lists.split_whitespace() {
        let assert = bilux(folder.path()).args(["list", what, "--json"]).assert().success();
        let json: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
        let rows = json[what].as_array().unwrap();
        assert!(!rows.is_empty() && rows.iter().all(|row| !row["summary"].as_str().unwrap().is_empty()));
    }
}

#[test]
fn copies_stand_at_their_offsets_and_conversion_loses_nothing() {
    let folder = folder();
    let path: PathBuf = folder.path().to_owned();
    let run = |arguments: &[&str]| bilux(&path).args(arguments).assert().success();
    std::fs::write(path.join("one.asc"), "triangle\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n")
        .unwrap();
    run(&[
        "generate",
        "teapots",
        "--from",
        "one.asc",
        "--count",
        "3",
        "--offset",
        "4,0,-0.1",
        "-o",
        "three.asc",
    ]);
    let info = run(&["info", "three.asc", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&info.get_output().stdout).unwrap();
    assert_eq!(json["triangles"], 3);
    assert_eq!(json["bounds"]["max"][0], 9.0);
    // Nine vertices with a position, a normal and texture coordinates, and the triangles' indices.
    assert_eq!(json["memory"]["meshes"], 9 * (12 + 12 + 8) + 3 * 12);
    assert_eq!(json["memory"]["textures"], 0);
    run(&["convert", "three.asc", "-o", "three.obj"]);
    run(&["convert", "three.obj", "-o", "again.asc"]);
    run(&["convert", "again.asc", "-o", "again.obj"]);
    let read = |name: &str| std::fs::read(path.join(name)).unwrap();
    assert!(read("again.obj") == read("three.obj"));
}

/// Each mesh has what the others lack.
#[test]
fn info_says_of_each_mesh_what_it_has() {
    let folder = TempDir::new().unwrap();
    let ply = |names: &str, values: &str, faces: usize| {
        let properties: String = names.split(' ').map(|name| format!("property float {name}\n")).collect();
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{properties}\
             element face {faces}\nproperty list uchar int vertex_indices\nend_header\n0 0 0 {values}\n1 0 0 {values}\n0 1 0 {values}\n{}",
            "3 0 1 2\n".repeat(faces)
        )
    };
    for (name, text, wanted) in [
        ("a.ply", ply("nx ny nz", "0 0 1", 1), "1 0 0 true false false"),
        ("b.ply", ply("s t", "0.25 0.5", 2), "2 0 0 false true false"),
        ("c.ply", ply("red green blue", "0.1 0.2 0.3", 3), "3 0 0 false false true"),
        (
            "d.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\np 1\nl 1 2 3 4\n".to_owned(),
            "0 1 3 false false false",
        ),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let info = bilux(folder.path()).args(["info", name, "--json"]).assert().success();
        let json: serde_json::Value = serde_json::from_slice(&info.get_output().stdout).unwrap();
        let keys = ["triangles", "points", "lines", "normals", "uvs", "vertex_colours"];
        let found = keys.map(|key| json["objects"][0][key].to_string()).join(" ");
        assert_eq!(found, wanted, "{name}: {}", json["objects"]);
    }
}

#[test]
fn read_only_picture_formats_convert_to_png() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    for (format, name) in
        [("tiff", "rgba_lzw.tif"), ("bmp", "runs8.bmp"), ("tga", "rgb_runs.tga"), ("webp", "rgb.webp")]
    {
        let file = corpus.join(format!("picture_{format}")).join(name);
        bilux(path).args(["convert", file.to_str().unwrap(), "-o", "out.png"]).assert().success();
        let [before, after] = [&file, &path.join("out.png")].map(|path| bilux::pictures::read(path).unwrap());
        assert_eq!(before.channels(), after.channels(), "{name}");
    }
}

/// Under uniform light, a board reflects exactly what its texture says at that point.
#[test]
fn procedural_textures_are_rendered() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/patterns.toml");
    let render = ["render", scene.to_str().unwrap(), "--size", "110x110", "--spp", "64", "-o", "out.pfm"];
    bilux(path).args(render).assert().success();
    let picture = bilux::pictures::read(path.join("out.pfm")).unwrap();
    // The picture is 4.4 m and 110 pixels wide; each board begins 0.05 m from the centre.
    let at = |board: [f32; 2], u: f32, v: f32| {
        let pixel = |x: f32| (55.0 + x * 25.0) as usize;
        let [x, y] = [board[0] + 2.0 * u, board[1] + 2.0 * v];
        picture.rgb(pixel(x), 109 - pixel(y)).to_array()
    };
    let close = |got: [f32; 3], wanted: [f32; 3]| {
        let is_near = got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.02 + 0.05 * b);
        assert!(is_near, "{got:?} and not {wanted:?}");
    };
    let [squares, target, floor] = [[-2.05, 0.05], [0.05, 0.05], [0.05, -2.05]];
    close(at(squares, 0.5 / 6.0, 0.5 / 6.0), [0.8, 0.75, 0.6]);
    close(at(squares, 1.5 / 6.0, 0.5 / 6.0), [0.15, 0.05, 0.05]);
    close(at(squares, 1.5 / 6.0, 5.5 / 6.0), [0.8, 0.75, 0.6]);
    // The centre of a pixel; the radius is 0.57 there.
    close(at(target, 0.505, 0.785), [0.447, 0.56, 0.787]);
    close(at(target, 0.02, 0.02), [0.02; 3]);
    let dark = at(floor, 1.5 / 4.0, 0.5 / 4.0);
    assert!(dark.iter().all(|c| *c < 0.15), "{dark:?}");
}

#[test]
fn every_shipped_scene_is_made_read_and_rendered_the_same() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    for row in bilux::gallery::GENERATORS {
        let name = row.entry.name;
        bilux(path).args(["generate", name, "-o", "scene.toml"]).assert().success();
        let render = ["render", "scene.toml", "--size", "24x24", "-i", "whitted", "-o", "read.pfm"];
        bilux(path).args(render).assert().success();
        let direct = bilux::generate(&bilux::scene::Spec::new("", name)).unwrap();
        let mut settings = bilux::scene::Parameters::default();
        settings.set("size", "24x24");
        settings.set("integrator", "whitted");
        let picture = bilux::Job::new(&direct, &settings).unwrap().render(&bilux::Quiet).unwrap();
        let read = bilux::pictures::read(path.join("read.pfm")).unwrap();
        assert!(read.to_rgb() == picture.picture().unwrap().to_rgb(), "{name}");
    }
}

#[test]
fn frames_are_numbered_and_differ_where_things_move() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let generate = ["generate", "teapots", "--count", "2", "--set", "moving=true", "-o", "move.toml"];
    bilux(path).args(generate).assert().success();
    let render = [
        "render",
        "move.toml",
        "--size",
        "32x32",
        "-i",
        "cast",
        "--frames",
        "0-2",
        "-o",
        "{stem}-{frame}.pfm",
    ];
    bilux(path).args(render).args(["--set", "fps=1"]).assert().success();
    let frame = |n: u32| std::fs::read(path.join(format!("move-{n:04}.pfm"))).unwrap();
    assert!(frame(0) != frame(1) && frame(1) != frame(2));
    let again = ["render", "move.toml", "--size", "32x32", "-i", "cast", "--at", "2", "-o", "at.pfm"];
    bilux(path).args(again).assert().success();
    assert!(std::fs::read(path.join("at.pfm")).unwrap() == frame(2));
}

#[test]
fn one_broken_scene_does_not_stop_the_others() {
    let folder = folder();
    std::fs::write(folder.path().join("broken.obj"), "v 1 2\nf 1 2 3\n").unwrap();
    let both = ["render", "broken.obj", "pots.asc", "-o", "{stem}.png", "--size", "16x16", "--spp", "1"];
    let output = bilux(folder.path()).args(both).assert().code(1).stdout("");
    let reported = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
    assert!(reported.contains("broken.obj:1") && reported.contains("1 of 2 scenes"), "{reported}");
    assert!(folder.path().join("pots.png").is_file() && !folder.path().join("broken.png").exists());
}

/// Lists every file that the program opens while it renders an untrusted scene.
#[test]
fn in_a_sandbox_nothing_outside_the_folder_is_opened() {
    let folder = folder();
    let inside = folder.path().join("inside");
    std::fs::create_dir(&inside).unwrap();
    let secret = "[[model]]\nfile = \"../pots.asc\"\n[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = \"/etc/passwd\"\n";
    std::fs::write(inside.join("spy.toml"), secret).unwrap();
    let harmless = "[[model]]\nshape = \"sphere\"\n";
    std::fs::write(inside.join("harmless.toml"), harmless).unwrap();
    let options = ["--size", "16x16", "--sandbox", "--time-limit", "0.2"];
    for (scene, works) in [("harmless", true), ("spy", false)] {
        let trace = folder.path().join("trace");
        let binary = assert_cmd::cargo::cargo_bin("bilux");
        // The variables that cargo sets for tests make the loader search more places.
        let strace = std::process::Command::new("strace")
            .env_remove("LD_LIBRARY_PATH")
            // No denoiser, so that `python3`, which would be queried for one, opens no files of its own.
            .env("OIDN_LIB", "nowhere")
            .args(["-f", "-qq", "-e", "trace=open,openat,creat,execve,landlock_restrict_self", "-o"])
            .arg(&trace)
            .arg(&binary)
            .args(["render", &format!("{scene}.toml"), "-o", &format!("{scene}.png")])
            .args(options)
            .current_dir(&inside)
            .output();
        let Ok(run) = strace else {
            eprintln!("skipped: strace is not installed");
            return;
        };
        assert_eq!(run.status.success(), works, "{}", String::from_utf8_lossy(&run.stderr));
        let trace = std::fs::read_to_string(&trace).unwrap();
        // The system's own files: the libraries that the program is linked with, and those that describe cores and
        // memory.
        let systems = ["/lib/", "/lib64/", "/usr/lib", "/etc/ld.so", "/proc/", "/sys/", "/dev/"];
        let name = |line: &str| line.split('"').nth(1).unwrap_or_default().to_owned();
        // Before the scene is read, Bilux looks for a denoiser's library and loads it.
        let names_scene = |line: &str| {
            line.contains("open") && line.contains(&format!("{scene}.toml")) && !line.contains("O_PATH")
        };
        let read_at = trace.lines().position(names_scene).expect("the scene is read");
        let restricted_at = trace.lines().position(|line| line.contains("landlock_restrict_self"));
        let version = bilux(&inside).arg("-V").output().unwrap().stdout;
        let enforced = String::from_utf8_lossy(&version).contains("enforced by the kernel");
        assert!(!enforced || restricted_at.is_some_and(|at| at < read_at), "{scene}: {trace}");
        let lines = trace.lines().skip(restricted_at.unwrap_or(read_at));
        let opened: Vec<String> =
            lines.filter(|l| l.contains("open") || l.contains("creat")).map(name).collect();
        assert!(opened.iter().any(|path| path.ends_with(&format!("{scene}.toml"))), "{opened:?}");
        let here = inside.canonicalize().unwrap();
        let is_inside = |path: &str| {
            !path.contains("..") && (!path.starts_with('/') || Path::new(path).starts_with(&here))
        };
        let outside: Vec<&String> = opened
            .iter()
            .filter(|path| !is_inside(path) && !systems.iter().any(|s| path.starts_with(s)))
            .collect();
        assert!(outside.is_empty(), "{scene}: {outside:?}");
    }
}

#[test]
fn a_picture_of_the_surroundings_lights_a_bare_model() {
    let folder = folder();
    let path = folder.path();
    let always = ["--spp", "4", "-i", "path"];
    render(path, "studio.pfm", &always);
    // Red all around: no other light remains.
    std::fs::write(path.join("red sky.ppm"), b"P6 2 1 255\n\xff\0\0\xff\0\0").unwrap();
    let lit = render(path, "red.pfm", &[&always[..], &["--env", "red sky.ppm"]].concat());
    let picture = bilux::pictures::read(path.join("red.pfm")).unwrap();
    let pixels = picture.to_rgb().unwrap();
    assert!(pixels.iter().all(|p| p.g == 0.0 && p.b == 0.0) && pixels.iter().any(|p| p.r > 0.5));
    assert!(lit != std::fs::read(path.join("studio.pfm")).unwrap());
    let missing = ["render", "pots.asc", "-o", "x.png", "--env", "nowhere.hdr"];
    let reported = bilux(path).args(missing).assert().code(1);
    let reported = String::from_utf8_lossy(&reported.get_output().stderr).into_owned();
    assert!(reported.contains("--env") && reported.contains("nowhere.hdr"), "{reported}");
}

/// A wall with a small, bright light on one side of it.
#[test]
fn all_pictures_of_a_turntable_are_lit_alike() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let scene = "mtllib a.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nv -.1 .9 .6\nv .1 .9 .6\nv 0 1.1 .6\nv 0 1 .7\n\
                 usemtl clay\nf 1 2 3 4\nusemtl light\nf 5 6 8\nf 6 7 8\nf 7 5 8\nf 5 7 6\n";
    std::fs::write(path.join("wall.obj"), scene).unwrap();
    let materials = "newmtl clay\nKd .6 .6 .6\nnewmtl light\nKd .5 .5 .5\nKe 90 90 90\n";
    std::fs::write(path.join("a.mtl"), materials).unwrap();
    let lit_by = |more: &[&str]| {
        let always = ["wall.obj", "-o", "a.png", "--size", "16x16", "--spp", "1", "--up", "y", "-v"];
        let done = bilux(path).arg("render").args(always).args(more).assert().success();
        let said = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
        let decisions = said
            .lines()
            .filter_map(|line| Some(line.split_once(" light it").or(line.split_once(" lights it"))?.0));
        decisions.map(|text| text.rsplit(": ").next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(
        [lit_by(&["--orbit", "0,15"]), lit_by(&["--orbit", "180,15"])].concat(),
        ["only its own lights", "the studio"]
    );
    // What is the same for all pictures is told once.
    assert_eq!(lit_by(&["--turntable", "4"]), ["the studio"]);
}

/// A figure with an arm to its left and a nose in front, written with other axes, looks the same once these are named.
#[test]
fn up_and_front_turn_a_model() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let body = [
        [-0.3f32, 0.0, -0.2],
        [0.3, 0.0, -0.2],
        [0.0, 2.0, 0.0],
        [0.9, 1.2, 0.0],
        [0.0, 1.7, 0.8],
        [0.0, 0.0, 0.6],
    ];
    let write = |name: &str, place: fn([f32; 3]) -> [f32; 3]| {
        let vertices = body.iter().map(|p| {
            let [x, y, z] = place(*p);
            format!("v {x} {y} {z}\n")
        });
        let faces = "f 1 3 2\nf 1 2 6\nf 1 6 3\nf 2 4 3\nf 2 3 6\nf 3 4 5\nf 6 5 3\n";
        std::fs::write(path.join(name), vertices.collect::<String>() + faces).unwrap();
    };
    write("y.obj", |p| p);
    write("z.obj", |[x, y, z]| [x, -z, y]);
    write("x.obj", |[x, y, z]| [y, z, x]);
    let picture = |scene: &str, axes: &[&str]| {
        let mut run = std::process::Command::new(assert_cmd::cargo::cargo_bin("bilux"));
        run.current_dir(path)
            .args(["render", scene, "-o", "a.pfm", "--size", "32x32", "--spp", "4", "-i", "path", "-v"]);
        let output = run.args(axes).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        (bilux::pictures::read(path.join("a.pfm")).unwrap().to_rgb().unwrap(), said)
    };
    let (upright, _) = picture("y.obj", &["--up", "y", "--front", "z"]);
    let apart = |other: &[bilux::math::Rgb]| {
        let sum = upright.iter().zip(other).map(|(a, b)| (a.g - b.g).abs()).sum::<f32>();
        sum / upright.iter().map(|p| p.g).sum::<f32>()
    };
    for (scene, up, front) in [("z.obj", "z", "-y"), ("x.obj", "x", "y")] {
        let (found, said) = picture(scene, &["--up", up, "--front", front]);
        assert!(apart(&found) < 1e-3, "{scene}: {}", apart(&found));
        assert!(said.contains(&format!("up is {up}, front is {front}, as asked")), "{said}");
    }
    // Each axis counts.
    for axes in
        [["--up", "-y", "--front", "z"], ["--up", "y", "--front", "-z"], ["--up", "y", "--front", "x"]]
    {
        assert!(apart(&picture("y.obj", &axes).0) > 0.02, "{axes:?}");
    }
    let reported = failing(path, 2, &["render", "y.obj", "-o", "b.pfm", "--up", "y", "--front", "-y"]);
    assert!(reported.contains("up and front lie on the same axis"), "{reported}");
    let reported = failing(path, 2, &["render", "y.obj", "-o", "b.pfm", "--up", "w"]);
    assert!(reported.contains("-z"), "{reported}");
    assert!(!path.join("b.pfm").exists());
}
