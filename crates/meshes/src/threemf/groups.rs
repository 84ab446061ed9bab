//! Groups of properties that triangles refer to, as plain data.

use super::colour::Colour;
use bilux_math::{Rgb, Vec2};
use bilux_scene::Span;
use bilux_scene::texture::{Filter, Wrap};

/// A group of properties.
pub(super) struct Group {
    pub(super) kind: GroupKind,
    /// The number of the resource with their appearance.
    pub(super) display: Option<u32>,
    /// The part that it lies in.
    pub(super) part: usize,
}

/// The kinds of groups.
pub(super) enum GroupKind {
    Bases(Vec<Base>),
    /// Colours at corners.
    Colours(Vec<Colour>),
    /// Mixtures of base materials, as colours.
    Mixtures(Vec<Colour>),
    /// Texture coordinates in a picture.
    Coordinates {
        picture: usize,
        uvs: Vec<Vec2>,
    },
    /// Layers of other groups, the lowest first.
    Layers(Layers),
}

/// Several properties, one above the other.
pub(super) struct Layers {
    /// The groups of the layers.
    pub(super) groups: Vec<usize>,
    /// Blend of each layer but the first with those below.
    pub(super) methods: Vec<Method>,
    /// For each entry, the index of each layer.
    pub(super) indices: Vec<u32>,
}

/// Blend of a layer with those below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// As its alpha says.
    Mix,
    Multiply,
}

/// A base material.
pub(super) struct Base {
    pub(super) name: String,
    pub(super) colour: Option<Colour>,
    /// The number of the resource with its appearance, where files before version 1.2 state it.
    pub(super) display: Option<u32>,
}

/// A picture of textures.
pub(super) struct Picture {
    pub(super) path: String,
    pub(super) wrap: [Wrap; 2],
    pub(super) filter: Filter,
    pub(super) at: Span,
}

/// Appearances of materials, each as the entry of a group with the same index.
pub(super) enum Display {
    Each(Vec<Appearance>),
    Textured(TexturedAppearance),
}

/// Appearance of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Appearance {
    Metallic {
        metalness: f32,
        roughness: f32,
    },
    Specular {
        colour: Rgb,
        roughness: f32,
    },
    /// Attenuation is per metre.
    Translucent {
        attenuation: Rgb,
        ior: f32,
        roughness: f32,
    },
}

/// Appearance of a textured material, by pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TexturedAppearance {
    Metallic { metalness: usize, roughness: usize, factors: [f32; 2], base: Rgb },
    Specular { colour: usize, glossiness: usize, factor: Rgb, glossiness_factor: f32, base: Rgb },
}

impl Group {
    /// The colour of an entry; `None` for those of textures and layers, and for what has no colour.
    pub(super) fn colour(&self, index: u32) -> Option<Colour> {
        match &self.kind {
            GroupKind::Bases(bases) => bases.get(index as usize)?.colour,
            GroupKind::Colours(colours) | GroupKind::Mixtures(colours) => {
                colours.get(index as usize).copied()
            }
            GroupKind::Coordinates { .. } | GroupKind::Layers(_) => None,
        }
    }

    /// True for materials, which can only be the lowest layer.
    pub(super) fn is_material(&self) -> bool {
        matches!(self.kind, GroupKind::Bases(_) | GroupKind::Mixtures(_))
    }

    /// The number of its entries.
    pub(super) fn len(&self) -> usize {
        match &self.kind {
            GroupKind::Bases(bases) => bases.len(),
            GroupKind::Colours(colours) | GroupKind::Mixtures(colours) => colours.len(),
            GroupKind::Coordinates { uvs, .. } => uvs.len(),
            GroupKind::Layers(layers) => layers.indices.len() / layers.groups.len().max(1),
        }
    }
}

impl Layers {
    /// The index of each layer for an entry.
    pub(super) fn entry(&self, index: u32) -> &[u32] {
        let width = self.groups.len();
        self.indices.get(index as usize * width..).and_then(|rest| rest.get(..width)).unwrap_or_default()
    }
}
