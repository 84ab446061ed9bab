//! Looks of surfaces, as far as they are known.

use super::sky_model::Sky;
use bilux_math::DVec3;
use bilux_scene::Span;
use std::collections::HashMap;
use std::rc::Rc;

/// Look of a surface.
#[derive(Clone, Debug)]
pub(super) enum Look {
    /// Surface that is not there.
    Nothing,
    /// A material, by its index.
    Material(usize),
    Lamp(Rc<Lamp>),
}

/// The brightness of a sky, turned as it stands in the scene.
#[derive(Clone, Debug)]
pub(super) struct PlacedSky {
    pub(super) sky: Rc<Sky>,
    /// Towards the sun, with z up.
    pub(super) sun: DVec3,
}

/// Looks that are known so far.
#[derive(Default)]
pub(super) struct Looks {
    pub(super) known: HashMap<usize, Look>,
    /// The material of surfaces whose modifier nothing defines.
    pub(super) undefined: Option<usize>,
    /// The materials of lamps, by the modifiers that these are.
    pub(super) lamps: HashMap<usize, usize>,
}

/// A material that emits light.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    /// Index of its modifier, by which it is the same again.
    pub(super) index: usize,
    pub(super) name: Rc<str>,
    /// Radiance in Radiance's units.
    pub(super) colour: [f64; 3],
    pub(super) emission: Emission,
    /// A sky, whose brightness is a factor on it.
    pub(super) sky: Option<PlacedSky>,
    pub(super) at: Span,
}

/// The directions that light leaves in, and what eyes see.
#[derive(Clone, Debug)]
pub(super) enum Emission {
    /// Equal light in all directions.
    Even,
    /// Within a cone with this whole angle around a direction.
    Spot { degrees: f64, aim: DVec3 },
    /// Equal light in all directions; eyes see another material.
    Illum(Box<Look>),
}
