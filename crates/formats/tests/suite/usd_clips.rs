//! Value clips of USD. All values are those that usd-core 26.11 gives for these files.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_scene::SceneBuilder;

/// The model without clips.
const MODEL: &str =
    "def \"m\" { def Sphere \"s\" { double radius = 1 } def Sphere \"t\" { double radius = 3 } }";
/// Two clips, of which the second is the first times ten.
const CLIPS: [&str; 2] = [
    "def \"m\" { def Sphere \"s\" { double radius.timeSamples = { 0: 10, 10: 20 } } }",
    "def \"m\" { def Sphere \"s\" { double radius.timeSamples = { 0: 100, 10: 200 } } }",
];
const TIMES: &str =
    "double2[] active = [(0, 0), (10, 1)] double2[] times = [(0, 0), (10, 10), (10, 0), (20, 5)]";

fn scene(time: f32, root: &str, more: &[(&str, &str)]) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    let own = [("model.usda", MODEL), ("c.0.usda", CLIPS[0]), ("c.1.usda", CLIPS[1])];
    let root = format!("(startTimeCode = 0 endTimeCode = 20 timeCodesPerSecond = 1)\n{root}");
    for (name, text) in own.iter().chain(more).chain([&("root.usda", &*root)]) {
        std::fs::write(folder.path().join(name), format!("#usda 1.0\n{text}")).unwrap();
    }
    read(&folder.path().join("root.usda"), &ReadOptions { time, ..ReadOptions::default() }).unwrap()
}

/// The radii of all balls with a name.
fn radii(scene: &SceneBuilder, name: &str) -> Vec<f32> {
    let named = scene.objects.iter().filter(|object| object.name == name);
    named.map(|object| object.motion.at(0.0).bounds(&object.mesh.bounds()).extent().z / 2.0).collect()
}

/// A model with clips.
fn model(prim: &str, clips: &str, body: &str) -> String {
    format!(
        "def \"{prim}\" (references = @model.usda@</m> clips = {{ dictionary default = {{ {clips} }} }}) {{ {body} }}\n"
    )
}

const LISTED: &str = "asset[] assetPaths = [@c.0.usda@, @c.1.usda@] string primPath = \"/m\"";
const TEMPLATE: &str = "string templateAssetPath = \"./c.#.usda\" string primPath = \"/m\" \
                        double templateStartTime = 0 double templateEndTime = 1 double templateStride = 1";

#[test]
fn clips_take_turns_at_their_own_times() {
    let root = model("m", &format!("{LISTED} {TIMES}"), "");
    for (time, radius) in [(0.0, 10.0), (5.0, 15.0), (9.0, 19.0), (10.0, 100.0), (20.0, 150.0), (25.0, 150.0)]
    {
        let scene = scene(time, &root, &[]);
        assert_eq!(radii(&scene, "s"), [radius], "at {time}");
        assert_eq!((radii(&scene, "t"), warnings(&scene)), (vec![3.0], String::new()));
        assert!(scene.inventory.moves());
    }
    // Where time does not jump, values go to those of the next clip.
    let smooth = "double2[] active = [(0, 0), (4, 1)] double2[] times = [(0, 0), (20, 10)]";
    for (times, radius) in [(smooth, 92.5), ("double2[] active = [(0, 0), (4, 1)]", 107.5)] {
        assert_eq!(
            radii(&scene(3.0, &model("m", &format!("{LISTED} {times}"), ""), &[]), "s"),
            [radius],
            "{times}"
        );
    }
    // Two models that differ only by their clips.
    let late = TIMES.replace("(0, 0), (10, 1)", "(0, 1)");
    let both = root + &model("late", &format!("{LISTED} {late}"), "");
    assert_eq!(radii(&scene(5.0, &both, &[]), "s"), [15.0, 150.0]);
    // A template has a clip for each step, whose times are those of the stage.
    let root = model("m", TEMPLATE, "");
    for (time, radius) in [(0.0, 10.0), (0.5, 60.0), (1.0, 110.0), (7.0, 110.0)] {
        assert_eq!(radii(&scene(time, &root, &[]), "s"), [radius], "at {time}");
    }
}

#[test]
fn clips_are_weaker_than_their_own_layers_and_stronger_than_what_these_bring_in() {
    let clips = format!("{LISTED} {TIMES}");
    let over = model("m", &clips, "over \"s\" { double radius = 7 }");
    assert_eq!(radii(&scene(5.0, &over, &[]), "s"), [7.0]);
    // Clips of a layer below, at its times: 5 here is 3 there.
    let below = model("m", &clips, "");
    let slow = format!("(timeCodesPerSecond = 1)\n{below}");
    let root = "def \"m\" (references = @below.usda@</m> (offset = 2)) {}";
    assert_eq!(radii(&scene(5.0, root, &[("below.usda", &slow)]), "s"), [13.0]);
    let root = "def \"m\" (references = @below.usda@</m>) { over \"s\" { double radius = 8 } }";
    assert_eq!(radii(&scene(5.0, root, &[("below.usda", &below)]), "s"), [8.0]);
    // Only what the manifest has comes from clips; where the clip has no samples of that, the manifest's value counts, or none.
    for (manifest, radius) in [
        ("def \"m\" { def Sphere \"s\" { double radius } }", [15.0, 1.0]),
        ("def \"m\" { def Sphere \"s\" { } def Sphere \"t\" { double radius = 50 } }", [1.0, 50.0]),
    ] {
        let root = model("m", &format!("{clips} asset manifestAssetPath = @manifest.usda@"), "");
        let scene = scene(5.0, &root, &[("manifest.usda", manifest)]);
        let wanted = if radius[1] == 1.0 { [radius[0], 3.0] } else { radius };
        assert_eq!([radii(&scene, "s")[0], radii(&scene, "t")[0]], wanted, "{manifest}");
    }
    let blocked = "def \"m\" { def Sphere \"t\" { double radius } }";
    let root = model("m", &format!("{clips} asset manifestAssetPath = @manifest.usda@"), "");
    assert_eq!(
        radii(&scene(5.0, &root, &[("manifest.usda", blocked)]), "t"),
        [1.0],
        "of spheres that say nothing"
    );
}

