//! `bilux bench speed`: its rows and what programs read of them.

use bilux_bench::Report;
use bilux_bench::speed::{MEASUREMENTS, Options, run};
use std::collections::HashSet;

/// One sample a pixel, and no other renderer.
fn quick(rows: &[&str]) -> Report {
    let options = Options {
        rows: rows.iter().map(|name| (*name).to_owned()).collect(),
        python: "no-such-python".into(),
        embree: "no-such-embree.so".into(),
        repeats: 1,
        share: 1e-6,
        ..Options::default()
    };
    run(&options, &|_| {}).unwrap()
}

#[test]
fn names_are_unique_and_others_refused() {
    let names: HashSet<_> = MEASUREMENTS.iter().map(|m| m.name).collect();
    assert_eq!(names.len(), MEASUREMENTS.len());
    assert!(MEASUREMENTS.iter().all(|m| !m.summary.is_empty()));
    let wrong = Options { rows: vec!["boxes".to_owned()], ..Options::default() };
    let Err(error) = run(&wrong, &|_| {}) else { panic!("there are no such rows") };
    assert!(error.to_string().contains("did you mean 'box'?"), "{error}");
}

#[test]
fn rows_have_what_programs_ask_for() {
    let report = quick(&["box", "bidirectional", "principled"]);
    let json = report.json();
    assert_eq!(json.as_object().unwrap().keys().collect::<Vec<_>>(), ["cpu", "rows"]);
    assert!(json["cpu"].as_str().unwrap().contains("core"), "{json}");
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6, "{json}");
    for row in rows {
        let keys: Vec<_> = row.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, ["what", "ours", "peer", "ratio", "goal", "met", "note"]);
        assert!(row["ours"].as_f64().unwrap() > 0.0 && !row["note"].as_str().unwrap().is_empty(), "{row}");
        assert_eq!(row["peer"].is_null(), row["ratio"].is_null(), "{row}");
        assert!(report.text.contains(row["what"].as_str().unwrap()), "{}", report.text);
    }
    // Without Mitsuba and the others there is our side, and a word about it.
    for row in &rows[..4] {
        assert!(row["peer"].is_null() && row["met"].is_null(), "{row}");
        assert!(row["note"].as_str().unwrap().starts_with("our side only"), "{row}");
    }
    // Both sides of this one are ours.
    assert!(rows[4]["ratio"].as_f64().unwrap() > 1.0 && rows[4]["met"].is_boolean(), "{}", rows[4]);
}

#[test]
fn rows_that_cannot_be_measured_say_what_they_need() {
    let report = quick(&["model", "studio", "rays"]);
    assert_eq!(report.rows.len(), 7);
    for row in &report.rows {
        assert!(row["ours"].is_null() && row["met"].is_null(), "{row}");
        let note = row["note"].as_str().unwrap();
        assert!(note.contains("--model FILE") || note.contains("--against embree=PATH"), "{row}");
    }
}

#[test]
fn memory_alone_is_measured_by_this_process() {
    let report = quick(&["memory"]);
    let [row] = &report.rows[..] else { panic!("{:?}", report.rows) };
    assert!(row["ours"].is_null() || row["ours"].as_f64().unwrap() > 1.0, "{row}");
}
