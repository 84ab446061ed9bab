//! Products, their representations, and what is part of what.

use super::axes::{between, operator};
use super::units::{USUAL, Units, of_context};
use crate::part21::Table;
use bilux_math::DMat4;
use std::collections::{HashMap, HashSet};

/// A part of an assembly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Use {
    /// The definition of the part's product.
    pub(super) product: u64,
    /// Place of the part; `None` if nothing says.
    pub(super) place: Option<DMat4>,
    /// Instance that states the part.
    pub(super) id: u64,
}

/// The tree of products, by the numbers of their definitions.
pub(super) struct Products<'t, 'b> {
    pub(super) table: &'t Table<'b>,
    /// The representations of the shape of each.
    representations: HashMap<u64, Vec<u64>>,
    /// The product of each representation.
    owners: HashMap<u64, u64>,
    parts: HashMap<u64, Vec<Use>>,
    /// Representations that share coordinates.
    beside: HashMap<u64, Vec<u64>>,
    /// Representations that are placed within others, without products.
    within: HashMap<u64, Vec<(u64, DMat4)>>,
    /// Products that are part of none.
    roots: Vec<u64>,
    /// Metres per unit of the picture's space.
    pub(super) unit: f64,
}

impl<'t, 'b> Products<'t, 'b> {
    pub(super) fn of_file(table: &'t Table<'b>) -> Products<'t, 'b> {
        let mut products = Products {
            table,
            representations: HashMap::new(),
            owners: HashMap::new(),
            parts: HashMap::new(),
            beside: HashMap::new(),
            within: HashMap::new(),
            roots: Vec::new(),
            unit: USUAL.length,
        };
        products.find_representations();
        products.find_relations();
        let children: HashSet<u64> = products.parts.values().flatten().map(|part| part.product).collect();
        let is_root = |id: &u64| {
            !children.contains(id)
                && (products.representations.contains_key(id) || products.parts.contains_key(id))
        };
        let ids = table.ids().iter().copied();
        products.roots =
            ids.filter(|&id| table.kind(id).starts_with(b"PRODUCT_DEFINITION")).filter(is_root).collect();
        // If every product is part of another one, the assembly goes in circles.
        if products.roots.is_empty() {
            products.roots.extend(products.parts.keys().min());
        }
        products
    }

    fn find_representations(&mut self) {
        let mut shows = false;
        for (_, link) in self.table.all("SHAPE_DEFINITION_REPRESENTATION") {
            let (Some(shape), Some(representation)) = (link.reference(0), link.reference(1)) else {
                continue;
            };
            if let Some(units) = self.units(representation).filter(|_| !shows) {
                self.unit = units.length;
                shows = true;
            }
            let Some(product) =
                self.table.part(shape, "PRODUCT_DEFINITION_SHAPE").and_then(|of| of.reference(2))
            else {
                continue;
            };
            if self.table.kind(product).starts_with(b"PRODUCT_DEFINITION") {
                self.representations.entry(product).or_default().push(representation);
                self.owners.insert(representation, product);
            }
        }
        if !shows {
            let units = self.table.ids().iter().find_map(|&id| of_context(self.table, id));
            self.unit = units.unwrap_or(USUAL).length;
        }
    }

    fn find_relations(&mut self) {
        // Relations that place a part of an assembly, by the usage.
        let mut placing: HashMap<u64, u64> = HashMap::new();
        let mut taken: HashSet<u64> = HashSet::new();
        for (_, link) in self.table.all("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
            let (Some(relation), Some(shape)) = (link.reference(0), link.reference(1)) else { continue };
            taken.insert(relation);
            if let Some(usage) =
                self.table.part(shape, "PRODUCT_DEFINITION_SHAPE").and_then(|of| of.reference(2))
            {
                placing.entry(usage).or_insert(relation);
            }
        }
        for &id in self.table.ids().iter().filter(|id| !taken.contains(id)) {
            self.relate(id);
        }
        for (id, usage) in self.table.all("NEXT_ASSEMBLY_USAGE_OCCURRENCE") {
            let (Some(whole), Some(product)) = (usage.reference(3), usage.reference(4)) else { continue };
            let place = placing.get(&id).and_then(|&relation| self.place(relation, product));
            self.parts.entry(whole).or_default().push(Use { product, place, id });
        }
    }