#[test]
fn what_a_clip_lacks_comes_from_the_clips_around_it() {
    let clip = |samples: &str| {
        format!("def \"m\" {{ def Sphere \"s\" {{ double radius.timeSamples = {{ {samples} }} }} }}")
    };
    let none = "def \"m\" { def Sphere \"s\" { } }".to_owned();
    let manifest = "def \"m\" { def Sphere \"s\" { double radius } }".to_owned();
    let full = "def \"m\" { def Sphere \"s\" { double radius = 77 } }".to_owned();
    let [early, middle, late] = ["0: 10, 5: 20", "20: 100, 25: 200", "31: 100, 35: 200"].map(clip);
    let paused = [clip("3: 10, 5: 20"), none.clone(), clip("23: 100, 25: 200"), none.clone()];
    let straight = "double2[] times = [(0, 0), (40, 40)]";
    // By the files of the clips, which take over every 10, and the manifest.
    for (files, times, manifest, radii_at) in [
        (
            [early.clone(), none.clone(), middle.clone(), none.clone()],
            "",
            Some(&manifest),
            [(4.0, 18.0), (8.0, 36.0), (12.0, 172.0 / 3.0), (20.0, 100.0), (22.0, 140.0), (35.0, 200.0)],
        ),
        (
            [early.clone(), none.clone(), middle.clone(), none.clone()],
            straight,
            None,
            [(4.0, 18.0), (8.0, 36.0), (12.0, 172.0 / 3.0), (20.0, 100.0), (22.0, 140.0), (35.0, 200.0)],
        ),
        // A value of the manifest is that of all clips without samples.
        (
            [early.clone(), none.clone(), middle.clone(), none.clone()],
            "",
            Some(&full),
            [(4.0, 18.0), (8.0, 54.2), (12.0, 81.6), (20.0, 100.0), (22.0, 140.0), (35.0, 77.0)],
        ),
        (
            [none.clone(), none.clone(), middle.clone(), none.clone()],
            "",
            Some(&manifest),
            [(4.0, 100.0), (8.0, 100.0), (12.0, 100.0), (20.0, 100.0), (22.0, 140.0), (35.0, 200.0)],
        ),
        (
            [early.clone(), none.clone(), none.clone(), late.clone()],
            "",
            Some(&manifest),
            [(4.0, 18.0), (8.0, 29.6), (12.0, 42.4), (20.0, 68.0), (22.0, 74.4), (35.0, 200.0)],
        ),
        (
            paused.clone(),
            straight,
            Some(&manifest),
            [(2.0, 10.0), (8.0, 36.0), (12.0, 172.0 / 3.0), (20.0, 100.0), (22.0, 100.0), (35.0, 200.0)],
        ),
    ] {
        let with = if manifest.is_some() { "asset manifestAssetPath = @manifest.usda@" } else { "" };
        let root = model(
            "m",
            &format!(
                "asset[] assetPaths = [@d.0.usda@, @d.1.usda@, @d.2.usda@, @d.3.usda@] string primPath = \"/m\" \
                 double2[] active = [(0, 0), (10, 1), (20, 2), (30, 3)] {times} {with} bool interpolateMissingClipValues = true"
            ),
            "",
        );
        let names = ["d.0.usda", "d.1.usda", "d.2.usda", "d.3.usda"];
        let mut more: Vec<(&str, &str)> = names.into_iter().zip(files.iter().map(String::as_str)).collect();
        more.extend(manifest.map(|text| ("manifest.usda", text.as_str())));
        for (time, radius) in radii_at {
            let scene = scene(time, &root, &more);
            let found = radii(&scene, "s")[0];
            assert!(
                (found - radius as f32).abs() < 1e-4,
                "{files:?} {times} at {time}: {found}, not {radius}"
            );
            assert_eq!(warnings(&scene), "");
        }
    }
}

#[test]
fn broken_clips_are_said_and_left_out() {
    for (clips, wanted) in [
        (LISTED.to_owned(), "value clips need assetPaths with active"),
        (TEMPLATE.replace("Stride = 1", "Stride = 0"), "value clips need assetPaths with active"),
        (TEMPLATE.replace("Stride = 1", "Stride = 1e-9"), "value clips need assetPaths with active"),
        (TEMPLATE.replace('#', "x"), ""),
        (
            format!("{LISTED} {TIMES}").replace("c.0", "gone"),
            "a layer is left out: there is no file 'gone.usda'",
        ),
        (format!("{LISTED} {TIMES}").replace("@c.0.usda@", "@root.usda@"), ""),
        (format!("{LISTED} {TIMES}").replace("(0, 0), (10, 1)", "(0, 9), (10, -1)"), ""),
    ] {
        let scene = scene(5.0, &model("m", &clips, ""), &[]);
        assert_eq!(radii(&scene, "s"), [1.0], "{clips}");
        let warnings = warnings(&scene);
        assert!(warnings.contains(wanted) && warnings.is_empty() == wanted.is_empty(), "{clips}: {warnings}");
    }
}
