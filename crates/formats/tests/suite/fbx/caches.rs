//! Caches of points, in files of 3ds Max and Maya that are made here.

use super::writer::ps;
use super::*;
use bilux_formats::read;
use std::fs;

/// The quad, with a cache at 24 frames per second that a file of this name describes.
fn cached(name: &str, channels: &[&'static str]) -> Vec<N> {
    let mut nodes = file(
        vec![p("UnitScaleFactor", &[100.0]), p("TimeMode", &[11.0])],
        vec![quad(1), model(2, "node", vec![]), cache(name)],
        vec![link(1, 2, ""), link(2, 0, "")],
    );
    for (number, channel) in (10..).zip(channels) {
        let list = properties(vec![ps("ChannelName", channel)]);
        nodes[2].children.push(object("Deformer", number, "", "VertexCacheDeformer", vec![list]));
        nodes[3].children.extend([link(number, 1, ""), link(9, number, "")]);
    }
    nodes
}

fn cache(name: &str) -> N {
    let list = vec![ps("CacheFileName", &format!("far away\\caches\\{name}"))];
    object("Cache", 9, "c", "", vec![properties(list)])
}

/// The quad's points at a height.
fn points(z: f64) -> Vec<f64> {
    vec![0., 0., z, 1., 0., z, 1., 2., z, 0., 2., z]
}

fn pc2(count: i32, heights: &[f64]) -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0".to_vec();
    bytes.extend([1, count].iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([24f32, 2.0].iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend((heights.len() as i32).to_le_bytes());
    bytes.extend(heights.iter().flat_map(|&z| points(z)).flat_map(|x| (x as f32).to_le_bytes()));
    bytes
}

/// A chunk of Maya's files.
fn chunk(name: &[u8; 4], data: &[u8], wide: bool) -> Vec<u8> {
    let (pad, size) = match wide {
        true => (vec![0xab; 4], (data.len() as u64).to_be_bytes().to_vec()),
        false => (vec![], (data.len() as u32).to_be_bytes().to_vec()),
    };
    let unit = if wide { 8 } else { 4 };
    // A group's kind is not padded.
    let rest = if name.starts_with(b"FOR") { 0 } else { (unit - data.len() % unit) % unit };
    [&name[..], &pad, &size, data, &vec![0; rest]].concat()
}

/// The channels at a time.
type Sample<'a> = (i32, Vec<(&'a str, Vec<f64>)>);

/// One file of samples, each with its time if it is not the only one, of the named channels.
fn maya(wide: bool, doubles: bool, samples: &[Sample]) -> Vec<u8> {
    let group = if wide { b"FOR8" } else { b"FOR4" };
    let head =
        [&b"CACH"[..], &chunk(b"VRSN", b"0.1\0", wide), &chunk(b"STIM", &samples[0].0.to_be_bytes(), wide)];
    let mut bytes = chunk(group, &head.concat(), wide);
    for (time, channels) in samples {
        let mut data = b"MYCH".to_vec();
        if samples.len() > 1 {
            data.extend(chunk(b"TIME", &time.to_be_bytes(), wide));
        }
        for (name, numbers) in channels {
            data.extend(chunk(b"CHNM", format!("{name}\0").as_bytes(), wide));
            data.extend(chunk(b"SIZE", &((numbers.len() / 3) as u32).to_be_bytes(), wide));
            data.extend(match doubles {
                true => {
                    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_be_bytes()).collect();
                    chunk(b"DVCA", &bytes, wide)
                }
                false => {
                    let bytes: Vec<u8> = numbers.iter().flat_map(|x| (*x as f32).to_be_bytes()).collect();
                    chunk(b"FVCA", &bytes, wide)
                }
            });
        }
        bytes.extend(chunk(group, &data, wide));
    }
    bytes
}

fn description(kind: &str, format: &str, channels: &[(&str, &str)]) -> String {
    let channel = |(name, what): &(&str, &str)| {
        format!(
            "<c ChannelName=\"{name}\" ChannelType=\"FloatVectorArray\" ChannelInterpretation=\"{what}\" SamplingType=\"Regular\" \
             SamplingRate=\"375\" StartTime=\"6000\" EndTime=\"6750\"/>"
        )
    };
    let channels: String = channels.iter().map(channel).collect();
    format!(
        "<?xml version=\"1.0\"?><Autodesk_Cache_File><cacheType Type=\"{kind}\" Format=\"{format}\"/><time Range=\"6000-6750\"/>\
         <cacheTimePerFrame TimePerFrame=\"250\"/><Channels>{channels}</Channels></Autodesk_Cache_File>"
    )
}

/// The first object of the scene at a time, with what is said of it; the caches are in a folder beside the scene.
fn at_time(nodes: &[N], files: &[(&str, Vec<u8>)], time: f32) -> (Object, String) {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("scene.fbx");
    fs::write(&path, binary(7400, true, nodes)).unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    let scene = read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap();
    (scene.objects[0].clone(), crate::warnings(&scene))
}

fn height(nodes: &[N], files: &[(&str, Vec<u8>)], time: f32) -> f32 {
    let (object, warnings) = at_time(nodes, files, time);
    assert_eq!(warnings, "", "at {time}");
    object.mesh.positions[2].z
}

