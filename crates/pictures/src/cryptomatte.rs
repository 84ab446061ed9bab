//! Cryptomatte: layers from which compositors cut out anything by its name. [Friedman 2015; Cryptomatte]
//!
//! A name becomes a number by MurmurHash3, and the number the bits of a float. Each pixel has pairs of such numbers and of
//! the fractions that they cover, those that cover most first, two pairs in each layer of four channels. The manifest, in
//! the metadata, lists the names.

use crate::{Picture, PictureError};
use std::collections::BTreeMap;

/// The names of one kind of things, and the ids that stand for them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cryptomatte {
    /// The name of the layers, such as `CryptoObject`.
    pub layer: String,
    ids: BTreeMap<String, u32>,
}

impl Cryptomatte {
    /// Without names so far.
    pub fn new(layer: &str) -> Cryptomatte {
        Cryptomatte { layer: layer.to_owned(), ids: BTreeMap::new() }
    }

    /// The id of a name, which joins the manifest. Equal names have one id.
    pub fn add(&mut self, name: &str) -> u32 {
        if let Some(id) = self.ids.get(name) {
            return *id;
        }
        let id = id_of(name);
        self.ids.insert(name.to_owned(), id);
        id
    }

    /// The manifest as JSON: each name with its id in eight hexadecimal digits. Only ASCII, whatever the names are.
    pub fn manifest(&self) -> String {
        let entries: Vec<String> =
            self.ids.iter().map(|(name, id)| format!("{}:\"{id:08x}\"", quoted(name))).collect();
        format!("{{{}}}", entries.join(","))
    }

    /// The metadata, which are found by the first seven digits of the layer's own id.
    pub fn metadata(&self) -> [(String, String); 4] {
        let key = format!("{:08x}", id_of(&self.layer));
        let entry = |what: &str, value: &str| (format!("cryptomatte/{}/{what}", &key[..7]), value.to_owned());
        [
            entry("name", &self.layer),
            entry("hash", "MurmurHash3_32"),
            entry("conversion", "uint32_to_float32"),
            entry("manifest", &self.manifest()),
        ]
    }

    /// Adds layers and metadata to a picture, given the ids of each pixel and the fractions that they cover.
    ///
    /// # Errors
    /// When the picture has a different size, or already has such layers.
    pub fn push<const RANKS: usize>(
        &self,
        picture: &mut Picture,
        pixels: &[[(u32, f32); RANKS]],
    ) -> Result<(), PictureError> {
        for rank in 0..RANKS {
            let channels = if rank % 2 == 0 { ["red", "green"] } else { ["blue", "alpha"] };
            let [id, share] = channels.map(|channel| format!("{}{:02}.{channel}", self.layer, rank / 2));
            picture.push_channel(id, pixels.iter().map(|pixel| f32::from_bits(pixel[rank].0)).collect())?;
            picture.push_channel(share, pixels.iter().map(|pixel| pixel[rank].1).collect())?;
        }
        picture.metadata.extend(self.metadata());
        Ok(())
    }
}

/// The bits of the float that stands for a name: its hash, with an exponent that makes it a normal number.
pub fn id_of(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    let exponent = (hash >> 23 & 0xff).clamp(1, 254);
    hash & 0x807f_ffff | exponent << 23
}

/// MurmurHash3 of 32 bits for x86, with seed 0. [Appleby 2011]
fn murmur3(bytes: &[u8]) -> u32 {
    let scramble = |word: u32| word.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (words, rest) = bytes.as_chunks::<4>();
    let mut hash = words.iter().fold(0u32, |hash, word| {
        let mixed = hash ^ scramble(u32::from_le_bytes(*word));
        mixed.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    let last = rest.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
    hash ^= scramble(last);
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// A JSON string of ASCII.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            ' '..='~' => quoted.push(letter),
            _ => {
                let mut units = [0; 2];
                letter.encode_utf16(&mut units).iter().for_each(|unit| quoted += &format!("\\u{unit:04x}"));
            }
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_reference() {
        // From other implementations.
        for (text, hash) in [
            ("", 0),
            ("a", 0x3c25_69b2),
            ("hello", 0x248b_fa47),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text:?}");
        }
    }

    #[test]
    fn every_id_is_a_normal_number() {
        let names = (0..200_000).map(|i| format!("object {i}"));
        assert!(names.chain([String::new()]).all(|name| f32::from_bits(id_of(&name)).is_normal()));
        // Exponents that would make infinities, NaNs or denormal numbers do occur.
        let raw = |name: &String| f32::from_bits(murmur3(name.as_bytes())).is_normal();
        assert!(!(0..2000).map(|i| format!("object {i}")).all(|name| raw(&name)));
    }

    #[test]
    fn names_of_strangers_are_escaped() {
        let mut matte = Cryptomatte::new("CryptoObject");
        for name in ["plain", "a\"b\\c", "line\nbreak", "Käse", "🫖", "\u{7f}</script>"] {
            matte.add(name);
        }
        let manifest = matte.manifest();
        assert!(manifest.is_ascii() && !manifest.contains('\n'), "{manifest}");
        for part in ["\"a\\\"b\\\\c\":", "\"line\\u000abreak\":", "\"K\\u00e4se\":", "\"\\ud83e\\uded6\":"] {
            assert!(manifest.contains(part), "{part} in {manifest}");
        }
    }

    #[test]
    fn two_things_of_one_name_have_one_id() {
        let mut matte = Cryptomatte::new("CryptoObject");
        assert_eq!(matte.add("cup"), matte.add("cup"));
        assert_ne!(matte.add("cup"), matte.add("saucer"));
        assert_eq!(matte.manifest().matches("cup").count(), 1);
    }
}
