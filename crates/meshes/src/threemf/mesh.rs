//! Reads meshes: the bulk of a file, so nothing is done twice here.

use super::attributes::{integer, number};
use super::lattice::LatticeAttributes;
use super::mesh_data::{MeshData, TriangleProperties};
use super::model::{Model, Property, Resource};
use super::namespaces::Namespace;
use super::part::PartReader;
use super::quick::{self, Triangle};
use super::xml::{Element, Level};
use bilux_import::FormatError;
use bilux_math::Vec3;

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
                        self.diagnostics.note("vertices have attributes of an unknown kind", || at);
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
                    self.diagnostics.not_shown(what, || at);
                }
                (Namespace::Undeclared, name) => return Err(super::part::undeclared(&child, name)),
                _ => {}
            }
        }
        Ok(mesh)
    }

    fn vertices(&mut self, level: Level, mesh: &mut MeshData) -> Result<(), FormatError> {
        let file = self.file.clone();
        loop {
            let known = mesh.positions.len();
            self.xml.skim(level, |bytes| {
                let mut at = 0;
                while let Some((position, length)) = quick::vertex(&bytes[at..]) {
                    mesh.positions.push(position);
                    at += length;
                }
                at
            })?;
            self.reading.budget.take::<Vec3>(mesh.positions.len() - known, &file)?;
            let Some(element) = self.xml.child(level)? else { return Ok(()) };
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
                self.diagnostics
                    .note("a vertex has numbers that are infinite or not numbers (NaN); it is kept", || at);
            }
            self.reading.budget.take::<Vec3>(1, &file)?;
            mesh.positions.push(position);
        }
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
        loop {
            let known = [mesh.triangles.len(), mesh.properties.len()];
            let model = &*self.model;
            self.xml.skim(level, |bytes| {
                let mut at = 0;
                while let Some((triangle, length)) = quick::triangle(&bytes[at..])
                    && let Some(corners) = triangle.sound_corners(count)
                    && let Some(properties) = triangle.known_properties(last, of_object, model)
                {
                    mesh.add(corners, properties);
                    at += length;
                }
                at
            })?;
            self.reading.budget.take::<[u32; 3]>(mesh.triangles.len() - known[0], &file)?;
            self.reading.budget.take::<TriangleProperties>(mesh.properties.len() - known[1], &file)?;
            let Some(element) = self.xml.child(level)? else { break };
            if element.name != "triangle" {
                continue;
            }
            let triangle = triangle(&element)?;
            let [Some(a), Some(b), Some(c)] = triangle.corners else {
                return Err(element.error("a triangle needs v1, v2 and v3"));
            };
            if let Some(&far) = [a, b, c].iter().find(|&&vertex| vertex >= count) {
                let message =
                    format!("this triangle refers to vertex {far}, but its mesh has {count}, counted from 0");
                return Err(element.error(message));
            }
            if a == b || b == c || a == c {
                let at = element.at();
                self.diagnostics
                    .note("a triangle has two corners at the same vertex, so it has no area", || at);
            }
            self.reading.budget.take::<[u32; 3]>(1, &file)?;
            let mut properties = None;
            if triangle.has_properties() {
                match (triangle.group, of_object) {
                    (Some(id), _) if last.is_none_or(|(known, _)| id != known) => {
                        last = Some((id, find_group(&element, self.model, self.part, id)?));
                    }
                    (None, None) => {
                        let at = element.at();
                        let what = "a triangle has properties (p1), but neither it nor its object says of what (pid)";
                        self.diagnostics.note(what, || at);
                    }
                    _ => {}
                }
                if let Some(group) = triangle.group_of(last, of_object) {
                    let corners = triangle.indices(group, of_object, self.model);
                    let corners = corners.map_err(|message| element.error(message))?;
                    let before = if mesh.properties.is_empty() { mesh.triangles.len() } else { 0 };
                    self.reading.budget.take::<TriangleProperties>(before + 1, &file)?;
                    properties = Some(TriangleProperties { group, corners });
                }
            }
            if !triangle.paint.is_empty() {
                self.reading.budget.take_bytes((triangle.paint.len() + 32) as u64, &file)?;
                mesh.paint.push((mesh.triangles.len() as u32, triangle.paint.into()));
            }
            mesh.add([a, b, c], properties);
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

impl Triangle<'_> {
    /// True if it says which entries of a group its corners have.
    fn has_properties(&self) -> bool {
        self.group.is_some() || self.properties[0].is_some()
    }

    /// Group of the triangle: its own, which was found last, or that of the object.
    fn group_of(&self, last: Option<(u32, u32)>, of_object: Option<Property>) -> Option<u32> {
        match self.group {
            Some(id) => last.filter(|(known, _)| *known == id).map(|(_, group)| group),
            None => of_object.map(|own| own.group as u32),
        }
    }

    /// Properties of the triangle, if they need no warning and their group is known: `Some(None)` if it has none.
    fn known_properties(
        &self,
        last: Option<(u32, u32)>,
        of_object: Option<Property>,
        model: &Model,
    ) -> Option<Option<TriangleProperties>> {
        if !self.has_properties() {
            return Some(None);
        }
        let group = self.group_of(last, of_object)?;
        let corners = self.indices(group, of_object, model).ok()?;
        Some(Some(TriangleProperties { group, corners }))
    }

    /// The entries of the group for the three corners: those that are not given are that of the first, or of the object.
    ///
    /// # Errors
    /// The message for one that the group does not have.
    fn indices(&self, group: u32, of_object: Option<Property>, model: &Model) -> Result<[u32; 3], String> {
        let length = model.groups[group as usize].len();
        let of_object = of_object.filter(|own| own.group == group as usize).map_or(0, |own| own.index);
        let first = self.properties[0].unwrap_or(of_object);
        let corners = [first, self.properties[1].unwrap_or(first), self.properties[2].unwrap_or(first)];
        match corners.iter().find(|&&index| index as usize >= length) {
            None => Ok(corners),
            Some(far) => Err(format!(
                "this triangle refers to property {far}, but its group has {length}, counted from 0"
            )),
        }
    }
}

fn triangle<'x>(element: &Element<'x>) -> Result<Triangle<'x>, FormatError> {
    let mut triangle = Triangle::default();
    for attribute in element.attributes() {
        let (key, value) = attribute.map_err(|_| element.no_attributes())?;
        let Some(slot) = triangle.slot(key.as_bytes()) else {
            if key == "paint_color" || key.ends_with("mmu_segmentation") {
                triangle.paint = value;
            }
            continue;
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
