//! MTL as MeshLab, OpenMVS, Maya, Cinema 4D, Blender and others write it, with what each of them means; and lines, names
//! and textures that are wrong.

use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_math::Rgb;
use bilux_scene::{SceneBuilder, Spec, Value};
use std::path::Path;

/// Reads a library next to the files that a closure writes.
fn with_files(library: &str, write: impl FnOnce(&Path)) -> SceneBuilder {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    std::fs::write(folder.path().join("l.mtl"), library).unwrap();
    let path = folder.path().join("s.obj");
    std::fs::write(&path, "mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n").unwrap();
    read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{library}: {error}"))
}

fn of(library: &str) -> SceneBuilder {
    with_files(library, |folder| write_picture(&folder.join("t.png"), Rgb::new(1.0, 0.5, 0.25)))
}

fn write_picture(path: &Path, texel: Rgb) {
    let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![texel]).unwrap();
    bilux_pictures::write(path, &picture, &Default::default()).unwrap();
}

fn value<'s>(spec: &'s Spec, key: &str) -> Option<&'s Value> {
    spec.parameters.find(key).map(|(value, _)| value)
}

/// Light that a material lets through: `opaque`, `clear N` with its opacity, or `glass`.
fn passes(spec: &Spec) -> String {
    match (spec.kind.as_str(), value(spec, "opacity")) {
        ("dielectric", _) => "glass".to_owned(),
        (_, None) => "opaque".to_owned(),
        (_, Some(Value::Number(opacity))) => format!("clear {opacity:.2}"),
        (_, other) => format!("{other:?}"),
    }
}

/// The meanings come from the exporters: MeshLab, mvs-texturing and OpenMVS write `Tr 1` for opaque; Autodesk's write
/// `d` and `Tr` = 1 − d; Maya's Tf is 1 − transparency, with an Ni of 1 where nothing is refracted; Cinema 4D writes
/// `illum 7` everywhere; Blender writes alpha as `d`, with `illum 9` or 6. Glass has a black `Kd`, with `Ni` or `Tf`.
#[test]
fn what_lets_light_through_is_what_the_exporter_means() {
    for (exporter, lines, meaning) in [
        ("MeshLab", "Kd 1 1 1\nTr 1.000000\nillum 2\nNs 0\nmap_Kd t.png", "opaque"),
        ("OpenMVS", "Kd 1 1 1\nKs 0 0 0\nTr 1.000000\nillum 1\nNs 1.000000\nmap_Kd t.png", "opaque"),
        ("3ds Max", "Kd .6 .6 .6\nd 1\nTr 0\nTf 1 1 1\nillum 2\nNi 1.5", "opaque"),
        ("3ds Max, pane", "Kd .6 .6 .6\nd .3\nTr .7\nTf 1 1 1\nillum 2", "clear 0.30"),
        ("both the same", "Kd .6 .6 .6\nd 1\nTr 1\nillum 2", "opaque"),
        ("Tr alone", "Kd .5 .5 .5\nTr .25", "clear 0.75"),
        ("Tr 0 alone", "Kd .5 .5 .5\nTr 0", "opaque"),
        ("LeoCAD", "D 0.2\nKd .5 .5 .5", "clear 0.20"),
        ("d 0 everywhere", "Kd .5 .5 .5\nd 0", "opaque"),
        ("d 0 with a mask", "Kd .5 .5 .5\nd 0\nmap_d t.png", "Some(Texture(0))"),
        ("Rhino", "Kd .8 .1 .1\nd 0.4\nTf 0 0 0\nillum 2", "clear 0.40"),
        ("Maya's default", "illum 4\nKd 0.50 0.50 0.50\nKa 0 0 0\nTf 1.00 1.00 1.00\nNi 1.00", "opaque"),
        ("Maya, black", "illum 4\nKd 0 0 0\nTf 1 1 1\nNi 1.00", "opaque"),
        ("Maya, texture", "illum 4\nKd 0 0 0\nTf 1 1 1\nmap_Kd t.png\nNi 1.00", "opaque"),
        ("Maya, half clear", "illum 4\nKd .5 .5 .5\nTf 0.40 0.40 0.40\nNi 1.00", "clear 0.40"),
        ("Maya, glass", "illum 4\nKd .52 .52 .52\nTf 0.00 0.00 0.00\nNi 1.80\nKs 1 1 1", "glass"),
        ("Cinema 4D", "Kd .2157 .2157 .2157\nKs 1 1 1\nNs 50\nillum 7", "opaque"),
        ("Cinema 4D, black", "Kd 0 0 0\nKs 1 1 1\nNs 50\nillum 7", "opaque"),
        ("Cinema 4D, texture", "Kd .8 .1 .1\nmap_Kd t.png\nKs .2 .2 .2\nillum 7", "opaque"),
        ("Blender, alpha", "Kd .8 .1 .1\nKs .5 .5 .5\nNi 1.45\nd 0.5\nillum 9", "clear 0.50"),
        ("Blender, metal", "Kd .8 .1 .1\nKs .5 .5 .5\nNi 1.45\nd 0.5\nillum 6", "clear 0.50"),
        ("Tf 0 by the book", "Kd .5 .5 .5\nTf 0 0 0\nillum 6", "opaque"),
        ("illum 2 with Ni", "Kd .5 .5 .5\nNi 1.5\nillum 2", "opaque"),
        ("glass", "Kd 0 0 0\nKs 1 1 1\nTf 1 1 1\nNi 1.5\nillum 7", "glass"),
        ("glass without Tf", "Kd 0.01 0.01 0.01\nKs .3 .3 .3\nNi 1.33\nillum 7", "glass"),
        ("glass without Ni", "Kd 0 0 0\nTf .9 1 1\nillum 6", "glass"),
        ("glass and nothing else", "illum 7", "glass"),
        ("glass by d", "Kd 0 0 0\nd 0\nillum 4", "glass"),
        ("tinted glass", "Kd .1 .3 .1\nTf .4 .9 .4\nNi 1.5\nillum 6", "glass"),
    ] {
        let scene = of(&format!("newmtl m\n{lines}\n"));
        assert_eq!(passes(&scene.materials[0]), meaning, "{exporter}: {}", warnings(&scene));
        assert!(scene.build(&Default::default(), [0.0, 0.0], 1.0).is_ok(), "{exporter}");
    }
}