/// Samples at frames 24, 26 and 28.
#[test]
fn points_are_where_a_cache_of_3ds_max_has_them() {
    let nodes = cached("box.pc2", &[""]);
    let files = [("box.pc2", pc2(4, &[1.0, 3.0, 9.0]))];
    let frames = [0.0, 24.0, 25.0, 26.0, 27.0, 28.0, 99.0];
    let heights = frames.map(|frame: f32| height(&nodes, &files, frame / 24.0));
    for (found, wanted) in heights.into_iter().zip([1.0, 1.0, 2.0, 3.0, 6.0, 9.0, 9.0]) {
        assert!((found - wanted).abs() < 1e-4, "{heights:?}");
    }
}

/// Samples at 1, 1.0625 and 1.125 s: frame 24, half past 25, and 27.
#[test]
fn points_are_where_caches_of_maya_have_them() {
    let nodes = cached("c.xml", &["mesh"]);
    let sample = |time: i32, z: f64| (time, vec![("other", points(-z)), ("mesh", points(z))]);
    let samples = [sample(6000, 1.0), sample(6375, 3.0), sample(6750, 9.0)];
    let channels = [("other", "positions"), ("mesh", "positions")];
    for (wide, doubles) in [(false, false), (true, false), (false, true), (true, true)] {
        let format = if wide { "mcx" } else { "mcc" };
        let end = if wide { "mcx" } else { "mc" };
        let one = [
            ("c.xml", description("OneFile", format, &channels).into_bytes()),
            (&*format!("c.{end}"), maya(wide, doubles, &samples)),
        ];
        let names = ["24", "25Tick125", "27"].map(|frame| format!("cFrame{frame}.{end}"));
        let each = samples.iter().map(|sample| maya(wide, doubles, std::slice::from_ref(sample)));
        let mut many: Vec<(&str, Vec<u8>)> = names.iter().map(String::as_str).zip(each).collect();
        many.push(("c.xml", description("OneFilePerFrame", format, &channels).into_bytes()));
        for (time, wanted) in [(0.0, 1.0), (1.03125, 2.0), (1.0625, 3.0), (1.125, 9.0), (5.0, 9.0)] {
            assert_eq!(height(&nodes, &one, time), wanted, "one file, {format}, {time}");
            assert_eq!(height(&nodes, &many, time), wanted, "many files, {format}, {time}");
        }
    }
}

/// The cache turns the quad upright: without normals of its own its old ones turn with it.
#[test]
fn normals_are_those_of_the_cache_or_of_its_points() {
    let upright = vec![0., 0., 0., 1., 0., 0., 1., 0., 2., 0., 0., 2.];
    let stated = [0.0, 0.6, 0.8].repeat(4);
    let sample = (6000, vec![("mesh", upright), ("mesh_normals", stated)]);
    let files = [
        (
            "c.xml",
            description("OneFile", "mcc", &[("mesh", "positions"), ("mesh_normals", "normals")]).into_bytes(),
        ),
        ("c.mc", maya(false, false, &[sample])),
    ];
    let (with, _) = at_time(&cached("c.xml", &["mesh", "mesh_normals"]), &files, 1.0);
    near(with.mesh.normals[1], [0.0, 0.6, 0.8]);
    let (without, _) = at_time(&cached("c.xml", &["mesh"]), &files, 1.0);
    near(without.mesh.normals[1], [0.0, -1.0, 0.0]);
}

#[test]
fn caches_that_cannot_be_read_are_left_out_by_name() {
    let xml = description("OneFile", "mcc", &[("mesh", "positions"), ("other", "positions")]).into_bytes();
    let mut endless = maya(false, false, &[(6000, vec![("mesh", points(1.0))])]);
    let at = endless.windows(4).position(|word| word == b"FVCA").unwrap() + 4;
    endless[at..at + 4].copy_from_slice(&u32::MAX.to_be_bytes());
    let said = |name: &str, files: &[(&str, Vec<u8>)]| {
        let (object, warnings) = at_time(&cached(name, &["mesh"]), files, 1.0);
        assert_eq!(object.mesh.positions[2].z, 0.0);
        warnings
    };
    for (name, files, wanted) in [
        ("c.pc2", vec![], "there is no file 'far away\\caches\\c.pc2'"),
        ("c.pc2", vec![("c.pc2", pc2(5, &[1.0]))], "'c.pc2' is of 5 points, and the mesh has 4"),
        ("c.pc2", vec![("c.pc2", pc2(4, &[1.0])[..60].to_vec())], "'c.pc2' ends too early"),
        ("c.xml", vec![("c.xml", vec![0xff; 99])], "'c.xml' is neither PC2 nor the XML file of a cache"),
        ("c.xml", vec![("c.xml", b"<a/>          ".to_vec())], "is not the description of a cache"),
        ("c.xml", vec![("c.xml", xml.clone())], "there is no file 'c.mc'"),
        (
            "c.xml",
            vec![("c.xml", xml.clone()), ("c.mc", b"FOR7 and more".to_vec())],
            "is not a cache of Maya",
        ),
        ("c.xml", vec![("c.xml", xml), ("c.mc", endless)], "and the mesh has 4"),
    ] {
        let warnings = said(name, &files);
        assert!(warnings.contains("a cache of points is left out"), "{warnings}");
        assert!(warnings.contains(wanted), "{wanted}: {warnings}");
    }
}
