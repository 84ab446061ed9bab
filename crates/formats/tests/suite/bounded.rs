//! Small files that stand for a great deal end with a message, by counts and not by clocks; and what may never end is not begun.

use crate::threemf::package;
use crate::{read_text, refusal};
use bilux_formats::{ReadOptions, read, read_bytes};

/// A stage in which each prim is composed with the one before it twice, by what `arc` says.
fn doubling(arc: &str, levels: usize) -> String {
    let first = "def Mesh \"m\"\n{\n    int[] faceVertexCounts = [3]\n    int[] faceVertexIndices = [0, 1, 2]\n    \
                 point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n}\n";
    let level = |i: usize| {
        let before = if i == 0 { "m".to_owned() } else { format!("a{}", i - 1) };
        let arc = arc.replace('@', &format!("</{before}>"));
        format!("def Xform \"a{i}\"\n{{\n    def \"x\" ({arc}) {{}}\n    def \"y\" ({arc}) {{}}\n}}\n")
    };
    format!(
        "#usda 1.0\n(\n    defaultPrim = \"a{}\"\n)\n{first}{}",
        levels - 1,
        (0..levels).map(level).collect::<String>()
    )
}

#[test]
fn arcs_that_double_are_counted() {
    for arc in ["references = @", "payload = @", "inherits = @"] {
        let message = refusal("usda", doubling(arc, 40));
        assert!(message.contains("multiply"), "{arc}: {message}");
        let few = read_text("usda", doubling(arc, 5)).unwrap();
        assert_eq!(few.objects.len(), 1 + 2 + 4 + 8 + 16 + 32, "{arc}");
    }
}

/// Instancers of instancers place copies of copies.
#[test]
fn copies_of_copies_are_counted() {
    let instancer = |name: &str, of: &str, inside: &str| {
        format!(
            "def PointInstancer \"{name}\"\n{{\n    rel prototypes = <{of}>\n    int[] protoIndices = [{}]\n    point3f[] positions = [{}]\n{inside}}}\n",
            vec!["0"; 64].join(", "),
            (0..64).map(|i| format!("({i}, 0, 0)")).collect::<Vec<_>>().join(", ")
        )
    };
    let mut text = "def Sphere \"s\" { double radius = 1 }\n".to_owned();
    for i in (0..12).rev() {
        let own: String = (0..=i).map(|j| format!("/p{j}")).collect();
        let of = if i == 11 { format!("{own}/s") } else { format!("{own}/p{}", i + 1) };
        text = instancer(&format!("p{i}"), &of, &text);
    }
    let options = ReadOptions { max_memory: 100 << 20, ..ReadOptions::default() };
    let read = read_bytes(format!("#usda 1.0\n{text}").as_bytes(), "usda", None, "a.usda", &options);
    let message = read.unwrap_err().to_string();
    assert!(message.contains("more than"), "{message}");
}

/// Generated models are charged for what making them takes; the same one is made once.
#[test]
fn generators_of_a_file_are_bounded() {
    let options = ReadOptions { max_memory: 32 << 20, ..ReadOptions::default() };
    let models = |detail: fn(usize) -> usize| -> String {
        (0..40)
            .map(|i| {
                format!("[[model]]\ngenerate = \"scan\"\ndetail = {}\ntranslate = [{i}, 0, 0]\n", detail(i))
            })
            .collect()
    };
    let read = |text: String| read_bytes(text.as_bytes(), "toml", None, "a.toml", &options);
    let message = read(models(|i| 150 + i)).unwrap_err().to_string();
    assert!(message.contains("allowed"), "{message}");
    // Before the first is made, which would take minutes.
    let before = std::time::Instant::now();
    for large in
        ["\"scan\"\ndetail = 800", "\"teapot\"\ntessellation = 256", "\"cornell-spheres\"\nlevel = 7"]
    {
        let message = read(format!("[[model]]\ngenerate = {large}\n")).unwrap_err().to_string();
        assert!(message.contains("allowed"), "{large}: {message}");
    }
    assert!(before.elapsed().as_secs_f64() < 5.0);
    let same = read(models(|_| 150)).unwrap();
    let statues: Vec<_> = same.objects.iter().filter(|object| object.name == "statue").collect();
    assert_eq!(statues.len(), 40);
    assert!(statues.iter().all(|object| std::sync::Arc::ptr_eq(&object.mesh, &statues[0].mesh)));
}

/// Two members of a zip file with the same bytes: the directory of one is changed to point at the other's.
#[test]
fn members_of_archives_share_no_bytes() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mut bytes = package(&[("a.obj", obj), ("b.obj", obj)]);
    let read = |bytes: &[u8]| read_bytes(bytes, "zip", None, "x.zip", &ReadOptions::default());
    assert!(read(&bytes).is_ok());
    // The places in the directory are 42 bytes after its signature.
    let entries: Vec<usize> =
        (0..bytes.len() - 4).filter(|&i| bytes[i..].starts_with(b"PK\x01\x02")).collect();
    let place = bytes[entries[0] + 42..entries[0] + 46].to_vec();
    bytes[entries[1] + 42..entries[1] + 46].copy_from_slice(&place);
    let message = read(&bytes).unwrap_err().to_string();
    assert!(message.contains("'a.obj' and 'b.obj' overlap"), "{message}");
}

/// A pipe, to which nobody ever writes, as a scene, as what a scene names, and as a picture.
#[cfg(unix)]
#[test]
fn pipes_are_no_files() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("a.obj");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [&*pipe, "/dev/zero".as_ref()] {
        let message = read(path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(message.contains("this is a pipe or a device"), "{message}");
        let message = bilux_pictures::read(path).unwrap_err().to_string();
        assert!(message.contains("this is a pipe or a device"), "{message}");
    }
    let scene = folder.path().join("a.toml");
    std::fs::write(&scene, "[[model]]\nfile = \"a.obj\"\n").unwrap();
    assert!(read(&scene, &ReadOptions::default()).is_err());
}