#[test]
fn a_guess_is_reported_with_its_line() {
    for (lines, part) in [
        ("Kd 1 1 1\nTr 1\n", "l.mtl:3:1: 'Tr 1' without 'd' is read as opaque"),
        ("Kd .5 .5 .5\nillum 7\n", "l.mtl:3:1: 'illum' 4, 6, 7 and 9 stand for glass"),
        ("Kd 1 1 1\nd 0\n", "l.mtl:3:1: all materials of this library are wholly transparent"),
        ("Kd 1 1 1\nd 0\nnewmtl n\nKd 1 0 0\n", "l.mtl:3:1: this material is wholly transparent"),
    ] {
        let all = warnings(&of(&format!("newmtl m\n{lines}")));
        assert!(all.contains(part), "{lines}: {all}");
    }
    // Nothing is guessed here.
    for lines in
        ["Kd 1 1 1\nd 1\nTr 0\nillum 2", "Kd 0 0 0\nNi 1.5\nTf 1 1 1\nillum 7", "Kd 1 0 0\nd .5\nillum 9"]
    {
        assert_eq!(warnings(&of(&format!("newmtl m\n{lines}\n"))), "", "{lines}");
    }
}

/// One library is the work of one exporter, so that its other materials decide what `Tr` means, and whether a `d` of 0 is
/// meant.
#[test]
fn a_library_is_interpreted_as_a_whole() {
    let all = |library: &str| {
        // The OBJ file's own material, which is in none of these libraries, comes after theirs.
        let count = library.matches("newmtl").count();
        of(library).materials.iter().take(count).map(passes).collect::<Vec<_>>().join(", ")
    };
    let tr = |numbers: &[&str]| {
        let material = |(i, tr): (usize, &&str)| format!("newmtl m{i}\nKd 1 0 0\nTr {tr}\n");
        all(&numbers.iter().enumerate().map(material).collect::<String>())
    };
    assert_eq!(tr(&["1", "1", "0.25"]), "opaque, opaque, clear 0.25");
    assert_eq!(tr(&["0", "0", "0.25"]), "opaque, opaque, clear 0.75");
    assert_eq!(tr(&["0", "1"]), "opaque, clear 0.00");
    // The first material says that Tr is 1 − d here.
    assert_eq!(all("newmtl a\nd .9\nTr .1\nnewmtl b\nTr 1\n"), "clear 0.90, clear 0.00");
    assert_eq!(all("newmtl a\nKd 1 0 0\nd 0\nnewmtl b\nKd 1 0 0\nd 0\n"), "opaque, opaque");
    assert_eq!(all("newmtl a\nKd 1 0 0\nd 0\nnewmtl b\nKd 1 0 0\nd 1\n"), "clear 0.00, opaque");
    // Glass is no paint that has to be visible.
    assert_eq!(all("newmtl a\nKd 0 0 0\nd 0\nNi 1.5\nillum 7\nnewmtl b\nKd 1 0 0\n"), "glass, opaque");
}

