//! `bilux bench build`: its rows.

use bilux_bench::{Options, build::run};

#[test]
fn builders_are_known_by_name_and_quality() {
    let names = ["bvh8-fast", "bvh8", "bvh8-best", "kd"];
    let accels = names.map(str::to_owned).to_vec();
    let report =
        run(&Options { counts: vec![1], accels, repeats: 1, ..Options::default() }, &|_| {}).unwrap();
    let found: Vec<_> = report.rows.iter().map(|row| row["accel"].as_str().unwrap()).collect();
    assert_eq!(found, names);
    for row in &report.rows {
        let figures =
            ["build_seconds", "build_seconds_on_all", "bytes_per_triangle", "references_per_triangle"];
        assert!(figures.iter().all(|key| row[key].as_f64().unwrap() > 0.0), "{row}");
        assert_eq!(row["triangles"], 4_034);
    }
    // The table has the same numbers.
    for row in &report.rows {
        let figures =
            ["build_seconds", "build_seconds_on_all"].map(|key| format!("{:.4}", row[key].as_f64().unwrap()));
        let line = report.text.lines().find(|line| line.split_whitespace().nth(1) == row["accel"].as_str());
        let words: Vec<_> = line.unwrap().split_whitespace().collect();
        assert_eq!(words[2..4], figures, "{row}");
    }
    let both = |row: &serde_json::Value| row["build_seconds"] != row["build_seconds_on_all"];
    assert!(report.rows.iter().any(both), "{:?}", report.rows);
    let unknown = Options { accels: vec!["bvh8-worst".to_owned()], ..Options::default() };
    assert!(run(&unknown, &|_| {}).err().unwrap().to_string().contains("-best"));
}
