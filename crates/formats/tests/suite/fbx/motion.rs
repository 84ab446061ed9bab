//! Curves, skins and blend shapes.

use super::*;

const SECOND: i64 = 46_186_158_000;
/// Flags of cubic keys: slopes that the file states, or that are chosen, by shape or by the keys around them.
const STATED: i32 = 0x8 | 0x400;
const SHAPED: i32 = 0x8 | 0x200;
const STRAIGHT: i32 = 0x8 | 0x100 | 0x2000;

/// A curve through keys at whole seconds, with the flags of all keys and the data of their tangents.
fn curve(id: i64, values: Vec<f32>, flags: i32, data: [f32; 4]) -> N {
    let times = (0..values.len() as i64).map(|i| (i + 2) * SECOND).collect();
    let count = values.len() as i32;
    object(
        "AnimationCurve",
        id,
        "",
        "",
        vec![
            n("KeyTime", vec![V::Longs(times)], vec![]),
            n("KeyValueFloat", vec![V::Floats(values)], vec![]),
            n("KeyAttrFlags", vec![V::Ints(vec![flags])], vec![]),
            n("KeyAttrDataFloat", vec![V::Floats(data.to_vec())], vec![]),
            n("KeyAttrRefCount", vec![V::Ints(vec![count])], vec![]),
        ],
    )
}

/// An animation from 2 s on of a property's first number, by a curve.
fn animated(mut nodes: Vec<N>, target: i64, property: &str, axis: &str, curve: N) -> Vec<N> {
    let stack =
        properties(vec![p("LocalStart", &[2.0 * SECOND as f64]), p("LocalStop", &[4.0 * SECOND as f64])]);
    nodes[2].children.extend([
        object("AnimationStack", 20, "walk", "", vec![stack]),
        object("AnimationLayer", 21, "base", "", vec![n("a", vec![], vec![])]),
        object("AnimationCurveNode", 22, "T", "", vec![n("a", vec![], vec![])]),
        curve,
    ]);
    nodes[3].children.extend([
        link(21, 20, ""),
        link(22, 21, ""),
        link(22, target, property),
        link(23, 22, axis),
    ]);
    nodes
}

fn at_time(nodes: &[N], time: f32, animation: Option<&str>) -> Result<SceneBuilder, FormatError> {
    let options = ReadOptions { time, animation: animation.map(str::to_owned), ..ReadOptions::default() };
    read_bytes(&binary(7400, true, nodes), "fbx", None, "scene.fbx", &options)
}

#[test]
fn curves_move_nodes_from_the_beginning_of_their_animation() {
    let place = |flags: i32, data: [f32; 4], time: f32| {
        let nodes =
            animated(placed(vec![]), 2, "Lcl Translation", "d|X", curve(23, vec![1.0, 5.0], flags, data));
        at(&at_time(&nodes, time, None).unwrap().objects[0], [0.0; 3]).x
    };
    let flat = [0.0; 4];
    assert_eq!([0.0, 0.5, 1.0, 9.0].map(|t| place(4, flat, t)), [1.0, 3.0, 5.0, 5.0], "lines");
    assert_eq!([0.5, 1.0].map(|t| place(2, flat, t)), [1.0, 5.0], "steps");
    // 1 + 4 (3 t² - 2 t³) at a quarter, and with a slope of 8 at the beginning t (1 - t)² · 8 more.
    assert!((place(STATED, flat, 0.25) - 1.625).abs() < 1e-5);
    assert!((place(STATED, [8.0, 0.0, 0.0, 0.0], 0.25) - 1.625 - 8.0 * 0.25 * 0.5625).abs() < 1e-5);
    let nodes = animated(placed(vec![]), 2, "Lcl Translation", "d|X", curve(23, vec![1.0, 5.0], 4, flat));
    let scene = at_time(&nodes, 0.0, Some("walk")).unwrap();
    let animation = &scene.inventory.animations[0];
    assert_eq!((animation.name.as_str(), animation.seconds, animation.plays), ("walk", 2.0, true));
    assert!(
        at_time(&nodes, 0.0, Some("run")).unwrap_err().to_string().contains("there is no animation 'run'")
    );
}

