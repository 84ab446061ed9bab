//! Files that lie, and files that are not for us.

use super::writer::zipped;
use super::*;

#[track_caller]
fn refused(bytes: &[u8]) -> String {
    crate::refusal("fbx", bytes)
}

#[test]
fn other_versions_and_encrypted_files_are_named() {
    let nodes = placed(vec![]);
    assert!(
        refused(&binary(5800, true, &nodes)).contains("this is FBX 5.8, but 6.1 (of 2006) is the oldest")
    );
    assert!(refused(&binary(8000, true, &nodes)).contains("this is FBX 8.0, but 7.7 is the newest"));
    let mut secret = nodes;
    secret[0].children.push(n("EncryptionType", vec![V::Int(1)], vec![]));
    assert!(refused(&binary(7400, true, &secret)).contains("this FBX file is encrypted"));
}

#[test]
fn files_that_were_cut_off_are_refused_wherever_it_happened() {
    for bytes in [binary(7400, true, &placed(vec![])), as_text(&placed(vec![])).into_bytes()] {
        let [objects, links] = [&b"Objects"[..], b"Connections"]
            .map(|name| bytes.windows(name.len()).position(|word| word == name).unwrap());
        for length in (objects + 12..links - 20).step_by(7) {
            let message = refused(&bytes[..length]);
            assert!(message.contains("cut off"), "{length}: {message}");
        }
    }
}

/// The vertices of the quad replaced by other bytes.
fn with_vertices(value: V) -> Vec<N> {
    let mut nodes = placed(vec![]);
    nodes[2].children[0].children[0].values = vec![value];
    nodes
}

#[test]
fn arrays_that_lie_are_refused_before_memory_is_taken() {
    let honest = binary(7400, false, &placed(vec![]));
    let at = honest.windows(9).position(|word| word == b"Verticesd").unwrap() + 9;
    let with = |count: u32, packing: u32| {
        let mut bytes = honest.clone();
        bytes[at..at + 4].copy_from_slice(&count.to_le_bytes());
        bytes[at + 4..at + 8].copy_from_slice(&packing.to_le_bytes());
        bytes
    };
    assert!(refused(&with(1 << 28, 0)).contains("numbers are stated, which these"), "2 GB");
    assert!(refused(&with(1 << 28, 1)).contains("numbers are stated, which these"), "2 GB, packed");
    assert!(refused(&with(12, 1)).contains("the packed numbers are damaged"));
    // A bomb that unpacks to what it says is subject to the limit of memory.
    let bomb = binary(7400, true, &with_vertices(V::Doubles(vec![0.0; 4 << 20])));
    assert!(bomb.len() < 1 << 17);
    let options = ReadOptions { max_memory: 8 << 20, ..ReadOptions::default() };
    let error = read_bytes(&bomb, "fbx", None, "bomb.fbx", &options).unwrap_err().to_string();
    assert!(error.contains("takes more than the 8388608 bytes"), "{error}");
    assert!(zipped(&[0; 1 << 16]).len() < 200);
}

/// As version control does to binary files that it takes for text.
#[test]
fn zeros_that_became_spaces_are_named() {
    let bytes: Vec<u8> =
        binary(7400, true, &placed(vec![])).iter().map(|&byte| if byte == 0 { b' ' } else { byte }).collect();
    assert!(refused(&bytes).contains("the zeros in this file were replaced by spaces"));
}

#[test]
fn a_million_nested_nodes_are_refused() {
    let text = format!("; FBX 7.4.0 project file\n{}", "a: {".repeat(1_000_000));
    assert!(refused(text.as_bytes()).contains("nested more than 64 levels"));
    let deep = (0..100).fold(n("a", vec![], vec![]), |inner, _| n("a", vec![], vec![inner]));
    assert!(refused(&binary(7400, true, &[deep])).contains("nested more than 64 levels"));
}

#[test]
fn cycles_and_indices_out_of_range_leave_out_what_they_concern() {
    let objects = vec![quad(1), model(2, "a", vec![]), model(3, "b", vec![]), model(4, "fine", vec![])];
    let links = vec![link(2, 3, ""), link(3, 2, ""), link(1, 4, ""), link(4, 0, ""), link(4, 4, "")];
    let scene = scene_of(&binary(7400, true, &file(vec![], objects, links))).unwrap();
    assert_eq!(scene.objects.len(), 1);
    assert!(crate::warnings(&scene).contains("some nodes are their own ancestors"));
    let mut nodes = placed(vec![]);
    nodes[2].children[0].children[1].values = vec![V::Ints(vec![0, 1, 2, -4, 0, 1, -1_000_000, i32::MIN])];
    let scene = scene_of(&binary(7400, true, &nodes)).unwrap();
    assert_eq!(scene.objects[0].mesh.triangles.len(), 2);
    assert!(
        crate::warnings(&scene).contains("a vertex that the mesh does not have, and is left out (2 times")
    );
}

#[test]
fn numbers_that_are_none_are_kept_and_reported() {
    for word in ["1.#QNAN", "-1.#IND", "nan(ind)", "-1.#INF", "inf"] {
        let text = as_text(&placed(vec![])).replace("a: 0,0,0,1", &format!("a: 0,0,{word},1"));
        let scene = scene_of(text.as_bytes()).unwrap();
        assert!(crate::warnings(&scene).contains("positions have numbers that are infinite"), "{word}");
    }
}

#[test]
fn mistakes_in_texts_have_their_line() {
    let text = as_text(&placed(vec![]));
    let cases = [
        (
            text.replace("a: 0,1,2,-4", "a: 0,1,x,-4"),
            "scene.fbx:18:3: 'PolygonVertexIndex': there are numbers here",
        ),
        (text.replacen("Objects:", ":", 1), "scene.fbx:13:1: the name of a node is missing"),
        (text.replacen('}', "} }", 1), "this brace closes nothing"),
        ("BLEND".to_owned(), "this is neither a binary FBX file nor one in text"),
    ];
    for (text, part) in cases {
        let message = refused(text.as_bytes());
        assert!(message.contains(part), "{message}");
    }
}
