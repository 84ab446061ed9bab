//! Fingerprint of a picture, known before it is rendered: partial films merge only if their fingerprints agree.

use crate::encoding::hash_what_is_seen;
use crate::settings::Settings;
use bilux_scene::SceneBuilder;

/// Returns a hexadecimal hash of a scene and of every setting that its samples depend on. Settings that change no
/// sample (threads, accelerator, number of samples, crop, display) are left out, and so are names.
pub fn fingerprint(scene: &SceneBuilder, settings: &Settings) -> String {
    let s = settings;
    let mut text = format!(
        "{} {} {} {} {} {:08x} {:08x} {} {} {:?} {}",
        s.width,
        s.height,
        s.seed,
        s.max_depth,
        s.camera,
        s.time.to_bits(),
        s.shutter.to_bits(),
        s.filter,
        s.corner_anchor,
        s.accel.query.culling,
        s.filters_textures && !scene.textures.is_empty(),
    );
    if s.readout != 0.0 {
        text += &format!(" {:08x}", s.readout.to_bits());
    }
    let hash = hash_what_is_seen(scene, &[&settings.integrator_parameters], &text).to_string();
    hash[..32].to_owned()
}
