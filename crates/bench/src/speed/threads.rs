//! Speedup of two threads over one.

use super::cpu::cores;
use super::measurement::{Context, Measurement};
use super::row::{Goal, Row};
use super::shots::Plan;
use crate::median;
use bilux::Error;
use bilux::scene::Spec;

pub(super) const MEASUREMENT: Measurement =
    Measurement { name: "threads", summary: "two threads over one, by path and by auto", run };

const SIDE: u32 = 384;
const MAX_DEPTH: u32 = 16;

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let integrators = [("path", 32), ("auto", 16)];
    let goal = Goal::RatioAtLeast(1.92);
    let what = |name: &str| format!("two threads over one, {name}: M samples/s");
    if cores() < 2 {
        let why = "not measured: there is only one core";
        return Ok(integrators.iter().map(|(name, _)| Row::skipped(what(name), goal, why)).collect());
    }
    let scene = bilux::generate(&Spec::new("", "cornell-spheres"))?;
    let mut rows = Vec::new();
    for (integrator, samples) in integrators {
        let samples = context.options.part_of(samples);
        let mut seconds = [Vec::new(), Vec::new()];
        for round in context.rounds() {
            for (seconds, threads) in seconds.iter_mut().zip([1, 2]) {
                context.say(&format!("threads: {integrator} on {threads}, round {}", round + 1));
                let plan = Plan { integrator, side: SIDE, samples, seed: 1, threads, max_depth: MAX_DEPTH };
                seconds.push(plan.shoot(&scene)?.seconds);
            }
        }
        let all = f64::from(SIDE * SIDE) * f64::from(samples) * 1e-6;
        let [one, two] = seconds.map(|seconds| all / median(seconds));
        rows.push(
            Row::new(what(integrator), two, goal).against(one).with_note("the other side is one thread"),
        );
    }
    Ok(rows)
}
