//! The results, as JSON and as tables.

use super::engine::Mode;
use super::options::Options;
use crate::table;
use serde_json::{Value, json};

/// The result of one engine for one class on one scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) triangles: usize,
    pub(super) class: String,
    pub(super) engine: String,
    pub(super) ours: bool,
    pub(super) mode: Mode,
    pub(super) mrays: f64,
    pub(super) build_seconds: f64,
    pub(super) bytes_per_triangle: f64,
    pub(super) mismatches: usize,
}

impl Row {
    pub(super) fn json(&self) -> Value {
        json!({
            "scene": self.scene, "triangles": self.triangles, "class": self.class, "engine": self.engine,
            "mode": self.mode.name(), "mrays": self.mrays, "build_seconds": self.build_seconds,
            "bytes_per_triangle": self.bytes_per_triangle, "mismatches": self.mismatches,
        })
    }
}

/// A table for each scene: engines down, classes across. Our own show their ratio to the best competitor in the same
/// mode. Where there are competitors, a line below compares the best of ours with the best of theirs, in any mode.
pub(super) fn text(rows: &[Row], options: &Options) -> String {
    let mut scenes: Vec<&str> = rows.iter().map(|row| &*row.scene).collect();
    scenes.dedup();
    let one = |scene: &str| {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
        of_one(scene, &of_scene, options)
    };
    scenes.iter().map(|scene| one(scene)).collect::<Vec<_>>().join("\n")
}

fn of_one(scene: &str, rows: &[&Row], options: &Options) -> String {
    let mut classes: Vec<&str> = Vec::new();
    let mut engines: Vec<(&str, Mode)> = Vec::new();
    for row in rows {
        if !classes.contains(&&*row.class) {
            classes.push(&row.class);
        }
        if !engines.contains(&(&*row.engine, row.mode)) {
            engines.push((&row.engine, row.mode));
        }
    }
    let best = |class: &str, mode: Mode| {
        let peers = rows.iter().filter(|r| !r.ours && r.class == class && r.mode == mode);
        peers.map(|r| r.mrays).fold(0.0, f64::max)
    };
    let cells: Vec<Vec<String>> = engines
        .iter()
        .map(|&(engine, mode)| {
            let own: Vec<&&Row> = rows.iter().filter(|r| r.engine == engine && r.mode == mode).collect();
            let speed = |row: &Row| match best(&row.class, mode) {
                best if best > 0.0 && row.ours => format!("{:.2} ({:.2}×)", row.mrays, row.mrays / best),
                _ => format!("{:.2}", row.mrays),
            };
            let mut line = vec![engine.to_owned(), mode.name().to_owned()];
            line.extend(own.iter().map(|row| speed(row)));
            line.push(format!("{:.4}", own[0].build_seconds));
            line.push(format!("{:.0}", own[0].bytes_per_triangle));
            line.push(own.iter().map(|row| row.mismatches.to_string()).collect::<Vec<_>>().join("/"));
            line
        })
        .collect();
    let header: Vec<&str> = ["engine", "mode"]
        .into_iter()
        .chain(classes.iter().copied())
        .chain(["build s", "bytes/tri", "mismatches"])
        .collect();
    let title = format!(
        "{scene}: {} triangles, Mrays/s on one thread, median of {} (× the best competitor of the same mode)",
        rows[0].triangles, options.rounds
    );
    table(&title, &header, &cells) + &best_against_best(rows, &classes)
}

/// Class by class, our fastest result and its ratio to the fastest competitor; empty without competitors.
fn best_against_best(rows: &[&Row], classes: &[&str]) -> String {
    let best = |class: &str, ours: bool| {
        let of_side = rows.iter().filter(|row| row.ours == ours && row.class == class);
        of_side.map(|row| row.mrays).fold(0.0, f64::max)
    };
    let ratios: Vec<String> = classes
        .iter()
        .map(|class| (class, best(class, true), best(class, false)))
        .filter(|(_, ours, theirs)| *ours > 0.0 && *theirs > 0.0)
        .map(|(class, ours, theirs)| format!("{class} {ours:.2} ({:.2}×)", ours / theirs))
        .collect();
    if ratios.is_empty() {
        return String::new();
    }
    format!("best mode against best mode: {}\n", ratios.join(", "))
}

/// The cost of a ray as scenes grow, if there are several scenes.
pub(super) fn curve(rows: &[Row]) -> String {
    let mut sizes: Vec<(usize, &str)> = rows.iter().map(|row| (row.triangles, &*row.scene)).collect();
    sizes.sort_unstable();
    sizes.dedup();
    if sizes.len() < 3 {
        return String::new();
    }
    let mut lines: Vec<(&str, Mode, &str)> = Vec::new();
    for row in rows.iter().filter(|row| row.ours) {
        let line = (&*row.engine, row.mode, &*row.class);
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    let cost = |&(engine, mode, class): &(&str, Mode, &str), scene: &str| {
        let is_it = |r: &&Row| r.scene == scene && r.engine == engine && r.mode == mode && r.class == class;
        rows.iter().find(is_it).map_or_else(|| "-".to_owned(), |row| format!("{:.0}", 1e3 / row.mrays))
    };
    let cells: Vec<Vec<String>> = lines
        .iter()
        .map(|line| {
            let names = [line.0, line.1.name(), line.2].map(str::to_owned);
            names.into_iter().chain(sizes.iter().map(|(_, scene)| cost(line, scene))).collect()
        })
        .collect();
    let sizes: Vec<String> = sizes.iter().map(|(triangles, _)| triangles.to_string()).collect();
    let header: Vec<&str> =
        ["engine", "mode", "class"].into_iter().chain(sizes.iter().map(|s| &**s)).collect();
    format!("\n{}", table("Nanoseconds a ray, by triangles", &header, &cells))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(engine: &str, ours: bool, mode: Mode, mrays: f64) -> Row {
        Row {
            scene: "room".to_owned(),
            triangles: 12,
            class: "bounce".to_owned(),
            engine: engine.to_owned(),
            ours,
            mode,
            mrays,
            build_seconds: 0.1,
            bytes_per_triangle: 50.0,
            mismatches: 0,
        }
    }

    #[test]
    fn the_best_modes_are_compared_whatever_they_are() {
        let mut rows = vec![row("bvh8", true, Mode::Single, 6.0), row("bvh8", true, Mode::Batch, 9.0)];
        assert!(!text(&rows, &Options::default()).contains("best mode against best mode"));
        rows.extend([row("other", false, Mode::Single, 4.5), row("other", false, Mode::Batch, 3.0)]);
        let text = text(&rows, &Options::default());
        assert!(text.contains("best mode against best mode: bounce 9.00 (2.00×)\n"), "{text}");
        assert!(text.contains("6.00 (1.33×)") && text.contains("9.00 (3.00×)"), "{text}");
    }
}
