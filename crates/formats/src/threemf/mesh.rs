//! Reads meshes: the bulk of a file, so nothing is done twice here.

use super::attributes::{integer, number};
use super::lattice::LatticeAttributes;
use super::mesh_data::{MeshData, TriangleProperties};
use super::model::{Model, Property, Resource};
use super::namespaces::Namespace;
use super::part::PartReader;
use super::xml::{Element, Level};
use crate::FormatError;
use bilux_math::Vec3;

/// The attributes of a triangle.
#[derive(Default)]
struct Triangle<'x> {
    corners: [Option<u32>; 3],
    group: Option<u32>,
    properties: [Option<u32>; 3],
    paint: &'x str,
}

impl PartReader<'_, '_> {
    pub(super) fn mesh(
        &mut self,
        level: Level,
        of_object: Option<Property>,
    ) -> Result<MeshData, FormatError> {
        let mut mesh = MeshData::default();
        while let Some(child) = self.xml.child(level)? {
            let inside = child.inside;
            match (child.namespace, child.name) {
                (Namespace::Core, "vertices") => {
                    if child.attributes().flatten().any(|(key, _)| key.contains(':')) {
                        let at = child.at();
                        self.oddities.note("vertices have attributes of an unknown kind", || at);
                    }
                    self.vertices(inside, &mut mesh)?;
                }
                (Namespace::Core, "triangles") => self.triangles(inside, &mut mesh, of_object)?,
                (Namespace::Lattice, "beamlattice") => {
                    let attributes = LatticeAttributes::of(&child)?;
                    mesh.lattice = Some(self.lattice(inside, attributes, mesh.positions.len())?);
                }
                (Namespace::Named(what), _) => {
                    let at = child.at();
                    self.oddities.not_shown(what, || at);
                }
                (Namespace::Undeclared, name) => return Err(super::part::undeclared(&child, name)),
                _ => {}
            }
        }
        Ok(mesh)
    }

    fn vertices(&mut self, level: Level, mesh: &mut MeshData) -> Result<(), FormatError> {
        let file = self.file.clone();
        while let Some(element) = self.xml.child(level)? {
            if element.name != "vertex" {
                continue;
            }
            let mut position = [None; 3];
            for attribute in element.attributes() {
                let (key, value) = attribute.map_err(|_| element.no_attributes())?;
                let axis = match key {
                    "x" => 0,
                    "y" => 1,
                    "z" => 2,
                    _ => continue,
                };
                position[axis] = Some(number(value).ok_or_else(|| element.wrong(key, value, "a number"))?);
            }
            let [Some(x), Some(y), Some(z)] = position else {
                return Err(element.error("a vertex needs x, y and z"));
            };
            let position = Vec3::new(x, y, z);
            if !position.is_finite() {
                let at = element.at();
                self.oddities
                    .note("a vertex has numbers that are infinite or not numbers (NaN); it is kept", || at);
            }
            self.reading.budget.take::<Vec3>(1, &file)?;
            mesh.positions.push(position);
        }
        Ok(())
    }

