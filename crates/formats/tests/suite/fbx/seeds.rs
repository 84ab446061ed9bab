//! The seeds of the fuzz target, which this file makes. `BILUX_SEEDS=1` writes them.

use super::*;
use std::path::Path;

fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let nodes = placed(vec![p("Lcl Rotation", &[10.0, 20.0, 30.0]), p("InheritType", &[0.0])]);
    let whole = binary(7400, true, &nodes);
    let mut lying = binary(7400, false, &nodes);
    let at = lying.windows(9).position(|word| word == b"Verticesd").unwrap() + 9;
    lying[at..at + 4].copy_from_slice(&(1u32 << 28).to_le_bytes());
    vec![
        ("packed_7400.fbx", whole.clone()),
        ("plain_7400.fbx", binary(7400, false, &nodes)),
        ("wide_7700.fbx", binary(7700, true, &nodes)),
        ("text.fbx", as_text(&nodes).into_bytes()),
        ("broken_cut_off.fbx", whole[..whole.len() - 200].to_vec()),
        ("broken_lying_array.fbx", lying),
        ("broken_version.fbx", binary(5800, true, &nodes)),
    ]
}

#[test]
fn the_corpus_is_what_is_made_here() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/scene_fbx");
    for (name, bytes) in seeds() {
        let path = folder.join(name);
        if std::env::var_os("BILUX_SEEDS").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        assert!(std::fs::read(&path).unwrap() == bytes, "{name}: set BILUX_SEEDS=1 to write it");
    }
}
