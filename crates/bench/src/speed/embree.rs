//! Our rays against Embree's, on the scenes and classes of `bench rays`.

use super::measurement::{Context, Measurement};
use super::row::{Goal, Row};
use crate::rays::{self, Best};
use bilux::Error;
use bilux::accel::registry::AUTO;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "rays",
    summary: "our rays against Embree's: single, and best mode against best mode",
    run,
};

/// The rays of a class.
const COUNT: u32 = 1 << 18;

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let library = &context.options.embree;
    let options = rays::Options {
        // As Embree is asked for its quick and its thorough tree.
        accels: vec![AUTO.to_owned(), format!("{AUTO}-best")],
        count: context.options.part_of(COUNT) as usize,
        rounds: context.options.repeats.max(1),
        against: vec![("embree".to_owned(), library.clone())],
        ..rays::Options::default()
    };
    if !rays::is_embree(library) {
        let why =
            format!("not measured: '{}' is not Embree 4; --against embree=PATH names it", library.display());
        let what = ["single rays over Embree's", "our best mode over Embree's best mode"];
        let goals = [Goal::RatioAtLeast(1.0), Goal::RatioAtLeast(1.2)];
        return Ok(what.iter().zip(goals).map(|(what, goal)| Row::skipped(*what, goal, &*why)).collect());
    }
    let best = rays::against_embree(&options, &|what| context.say(&format!("rays: {what}")))?;
    Ok(best.iter().filter_map(single).chain(best.iter().map(best_mode)).collect())
}

fn single(best: &Best) -> Option<Row> {
    let [ours, embree] = best.single.as_ref()?;
    let what = format!("single rays, {}, {}: Mrays/s", best.scene, best.class);
    Some(Row::new(what, ours.mrays, Goal::RatioAtLeast(1.0)).against(embree.mrays))
}

fn best_mode(best: &Best) -> Row {
    let what = format!("best mode, {}, {}: Mrays/s", best.scene, best.class);
    let row = Row::new(what, best.ours.mrays, Goal::RatioAtLeast(1.2)).against(best.embree.mrays);
    row.with_note(format!("{} against {}", best.ours.name, best.embree.name))
}
