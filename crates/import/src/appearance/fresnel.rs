//! Reflectances of boundaries.

use bilux_math::Rgb;

/// The fraction of diffuse light from below that a boundary reflects.
///
/// By reciprocity, the transmitted fraction is that from above divided by the squared index.
pub fn reflected_inside(index: f32) -> f32 {
    const STEPS: u32 = 512;
    let step = |i: u32| {
        let cos = (i as f32 + 0.5) / STEPS as f32;
        fresnel(cos, index) * 2.0 * cos / STEPS as f32
    };
    let above: f32 = (0..STEPS).map(step).sum();
    1.0 - (1.0 - above) / (index * index)
}

/// The reflectance of a dielectric with an index relative to where light comes from. [Fresnel 1823]
pub fn fresnel(cos: f32, index: f32) -> f32 {
    let inside = (1.0 - (1.0 - cos * cos) / (index * index)).max(0.0).sqrt();
    let across = (cos - index * inside) / (cos + index * inside);
    let along = (index * cos - inside) / (index * cos + inside);
    0.5 * (across * across + along * along)
}

/// The extinction coefficient at which a metal of index 1 has this reflectance at normal incidence.
pub fn extinction_of(reflectance: Rgb) -> Rgb {
    reflectance.map(|r| {
        let r = r.clamp(0.0, 0.9999);
        (2.0 * r.sqrt() / (1.0 - r).sqrt()).min(100.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn internal_reflectance_matches_tables() {
        // [Egan 1973]: 0.596 for an index of 1.5.
        assert!((reflected_inside(1.5) - 0.596).abs() < 2e-3, "{}", reflected_inside(1.5));
        assert!(reflected_inside(1.0).abs() < 1e-4);
    }
}
