//! Surfaces of media that coincide.

use bilux_math::Vec3;
use bilux_scene::{Ray, Surface, Tracer};

/// Maximum number of surfaces that coincide with another; further ones are ignored.
pub(super) const MAX_COINCIDENT: usize = 3;

/// Surfaces coincide if they are closer than this part of the error of a hit. Rays that leave a surface start beyond the
/// whole error, and so beyond all that coincide with it.
const PART_OF_ERROR: f32 = 0.5;

/// Minimum cosine of the angle between their normals.
const PARALLEL: f32 = 0.9;

/// Surfaces of other media where a ray hits the surface of one.
pub(super) struct Coincident {
    /// One for each body, nearest first.
    pub(super) others: Vec<Surface>,
    /// The largest distance along the ray.
    pub(super) t: f32,
}

impl Coincident {
    /// Surfaces that coincide with the closest one along a ray; none unless that is the surface of a medium with a priority.
    pub(super) fn with(tracer: &mut Tracer, ray: &Ray, surface: &Surface) -> Coincident {
        let (scene, direction) = (tracer.scene, Vec3::from(ray.direction));
        let is_nested = |object| scene.nested(object).is_some();
        let is_one = |a, b| scene.body(a) == scene.body(b);
        let mut found = Coincident { others: Vec::new(), t: surface.t };
        if !scene.has_nested() || !is_nested(surface.object) {
            return found;
        }
        let near = PART_OF_ERROR * surface.n_geom.abs().dot(surface.p_error);
        let reach = near / surface.n_geom.dot(direction).abs();
        let t_max = (surface.t + reach).min(ray.t_max);
        let around = Ray { t_min: surface.t, t_max, exclude: surface.primitive, ..*ray };
        for hit in tracer.all_hits(&around) {
            let object = scene.geometry().object_of(&hit);
            let is_known = is_one(object, surface.object)
                || found.others.iter().any(|other| is_one(object, other.object));
            if is_known || !is_nested(object) || found.others.len() == MAX_COINCIDENT {
                continue;
            }
            let other = tracer.surface(ray, &hit);
            let is_parallel = other.n_geom.dot(surface.n_geom).abs() >= PARALLEL;
            // A grazing ray reaches far.
            let is_near = surface.n_geom.dot(other.p - surface.p).abs() <= near + other.p_error.max_element();
            if is_parallel && is_near {
                found.t = found.t.max(other.t);
                found.others.push(other);
            }
        }
        found
    }
}
