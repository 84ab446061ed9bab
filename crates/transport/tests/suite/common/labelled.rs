//! Labels of a scene, by their names.

use bilux_math::{Vec2, Vec3};
use bilux_pictures::Picture;
use bilux_scene::Scene;
use bilux_transport::aovs::Aov;
use bilux_transport::labels::{Moment, Wanted, labels};
use bilux_transport::{RenderSettings, Silent};

/// All labels of the scene's first camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    pub depth: Vec<f32>,
    pub z_depth: Vec<f32>,
    pub normal: Vec<Vec3>,
    pub camera_normal: Vec<Vec3>,
    pub object: Vec<u32>,
    pub material: Vec<u32>,
    pub position: Vec<Vec3>,
    pub uv: Vec<Vec2>,
    pub primitive: Vec<u32>,
    pub barycentric: Vec<Vec2>,
    pub motion: Vec<Vec2>,
    pub backward_motion: Vec<Vec2>,
    pub occluded: Vec<Vec2>,
}

impl Labelled {
    pub fn of(scene: &Scene, settings: &RenderSettings) -> Labelled {
        Labelled::between(scene, settings, [None, None])
    }

    /// With the next frame and the previous one.
    pub fn between(scene: &Scene, settings: &RenderSettings, others: [Option<Moment>; 2]) -> Labelled {
        let aovs: Vec<Aov> = Aov::labels().collect();
        let [next, previous] = others;
        let wanted = Wanted { aovs: &aovs, next, previous, ..Wanted::default() };
        let found = labels(scene, &*scene.cameras()[0].1, settings, &wanted, &Silent).unwrap().unwrap();
        let (floats, integers) = (|name: &str| floats(&found, name), |name: &str| integers(&found, name));
        let vectors = |layer: &str| {
            let [x, y, z] = ["X", "Y", "Z"].map(|axis| floats(&format!("{layer}.{axis}")));
            x.iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(*x, y, z)).collect::<Vec<Vec3>>()
        };
        let pairs = |layer: &str, [a, b]: [&str; 2]| {
            let [x, y] = [a, b].map(|name| floats(&format!("{layer}.{name}")));
            x.into_iter().zip(y).map(|(x, y)| Vec2::new(x, y)).collect::<Vec<Vec2>>()
        };
        Labelled {
            depth: floats("depth.Z"),
            z_depth: floats("z_depth.Z"),
            normal: vectors("normal"),
            camera_normal: vectors("camera_normal"),
            object: integers("id.object"),
            material: integers("id.material"),
            position: vectors("position"),
            uv: pairs("uv", ["U", "V"]),
            primitive: integers("primitive.id"),
            barycentric: pairs("barycentric", ["U", "V"]),
            motion: pairs("motion", ["X", "Y"]),
            backward_motion: pairs("backward_motion", ["X", "Y"]),
            occluded: pairs("occluded", ["next", "previous"]),
        }
    }
}

fn floats(picture: &Picture, name: &str) -> Vec<f32> {
    picture.channel(name).unwrap_or_else(|| panic!("no channel {name}")).to_vec()
}

fn integers(picture: &Picture, name: &str) -> Vec<u32> {
    picture.integer_plane(name).unwrap_or_else(|| panic!("no plane {name}")).to_vec()
}
