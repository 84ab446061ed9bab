//! Shapes of other shapes.

use super::maker::{Piece, ShapeMaker};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use std::rc::Rc;

/// A group is shown only where an instance refers to it.
pub(super) fn not_yet(_: &mut ShapeMaker, _: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    Ok(Vec::new())
}

/// The shapes within a shape, each with its own material.
pub(super) fn merge(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let mut all = Vec::new();
    for (_, part) in maker.maker.document.parts_of(plugin, "shape")? {
        let made = nested(maker, plugin, &part)?;
        maker.maker.reading.budget.take::<Piece>(made.len(), &plugin.at.file)?;
        all.extend(made);
    }
    Ok(all)
}

/// The pieces of a shape within another.
fn nested(maker: &mut ShapeMaker, around: &Rc<Plugin>, part: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let ShapeMaker { maker: inner, cache, pieces } = maker;
    let pieces = *pieces;
    inner.within(around, |inner| pieces(&mut ShapeMaker { maker: inner, cache, pieces }, part))
}

/// A group in another place.
pub(super) fn instance(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    let placement = plugin.placement("to_world")?.as_deref().cloned().unwrap_or_default();
    let (motion, is_lost) = placement.motion();
    if is_lost {
        maker.maker.note(LOST_MOTION, &plugin.at);
    }
    let Some(motion) = motion else {
        maker.maker.note(FLAT, &plugin.at);
        return Ok(Vec::new());
    };
    let Some(group) = maker.maker.document.part_of(plugin, "shape")? else {
        return Err(plugin.missing("a shapegroup (of an instance)"));
    };
    let known = maker.cache.groups.get(&Rc::as_ptr(&group)).cloned();
    let parts = match known {
        Some(parts) => parts,
        None => {
            let made = if group.kind == "shapegroup" {
                let ShapeMaker { maker: inner, cache, pieces } = &mut *maker;
                let pieces = *pieces;
                inner
                    .within(plugin, |inner| merge(&mut ShapeMaker { maker: inner, cache, pieces }, &group))?
            } else {
                nested(maker, plugin, &group)?
            };
            let made = Rc::new(made);
            maker.cache.groups.insert(Rc::as_ptr(&group), made.clone());
            made
        }
    };
    maker.maker.reading.budget.take::<Piece>(parts.len(), &plugin.at.file)?;
    let placed = |piece: &Piece| {
        let mut piece = piece.clone();
        piece.instances.push(motion.clone());
        piece
    };
    Ok(parts.iter().map(placed).collect())
}

/// Message about a motion that cannot be kept.
pub(in crate::mitsuba) const LOST_MOTION: &str =
    "a motion that is not made of translations, rotations and scales is not supported: the start is shown";
/// Message about a shape without extent.
pub(in crate::mitsuba) const FLAT: &str = "objects with a scale of zero are not rendered";
