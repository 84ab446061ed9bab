//! Cameras and lights of nodes: the attribute that belongs to a node, or before version 7 the node itself.

use super::document::{Index, Properties};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_math::DVec3;

/// A camera or a light at its node.
pub(super) struct Attribute<'d, 'p> {
    pub(super) properties: Properties<'d, 'p>,
    /// The object that has them.
    pub(super) index: Index,
}

/// The attribute of this kind, if a node has one.
pub(super) fn of_kind<'d, 'p>(kind: &str, model: Index, posed: &'p Posed<'d>) -> Option<Attribute<'d, 'p>> {
    let document = posed.document;
    let is_of_kind = |&index: &Index| document.object(index).kind == kind.as_bytes();
    let index = document.sources_of_class(model, "NodeAttribute").find(is_of_kind);
    let index = index.or_else(|| Some(model).filter(is_of_kind))?;
    Some(Attribute { properties: posed.properties(index), index })
}

/// The direction of a node's axis in the world, or towards the node that it looks at; `None` for a scale of zero.
pub(super) fn direction(placed: &Placed, axis: DVec3, posed: &Posed, graph: &Graph) -> Option<DVec3> {
    let links = posed.document.sources(placed.model).iter();
    let target = links
        .filter(|link| link.property == Some(b"LookAtProperty"))
        .find_map(|link| graph.world_of(link.source));
    let towards = target.and_then(|target| (target.w_axis - placed.world.w_axis).truncate().try_normalize());
    towards.or_else(|| placed.world.transform_vector3(axis).try_normalize())
}
