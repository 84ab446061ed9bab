//! Messages about broken files are whole sentences in plain words, whatever is broken.

use bilux_formats::{ReadOptions, SCENE_FORMATS, read, read_bytes};
use bilux_pictures::{Limits, PICTURE_FORMATS};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn seeds(folder: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

/// Pseudo-random numbers that are the same in every run. [Steele 2014]
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) % end.max(1) as u64) as usize
    }
}

/// Changes, removes, repeats or inserts a few bytes, or cuts off the end.
fn damaged(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    const WORDS: [&str; 8] = ["-1", "nan", "1e39", "x", "\"", "{", "4294967295", "\n"];
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + numbers.below(3) {
        let at = numbers.below(bytes.len());
        let end = (at + 1 + numbers.below(8)).min(bytes.len());
        match numbers.below(7) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..at, WORDS[numbers.below(WORDS.len())].bytes())),
            // Most faults are possible in headers.
            3 if !bytes.is_empty() => {
                let at = at % bytes.len().min(64);
                bytes[at] = numbers.below(256) as u8;
            }
            _ if !bytes.is_empty() => bytes[at] = numbers.below(256) as u8,
            _ => {}
        }
    }
    bytes
}

/// A message without its quoted parts, which come from the file.
fn unquoted(message: &str) -> String {
    let mut plain = String::new();
    let mut quote = None;
    for letter in message.chars() {
        match quote {
            None if matches!(letter, '\'' | '"') => quote = Some(letter),
            None => plain.push(letter),
            Some(open) if open == letter => {
                quote = None;
                plain.push('_');
            }
            Some(_) => {}
        }
    }
    plain
}

/// The debug syntax of a Rust value in a message, if there is any.
fn raw_rust(message: &str) -> Option<&'static str> {
    // What our own format has for a texture is no value of Rust.
    let plain = unquoted(message).replace("{ texture = _ }", "_");
    let shapes = [
        "Some(", "None", "Ok(", "Err(", "Error(", "Error:", "::", "`", "\\x", "\\u", "os error", "{ ", "u8",
        "usize",
    ];
    let found = shapes.into_iter().find(|shape| plain.contains(shape));
    // A list of bytes; the last row of a matrix does not count.
    let is_byte = |word: &str| word.trim().parse::<u8>().is_ok();
    let lists = plain.split('[').skip(1).filter_map(|rest| rest.split(']').next());
    let is_bytes = |list: &str| list.split(',').count() >= 4 && list.split(',').all(is_byte);
    found.or(lists.into_iter().any(|l| is_bytes(l) && l != "0, 0, 0, 1").then_some("a list of bytes"))
}

/// Reports all messages that are not plain, one per kind.
#[track_caller]
fn assert_plain(messages: impl IntoIterator<Item = String>) {
    let mut bad: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut count = 0;
    for message in messages {
        count += 1;
        let shape = raw_rust(&message).or((message.len() < 20).then_some("short"));
        let shape = shape.or(unquoted(&message).contains("  ").then_some("two blanks"));
        let shape = shape.or(message.trim_end().ends_with(['.', ':', ';', ',']).then_some("its end"));
        if let Some(shape) = shape {
            bad.entry(shape).or_default().push(message);
        }
    }
    let lines = bad.iter().map(|(shape, all)| format!("{shape}: {} such as\n  {}", all.len(), all[0]));
    assert!(bad.is_empty(), "of {count} messages\n{}", lines.collect::<Vec<_>>().join("\n"));
    println!("{count} messages, all plain");
}

#[test]
fn the_test_would_notice() {
    for raw in [
        "PNG: ChunkType { type: IHDR, critical: true }",
        "Invalid RIFF signature: [52, 49, 46, 47]",
        "it cannot be unpacked: UnsupportedFeature(\"x\") of Some(3)",
        "expected `,` or `]`",
        "No such file or directory (os error 2)",
    ] {
        assert!(raw_rust(raw).is_some(), "{raw}");
    }
    assert_eq!(raw_rust("x.toml:2:1: kd must be a colour or { texture = \"FILE\" }"), None);
    assert_eq!(raw_rust("x.toml:2:1: there is no key 'a::b' of the matrix [0, 0, 0, 1]"), None);
}

#[test]
fn messages_about_broken_scenes_are_plain() {
    let options = ReadOptions { max_memory: 8 << 20, validate: true, ..ReadOptions::default() };
    let mut numbers = Numbers(1);
    let mut messages = Vec::new();
    for row in SCENE_FORMATS {
        for (_, bytes) in seeds(&format!("scene_{}", row.entry.name)) {
            for _ in 0..60 {
                match read_bytes(&damaged(&bytes, &mut numbers), row.entry.name, None, "scene", &options) {
                    Ok(scene) => messages.extend(scene.warnings.iter().map(ToString::to_string)),
                    Err(error) => messages.push(error.to_string()),
                }
            }
        }
    }
    for message in &messages {
        let is_of_texture =
            message.contains("bytes that are allowed") || message.starts_with("there is nothing to render");
        assert!(message.starts_with("scene") || is_of_texture, "it does not say which file: {message}");
    }
    assert_plain(messages);
}

#[test]
fn messages_about_broken_materials_are_plain() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    put("x.obj", b"mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    let mut numbers = Numbers(2);
    let mut messages = Vec::new();
    for (_, bytes) in seeds("scene_mtl") {
        for _ in 0..60 {
            put("x.mtl", &damaged(&bytes, &mut numbers));
            match read(&folder.path().join("x.obj"), &ReadOptions::default()) {
                Ok(scene) => messages.extend(scene.warnings.iter().map(ToString::to_string)),
                Err(error) => messages.push(error.to_string()),
            }
        }
    }
    // The folder has a name of random letters, which may look like words.
    let folder = folder.path().display().to_string();
    assert_plain(messages.iter().map(|message| message.replace(&folder, "folder")));
}

#[test]
fn messages_about_broken_pictures_are_plain() {
    let mut numbers = Numbers(3);
    let mut messages = Vec::new();
    for row in PICTURE_FORMATS {
        for (_, bytes) in seeds(&format!("picture_{}", row.entry.name)) {
            for _ in 0..100 {
                let damaged = damaged(&bytes, &mut numbers);
                messages.extend((row.read)(&damaged, &Limits::new(1 << 22)).err().map(|e| e.to_string()));
            }
        }
    }
    assert_plain(messages);
}
