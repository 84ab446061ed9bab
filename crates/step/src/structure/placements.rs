//! The shapes of a file, each with its place.

use super::axes::between;
use super::products::Products;
use super::styles::{Style, Styles};
use super::units::{USUAL, Units};
use crate::part21::Table;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_math::{DMat4, DVec3};
use std::collections::HashSet;
use std::sync::Arc;

/// A shape in its place.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    /// The instance that is the shape, as one of [`EXACT`] or [`TESSELLATED`].
    pub(crate) item: u64,
    pub(crate) place: DMat4,
    /// The units of its representation.
    pub(crate) units: Units,
    /// The name of its product.
    pub(crate) name: Arc<str>,
    /// Style of what states none for itself.
    pub(crate) style: Option<Style>,
}

/// Shapes whose faces are exact surfaces.
const EXACT: &[&str] = &[
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "CONNECTED_FACE_SET",
    "ORIENTED_CLOSED_SHELL",
    "ADVANCED_FACE",
    "FACE_SURFACE",
];

/// Shapes that are triangles.
const TESSELLATED: &[&str] = &[
    "TESSELLATED_SOLID",
    "TESSELLATED_SHELL",
    "TRIANGULATED_FACE",
    "COMPLEX_TRIANGULATED_FACE",
    "TRIANGULATED_SURFACE_SET",
    "COMPLEX_TRIANGULATED_SURFACE_SET",
    "TESSELLATED_GEOMETRIC_SET",
];

/// Items that place others, or say how they look.
const SILENT: &[&str] =
    &["AXIS2_PLACEMENT_3D", "AXIS2_PLACEMENT_2D", "AXIS1_PLACEMENT", "STYLED_ITEM", "PLANE"];

/// Assemblies within assemblies, up to this depth.
const MAX_DEPTH: usize = 64;

/// Cost against the budget of entering a product or a representation, in bytes: time, rather than memory.
const VISIT: u64 = 1024;

/// All shapes, and metres per unit of the space that they are placed in.
pub(crate) fn placed(
    reading: &mut Reading,
    table: &Table,
    styles: &Styles,
    diagnostics: &mut Diagnostics,
) -> Result<(Vec<Placed>, f64), FormatError> {
    let products = Products::of_file(table);
    let unit = products.unit;
    let mut walk =
        Walk { reading, table, products, styles, diagnostics, found: Vec::new(), open: Vec::new() };
    for root in walk.products.roots().to_vec() {
        walk.product(root, DMat4::IDENTITY, None)?;
    }
    if walk.found.is_empty() {
        walk.without_products()?;
    }
    Ok((walk.found, unit))
}

struct Walk<'a, 't, 'b, 'o> {
    reading: &'a mut Reading<'o>,
    table: &'t Table<'b>,
    products: Products<'t, 'b>,
    styles: &'a Styles,
    diagnostics: &'a mut Diagnostics,
    found: Vec<Placed>,
    /// The products and representations that the walk is within.
    open: Vec<u64>,
}

/// Attributes that an item inherits from what it is in.
#[derive(Clone)]
struct Around {
    place: DMat4,
    units: Units,
    name: Arc<str>,
    style: Option<Style>,
    /// False if triangles of the same shape are shown exactly.
    shows_tessellated: bool,
    /// The assembly whose parts are placed by other means than mapped items.
    product: Option<u64>,
}

impl Walk<'_, '_, '_, '_> {
    /// Enters a product or a representation; false if the walk is within it already.
    fn enter(&mut self, id: u64) -> Result<bool, FormatError> {
        // Assemblies of assemblies grow fast, so each visit counts.
        self.reading.budget.take_bytes(VISIT, &self.table.file())?;
        let is_circle = self.open.contains(&id);
        if is_circle || self.open.len() >= MAX_DEPTH {
            let what = if is_circle {
                "an assembly contains itself, which is left out"
            } else {
                "assemblies are nested more than 64 levels deep, and the rest is left out"
            };
            self.diagnostics.note(what, || self.table.span(id));
            return Ok(false);
        }
        self.open.push(id);
        Ok(true)
    }

    fn product(&mut self, product: u64, place: DMat4, style: Option<Style>) -> Result<(), FormatError> {
        if !self.enter(product)? {
            return Ok(());
        }
        let style = self.styles.of(product).or(style);
        let representations = self.products.representations(product);
        let shows_tessellated = !representations.iter().any(|&id| self.has_exact(id));
        let name: Arc<str> = self.products.name(product).into();
        let mapped: HashSet<u64> = representations
            .iter()
            .flat_map(|&id| self.items(id))
            .filter_map(|item| self.products.owner(self.mapped(item)?))
            .collect();
        for &id in &representations {
            let around = Around {
                place,
                units: self.products.units(id).unwrap_or(USUAL),
                name: name.clone(),
                style: self.styles.of(id).or(style),
                shows_tessellated,
                product: Some(product),
            };
            self.representation(id, &around)?;
        }
        for part in self.products.parts(product).to_vec() {
            if self.styles.hides(part.id) || (part.place.is_none() && mapped.contains(&part.product)) {
                continue;
            }
            let style = self.styles.of(part.id).or(style);
            self.product(part.product, place * part.place.unwrap_or(DMat4::IDENTITY), style)?;
        }
        self.open.pop();
        Ok(())
    }

