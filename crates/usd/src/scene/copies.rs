//! The copies of a `PointInstancer`, each with its own colour.

use crate::scene::instancer::{Copies, Look};
use crate::scene::{Scene, State};
use crate::stage::Stage;
use bilux_import::{FormatError, geometry::flat};
use bilux_math::DMat4;
use bilux_scene::Object;
use std::collections::{HashMap, HashSet};

/// Largest number of prims of prototypes that are looked at again for copies of other colours.
const AGAIN_LIMIT: usize = 1 << 20;

impl Scene<'_, '_> {
    /// Adds the copies of a `PointInstancer`.
    pub(crate) fn copies(&mut self, stage: &Stage, prim: u32, state: &State) -> Result<(), FormatError> {
        if self.lineage.contains(&prim) {
            let what = "an instancer is its own prototype: left out there";
            self.context.sink.diagnostics.note(what, || stage.at(prim));
            return Ok(());
        }
        let file = &stage.layers[0].name;
        let Some(copies) = Copies::read(stage, prim, &mut self.context.reading.budget)? else {
            return Ok(());
        };
        let bytes = copies.len() as u64 * Copies::BYTES;
        self.context.reading.budget.take_bytes(bytes, file)?;
        let mut groups = copies.by_look();
        let most = 1 + AGAIN_LIMIT / below(stage, &copies.prototypes).max(1);
        if groups.len() > most {
            let what =
                "an instancer has too many colours: the last of its copies have those of its prototypes";
            self.context.sink.diagnostics.note(what, || stage.at(prim));
            let rest = groups.split_off(most).into_iter().flat_map(|(_, copies)| copies);
            let rest = rest.collect();
            groups.push((Look::default(), rest));
        }
        self.lineage.push(prim);
        for (look, group) in groups {
            self.looks.push((prim, look.primvars()));
            let used = group.iter().filter_map(|&i| copies.prototype(i as usize)).collect();
            let made = self.prototypes(stage, &used, state);
            self.looks.pop();
            self.placed(stage, &copies, &group, &made?, &state.world)?;
        }
        self.lineage.pop();
        self.context.reading.budget.release(bytes);
        Ok(())
    }

    /// The objects of some prototypes, each as if there were nothing else.
    fn prototypes(
        &mut self,
        stage: &Stage,
        used: &HashSet<u32>,
        state: &State,
    ) -> Result<HashMap<u32, Vec<Object>>, FormatError> {
        let state = State { world: DMat4::IDENTITY, purpose: None, binding: None, ..state.clone() };
        let mut made = HashMap::new();
        let mut used: Vec<u32> = used.iter().copied().collect();
        used.sort_unstable();
        for prototype in used {
            let (depth, sink) = (self.lineage.len(), &mut self.context.sink);
            let objects = std::mem::take(&mut sink.scene.objects);
            let before = (sink.scene.lights.len(), sink.scene.cameras.len());
            // What holds for the prims above a prototype holds for it, wherever it is.
            let above = lineage(stage, prototype);
            let above = above.into_iter().filter(|prim| !self.lineage.contains(prim)).collect::<Vec<_>>();
            self.lineage.extend(above);
            let added = self.prim(stage, prototype, &state);
            self.lineage.truncate(depth);
            let sink = &mut self.context.sink;
            if sink.scene.lights.len() > before.0 || sink.scene.cameras.len() > before.1 {
                let what = "lights and cameras below a prototype of a PointInstancer";
                sink.diagnostics.not_shown(what, || stage.at(prototype));
            }
            sink.scene.lights.truncate(before.0);
            sink.scene.cameras.truncate(before.1);
            made.insert(prototype, std::mem::replace(&mut sink.scene.objects, objects));
            added?;
        }
        Ok(made)
    }

    /// Adds a group of copies.
    fn placed(
        &mut self,
        stage: &Stage,
        copies: &Copies,
        group: &[u32],
        made: &HashMap<u32, Vec<Object>>,
        world: &DMat4,
    ) -> Result<(), FormatError> {
        let file = &stage.layers[0].name;
        for &i in group {
            let Some((prototype, place)) = copies.copy(i as usize) else { continue };
            let world = *world * place;
            for object in made.get(&prototype).into_iter().flatten() {
                let whole = world * object.motion.at(0.0).matrix().as_dmat4();
                let budget = &mut self.context.reading.budget;
                budget.take_bytes(bytes_of(object), file)?;
                if let Some((mesh, motion)) = flat::placed(&object.mesh, &whole, budget, file)? {
                    self.context.sink.scene.objects.push(Object { mesh, motion, ..object.clone() });
                }
            }
        }
        // The prototypes themselves are no longer held.
        let held = made.values().flatten().map(bytes_of).sum();
        self.context.reading.budget.release(held);
        Ok(())
    }
}

fn bytes_of(object: &Object) -> u64 {
    (size_of::<[Object; 2]>() + object.name.len() + object.category.len()) as u64
}

/// The prims above one, from the root on.
fn lineage(stage: &Stage, prim: u32) -> Vec<u32> {
    let mut above: Vec<u32> = std::iter::successors(stage.above(prim), |&prim| stage.above(prim)).collect();
    above.reverse();
    above
}

/// The number of prims of some prototypes.
fn below(stage: &Stage, prototypes: &[u32]) -> usize {
    let mut waiting: Vec<u32> = prototypes.iter().copied().collect::<HashSet<_>>().into_iter().collect();
    let mut count = 0;
    while let Some(prim) = waiting.pop() {
        count += 1;
        waiting.extend(&stage.prim(prim).children);
    }
    count
}
