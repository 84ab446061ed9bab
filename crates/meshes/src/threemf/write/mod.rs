//! Writes 3MF: a package with one model, its pictures, and what says where they are.

mod looks;
mod meshes;
mod model;

use bilux_import::FormatError;
use bilux_import::bytes::xml::escaped;
use bilux_import::bytes::zipped::{Members, zipped};
use bilux_import::output::bake::warn_of_scene;
use bilux_import::output::writing::Writing;
use bilux_scene::{Object, SceneBuilder, Visibility};
use model::Model;

/// Content types of the package's parts. [3MF Core 1.3, 2]
const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\
    <Default Extension=\"png\" ContentType=\"image/png\"/></Types>\n";

/// The kind of relationship to the model, and to its textures.
const MODEL: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const TEXTURE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture";

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, "3MF", writing);
    let mut model = Model::new(scene);
    let shown = |object: &&Object| object.visibility != Visibility::Hidden;
    for object in scene.objects.iter().filter(shown) {
        model.object(object, writing)?;
    }
    if model.open > 0 {
        writing.warn(format!(
            "{} of the {} meshes are not closed, as 3D printing needs them: they are written as surfaces",
            model.open,
            model.meshes.len()
        ));
    }
    let pictures: Vec<_> = writing.take_beside();
    let textures: Vec<String> = pictures.iter().map(|(name, _)| format!("/3D/Textures/{name}")).collect();
    let mut members = vec![
        ("[Content_Types].xml".to_owned(), TYPES.as_bytes().to_vec()),
        ("_rels/.rels".to_owned(), relationships(MODEL, &["/3D/3dmodel.model".to_owned()])),
        ("3D/3dmodel.model".to_owned(), model.finish()),
    ];
    if !textures.is_empty() {
        members.push(("3D/_rels/3dmodel.model.rels".to_owned(), relationships(TEXTURE, &textures)));
    }
    members.extend(pictures.into_iter().map(|(name, bytes)| (format!("3D/Textures/{name}"), bytes)));
    writing.main = zipped(&members, Members::Deflated)?;
    Ok(())
}

fn relationships(kind: &str, targets: &[String]) -> Vec<u8> {
    let one = |(i, target): (usize, &String)| {
        let target = escaped(target);
        format!("<Relationship Target=\"{target}\" Id=\"rel{i}\" Type=\"{kind}\"/>")
    };
    let all: String = targets.iter().enumerate().map(one).collect();
    let space = "http://schemas.openxmlformats.org/package/2006/relationships";
    let head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    format!("{head}<Relationships xmlns=\"{space}\">{all}</Relationships>\n").into_bytes()
}
