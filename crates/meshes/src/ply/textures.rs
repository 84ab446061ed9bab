//! The textures of a mesh, which comments of the header name.

use super::reader::Ply;
use bilux_import::FormatError;
use bilux_import::input::reading::{Texels, plain_material};
use bilux_import::meshes::indexed_faces::{NONE, Run};
use bilux_scene::{SceneBuilder, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

impl Ply<'_, '_, '_> {
    /// Begins a run of faces for each texture, and returns the materials by name. MeshLab names textures in comments,
    /// and each face has the number of one in `texnumber`.
    pub(super) fn materials(
        &mut self,
        textures: &[(String, usize)],
        scene: &mut SceneBuilder,
    ) -> Result<HashMap<String, usize>, FormatError> {
        let mut materials = HashMap::new();
        let name = self.source.stem();
        let mut numbers = std::mem::take(&mut self.face_textures);
        let groups = if textures.len() < 2 || numbers.is_empty() {
            self.only_texture(textures, scene, &mut materials)?;
            vec![(0, NONE)]
        } else {
            self.check_numbers(&mut numbers, textures.len());
            self.indexed.sort_by(&numbers)
        };
        for (first_face, number) in groups {
            let material = match textures.get(number as usize) {
                Some((file, offset)) => {
                    let key = format!("{number} {file}");
                    self.texture(file, *offset, &key, scene, &mut materials)?;
                    Some((key, *offset as u64))
                }
                None => None,
            };
            self.indexed.runs.push(Run { first_face, name: name.clone(), material });
        }
        Ok(materials)
    }

    /// Takes away numbers of textures that there are not.
    fn check_numbers(&mut self, numbers: &mut [u32], count: usize) {
        let wrong = |(_, number): &(usize, &mut u32)| **number != NONE && **number as usize >= count;
        for (face, number) in numbers.iter_mut().enumerate().filter(wrong) {
            let (places, at) = (self.places, self.indexed.places.at(face) as usize);
            let first =
                || format!("a face has the texture {number}, but there are only {count}, counted from 0");
            self.diagnostics.note_first(": such faces have none", first, || places.at(at));
            *number = NONE;
        }
    }

    /// Adds the texture of the whole mesh, if there is one, as the material without a name.
    pub(super) fn only_texture(
        &mut self,
        textures: &[(String, usize)],
        scene: &mut SceneBuilder,
        materials: &mut HashMap<String, usize>,
    ) -> Result<(), FormatError> {
        let [(file, offset), others @ ..] = textures else { return Ok(()) };
        if let Some((_, other)) = others.first() {
            let places = self.places;
            let what = "textures after the first, since faces do not say which they have";
            self.diagnostics.not_shown(what, || places.at(*other));
        }
        self.texture(file, *offset, "", scene, materials)
    }

    /// Adds a texture as a material.
    fn texture(
        &mut self,
        file: &str,
        offset: usize,
        key: &str,
        scene: &mut SceneBuilder,
        materials: &mut HashMap<String, usize>,
    ) -> Result<(), FormatError> {
        let at = self.places.at(offset);
        let texture = match self.reading.texture(self.source.folder, file, Texels::Colours, &at) {
            Ok(texture) => texture,
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            Err(error) => {
                let reason = error.without_place();
                scene.warn(format!("a texture is replaced by a magenta checker: {reason}"), at.clone());
                Arc::new(Texture::missing(file))
            }
        };
        let mut spec = plain_material(false, !self.indexed.specular.is_empty());
        spec.parameters.set_at("kd", Value::Texture(scene.textures.len()), at);
        scene.textures.push(texture);
        let index = scene.add_material(spec);
        materials.insert(key.to_owned(), index);
        Ok(())
    }
}