    /// The items of a representation.
    fn items(&self, id: u64) -> Vec<u64> {
        let values = self.table.parts(id).map(|(_, values)| values).find(|values| values.len() >= 3);
        values.map_or_else(Vec::new, |values| values.references_at(1).collect())
    }

    /// The representation that a mapped item repeats.
    fn mapped(&self, item: u64) -> Option<u64> {
        let map = self.table.part(item, "MAPPED_ITEM")?.reference(1)?;
        self.table.part(map, "REPRESENTATION_MAP")?.reference(1)
    }

    fn has_exact(&self, representation: u64) -> bool {
        self.items(representation).iter().any(|&item| self.is_one_of(item, EXACT))
    }

    fn is_one_of(&self, item: u64, names: &[&str]) -> bool {
        names.iter().any(|name| self.table.is(item, name))
    }

    fn representation(&mut self, id: u64, around: &Around) -> Result<(), FormatError> {
        if !self.enter(id)? {
            return Ok(());
        }
        let items = self.items(id);
        self.reading.budget.take::<u64>(items.len(), &self.table.file())?;
        for item in items {
            self.item(item, id, around)?;
        }
        for (other, place) in self.products.within(id).to_vec() {
            if self.products.owner(other).is_none() {
                let units = self.products.units(other).unwrap_or(around.units);
                self.representation(other, &Around { place: around.place * place, units, ..around.clone() })?;
            }
        }
        self.open.pop();
        Ok(())
    }

    fn item(&mut self, item: u64, representation: u64, around: &Around) -> Result<(), FormatError> {
        if self.styles.hides(item) {
            self.diagnostics.not_used("hidden shapes", || self.table.span(item));
            return Ok(());
        }
        if self.table.is(item, "MAPPED_ITEM") {
            return self.mapped_item(item, representation, around);
        }
        if self.is_one_of(item, EXACT) || self.is_one_of(item, TESSELLATED) {
            if self.is_one_of(item, EXACT) || around.shows_tessellated {
                self.add(item, around)?;
            }
            return Ok(());
        }
        if self.is_one_of(item, SILENT) || self.table.kind(item).is_empty() {
            return Ok(());
        }
        let kind = String::from_utf8_lossy(self.table.kind(item)).into_owned();
        let is_drawing = ["CURVE", "POINT", "GEOMETRIC_SET", "LINE", "ANNOTATION", "TEXT", "CALLOUT"]
            .iter()
            .any(|word| kind.contains(word));
        if is_drawing {
            self.diagnostics.not_used("curves, points and annotations", || self.table.span(item));
        } else {
            self.diagnostics.not_shown(&format!("shapes of the kind {kind}"), || self.table.span(item));
        }
        Ok(())
    }

    fn add(&mut self, item: u64, around: &Around) -> Result<(), FormatError> {
        self.reading.budget.take::<Placed>(1, &self.table.file())?;
        let scale = around.units.length / self.products.unit;
        let place = around.place * DMat4::from_scale(DVec3::splat(scale));
        let (name, style) = (around.name.clone(), around.style);
        self.found.push(Placed { item, place, units: around.units, name, style });
        Ok(())
    }

    fn mapped_item(&mut self, item: u64, representation: u64, around: &Around) -> Result<(), FormatError> {
        let read = || {
            let values = self.table.part(item, "MAPPED_ITEM")?;
            let (map, target) = (values.reference(1)?, values.reference(2)?);
            let source = self.table.part(map, "REPRESENTATION_MAP")?;
            let (origin, mapped) = (source.reference(0)?, source.reference(1)?);
            let scales = (self.products.scale(mapped), self.products.scale(representation));
            let place = between(self.table, (origin, scales.0), (target, scales.1))?;
            Some((mapped, place))
        };
        let Some((mapped, place)) = read() else {
            self.diagnostics.note("a mapped item has no place, and is left out", || self.table.span(item));
            return Ok(());
        };
        // What the assembly places by its own means is not placed once more.
        let owner = self.products.owner(mapped);
        let parts = around.product.map_or(&[][..], |product| self.products.parts(product));
        if parts.iter().any(|part| Some(part.product) == owner && part.place.is_some()) {
            return Ok(());
        }
        let around = Around {
            place: around.place * place,
            units: self.products.units(mapped).unwrap_or(around.units),
            name: owner.map_or_else(|| around.name.clone(), |owner| self.products.name(owner).into()),
            style: self.styles.of(item).or(self.styles.of(mapped)).or(around.style),
            shows_tessellated: !self.has_exact(mapped),
            product: owner,
        };
        self.representation(mapped, &around)
    }

    /// Shows all shapes of a file that has no tree of products, each where it is.
    fn without_products(&mut self) -> Result<(), FormatError> {
        for names in [&EXACT[..5], &TESSELLATED[..2], &TESSELLATED[2..], &EXACT[5..8], &EXACT[8..]] {
            for &item in self.table.ids() {
                if self.is_one_of(item, names) && !self.styles.hides(item) {
                    let units = Units { length: self.products.unit, ..USUAL };
                    let around = Around {
                        place: DMat4::IDENTITY,
                        units,
                        name: "".into(),
                        style: None,
                        shows_tessellated: true,
                        product: None,
                    };
                    self.add(item, &around)?;
                }
            }
            if !self.found.is_empty() {
                return Ok(());
            }
        }
        Ok(())
    }
}
