//! Presets that the user asks for, and the studio for files without a camera or lights: how bare files are shown.

use crate::Error;
use bilux_formats::{FormatError, ReadOptions};
use bilux_math::{DMat3, DVec3};
use bilux_pictures::Limits;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::lights::surrounds;
pub use bilux_scene::presets::{
    Ground, PRESETS, PresetEntry, Studio, add_fog, add_missing, apply, frame, set_upright, shadow_catcher,
};
use bilux_scene::{Parameters, SceneBuilder, Span, Spec, Value, Warning};
use std::path::Path;

/// Returns a copy of the scene with a camera and lights added where they are missing, and with whatever the user asks
/// of the studio.
pub fn completed(scene: &SceneBuilder, studio: &Studio) -> SceneBuilder {
    let mut scene = scene.clone();
    bilux_scene::presets::complete(&mut scene, studio);
    scene
}

/// Shows an image in longitude and latitude as the background, whatever lights the scene.
///
/// # Errors
/// If the image cannot be read, or has no colours.
pub fn set_background(scene: &mut SceneBuilder, picture: &Path, options: &ReadOptions) -> Result<(), Error> {
    let light = picture_light(scene, picture, options)?;
    replace_backdrop(scene, light);
    Ok(())
}

/// Makes an environment the only backdrop of a scene.
pub(crate) fn replace_backdrop(scene: &mut SceneBuilder, environment: Spec) {
    scene.lights.retain(|light| !light.is_backdrop());
    scene.lights.push(environment.with("backdrop", true));
}

/// Surroundings that need no file.
pub struct Surroundings {
    /// The word that names them in place of a file.
    pub name: &'static str,
    /// Changes a scene.
    apply: fn(&mut SceneBuilder),
}

/// All surroundings that need no file.
pub static SURROUNDINGS: &[Surroundings] = &[
    // The studio adds nothing to lights of the scene's own.
    Surroundings { name: "none", apply: |scene| scene.environment_unspecified = false },
    Surroundings {
        name: "sky",
        apply: |scene| replace_surroundings(scene, Spec::new("surroundings", "sky")),
    },
    // The studio lights what has no lights.
    Surroundings {
        name: "studio",
        apply: |scene| {
            scene.lights.retain(Spec::is_backdrop);
            (scene.environment_unspecified, scene.describes_all_light) = (true, false);
        },
    },
];

/// The surroundings of this name; `None` if it is that of a file.
pub fn surroundings_named(name: &Path) -> Option<&'static Surroundings> {
    SURROUNDINGS.iter().find(|row| name == Path::new(row.name))
}

/// Surrounds a scene with one of [`SURROUNDINGS`], by its name, or with an environment map in longitude and latitude, in
/// place of what it may have around it. Other lights stay, except in the studio.
///
/// # Errors
/// If the image cannot be read, or has no colours.
pub fn surround(scene: &mut SceneBuilder, around: &Path, options: &ReadOptions) -> Result<(), Error> {
    match surroundings_named(around) {
        Some(row) => (row.apply)(scene),
        None => {
            let light = picture_light(scene, around, options)?;
            replace_surroundings(scene, light);
        }
    }
    Ok(())
}

fn replace_surroundings(scene: &mut SceneBuilder, light: Spec) {
    scene.lights.retain(|old| !surrounds(&old.kind) || old.is_backdrop());
    scene.lights.push(light);
}

/// Replaces the cameras of a scene by those of a file ([`bilux_formats::read_cameras`]). If it does not say where they are, they
/// stand where the scene's first camera does, or that of the studio: all, or the first, if it says how they stand to that.
///
/// # Errors
/// If the file cannot be read, or has no cameras.
pub fn take_cameras(scene: &mut SceneBuilder, file: &Path, options: &ReadOptions) -> Result<(), Error> {
    let read = bilux_formats::read_cameras(file, options)?;
    let at = Span { file: file.display().to_string().into(), line: 0, column: 0 };
    scene.warnings.extend(read.warnings.into_iter().map(|message| Warning { message, at: at.clone() }));
    let mut cameras: Vec<_> = read.cameras.into_iter().map(CameraSpec::new).collect();
    if !read.are_placed {
        let standing = completed(scene, &Studio::default());
        let first = standing.cameras.first().map(|camera| &camera.spec.parameters);
        if let Some(first) = first.filter(|_| read.are_relative) {
            cameras.iter_mut().for_each(|camera| stand_relative_to(first, &mut camera.spec.parameters));
            scene.cameras = cameras;
            return Ok(());
        }
        for key in ["position", "look_at", "up"] {
            let Some((value, at)) = first.and_then(|first| first.find(key)) else { continue };
            cameras
                .iter_mut()
                .for_each(|camera| camera.spec.parameters.set_at(key, value.clone(), at.clone()));
        }
    }
    scene.cameras = cameras;
    Ok(())
}