/// `d` is how much of a surface is there, so its colour does not change with it.
#[test]
fn the_paint_of_a_half_clear_surface_keeps_its_colour() {
    let scene = of("newmtl m\nKd .8 .1 .1\nKs 0 0 0\nd .5\nillum 2\n");
    assert_eq!(value(&scene.materials[0], "kd"), Some(&Value::triple([0.8, 0.1, 0.1])));
    assert_eq!(value(&scene.materials[0], "kt"), None);
}

#[test]
fn a_bad_line_costs_only_itself() {
    let good = "Kd .8 .1 .1\nKs .2 .2 .2\n";
    for (line, part) in [
        ("Ns", "l.mtl:4:3: a number is missing here"),
        ("Ns high", "l.mtl:4:4: 'high' is not a number"),
        ("d -", "l.mtl:4:3: '-' is not a number"),
        ("illum two", "'two' is not a number"),
        ("Ke 1 one 1", "l.mtl:4:6: 'one' is not a number"),
        ("Ke", "l.mtl:4:3: a number is missing here"),
        ("Ni nan", "is infinite or not a number"),
        ("Pr", "a number is missing here"),
        ("map_Kd", "l.mtl:4:1: 'map_Kd' has no file name"),
        ("map_Kd -s 1 1 1", "l.mtl:4:1: 'map_Kd' has no file name"),
        ("map_Kd \"\"", "l.mtl:4:1: 'map_Kd' has no file name"),
        ("map_Bump -bm", "has no file name"),
        ("norm", "'norm' has no file name"),
        ("refl", "'refl' of materials"),
        ("what is this", "'what' of a material is ignored"),
    ] {
        let scene = of(&format!("newmtl m\n{good}{line}\nnewmtl n\nKd 0 1 0\n"));
        let all = warnings(&scene);
        assert!(all.contains(part), "{line}: {all}");
        let kd = |i: usize| value(&scene.materials[i], "kd");
        assert_eq!(kd(0), Some(&Value::triple([0.8, 0.1, 0.1])), "{line}");
        assert_eq!(kd(1), Some(&Value::triple([0.0, 1.0, 0.0])), "{line}");
    }
    let scene = of("Kd 1 1 1\nnewmtl m\nKd .8 .1 .1\n");
    assert!(
        warnings(&scene).contains("l.mtl:1:1: 'Kd' comes before the first 'newmtl'"),
        "{}",
        warnings(&scene)
    );
    let comma = of("newmtl m\nKd 0,8 0,25 1,0\n");
    assert_eq!(value(&comma.materials[0], "kd"), Some(&Value::triple([0.8, 0.25, 1.0])));
}