    /// A relation of representations that places no part of an assembly.
    fn relate(&mut self, id: u64) {
        let Some([first, second]) = self.related(id) else { return };
        if self.table.is(id, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") {
            if let Some(place) = self.transformation(id, first, second) {
                self.within.entry(second).or_default().push((first, place));
            }
        } else {
            self.beside.entry(first).or_default().push(second);
            self.beside.entry(second).or_default().push(first);
        }
    }

    /// The two representations of a relation.
    fn related(&self, id: u64) -> Option<[u64; 2]> {
        let names = ["SHAPE_REPRESENTATION_RELATIONSHIP", "REPRESENTATION_RELATIONSHIP"];
        let found =
            names.iter().filter_map(|name| self.table.part(id, name)).find(|values| values.len() >= 4)?;
        Some([found.reference(2)?, found.reference(3)?])
    }

    fn transformation(&self, id: u64, first: u64, second: u64) -> Option<DMat4> {
        let by = self.table.part(id, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")?.reference(0)?;
        let Some(items) = self.table.part(by, "ITEM_DEFINED_TRANSFORMATION") else {
            return operator(self.table, by);
        };
        between(
            self.table,
            (items.reference(2)?, self.scale(first)),
            (items.reference(3)?, self.scale(second)),
        )
    }

    /// Transform by which a relation places a part. Some programs name the whole first.
    fn place(&self, relation: u64, part: u64) -> Option<DMat4> {
        let [first, second] = self.related(relation)?;
        let place = self.transformation(relation, first, second)?;
        let is_of_part = |id: &u64| self.representations.get(&part).is_some_and(|own| own.contains(id));
        Some(if is_of_part(&second) && !is_of_part(&first) { place.inverse() } else { place })
    }

    /// The units of a representation, if it states them.
    pub(super) fn units(&self, representation: u64) -> Option<Units> {
        let (_, values) = self.table.parts(representation).find(|(_, values)| values.len() >= 3)?;
        of_context(self.table, values.reference(2)?)
    }

    /// The length of a representation's unit, in that of the picture's space.
    pub(super) fn scale(&self, representation: u64) -> f64 {
        self.units(representation).map_or(1.0, |units| units.length / self.unit)
    }

    pub(super) fn roots(&self) -> &[u64] {
        &self.roots
    }

    pub(super) fn parts(&self, product: u64) -> &[Use] {
        self.parts.get(&product).map_or(&[], |parts| parts)
    }

    /// Representations that are placed within another.
    pub(super) fn within(&self, representation: u64) -> &[(u64, DMat4)] {
        self.within.get(&representation).map_or(&[], |within| within)
    }

    /// The product that a representation is of.
    pub(super) fn owner(&self, representation: u64) -> Option<u64> {
        self.owners.get(&representation).copied()
    }

    /// All representations of a product that share its coordinates.
    pub(super) fn representations(&self, product: u64) -> Vec<u64> {
        let mut found = self.representations.get(&product).cloned().unwrap_or_default();
        let mut known: HashSet<u64> = found.iter().copied().collect();
        let mut next = 0;
        while let Some(id) = found.get(next) {
            next += 1;
            for &other in self.beside.get(id).into_iter().flatten() {
                // Of another product, only the parts of the assembly lead there.
                if self.owner(other).is_none_or(|owner| owner == product) && known.insert(other) {
                    found.push(other);
                }
            }
        }
        found
    }

    /// The name of a product, or else its identifier.
    pub(super) fn name(&self, product: u64) -> String {
        let named = || {
            let formation = self.table.simple(product)?.reference(2)?;
            let of = self.table.simple(formation)?.reference(2)?;
            let values = self.table.part(of, "PRODUCT")?;
            Some(
                [values.text(1), values.text(0)]
                    .into_iter()
                    .find(|name| !name.trim().is_empty())?
                    .trim()
                    .to_owned(),
            )
        };
        named().unwrap_or_default()
    }
}
