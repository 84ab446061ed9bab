//! `course`: renders `.asc` files as the renderer of their course did.
//!
//! It has a left-handed camera, a model matrix, lights fixed to the camera and one material. Pixels are sampled at
//! their corners, and bytes are proportional to light.

#![allow(clippy::approx_constant, reason = "0.7071 is what that renderer has, not the square root of a half")]

use super::{PresetEntry, affine, move_all, set_all};
use crate::builder::SceneBuilder;
use crate::cameras::CameraSpec;
use crate::messages::error::SceneError;
use crate::parameters::{Spec, Value};
use bilux_math::registry::Entry;
use bilux_math::transcendental::tan_f64;
use bilux_math::{DMat3, DVec3, Rgb, Transform, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

pub(super) const ENTRY: PresetEntry = PresetEntry {
    entry: Entry {
        name: "course",
        summary: "like the course renderer that .asc files come from: its camera, lights, material, pixels and \
                  transfer function",
        source: "",
        parameters: &[],
    },
    apply: |scene| apply(scene, &FIRST_VIEW),
};

pub(super) const SECOND: PresetEntry = PresetEntry {
    entry: Entry {
        name: "course-2",
        summary: "like 'course', with that renderer's second camera",
        source: "",
        parameters: &[],
    },
    apply: |scene| apply(scene, &SECOND_VIEW),
};

/// A camera of the course, angles in degrees.
pub(super) struct CourseView {
    /// The centre of the image plane, not the eye.
    position: Vec3,
    look_at: Vec3,
    up: Vec3,
    fov: f32,
}

pub(super) const FIRST_VIEW: CourseView =
    CourseView { position: Vec3::new(-10.0, 5.0, -10.0), look_at: Vec3::ZERO, up: Vec3::Y, fov: 35.0 };

const SECOND_VIEW: CourseView = CourseView {
    position: Vec3::new(13.2, -8.7, -14.8),
    look_at: Vec3::new(0.8, 0.7, 4.5),
    up: Vec3::new(-0.2, 1.0, 0.0),
    fov: 53.7,
};

impl CourseView {
    /// The camera's x, y and z axes in world space, as columns. Left-handed means that x = y × z points to the right of
    /// the image while z points into it.
    pub(super) fn axes(&self) -> DMat3 {
        let z = (self.look_at - self.position).as_dvec3().normalize();
        let up = self.up.as_dvec3();
        let y = (up - z * up.dot(z)).normalize();
        DMat3::from_cols(y.cross(z), y, z)
    }

    /// The centre of projection. That renderer divides x and y by `z tan(fov / 2) + 1`, where z is the depth from
    /// `position`: rays meet where this is zero, 1/tan(fov / 2) behind it.
    fn eye(&self) -> Vec3 {
        let behind = 1.0 / tan_f64(f64::from(self.fov).to_radians() / 2.0);
        (self.position.as_dvec3() - self.axes().z_axis * behind).as_vec3()
    }

    fn camera(&self) -> CameraSpec {
        let spec = Spec::new("course", "perspective")
            .with("position", self.eye())
            .with("look_at", self.look_at)
            .with("up", self.up)
            .with("fov", self.fov)
            .with("mirrored", true);
        CameraSpec { spec, keyframes: Vec::new() }
    }
}

/// The course's rotations about y and x, concatenated (x first), with the number of digits that it used.
pub(super) fn turn() -> DMat3 {
    let about_y = DMat3::from_cols_array_2d(&[[0.866, 0.0, 0.5], [0.0, 1.0, 0.0], [-0.5, 0.0, 0.866]]);
    let about_x =
        DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [0.0, 0.7071, -0.7071], [0.0, 0.7071, 0.7071]]);
    about_y * about_x
}

/// Rotated, scaled by 3.25 and translated.
fn model() -> Transform {
    affine(turn() * 3.25, DVec3::new(0.0, -3.25, 3.5))
}

/// Lights in camera space: the direction towards each, and its colour.
const LIGHTS: [(Vec3, Rgb); 3] = [
    (Vec3::new(-0.7071, 0.7071, 0.0), Rgb::new(0.5, 0.5, 0.9)),
    (Vec3::new(0.0, -0.7071, -0.7071), Rgb::new(0.9, 0.2, 0.3)),
    (Vec3::new(0.7071, 0.0, -0.7071), Rgb::new(0.2, 0.7, 0.3)),
];

const BACKGROUND: [u8; 3] = [128, 112, 96];

