//! Reads beam lattices. [3MF Beam Lattice 1.2]

use super::beams::{Beam, Lattice};
use super::namespaces::Namespace;
use super::part::PartReader;
use super::xml::{Element, Level};
use bilux_import::FormatError;

/// Attributes that hold for all beams of a lattice.
#[derive(Clone, Copy)]
pub(super) struct LatticeAttributes {
    radius: f32,
    ball_radius: f32,
    /// True if all vertices of beams have balls.
    has_all_balls: bool,
    /// True if beams end flat.
    is_flat: bool,
    is_clipped: bool,
}

impl LatticeAttributes {
    pub(super) fn of(element: &Element) -> Result<LatticeAttributes, FormatError> {
        let radius = element.need_number("radius")?;
        let ball = |name: &str| element.of(Namespace::Balls, name).or_else(|| element.get(name));
        let ball_radius = ball("ballradius").and_then(super::attributes::number).unwrap_or(radius);
        Ok(LatticeAttributes {
            radius,
            ball_radius,
            has_all_balls: ball("ballmode") == Some("all"),
            is_flat: element.get("cap") == Some("butt"),
            is_clipped: !matches!(element.get("clippingmode"), None | Some("none")),
        })
    }
}

impl PartReader<'_, '_> {
    pub(super) fn lattice(
        &mut self,
        level: Level,
        attributes: LatticeAttributes,
        vertices: usize,
    ) -> Result<Lattice, FormatError> {
        let mut lattice = Lattice::default();
        if attributes.is_clipped {
            let at = self.xml.here();
            self.diagnostics.not_shown("the mesh that clips a beam lattice (all beams are shown)", || at);
        }
        while let Some(child) = self.xml.child(level)? {
            let inside = child.inside;
            match child.name {
                "beams" => self.beams(inside, &attributes, vertices, &mut lattice)?,
                "balls" => self.balls(inside, &attributes, vertices, &mut lattice)?,
                _ => {}
            }
        }
        let ends = lattice.beams.iter().flat_map(|beam| beam.ends.into_iter().zip(beam.radii));
        let round: Vec<(u32, f32)> = match (attributes.has_all_balls, attributes.is_flat) {
            (true, _) => ends.map(|(vertex, _)| (vertex, attributes.ball_radius)).collect(),
            (false, true) => Vec::new(),
            // The larger one of those that meet hides the others.
            (false, false) => ends.collect(),
        };
        self.reading.budget.take::<(u32, f32)>(round.len(), &self.file)?;
        lattice.balls.extend(round);
        lattice
            .balls
            .sort_by(|a, b| (a.0, b.1).partial_cmp(&(b.0, a.1)).unwrap_or(std::cmp::Ordering::Equal));
        lattice.balls.dedup_by_key(|(vertex, _)| *vertex);
        Ok(lattice)
    }

    fn beams(
        &mut self,
        level: Level,
        attributes: &LatticeAttributes,
        vertices: usize,
        lattice: &mut Lattice,
    ) -> Result<(), FormatError> {
        let file = self.file.clone();
        while let Some(element) = self.xml.child(level)? {
            if element.name != "beam" {
                continue;
            }
            let ends = [element.need_index("v1")?, element.need_index("v2")?];
            if let Some(far) = ends.iter().find(|&&vertex| vertex as usize >= vertices) {
                let message =
                    format!("this beam refers to vertex {far}, but its mesh has {vertices}, counted from 0");
                return Err(element.error(message));
            }
            let first = element.number("r1")?.unwrap_or(attributes.radius);
            let radii = [first, element.number("r2")?.unwrap_or(first)].map(|radius| radius.max(0.0));
            self.reading.budget.take::<Beam>(1, &file)?;
            lattice.beams.push(Beam { ends, radii });
        }
        Ok(())
    }

    fn balls(
        &mut self,
        level: Level,
        attributes: &LatticeAttributes,
        vertices: usize,
        lattice: &mut Lattice,
    ) -> Result<(), FormatError> {
        let file = self.file.clone();
        while let Some(element) = self.xml.child(level)? {
            if element.name != "ball" {
                continue;
            }
            let vertex = element.need_index("vindex")?;
            if vertex as usize >= vertices {
                let message = format!(
                    "this ball refers to vertex {vertex}, but its mesh has {vertices}, counted from 0"
                );
                return Err(element.error(message));
            }
            self.reading.budget.take::<(u32, f32)>(1, &file)?;
            lattice.balls.push((vertex, element.number("r")?.unwrap_or(attributes.ball_radius).max(0.0)));
        }
        Ok(())
    }
}
