//! Fog around everything, for those who want just that.

use crate::builder::{Object, SceneBuilder};
use crate::mesh::shapes::cuboid;
use crate::parameters::Spec;
use bilux_math::{Aabb, Vec3};
use std::sync::Arc;

/// Visibility times extinction: at that distance a black body has 2% of the contrast that it has close by. [Koschmieder 1924]
const VISIBILITY: f32 = 3.912;

/// Height of fog above and below everything, over the visibility: less than the reach of fog sideways, so that the sky lights it.
const HEIGHT: f32 = 0.25;

/// Fills a scene with fog in which people see this many metres far, if it is given. It reaches as far beyond the objects and cameras.
pub fn add_fog(scene: &mut SceneBuilder, visibility: Option<f32>) {
    let Some(visibility) = visibility else { return };
    let positions = scene.cameras.iter().filter_map(|camera| camera.spec.vector("position"));
    let around = positions.fold(scene.bounds(0.0), |bounds, p| bounds.union(Aabb { min: p, max: p }));
    let around = if around.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { around };
    let reach = Vec3::new(1.0, HEIGHT, 1.0) * visibility;
    let bounds = Aabb { min: around.min - reach, max: around.max + reach };
    let fog = Spec::new("fog", "interface")
        .with("scattering", VISIBILITY / visibility)
        .with("phase", "droplets")
        .with("priority", 1);
    let material = scene.add_material(fog);
    scene.objects.push(Object::new("fog", Arc::new(cuboid(bounds)), material));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::CameraSpec;
    use crate::media::Medium;
    use crate::{AccelChoice, SceneBuilder};
    use bilux_math::transcendental::exp;

    #[test]
    fn fog_reaches_beyond_everything_and_lets_two_percent_pass() {
        let mut scene = SceneBuilder::default();
        let grey = scene.add_material(Spec::new("", "diffuse"));
        let ball = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        scene.objects.push(Object::new("box", Arc::new(cuboid(ball)), grey));
        let spec = Spec::new("", "perspective").with("position", Vec3::new(0.0, 2.0, 7.0));
        scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
        add_fog(&mut scene, None);
        assert_eq!(scene.objects.len(), 1);
        add_fog(&mut scene, Some(20.0));
        let bounds = scene.bounds(0.0);
        assert_eq!((bounds.min, bounds.max), (Vec3::new(-21.0, -6.0, -21.0), Vec3::new(21.0, 7.0, 27.0)));
        let built = scene.build(&AccelChoice::default(), [0.0; 2], 1.0).unwrap();
        let material = built.material_of(1);
        let Medium { sigma_a, sigma_s, .. } = material.medium().unwrap();
        assert!(sigma_a.is_black() && (exp(-20.0 * sigma_s.g) - 0.02).abs() < 1e-4);
    }
}