fn apply(scene: &mut SceneBuilder, view: &CourseView) -> Result<(), SceneError> {
    move_all(scene, &model());
    let plastic = Spec::new("course", "phong")
        .with("ka", 0.1f32)
        .with("kd", 0.7f32)
        .with("ks", 0.3f32)
        .with("exponent", 32.0f32)
        .with("reflectivity", 0.0f32);
    scene.materials = vec![plastic];
    scene.textures.clear();
    for object in &mut scene.objects {
        object.material = 0;
        if !(object.mesh.vertex_kd.is_empty() && object.mesh.vertex_ks.is_empty()) {
            let mesh = Arc::make_mut(&mut object.mesh);
            mesh.vertex_kd.clear();
            mesh.vertex_ks.clear();
        }
    }
    scene.lights = lights(&view.axes());
    scene.cameras = vec![view.camera()];
    let settings = [
        ("integrator", Value::from("cast")),
        ("size", Value::from("256x256")),
        ("spp", Value::Integer(1)),
        ("pixel_anchor", Value::from("corner")),
        ("transfer", Value::from("linear")),
        ("viewer", Value::from("infinite")),
        ("specular", Value::from("reflect")),
        ("shadows", Value::Bool(false)),
    ];
    set_all(scene, &settings);
    Ok(())
}

/// The lights of the course, rotated into world space with the camera, its ambient light and its background.
pub(super) fn lights(camera: &DMat3) -> Vec<Spec> {
    let suns = LIGHTS.iter().zip(["left", "below", "right"]).map(|((towards, colour), name)| {
        let direction = -(*camera * towards.as_dvec3()).as_vec3();
        Spec::new(name, "directional")
            .with("direction", direction)
            .with("irradiance", *colour * PI)
            .with("classic", *colour)
    });
    let background = Rgb::from_array(BACKGROUND.map(|byte| f32::from(byte) / 255.0));
    let rest = [
        Spec::new("ambient", "ambient").with("colour", 0.3f32),
        Spec::new("background", "environment").with("radiance", background).with("backdrop", true),
    ];
    suns.chain(rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CameraSample;
    use crate::cameras;
    use bilux_math::Vec2;

    /// Rows of an example image by that renderer, which its course hands out: the first column that shows the square
    /// from 0 to 20 in x and z, and the last one where no other object hides it.
    const ROWS: [(u32, u32, Option<u32>); 10] = [
        (50, 3, None),
        (70, 10, None),
        (90, 17, None),
        (130, 30, None),
        (160, 40, Some(117)),
        (180, 47, Some(119)),
        (200, 58, Some(121)),
        (220, 71, Some(123)),
        (240, 84, Some(125)),
        (255, 94, Some(127)),
    ];

    /// The camera of that image.
    const EXAMPLE: CourseView = CourseView {
        position: Vec3::new(-3.0, -25.0, -4.0),
        look_at: Vec3::new(7.8, 0.7, 6.5),
        up: Vec3::new(-0.2, 1.0, 0.0),
        fov: 63.7,
    };

    /// The number of pixels that differ from the image in what they see.
    fn wrong(camera: &CameraSpec) -> usize {
        let camera = cameras::build(camera, 1.0).unwrap();
        let to_model = *model().inverse_matrix();
        let sees = |i: u32, j: u32| {
            let film = Vec2::new(i as f32, j as f32) / 256.0;
            let ray = camera.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 });
            let (o, d) = (
                to_model.transform_point3(ray.origin.into()),
                to_model.transform_vector3(ray.direction.into()),
            );
            let at = o - d * (o.y / d.y);
            o.y / d.y < 0.0 && (0.0..=20.0).contains(&at.x) && (0.0..=20.0).contains(&at.z)
        };
        let row = |(j, first, last): (u32, u32, Option<u32>)| {
            let ends = [
                Some((first - 1, false)),
                Some((first, true)),
                last.map(|i| (i, true)),
                last.map(|i| (i + 1, false)),
            ];
            ends.into_iter().flatten().filter(|(i, wanted)| sees(*i, j) != *wanted).count()
        };
        ROWS.into_iter().map(row).sum()
    }

    #[test]
    fn the_eye_is_where_a_picture_of_the_course_has_it() {
        assert_eq!(wrong(&EXAMPLE.camera()), 0);
        // From the camera's own position it would see something else.
        let mut there = EXAMPLE.camera();
        there.spec.parameters.set("position", EXAMPLE.position);
        assert!(wrong(&there) > 10);
    }
}
