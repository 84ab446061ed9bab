//! Meshes that are subdivision surfaces.

use crate::geometry::meshes::{Piece, Subset, name_of, uvs};
use crate::geometry::polygons::Polygons;
use crate::geometry::primvars::{Interpolation, Place, Primvar};
use crate::geometry::subdivision::Subdivision;
use crate::stage::Stage;
use crate::stage::context::{Context, Worn};
use bilux_import::FormatError;
use bilux_import::geometry::subdivision::{Attribute, Cage, Linear, PendingCage, Scheme};
use bilux_math::Vec3;

/// From this sharpness on, an edge is as sharp as it can be. [OpenUSD, UsdGeomMesh]
const SHARPEST: f32 = 10.0;

/// The pieces of a subdivision surface, one for each subset and one for all other faces; they are refined when the whole
/// scene is known. `None` if the mesh is no such surface, or does not say so while it has normals, which only polygons have.
pub(crate) fn pieces(
    stage: &Stage,
    prim: u32,
    polygons: &Polygons,
    subdivision: &Subdivision,
    subsets: &[Subset],
    rest: &Worn,
    scene: &mut Context,
) -> Result<Option<Vec<Piece>>, FormatError> {
    let is_meant = !polygons.has_normals || subdivision.is_stated || subdivision.has_creases();
    let Some(scheme) = subdivision.scheme.refined().filter(|_| is_meant) else {
        return Ok(None);
    };
    if polygons.has_normals {
        scene.sink.diagnostics.not_used("normals of subdivision surfaces", || stage.at(prim));
    }
    let worn: Vec<&Worn> = subsets.iter().map(|subset| &subset.worn).chain([rest]).collect();
    let file = stage.layers[0].name.clone();
    let bytes = polygons.points.len() * 48 + polygons.corners.len() * 200 + polygons.ends.len() * 12;
    scene.reading.budget.take_bytes(bytes as u64, &file)?;
    let mut surface = Surface { cage: Cage::new(scheme, &polygons.points), places: Vec::new() };
    let groups = groups(polygons, subsets);
    for (face, &group) in groups.iter().enumerate() {
        let mut corners: Vec<usize> = polygons.face(face).collect();
        if corners.len() < 3 || polygons.is_hole.get(face).is_some_and(|hole| *hole) {
            continue;
        }
        if polygons.is_left_handed {
            corners.reverse();
        }
        let place = |&corner: &usize| Place { corner, vertex: polygons.corners[corner] as usize, face };
        let places: Vec<Place> = corners.iter().map(place).collect();
        match scheme {
            Scheme::Loop => {
                (2..places.len()).for_each(|i| surface.add(&[places[0], places[i - 1], places[i]], group))
            }
            _ => surface.add(&places, group),
        }
    }
    sharpen(&mut surface.cage, subdivision);
    let coordinates = worn.iter().map(|worn| uvs(stage, prim, worn, scene)).collect::<Result<Vec<_>, _>>()?;
    for (set, attribute) in [Attribute::Uv, Attribute::SecondUv].into_iter().enumerate() {
        surface.add_uvs(attribute, &coordinates, set, subdivision.linear);
    }
    let users = |uses: fn(&Worn) -> bool| worn.iter().map(|worn| uses(worn)).collect::<Vec<_>>();
    if let Some(colours) = &polygons.colours {
        surface.add_primvar(Attribute::Colour, colours, subdivision.linear, users(|worn| worn.uses_colours));
    }
    if let Some(opacities) = &polygons.opacities {
        surface.add_primvar(
            Attribute::Opacity,
            opacities,
            subdivision.linear,
            users(|worn| worn.uses_opacities),
        );
    }
    let name = name_of(stage, prim).to_owned();
    let pending = PendingCage::new(surface.cage, worn.iter().map(|_| name.clone()), stage.at(prim));
    let pieces = (0..worn.len()).map(|group| Piece { mesh: pending.mesh(group).clone(), group }).collect();
    scene.reading.cages.push(pending);
    Ok(Some(pieces))
}

/// A cage, and the place on the mesh of each of its corners.
struct Surface {
    cage: Cage,
    places: Vec<Place>,
}

