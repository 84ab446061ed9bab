//! Equations 1 and 2 of the paper, shared by `cast`, `whitted` and `cook`.

mod local;
mod ray_tree;
mod shadow;

pub(crate) use local::{Local, LocalRules, ShadowRule, Specular};
pub(crate) use ray_tree::{FresnelLaw, RayTree};
pub(crate) use shadow::Shadows;

use bilux_math::registry::{Parameter, ParameterKind};
use bilux_scene::Reader;

pub(crate) const SPECULAR: Parameter = Parameter {
    name: "specular",
    summary: "how highlights are computed: from the halfway vector of the paper's Equation 1, or from the reflected ray \
              of its section 3.1",
    unit: "",
    kind: ParameterKind::Choice(&["halfway", "reflect"]),
    default: "halfway",
};

pub(crate) const SHADOW_RULE: Parameter = Parameter {
    name: "shadow_rule",
    summary: "which lights a shadow removes: each one that is blocked (per-light), or all, with the ambient light, if \
              every one is blocked (paper)",
    unit: "",
    kind: ParameterKind::Choice(&["per-light", "paper"]),
    default: "per-light",
};

pub(crate) const SHADOWS: Parameter = Parameter {
    name: "shadows",
    summary: "how glass affects shadow rays: it blocks light, or tints it without bending it",
    unit: "",
    kind: ParameterKind::Choice(&["opaque", "tinted"]),
    default: "opaque",
};

pub(crate) const FRESNEL: Parameter = Parameter {
    name: "fresnel",
    summary: "reflectance of glass: Schlick's approximation, or the Fresnel equations",
    unit: "",
    kind: ParameterKind::Choice(&["schlick", "exact"]),
    default: "schlick",
};

pub(crate) const CUTOFF: Parameter = Parameter {
    name: "cutoff",
    summary: "minimum contribution of a ray to the picture; 0 traces all rays",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 1.0 },
    default: "0.004",
};

/// Reads the parameter [`SPECULAR`].
pub(crate) fn specular(reader: &Reader) -> Specular {
    if reader.text("specular") == "reflect" { Specular::Reflect } else { Specular::Halfway }
}

/// Whitted's ray tree with the parameters that `whitted` and `cook` share, all extents zero.
pub(crate) fn ray_tree(reader: &Reader) -> RayTree {
    let paper = reader.text("shadow_rule") == "paper";
    let tinted = reader.text("shadows") == "tinted";
    RayTree {
        local: LocalRules {
            specular: specular(reader),
            shadows: if tinted { Shadows::Tinted } else { Shadows::Opaque },
            rule: if paper { ShadowRule::Paper } else { ShadowRule::PerLight },
            light_extent: 0.0,
        },
        fresnel: if reader.text("fresnel") == "exact" { FresnelLaw::Exact } else { FresnelLaw::Schlick },
        cutoff: reader.number("cutoff"),
        gloss_extent: 0.0,
        translucency_extent: 0.0,
    }
}