#[test]
fn names_are_found_in_quotes_with_comments_backslashes_and_other_letters() {
    let texel = Rgb::new(1.0, 0.5, 0.25);
    for line in [
        "map_Kd \"my tex.png\"",
        "map_Kd 'my tex.png'",
        "map_Kd my tex.png",
        "map_Kd my tex.png # the paint",
        "map_Kd -s 1 1 1 \"my tex.png\"",
        "map_Kd \"my tex.png\" -bm 1",
        "map_Kd My Tex.PNG",
        "map_Kd .\\maps\\..\\my tex.png",
        "map_Kd C:\\Users\\me\\MY TEX.png",
        "map_Kd \"C:\\Users\\me\\my tex.png\"",
        "map_Kd /srv/me/my tex.png",
        "map_Kd file:///srv/me/my tex.png",
        "map_Kd Sub\\Deep.png",
    ] {
        let scene = with_files(&format!("newmtl m\nKd 1 1 1\n{line}\n"), |folder| {
            std::fs::create_dir_all(folder.join("sub")).unwrap();
            write_picture(&folder.join("my tex.png"), texel);
            write_picture(&folder.join("sub/deep.png"), texel);
        });
        assert_eq!(warnings(&scene), "", "{line}");
        assert_eq!(value(&scene.materials[0], "kd"), Some(&Value::Texture(0)), "{line}");
        assert!((scene.textures[0].texel(0, 0).r - 1.0).abs() < 0.01, "{line}");
        // Where upper and lower case matter, the file may be missing: this is worth a note.
        let is_renamed = line.contains("My Tex") || line.contains("MY TEX") || line.contains("Sub");
        assert_eq!(scene.notes.len(), usize::from(is_renamed), "{line}: {:?}", scene.notes);
    }
}

#[test]
fn libraries_are_found_in_quotes_and_in_other_letters() {
    for line in ["\"a b.mtl\"", "A B.mtl", "'a b.mtl' # paints", "\"a b.mtl\" \"none.mtl\"", "..\\x\\a b.mtl"]
    {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.mtl"), "newmtl \"m\"\nKd .8 .1 .1\n").unwrap();
        let path = folder.path().join("s.obj");
        let text = format!("mtllib {line}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
        std::fs::write(&path, text).unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap();
        let kd = value(&scene.materials[scene.objects[0].material], "kd");
        assert_eq!(kd, Some(&Value::triple([0.8, 0.1, 0.1])), "{line}: {}", warnings(&scene));
    }
}

/// A name in other letters opens nothing that the name itself would not.
#[test]
fn names_in_other_letters_stay_within_the_folder() {
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    write_picture(&outer.path().join("secret.png"), Rgb::WHITE);
    #[cfg(unix)]
    std::os::unix::fs::symlink(outer.path(), inner.join("link")).unwrap();
    for name in ["../SECRET.PNG", "../Inner/../Secret.png", "LINK/secret.png", "link/Secret.png"] {
        std::fs::write(inner.join("l.mtl"), format!("newmtl m\nmap_Kd {name}\n")).unwrap();
        let path = inner.join("s.obj");
        std::fs::write(&path, "mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n").unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap();
        assert!(warnings(&scene).contains("magenta checker"), "{name}: {}", warnings(&scene));
        assert!(scene.files.iter().all(|file| !file.ends_with("secret.png")), "{name}");
    }
}

/// The picture says where there are holes. A number beside it is a factor on it, but for a zero, which would leave nothing.
#[test]
fn a_zero_beside_a_picture_of_holes_does_not_hide_everything() {
    for (d, factor) in [("d 0", 1.0), ("d .25", 0.25), ("Tr 1\nd 0", 1.0)] {
        let library = format!("newmtl m\nKd .5 .5 .5\n{d}\nmap_d t.png\nnewmtl n\nKd 1 0 0\n");
        let scene = with_files(&library, |folder| write_picture(&folder.join("t.png"), Rgb::WHITE));
        assert_eq!(scene.textures[0].factor, Rgb::grey(factor), "{d}");
    }
}
