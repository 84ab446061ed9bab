//! `auto` against the best single integrator, on every scene of `bench render`.

use super::measurement::{Context, Measurement};
use super::row::{Goal, Row};
use crate::render::{self, SCENES};
use bilux::Error;
use serde_json::Value;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "auto",
    summary: "auto over the best single integrator's error at equal time, on the scenes of bench render",
    run,
};

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let seconds = context.options.seconds * context.options.share;
    let options = render::Options {
        seconds: vec![seconds],
        seeds: context.options.repeats.max(1),
        ..render::Options::default()
    };
    let report = render::run(&options, &|what| context.say(&format!("auto: {what}")))?;
    Ok(SCENES.iter().filter_map(|(scene, _)| of_scene(scene, &report.rows, seconds)).collect())
}

/// Compares errors, each scaled to exactly the budget: an error is inversely proportional to the time.
fn of_scene(scene: &str, rows: &[Value], seconds: f64) -> Option<Row> {
    let error = |row: &Value| Some(row["relmse"].as_f64()? * row["cpu_seconds"].as_f64()? / seconds);
    let of_scene = || rows.iter().filter(|row| row["scene"] == scene);
    let auto = error(of_scene().find(|row| row["integrator"] == "auto")?)?;
    let others = of_scene().filter(|row| row["integrator"] != "auto");
    let scored = others.filter_map(|row| Some((error(row)?, row["integrator"].as_str()?)));
    let (best, name) = scored.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let what = format!("auto over the best single integrator, {scene}: relMSE at {seconds} CPU s");
    let row = Row::new(what, auto, Goal::RatioAtMost(1.1)).against(best);
    Some(row.with_note(format!("the best single integrator is {name}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn errors_are_compared_at_equal_time() {
        let row = |integrator: &str, relmse: f64, took: f64| json!({ "scene": "pool", "integrator": integrator, "relmse": relmse, "cpu_seconds": took });
        // vcm has the smaller error only because it took twice as long.
        let rows = [row("auto", 0.02, 1.0), row("vcm", 0.015, 2.0), row("path", 0.025, 1.0)];
        let found = of_scene("pool", &rows, 1.0).unwrap().json();
        assert_eq!((found["ours"].as_f64(), found["peer"].as_f64()), (Some(0.02), Some(0.025)), "{found}");
        assert!(
            found["met"].as_bool().unwrap() && found["note"].as_str().unwrap().contains("path"),
            "{found}"
        );
        assert!(of_scene("caustics", &rows, 1.0).is_none());
    }
}
