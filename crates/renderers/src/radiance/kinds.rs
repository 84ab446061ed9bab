//! The types of Radiance's primitives. [Ward 1994]

/// Kind of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Polygon,
    /// A bubble faces inwards, as a sphere does outwards.
    Sphere {
        inwards: bool,
    },
    /// A cup faces inwards.
    Cone {
        inwards: bool,
    },
    /// A tube faces inwards.
    Cylinder {
        inwards: bool,
    },
    Ring,
    /// Something infinitely far away.
    Source,
    /// An octree, or a mesh of triangles, in a file of its own.
    Foreign,
    Material(Finish),
    /// A pattern (of colours) or a texture (of normals).
    Pattern,
    Mixture,
    /// Another name for a modifier.
    Alias,
}

/// The kinds of materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Finish {
    Light,
    Illum,
    Glow,
    Spotlight,
    Mirror,
    Prism,
    Plastic,
    Metal,
    Trans,
    Plastic2,
    Metal2,
    Trans2,
    Ashik2,
    Dielectric,
    Interface,
    Glass,
    /// A reflectance with a function or data for its gloss.
    Function,
    /// A reflectance and a transmittance with a function or data for the gloss.
    TransFunction,
    Brtd,
    Bsdf,
    Antimatter,
    Mist,
}

impl Kind {
    /// True for what has a place in the scene; the others modify it.
    pub(super) fn is_surface(self) -> bool {
        !matches!(self, Kind::Material(_) | Kind::Pattern | Kind::Mixture | Kind::Alias)
    }

    /// True if a transform changes what the arguments mean: lengths and directions.
    pub(super) fn depends_on_place(self) -> bool {
        use Finish::{Dielectric, Interface, Mist, Spotlight};
        matches!(self, Kind::Material(Dielectric | Interface | Mist | Spotlight))
    }
}

/// A row of the table: a type, and how many numbers it takes. Without any, it takes any number of them.
pub(super) struct Row {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) reals: &'static [usize],
}

const fn row(name: &'static str, kind: Kind, reals: &'static [usize]) -> Row {
    Row { name, kind, reals }
}

const fn finish(name: &'static str, kind: Finish, reals: &'static [usize]) -> Row {
    Row { name, kind: Kind::Material(kind), reals }
}

/// Every type.
pub(super) static KINDS: &[Row] = &[
    row("alias", Kind::Alias, &[]),
    row("polygon", Kind::Polygon, &[]),
    row("sphere", Kind::Sphere { inwards: false }, &[4]),
    row("bubble", Kind::Sphere { inwards: true }, &[4]),
    row("cone", Kind::Cone { inwards: false }, &[8]),
    row("cup", Kind::Cone { inwards: true }, &[8]),
    row("cylinder", Kind::Cylinder { inwards: false }, &[7]),
    row("tube", Kind::Cylinder { inwards: true }, &[7]),
    row("ring", Kind::Ring, &[8]),
    row("source", Kind::Source, &[4]),
    row("instance", Kind::Foreign, &[]),
    row("mesh", Kind::Foreign, &[]),
    finish("light", Finish::Light, &[3]),
    finish("illum", Finish::Illum, &[3]),
    finish("glow", Finish::Glow, &[4]),
    finish("spotlight", Finish::Spotlight, &[7]),
    finish("mirror", Finish::Mirror, &[3]),
    finish("prism1", Finish::Prism, &[]),
    finish("prism2", Finish::Prism, &[]),
    finish("plastic", Finish::Plastic, &[5]),
    finish("metal", Finish::Metal, &[5]),
    finish("trans", Finish::Trans, &[7]),
    finish("plastic2", Finish::Plastic2, &[6]),
    finish("metal2", Finish::Metal2, &[6]),
    finish("trans2", Finish::Trans2, &[8]),
    finish("ashik2", Finish::Ashik2, &[8]),
    finish("dielectric", Finish::Dielectric, &[5]),
    finish("interface", Finish::Interface, &[8]),
    finish("glass", Finish::Glass, &[3, 4]),
    finish("plasfunc", Finish::Function, &[]),
    finish("metfunc", Finish::Function, &[]),
    finish("plasdata", Finish::Function, &[]),
    finish("metdata", Finish::Function, &[]),
    finish("transfunc", Finish::TransFunction, &[]),
    finish("transdata", Finish::TransFunction, &[]),
    finish("BRTDfunc", Finish::Brtd, &[]),
    finish("BSDF", Finish::Bsdf, &[]),
    finish("aBSDF", Finish::Bsdf, &[]),
    finish("antimatter", Finish::Antimatter, &[]),
    finish("mist", Finish::Mist, &[]),
    row("texfunc", Kind::Pattern, &[]),
    row("texdata", Kind::Pattern, &[]),
    row("colorfunc", Kind::Pattern, &[]),
    row("brightfunc", Kind::Pattern, &[]),
    row("colordata", Kind::Pattern, &[]),
    row("brightdata", Kind::Pattern, &[]),
    row("colorpict", Kind::Pattern, &[]),
    row("colortext", Kind::Pattern, &[]),
    row("brighttext", Kind::Pattern, &[]),
    row("spectrum", Kind::Pattern, &[]),
    row("specfile", Kind::Pattern, &[]),
    row("specfunc", Kind::Pattern, &[]),
    row("specdata", Kind::Pattern, &[]),
    row("specpict", Kind::Pattern, &[]),
    row("mixfunc", Kind::Mixture, &[]),
    row("mixdata", Kind::Mixture, &[]),
    row("mixpict", Kind::Mixture, &[]),
    row("mixtext", Kind::Mixture, &[]),
];

/// The row with a name.
pub(super) fn named(name: &[u8]) -> Option<&'static Row> {
    KINDS.iter().find(|row| row.name.as_bytes() == name)
}
