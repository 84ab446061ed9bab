//! Materials and lights as Rust types: a misspelt parameter, or one of the wrong kind, does not compile.
//!
//! Each converts to a [`Spec`](crate::Spec), from which scenes are built. `cargo xtask docs` generates the types from
//! [`MATERIALS`](crate::MATERIALS) and [`LIGHTS`](crate::LIGHTS), and a test compares them.
//!
//! ```
//! use bilux_math::{Rgb, Vec3};
//! use bilux_scene::SceneBuilder;
//! use bilux_scene::typed::lights::Rect;
//! use bilux_scene::typed::materials::Principled;
//!
//! let mut scene = SceneBuilder::default();
//! let red = scene.add_material(Principled::new("paint").base_color(Rgb::new(0.6, 0.05, 0.04)));
//! scene.add_light(Rect::new("panel").position(Vec3::new(0.0, 3.0, 0.0)).intensity(Rgb::grey(10.0)));
//! assert_eq!((red, scene.materials[0].kind.as_str()), (0, "principled"));
//! ```

/// Generates types for the rows of a table.
macro_rules! typed {
    ($(
        $(#[$about:meta])*
        $name:ident = $kind:literal {
            $($(#[$what:meta])* $key:ident: $value:ty,)*
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
                        $name(self.0.with(stringify!($key), value))
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

pub mod lights;
pub mod materials;