/// A curve from 1 to 5 within a second repeats itself so often, before and after: it begins anew, goes back, or goes on.
#[test]
fn curves_repeat_themselves_as_often_as_they_say() {
    let place = |end: &'static str, letter: &str, times: i32, time: f32| {
        let mut curve = curve(23, vec![1.0, 5.0], 4, [0.0; 4]);
        let how = vec![n("Type", vec![text(letter)], vec![]), n("Repetition", vec![V::Int(times)], vec![])];
        curve.children.push(n(end, vec![], how));
        let nodes = animated(placed(vec![]), 2, "Lcl Translation", "d|X", curve);
        at(&at_time(&nodes, time, None).unwrap().objects[0], [0.0; 3]).x
    };
    let (before, after) = ("Pre-Extrapolation", "Post-Extrapolation");
    // One second later and a quarter, where it ends, and what is left of that without an end (-1).
    for (end, letter, times, wanted) in [
        (after, "R", 2, [2.0, 2.0, 5.0]),
        (after, "M", 1, [4.0, 1.0, 1.0]),
        (after, "M", 2, [4.0, 2.0, 5.0]),
        (after, "A", 1, [6.0, 9.0, 9.0]),
        (after, "A", 2, [6.0, 10.0, 13.0]),
        (after, "A", -1, [6.0, 10.0, 34.0]),
        (after, "C", 1, [5.0, 5.0, 5.0]),
        (before, "R", 2, [4.0, 4.0, 1.0]),
        (before, "M", 1, [2.0, 5.0, 5.0]),
        (before, "A", 1, [0.0, -3.0, -3.0]),
        (before, "A", 2, [0.0, -4.0, -7.0]),
    ] {
        let beyond = |seconds: f32| if end == after { 1.0 + seconds } else { -seconds };
        let found = [0.25, 1.25, 7.25].map(|seconds| place(end, letter, times, beyond(seconds)));
        let is_near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(is_near, "{end} {letter} {times}: {found:?}, not {wanted:?}");
    }
}

/// Keys at 0, 3 and 6: the middle one is on the line, so that all curves that know it have its slope, 3.
#[test]
fn slopes_that_the_file_does_not_state_come_from_the_keys_around() {
    let place = |values: &[f32], flags: i32, data: [f32; 4], time: f32| {
        let curve = curve(23, values.to_vec(), flags, data);
        let nodes = animated(placed(vec![]), 2, "Lcl Translation", "d|X", curve);
        at(&at_time(&nodes, time, None).unwrap().objects[0], [0.0; 3]).x
    };
    // Straight up to the neighbours; held between them, the ends are flat: at a half 3 / 2 - 3 / 8.
    let line = [0.0, 3.0, 6.0];
    for flags in [STRAIGHT, 0x8 | 0x100, SHAPED] {
        assert!((place(&line, flags, [0.0; 4], 0.5) - 1.5).abs() < 1e-5, "{flags:x}");
    }
    assert!((place(&line, STRAIGHT | 0x4000, [0.0; 4], 0.5) - 1.125).abs() < 1e-5);
    // A key at the top of a hill is flat if held between its neighbours, and a clamped one is next to its like.
    let hill = [0.0, 2.0, 1.0];
    let flat_after_line = |slope: f32| 1.0 + slope / 8.0;
    assert!((place(&hill, STRAIGHT, [0.0; 4], 0.5) - flat_after_line(2.0 - 0.5)).abs() < 1e-5);
    assert!((place(&hill, STRAIGHT | 0x4000, [0.0; 4], 0.5) - flat_after_line(0.0)).abs() < 1e-5);
    let step = [0.0, 2.0, 2.0];
    assert!((place(&step, STRAIGHT | 0x1000, [0.0; 4], 0.5) - flat_after_line(2.0)).abs() < 1e-5);
    // Full tension is a rest at every key.
    assert!((place(&hill, SHAPED, [1.0, 0.0, 0.0, 0.0], 0.25) - 2.0 * 0.15625).abs() < 1e-5);
}

