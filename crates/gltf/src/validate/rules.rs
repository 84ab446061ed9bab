//! The rules, by the kind of object that they check. To add one, write a function and add its row here.

use super::Check;
use super::core_kinds::{
    ACCESSOR, BUFFER, BUFFER_VIEW, CAMERA, IMAGE, MESH, NODE, ORTHOGRAPHIC, PERSPECTIVE, PRIMITIVE, ROOT,
    SCENE, SKIN,
};
use super::extension_kinds::{LIGHT, MAPPINGS};
use super::material_kinds::MATERIAL;
use super::schema::Kind;
use super::{
    accessors, animations, attributes, buffers, images, materials, meshes, nodes, root, skins, vertices,
};
use crate::document::json::JsonNode;

/// A rule.
pub(super) struct Rule {
    /// The condition that must hold.
    #[cfg(test)]
    name: &'static str,
    /// The kind of object that it applies to.
    pub(super) of: &'static Kind,
    pub(super) check: for<'d> fn(&mut Check<'d, '_>, JsonNode<'d>),
}

const fn rule(
    _name: &'static str,
    of: &'static Kind,
    check: for<'d> fn(&mut Check<'d, '_>, JsonNode<'d>),
) -> Rule {
    Rule {
        #[cfg(test)]
        name: _name,
        of,
        check,
    }
}

/// All rules. The rules of an object run after everything it contains has been checked; those of the root run
/// last.
pub(super) static RULES: &[Rule] = &[
    rule("an accessor lies within its buffer view", &ACCESSOR, accessors::lies_within),
    rule("elements are aligned", &ACCESSOR, accessors::is_aligned),
    rule("only integers are normalized", &ACCESSOR, accessors::normalized),
    rule("an offset needs a buffer view", &ACCESSOR, accessors::offset_alone),
    rule("sparse data have no stride", &ACCESSOR, accessors::sparse),
    rule("min and max are those of the data", &ACCESSOR, accessors::bounds),
    rule("a buffer has bytes", &BUFFER, buffers::has_bytes),
    rule("a buffer's data URI says that it is a buffer", &BUFFER, buffers::mime_type),
    rule("a GLB file is self-contained", &BUFFER, buffers::in_glb),
    rule("a buffer view lies within its buffer", &BUFFER_VIEW, buffers::view),
    rule("a stride is for vertex attributes", &BUFFER_VIEW, buffers::stride_target),
    rule("a camera has the lens of its type", &CAMERA, root::camera),
    rule("a lens sees from near to far", &ORTHOGRAPHIC, root::orthographic),
    rule("a perspective lens sees from near to far", &PERSPECTIVE, root::perspective),
    rule("an image has one source", &IMAGE, images::source),
    rule("a spot light has a cone", &LIGHT, root::spot),
    rule("a variant is mapped once", &MAPPINGS, materials::mappings),
    rule("a cutoff needs alphaMode MASK", &MATERIAL, materials::cutoff),
    rule("material extensions can be combined", &MATERIAL, materials::go_together),
    rule("normal maps share texture coordinates", &MATERIAL, materials::same_coordinates),
    rule("a thickness range needs its texture", &MATERIAL, materials::thickness),
    rule("there is a weight for each morph target", &MESH, meshes::weights),
    rule("primitives have the same morph targets", &MESH, meshes::same_targets),
    rule("attributes have the names of glTF", &PRIMITIVE, attributes::names),
    rule("attributes have the formats of glTF", &PRIMITIVE, attributes::formats),
    rule("attributes are aligned and strided", &PRIMITIVE, attributes::layout),
    rule("positions have bounds", &PRIMITIVE, meshes::position_bounds),
    rule("all attributes have the same number of elements", &PRIMITIVE, meshes::counts),
    rule("indices fit the mode and the vertices", &PRIMITIVE, meshes::indices),
    rule("morph targets move existing attributes", &PRIMITIVE, meshes::morph),
    rule("a material has the attributes that it needs", &PRIMITIVE, meshes::material),
    rule("vertex attributes hold valid values", &PRIMITIVE, vertices::values),
    rule("a node has either a matrix or its parts", &NODE, nodes::transform),
    rule("a rotation has length one", &NODE, nodes::rotation),
    rule("skins and weights have their mesh", &NODE, nodes::mesh),
    rule("only joints position a skinned mesh", &NODE, nodes::skinned_place),
    rule("a scene lists only root nodes", &SCENE, nodes::roots),
    rule("inverse bind matrices fit their joints", &SKIN, skins::matrices),
    rule("joints have a common root", &SKIN, skins::common_root),
    rule("keyframes match the property that they animate", &ROOT, animations::all),
    rule("the version is known", &ROOT, root::version),
    rule("extensions are declared", &ROOT, root::extensions),
    rule("nodes form trees", &ROOT, nodes::trees),
    rule("joints are in the scene of their mesh", &ROOT, skins::in_scene),
    rule("all objects are used", &ROOT, root::unused),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn rule_names_are_unique() {
        let names: HashSet<_> = RULES.iter().map(|rule| rule.name).collect();
        assert_eq!(names.len(), RULES.len());
    }
}
