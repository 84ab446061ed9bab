//! Cache and functions that the makers of shapes share.

use crate::mitsuba::maker::Maker;
use crate::mitsuba::plugin::Plugin;
use crate::mitsuba::transforms::Placement;
use bilux_import::FormatError;
use bilux_math::{DMat4, Motion};
use bilux_scene::{Mesh, Warning};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// A part of a shape, in place.
#[derive(Clone, Debug)]
pub(in crate::mitsuba) struct Piece {
    pub(in crate::mitsuba) mesh: Arc<Mesh>,
    /// From the space of the mesh to the world, or to that of its group.
    pub(in crate::mitsuba) to_world: Placement,
    /// Motions of the instances around it, the innermost first.
    pub(in crate::mitsuba) instances: Vec<Motion>,
    /// True for a whole sphere of radius 1 that faces outwards.
    pub(in crate::mitsuba) is_sphere: bool,
    /// The shape, which has its material.
    pub(in crate::mitsuba) plugin: Rc<Plugin>,
}

/// Meshes of files: by path, number of the mesh, how they are changed, and the attribute that is their colours.
pub(super) type FileKey = (PathBuf, usize, [bool; 3], Option<String>);

/// Meshes that are built once and shared.
#[derive(Default)]
pub(in crate::mitsuba) struct ShapeCache {
    pub(super) files: HashMap<FileKey, Vec<Arc<Mesh>>>,
    /// Meshes of a size of their own: spheres, cubes and so on, and whether they are turned inside out.
    pub(super) solids: HashMap<(&'static str, bool), Arc<Mesh>>,
    /// The pieces of groups.
    pub(super) groups: HashMap<*const Plugin, Rc<Vec<Piece>>>,
    /// Faults in the files of meshes, and what is odd.
    pub(in crate::mitsuba) warnings: Vec<Warning>,
    pub(in crate::mitsuba) notes: Vec<Warning>,
}

/// Makes shapes.
pub(in crate::mitsuba) struct ShapeMaker<'m, 'p, 'o> {
    pub(in crate::mitsuba) maker: &'m mut Maker<'p, 'o>,
    pub(in crate::mitsuba) cache: &'m mut ShapeCache,
    /// Looks up shapes in their table, so that these may contain one another.
    pub(in crate::mitsuba) pieces: Make,
}

/// Builds the pieces of a shape; none if it is invisible.
pub(in crate::mitsuba) type Make = fn(&mut ShapeMaker, &Rc<Plugin>) -> Result<Vec<Piece>, FormatError>;

impl ShapeMaker<'_, '_, '_> {
    /// The pieces of a shape: these meshes, each after a transform of its own.
    pub(super) fn placed(
        &mut self,
        plugin: &Rc<Plugin>,
        meshes: Vec<Arc<Mesh>>,
        first: &DMat4,
    ) -> Result<Vec<Piece>, FormatError> {
        let placement = plugin.placement("to_world")?.as_deref().cloned().unwrap_or_default();
        Ok(self.placed_by(plugin, meshes, first, placement))
    }

    /// Pieces of a shape as in `placed`, by another placement than that of the shape.
    pub(super) fn placed_by(
        &mut self,
        plugin: &Rc<Plugin>,
        meshes: Vec<Arc<Mesh>>,
        first: &DMat4,
        placement: Placement,
    ) -> Vec<Piece> {
        let to_world = if *first == DMat4::IDENTITY { placement } else { placement.after(first) };
        let piece = |mesh| Piece {
            mesh,
            to_world: to_world.clone(),
            instances: Vec::new(),
            is_sphere: false,
            plugin: plugin.clone(),
        };
        meshes.into_iter().map(piece).collect()
    }

    /// A mesh of one size, made once.
    pub(super) fn solid(
        &mut self,
        plugin: &Plugin,
        kind: &'static str,
        make: impl FnOnce() -> Mesh,
    ) -> Result<Arc<Mesh>, FormatError> {
        let flips = plugin.flag("flip_normals", false)?;
        if let Some(mesh) = self.cache.solids.get(&(kind, flips)) {
            return Ok(mesh.clone());
        }
        let mesh = self.finished(make(), flips, plugin)?;
        self.cache.solids.insert((kind, flips), mesh.clone());
        Ok(mesh)
    }

    /// Charges a mesh, and turns it inside out where that is asked for.
    pub(super) fn finished(
        &mut self,
        mut mesh: Mesh,
        flips: bool,
        plugin: &Plugin,
    ) -> Result<Arc<Mesh>, FormatError> {
        self.maker.reading.budget.take_bytes(mesh.size(), &plugin.at.file)?;
        if flips {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            mesh.normals.iter_mut().for_each(|n| *n = -*n);
        }
        Ok(Arc::new(mesh))
    }
}
