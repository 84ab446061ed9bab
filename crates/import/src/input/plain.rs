//! Materials of what has none.

use bilux_scene::Spec;

/// The material of files that do not describe any.
pub fn default_material() -> Spec {
    Spec::new("default", "phong")
}

/// The default material for vertices with kd or ks. These are the reflectances themselves, so the material's own
/// factors are 1.
pub fn plain_material(vertex_kd: bool, vertex_ks: bool) -> Spec {
    let mut spec = default_material();
    for (key, _) in [("kd", vertex_kd), ("ks", vertex_ks)].iter().filter(|(_, given)| *given) {
        "vertices".clone_into(&mut spec.name);
        spec.parameters.set(key, 1.0);
    }
    spec
}