/// Moves a camera from the frame of another into the world in which that one is.
fn stand_relative_to(other: &Parameters, own: &mut Parameters) {
    let number = |value: &Value| match value {
        Value::Number(number) => *number,
        Value::Integer(number) => *number as f64,
        _ => 0.0,
    };
    let point = |of: &Parameters, key: &str, default: DVec3| match of.find(key) {
        Some((Value::List(numbers), _)) => match &numbers.iter().map(number).collect::<Vec<f64>>()[..] {
            &[x, y, z] => DVec3::new(x, y, z),
            _ => default,
        },
        _ => default,
    };
    let position = point(other, "position", DVec3::ZERO);
    let back = (position - point(other, "look_at", DVec3::NEG_Z)).normalize_or(DVec3::Z);
    let right = point(other, "up", DVec3::Y).cross(back).normalize_or(back.any_orthonormal_vector());
    let axes = DMat3::from_cols(right, back.cross(right), back);
    for (key, origin) in [("position", position), ("look_at", position), ("up", DVec3::ZERO)] {
        let moved = origin + axes * point(own, key, DVec3::ZERO);
        own.set(key, Value::List(moved.to_array().map(Value::Number).to_vec()));
    }
}

/// Fault of the image itself: an error's position in the generated text below would mean nothing to the user.
fn picture_fault(picture: &Path, options: &ReadOptions) -> Option<Error> {
    let limits = Limits::new(options.max_memory);
    let read = bilux_pictures::read_with(picture, &limits);
    let main = read.and_then(|read| read.with_main(options.picture_layer.as_deref()));
    main.err().map(|error| error.in_file(picture).into())
}

/// An environment map as a light; its texture joins the scene's.
fn picture_light(scene: &mut SceneBuilder, picture: &Path, options: &ReadOptions) -> Result<Spec, Error> {
    let name = picture.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    // Written as a scene file would be, so that the image is found, decoded and refused exactly as a scene's images
    // are.
    let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let layer =
        options.picture_layer.as_deref().map_or_else(String::new, |l| format!(", layer = {}", quoted(l)));
    let text = format!(
        "[[light]]\nname = \"surroundings\"\nkind = \"environment\"\nradiance = {{ texture = {}{layer} }}\n",
        quoted(&name)
    );
    let folder = picture.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let options = ReadOptions { strict: false, ..options.clone() };
    let read = bilux_formats::read_bytes(text.as_bytes(), "toml", Some(folder), &name, &options);
    let mut read = read.map_err(|error| picture_fault(picture, &options).unwrap_or(error.into()))?;
    // A user who asks for it does not want a grey in its place.
    let is_lost = |warning: &Warning| warning.message.starts_with("a texture is replaced");
    if let Some(lost) = read.warnings.iter().position(is_lost) {
        let error = FormatError::Strict(read.warnings.swap_remove(lost));
        return Err(picture_fault(picture, &options).unwrap_or(error.into()));
    }
    // A place in the text above would mean nothing.
    scene.warnings.extend(read.warnings.drain(..).map(|warning| Warning { at: Span::default(), ..warning }));
    let before = scene.textures.len();
    scene.textures.append(&mut read.textures);
    scene.files.append(&mut read.files);
    let mut light = read.lights.swap_remove(0);
    for (_, value, _) in &mut light.parameters.0 {
        if let Value::Texture(index) = value {
            *index += before;
        }
    }
    Ok(light)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_scene::LIGHTS;

    #[test]
    fn surroundings_that_need_no_file_take_the_place_of_those_there_are() {
        let surrounded = |around: &str| {
            let mut scene = SceneBuilder { describes_all_light: true, ..SceneBuilder::default() };
            scene.lights.push(Spec::new("lamp", "point"));
            let kinds = LIGHTS.iter().map(|row| row.entry.name).filter(|kind| surrounds(kind));
            scene.lights.extend(kinds.map(|kind| Spec::new(kind, kind)));
            scene.lights.push(Spec::new("behind", "environment").with("backdrop", true));
            let read = surround(&mut scene, Path::new(around), &ReadOptions::default());
            let names: Vec<String> = scene.lights.iter().map(|light| light.name.clone()).collect();
            (read.map(|()| (names, scene.environment_unspecified, scene.describes_all_light)), scene)
        };
        let names = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let (sky, scene) = surrounded("sky");
        assert_eq!(sky.unwrap(), (names(&["lamp", "behind", "surroundings"]), false, true));
        assert_eq!(scene.lights[2].kind, "sky");
        // The studio lights what has no light, and says nothing of it.
        let (studio, scene) = surrounded("studio");
        assert_eq!(studio.unwrap(), (names(&["behind"]), true, false));
        assert!(!bilux_scene::presets::seems_lit(&scene));
        let before = names(&["lamp", "environment", "sky", "cie-sky", "perez-sky", "behind"]);
        assert_eq!(surrounded("none").0.unwrap(), (before, false, true));
        assert!(surrounded("./sky").0.unwrap_err().to_string().contains("cannot open"), "that is a file");
    }
}