    fn triangles(
        &mut self,
        level: Level,
        mesh: &mut MeshData,
        of_object: Option<Property>,
    ) -> Result<(), FormatError> {
        let file = self.file.clone();
        let count = mesh.positions.len() as u32;
        // The group of the last triangle: most have that of the one before.
        let mut last: Option<(u32, u32)> = None;
        while let Some(element) = self.xml.child(level)? {
            if element.name != "triangle" {
                continue;
            }
            let Triangle { corners, group, properties, paint } = triangle(&element)?;
            let [Some(a), Some(b), Some(c)] = corners else {
                return Err(element.error("a triangle needs v1, v2 and v3"));
            };
            if let Some(&far) = [a, b, c].iter().find(|&&vertex| vertex >= count) {
                let message =
                    format!("this triangle refers to vertex {far}, but its mesh has {count}, counted from 0");
                return Err(element.error(message));
            }
            if a == b || b == c || a == c {
                let at = element.at();
                self.oddities.note("a triangle has two corners at the same vertex, so it has no area", || at);
            }
            self.reading.budget.take::<[u32; 3]>(1, &file)?;
            if group.is_some() || properties[0].is_some() {
                let known = match (group, last) {
                    (Some(id), Some((known, own))) if id == known => Some(own),
                    (Some(id), _) => {
                        let own = find_group(&element, self.model, self.part, id)?;
                        last = Some((id, own));
                        Some(own)
                    }
                    (None, _) => of_object.map(|own| own.group as u32),
                };
                if known.is_none() {
                    let at = element.at();
                    let what =
                        "a triangle has properties (p1), but neither it nor its object says of what (pid)";
                    self.oddities.note(what, || at);
                }
                if let Some(group) = known {
                    let corners = indices(&element, properties, group, of_object, self.model)?;
                    let before = if mesh.properties.is_empty() { mesh.triangles.len() } else { 0 };
                    self.reading.budget.take::<TriangleProperties>(before + 1, &file)?;
                    mesh.properties.resize(mesh.triangles.len(), TriangleProperties::OF_OBJECT);
                    mesh.properties.push(TriangleProperties { group, corners });
                }
            }
            if !paint.is_empty() {
                self.reading.budget.take_bytes((paint.len() + 32) as u64, &file)?;
                mesh.paint.push((mesh.triangles.len() as u32, paint.into()));
            }
            mesh.triangles.push([a, b, c]);
        }
        if !mesh.properties.is_empty() {
            self.reading
                .budget
                .take::<TriangleProperties>(mesh.triangles.len() - mesh.properties.len(), &file)?;
            mesh.properties.resize(mesh.triangles.len(), TriangleProperties::OF_OBJECT);
        }
        Ok(())
    }
}

fn triangle<'x>(element: &Element<'x>) -> Result<Triangle<'x>, FormatError> {
    let mut triangle = Triangle::default();
    for attribute in element.attributes() {
        let (key, value) = attribute.map_err(|_| element.no_attributes())?;
        let slot = match key {
            "v1" => &mut triangle.corners[0],
            "v2" => &mut triangle.corners[1],
            "v3" => &mut triangle.corners[2],
            "pid" => &mut triangle.group,
            "p1" => &mut triangle.properties[0],
            "p2" => &mut triangle.properties[1],
            "p3" => &mut triangle.properties[2],
            key => {
                if key == "paint_color" || key.ends_with("mmu_segmentation") {
                    triangle.paint = value;
                }
                continue;
            }
        };
        *slot = Some(integer(value).ok_or_else(|| element.wrong(key, value, "a whole number from 0 on"))?);
    }
    Ok(triangle)
}

/// The group of properties with this id.
fn find_group(element: &Element, model: &Model, part: usize, id: u32) -> Result<u32, FormatError> {
    match model.resources.get(&(part, id)) {
        Some(&Resource::Group(group)) => Ok(group as u32),
        _ => {
            let message = format!(
                "this triangle has pid={id}, but no group of properties with this id comes before it"
            );
            Err(element.error(message))
        }
    }
}

/// The entries of the group for the three corners: those that are not given are that of the first, or of the object.
fn indices(
    element: &Element,
    given: [Option<u32>; 3],
    group: u32,
    of_object: Option<Property>,
    model: &Model,
) -> Result<[u32; 3], FormatError> {
    let length = model.groups[group as usize].len();
    let of_object = of_object.filter(|own| own.group == group as usize).map_or(0, |own| own.index);
    let first = given[0].unwrap_or(of_object);
    let corners = [first, given[1].unwrap_or(first), given[2].unwrap_or(first)];
    match corners.iter().find(|&&index| index as usize >= length) {
        None => Ok(corners),
        Some(far) => {
            let message =
                format!("this triangle refers to property {far}, but its group has {length}, counted from 0");
            Err(element.error(message))
        }
    }
}
