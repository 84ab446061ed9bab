//! Materials, lights and cameras as Rust types: a misspelt parameter, or one of the wrong kind, does not compile.
//!
//! Each converts to a [`Spec`](crate::Spec), from which scenes are built. `cargo xtask docs` generates the types from
//! [`MATERIALS`](crate::MATERIALS), [`LIGHTS`](crate::LIGHTS) and [`CAMERAS`](crate::CAMERAS), and a test compares them.
//!
//! ```
//! use bilux_math::{Rgb, Vec3};
//! use bilux_scene::SceneBuilder;
//! use bilux_scene::typed::cameras::Perspective;
//! use bilux_scene::typed::lights::Rect;
//! use bilux_scene::typed::materials::Principled;
//!
//! let mut scene = SceneBuilder::default();
//! let red = scene.add_material(Principled::new("paint").base_color(Rgb::new(0.6, 0.05, 0.04)));
//! scene.add_light(Rect::new("panel").position(Vec3::new(0.0, 3.0, 0.0)).intensity(Rgb::grey(10.0)));
//! scene.add_camera(Perspective::new("eye").position(Vec3::new(0.0, 1.0, 4.0)).look_at(Vec3::Y).fov(30.0));
//! assert_eq!((red, scene.materials[0].kind.as_str()), (0, "principled"));
//! ```
//!
//! Numbers and points of cameras are in double precision, as calibrations state them: `f32` and [`Vec3`](bilux_math::Vec3)
//! convert.

use crate::parameters::Value;
use bilux_math::DVec3;

/// Generates types for the rows of a table. What does not convert to a [`Value`](crate::Value) by itself names the function that
/// converts it.
macro_rules! typed {
    (@convert $value:ident) => { $value };
    (@convert $value:ident $convert:path) => { $convert($value) };
    ($(
        $(#[$about:meta])*
        $name:ident = $kind:literal {
            $($(#[$what:meta])* $key:ident: $value:ty $(as $convert:path)?,)*
        }
    )*) => {
        use crate::parameters::Spec;
        $(
            $(#[$about])*
            #[derive(Clone, Debug, PartialEq)]
            pub struct $name(Spec);

            impl $name {
                /// All parameters at their defaults. The name is up to the user, and may be empty.
                pub fn new(name: &str) -> $name {
                    $name(Spec::new(name, $kind))
                }

                $(
                    $(#[$what])*
                    #[must_use]
                    pub fn $key(self, value: $value) -> $name {
                        $name(self.0.with(stringify!($key), typed!(@convert value $($convert)?)))
                    }
                )*
            }

            impl From<$name> for Spec {
                fn from(typed: $name) -> Spec {
                    typed.0
                }
            }
        )*
    };
}

pub mod cameras;
pub mod lights;
pub mod materials;

/// A number in double precision.
fn number(number: impl Into<f64>) -> Value {
    Value::Number(number.into())
}

/// A point or a direction in double precision.
fn vector(vector: impl Into<DVec3>) -> Value {
    Value::List(vector.into().to_array().map(Value::Number).to_vec())
}
