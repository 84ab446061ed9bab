//! Results of one build of a scene, kept for the next one: values by all that they were made from.

mod mesh_pool;
mod same;
mod spec_key;

pub(crate) use mesh_pool::MeshPool;
pub(crate) use same::{Place, Same};
pub(crate) use spec_key::SpecKey;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::convert::Infallible;
use std::hash::Hash;

/// Values by their keys. After a build only those are kept that it used.
#[derive(Clone)]
pub(crate) struct Kept<K, V> {
    values: HashMap<K, Used<V>>,
    build: u64,
}

#[derive(Clone)]
struct Used<V> {
    value: V,
    /// The build that made it, and the last one that used it.
    made: u64,
    used: u64,
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Kept<K, V> {
        Kept { values: HashMap::new(), build: 0 }
    }
}

impl<K: Eq + Hash, V: Clone> Kept<K, V> {
    /// A build begins.
    pub(crate) fn begin(&mut self) {
        self.build += 1;
    }

    /// The build ends: drops what a successful one did not use, and what a failed one made.
    pub(crate) fn end(&mut self, succeeded: bool) {
        let build = self.build;
        self.values.retain(|_, value| if succeeded { value.used == build } else { value.made != build });
    }

    /// The value of a key; `make` makes it where there is none.
    pub(crate) fn or_make<E>(&mut self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        let build = self.build;
        match self.values.entry(key) {
            Entry::Occupied(mut entry) => {
                entry.get_mut().used = build;
                Ok(entry.get().value.clone())
            }
            Entry::Vacant(entry) => {
                Ok(entry.insert(Used { value: make()?, made: build, used: build }).value.clone())
            }
        }
    }

    /// [`Kept::or_make`], where making cannot fail.
    pub(crate) fn or_make_surely(&mut self, key: K, make: impl FnOnce() -> V) -> V {
        match self.or_make(key, || Ok::<V, Infallible>(make())) {
            Ok(value) => value,
            Err(never) => match never {},
        }
    }

    /// Uses the value of a key, if there is one.
    pub(crate) fn touch(&mut self, key: &K) {
        if let Some(value) = self.values.get_mut(key) {
            value.used = self.build;
        }
    }

    /// Drops everything.
    pub(crate) fn clear(&mut self) {
        self.values.clear();
    }

    /// The number of values.
    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }
}
