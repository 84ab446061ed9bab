//! Every structure agrees on a mesh and rays made from arbitrary bytes: the fuzzer's seeds, and as many random ones
//! as time allows. `fuzz/run.sh rays` continues from here.

use crate::support::fuzzed;
use bilux_math::hash::hash_words;
use bilux_testing::effort;
use rayon::prelude::*;
use std::fs;
use std::path::Path;

#[test]
fn every_structure_agrees_on_the_seeds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/rays");
    let seeds: Vec<_> =
        fs::read_dir(folder).expect("seeds").map(|entry| entry.expect("a seed").path()).collect();
    assert!(seeds.len() >= 5);
    for seed in seeds {
        assert!(fuzzed::agree(&fs::read(&seed).expect("a seed")) > 0, "{} hits nothing", seed.display());
    }
}

#[test]
fn every_structure_agrees_on_random_bytes() {
    let seeds = effort(250, 1500);
    let found: usize = (0..seeds)
        .into_par_iter()
        .map(|seed| {
            let len = 200 + hash_words([seed, 0]) % 1500;
            let byte = |i: u64| {
                let byte = hash_words([seed, i, 1]) as u8;
                // Numbers on the lattice are made more frequent, or few rays would hit anything.
                if seed % 4 > 0 && hash_words([seed, i, 2]) % 16 > 0 { byte & 127 } else { byte }
            };
            fuzzed::agree(&(0..len).map(byte).collect::<Vec<u8>>())
        })
        .sum();
    assert!(found > seeds as usize, "{found}");
}
