//! The document as it is at one time.

use super::animation::Pose;
use super::document::Document;
use super::element::Element;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// A document with what its animation gives to elements.
pub(super) struct Posed<'p, 'd> {
    pub(super) document: &'p Document<'d>,
    pub(super) pose: Pose,
}

impl Posed<'_, '_> {
    /// The numbers of an element at this time.
    pub(super) fn numbers(&self, element: Element, budget: &mut Budget) -> Result<Vec<f64>, FormatError> {
        let mut numbers = element.numbers(budget)?;
        for set in self.pose.of(element) {
            let first = set.first.unwrap_or(0);
            for (number, value) in numbers.iter_mut().skip(first).zip(&set.values) {
                *number = *value;
            }
        }
        Ok(numbers)
    }

    /// The first of them. One that is malformed, infinite or not a number (NaN) counts as missing.
    pub(super) fn number(&self, element: Element) -> Option<f64> {
        let animated = self.pose.of(element).iter().rev().find(|set| set.first.unwrap_or(0) == 0);
        let stated = || bilux_import::bytes::float::parse_f64(element.words().next()?.as_bytes());
        let number = animated.and_then(|set| set.values.first().copied()).or_else(stated);
        number.filter(|number| number.is_finite())
    }

    /// The first number of a child.
    pub(super) fn number_of(&self, element: Element, child: &str) -> Option<f64> {
        self.number(element.child(child)?)
    }
}