impl Surface {
    fn add(&mut self, places: &[Place], group: u32) {
        let points: Vec<u32> = places.iter().map(|place| place.vertex as u32).collect();
        self.cage.add_face(&points, &[], group);
        self.places.extend_from_slice(places);
    }

    /// Adds a set of texture coordinates. Groups that are placed by different primvars have them one after the other.
    fn add_uvs(
        &mut self,
        attribute: Attribute,
        coordinates: &[[Option<Primvar>; 2]],
        set: usize,
        linear: Linear,
    ) {
        let mut waiting: Vec<usize> =
            (0..coordinates.len()).filter(|group| coordinates[*group][set].is_some()).collect();
        while let Some(&first) = waiting.first() {
            let Some(primvar) = &coordinates[first][set] else { break };
            let is_same = |group: &usize| {
                let other = coordinates[*group][set].as_ref();
                other.is_some_and(|other| {
                    std::sync::Arc::ptr_eq(&other.values, &primvar.values) || other.values == primvar.values
                })
            };
            let users = (0..coordinates.len()).map(|group| is_same(&group)).collect();
            self.add_primvar(attribute, primvar, linear, users);
            waiting.retain(|group| !is_same(group));
        }
    }

    /// Adds a primvar for the groups that use it.
    fn add_primvar(&mut self, attribute: Attribute, primvar: &Primvar, linear: Linear, users: Vec<bool>) {
        if !users.contains(&true) {
            return;
        }
        let value = |corner: usize| {
            let place = self.places[corner];
            if attribute == Attribute::Opacity {
                return Vec3::splat(primvar.index(place).map_or(1.0, |_| primvar.at::<1>(place)[0]));
            }
            Vec3::from(primvar.at::<3>(place))
        };
        let number =
            |corner: usize| primvar.index(self.places[corner]).map_or(u32::MAX, |index| index as u32);
        match primvar.interpolation {
            Interpolation::Vertex => self.cage.add_layer_of_points(attribute, false, users, value),
            Interpolation::Varying => self.cage.add_layer_of_points(attribute, true, users, value),
            Interpolation::FaceVarying => {
                self.cage.add_layer(attribute, linear, users, |corner| (number(corner), value(corner)));
            }
            // The polygons made of a face have its value.
            Interpolation::Uniform | Interpolation::Constant => {
                let face = |corner: usize| (self.places[corner].face as u32, value(corner));
                self.cage.add_layer(attribute, Linear::All, users, face);
            }
        }
    }
}

/// The group of each face: the first subset that has it, or that of all others.
fn groups(polygons: &Polygons, subsets: &[Subset]) -> Vec<u32> {
    let mut groups = vec![subsets.len() as u32; polygons.ends.len()];
    for (group, subset) in subsets.iter().enumerate().rev() {
        for &face in &subset.faces {
            if let Some(slot) = groups.get_mut(face as usize) {
                *slot = group as u32;
            }
        }
    }
    groups
}

/// Adds creases and corners.
fn sharpen(cage: &mut Cage, subdivision: &Subdivision) {
    let sharpness = |s: f64| if s as f32 >= SHARPEST { f32::INFINITY } else { s as f32 };
    if subdivision.rounds_corners {
        cage.round_corners();
    }
    if let (Some(points), Some(lengths), Some(sharp)) =
        (&subdivision.crease_indices, &subdivision.crease_lengths, &subdivision.crease_sharpnesses)
    {
        let is_per_crease = sharp.len() == lengths.len();
        let (mut first, mut edge) = (0usize, 0);
        for crease in 0..lengths.len() {
            let end = first.saturating_add(lengths.numbers.at(crease).max(0.0) as usize).min(points.len());
            for i in first + 1..end {
                let which = if is_per_crease { crease } else { edge };
                let ends = [i - 1, i].map(|i| points.numbers.at(i) as u32);
                if which < sharp.len() {
                    cage.crease(ends, sharpness(sharp.numbers.at(which)));
                }
                edge += 1;
            }
            first = end;
        }
    }
    if let (Some(points), Some(sharp)) = (&subdivision.corner_indices, &subdivision.corner_sharpnesses) {
        for i in 0..points.len().min(sharp.len()) {
            cage.sharpen(points.numbers.at(i) as u32, sharpness(sharp.numbers.at(i)));
        }
    }
}
