//! What identifies a picture before it is rendered: partial films merge only if their fingerprints agree.

use crate::settings::Settings;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Texture};
use sha2::{Digest, Sha256};

/// Returns a hexadecimal hash of a scene and of every setting that its samples depend on. Settings that change no
/// sample (threads, accelerator, number of samples, crop, display) are left out.
pub fn fingerprint(scene: &SceneBuilder, settings: &Settings) -> String {
    let mut hash = Sha256::new();
    for object in &scene.objects {
        let mesh = &*object.mesh;
        points(&mut hash, &mesh.positions);
        points(&mut hash, &mesh.normals);
        floats(&mut hash, mesh.uvs.iter().flat_map(|v: &Vec2| v.to_array()));
        // Few meshes have these; films of all other meshes keep their old fingerprints.
        if !mesh.uvs2.is_empty() || !mesh.tangents.is_empty() {
            floats(&mut hash, mesh.uvs2.iter().flat_map(|v: &Vec2| v.to_array()));
            floats(&mut hash, mesh.tangents.iter().flat_map(|t| t.to_array()));
        }
        floats(&mut hash, mesh.vertex_kd.iter().chain(&mesh.vertex_ks).flat_map(|c: &Rgb| c.to_array()));
        hash.update((mesh.triangles.len() as u64).to_le_bytes());
        for index in mesh.triangles.iter().flatten() {
            hash.update(index.to_le_bytes());
        }
        // Few meshes have these either.
        if mesh.stroke_count() > 0 {
            for index in mesh.points.iter().chain(mesh.lines.iter().flatten()) {
                hash.update(index.to_le_bytes());
            }
            hash.update(format!("{} strokes {:?}", mesh.points.len(), scene.stroke_widths));
        }
        hash.update(format!("{} {:?}", object.material, object.motion));
    }
    if settings.filters_textures && !scene.textures.is_empty() {
        hash.update("footprint");
    }
    scene.textures.iter().for_each(|texture| hash_texture(&mut hash, texture));
    for spec in scene.materials.iter().chain(&scene.lights) {
        hash_spec(&mut hash, spec);
    }
    for camera in &scene.cameras {
        hash_spec(&mut hash, &camera.spec);
        for (time, changes) in &camera.keyframes {
            hash.update(time.to_le_bytes());
            hash_parameters(&mut hash, changes);
        }
    }
    hash_spec(&mut hash, &settings.integrator_parameters);
    let s = settings;
    hash.update(format!(
        "{} {} {} {} {} {} {} {} {} {:?}",
        s.width,
        s.height,
        s.seed,
        s.max_depth,
        s.camera,
        s.time,
        s.shutter,
        s.filter,
        s.corner_anchor,
        s.accel.query.culling
    ));
    hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

fn points(hash: &mut Sha256, points: &[Vec3]) {
    floats(hash, points.iter().flat_map(|p| p.to_array()));
}

fn floats(hash: &mut Sha256, values: impl Iterator<Item = f32>) {
    let mut count = 0u64;
    for value in values {
        hash.update(value.to_le_bytes());
        count += 1;
    }
    hash.update(count.to_le_bytes());
}

fn hash_texture(hash: &mut Sha256, texture: &Texture) {
    let (width, height) = (texture.width(), texture.height());
    hash.update(format!("{width} {height} {:?} {:?} {:?}", texture.wrap, texture.filter, texture.transform));
    if texture.second_uv {
        hash.update("second");
    }
    match texture.formula() {
        None => floats(hash, texture.texels().flat_map(|c| c.to_array())),
        Some(formula) => {
            hash_spec(hash, formula.spec());
            hash.update(format!("{:?} {:?} {:?}", texture.factor, texture.channel, texture.threshold));
            formula.parts().for_each(|part| hash_texture(hash, part));
        }
    }
}

fn hash_spec(hash: &mut Sha256, spec: &bilux_scene::Spec) {
    hash.update(format!("{} {}", spec.name, spec.kind));
    hash_parameters(hash, &spec.parameters);
}

/// The place in the file where a value was written does not matter.
fn hash_parameters(hash: &mut Sha256, parameters: &bilux_scene::Parameters) {
    for (key, value, _) in &parameters.0 {
        hash.update(format!("{key}={value:?};"));
    }
}