/// Before version 7, takes list channels below the names of nodes: what neither they nor the node say is as it is at rest.
#[test]
fn takes_of_older_files_move_the_axes_that_they_list() {
    let place = |channel: &str, time: f32| {
        let text = format!(
            "; FBX 6.1.0 project file\nFBXHeaderExtension:  {{\nFBXHeaderVersion: 1003\nFBXVersion: 6100\n}}\nObjects:  {{\n\
             Model: \"Model::a\", \"Mesh\" {{\nVersion: 232\nVertices: 0,0,0,1,0,0,1,2,0,0,2,0\nPolygonVertexIndex: 0,1,2,-4\n}}\n\
             GlobalSettings:  {{\nProperties60:  {{\nProperty: \"UnitScaleFactor\", \"double\", \"\",100\n}}\n}}\n}}\n\
             Connections:  {{\nConnect: \"OO\", \"Model::a\", \"Model::Scene\"\n}}\nTakes:  {{\nCurrent: \"walk\"\nTake: \"walk\" {{\n\
             LocalTime: 0,{SECOND}\nModel: \"Model::a\" {{\nChannel: \"Transform\" {{\n{channel}\n}}\n}}\n}}\n}}\n"
        );
        let options = ReadOptions { time, ..ReadOptions::default() };
        let scene = read_bytes(text.as_bytes(), "fbx", None, "scene.fbx", &options).unwrap();
        assert_eq!(scene.inventory.animations[0].name, "walk");
        at(&scene.objects[0], [1.0, 2.0, 3.0])
    };
    let axis = |name: &str, from: f32, to: f32| {
        format!("Channel: \"{name}\" {{\nKeyVer: 4005\nKeyCount: 2\nKey: 0,{from},L,{SECOND},{to},L\n}}\n")
    };
    let of = |letter: &str, inside: String| format!("Channel: \"{letter}\" {{\n{inside}\n}}\n");
    near(place(&of("T", axis("Y", 1.0, 5.0)), 0.5), [1.0, 5.0, 3.0]);
    near(place(&of("R", axis("Z", 0.0, 180.0)), 0.5), [-2.0, 1.0, 3.0]);
    near(place(&of("S", axis("X", 1.0, 3.0)), 1.0), [3.0, 2.0, 3.0]);
    near(place(&of("S", axis("X", 1.0, 3.0) + "Channel: \"Z\" {\nDefault: 2\n}\n"), 0.5), [2.0, 2.0, 6.0]);
}

/// The quad's upper vertices follow a bone that is turned a quarter about x.
#[test]
fn vertices_follow_their_bones() {
    let identity = bilux_math::DMat4::IDENTITY.to_cols_array().to_vec();
    let cluster = object(
        "Deformer",
        11,
        "c",
        "Cluster",
        vec![
            n("Indexes", vec![V::Ints(vec![2, 3, 99])], vec![]),
            n("Weights", vec![V::Doubles(vec![0.5, 2.0, 1.0])], vec![]),
            n("Transform", vec![V::Doubles(identity.clone())], vec![]),
            n("TransformLink", vec![V::Doubles(identity)], vec![]),
        ],
    );
    let mut nodes = placed(vec![p("Lcl Translation", &[7.0, 0.0, 0.0])]);
    nodes[2].children.extend([
        object("Deformer", 10, "skin", "Skin", vec![n("a", vec![], vec![])]),
        cluster,
        model(12, "bone", vec![p("Lcl Rotation", &[90.0, 0.0, 0.0])]),
    ]);
    nodes[3].children.extend([link(10, 1, ""), link(11, 10, ""), link(12, 11, ""), link(12, 0, "")]);
    let scene = read_all(&nodes);
    let mesh = &scene.objects[0].mesh;
    near(mesh.positions[0], [7.0, 0.0, 0.0]);
    near(mesh.positions[2], [1.0, 0.0, 2.0]);
    near(mesh.normals[2], [0.0, -1.0, 0.0]);
    assert_eq!(scene.inventory.skins, ["skin"]);
    assert!(crate::warnings(&scene).contains("a bone moves a vertex that the mesh does not have"));
}

/// Shapes at 50 and at 100 percent: 75 is half of both.
#[test]
fn blend_shapes_run_from_one_to_the_next() {
    let shape = |id: i64, z: f64| {
        object(
            "Geometry",
            id,
            "s",
            "Shape",
            vec![
                n("Indexes", vec![V::Ints(vec![2])], vec![]),
                n("Vertices", vec![V::Doubles(vec![0.0, 0.0, z])], vec![]),
            ],
        )
    };
    let height = |percent: f64| {
        let mut nodes = placed(vec![]);
        let channel = vec![
            properties(vec![p("DeformPercent", &[percent])]),
            n("FullWeights", vec![V::Doubles(vec![50.0, 100.0])], vec![]),
        ];
        nodes[2].children.extend([
            object("Deformer", 10, "b", "BlendShape", vec![n("a", vec![], vec![])]),
            object("Deformer", 11, "c", "BlendShapeChannel", channel),
            shape(12, 1.0),
            shape(13, 3.0),
        ]);
        nodes[3].children.extend([link(10, 1, ""), link(11, 10, ""), link(12, 11, ""), link(13, 11, "")]);
        read_all(&nodes).objects[0].mesh.positions[2].z
    };
    assert_eq!([0.0, 25.0, 50.0, 75.0, 100.0].map(height), [0.0, 0.5, 1.0, 2.0, 3.0]);
}
