//! Our best result for each class of rays on each scene, against Embree's.

use super::engine::Mode;
use super::report::Row;
use crate::table;

/// A class of rays on a scene.
pub struct Best {
    /// The scene.
    pub scene: String,
    /// The class.
    pub class: String,
    /// Our fastest engine in any mode.
    pub ours: Champion,
    /// Embree's fastest, with any tree and any width of packets.
    pub embree: Champion,
    /// The fastest of both sides that take one ray a call.
    pub single: Option<[Champion; 2]>,
}

/// The fastest of several engines.
#[derive(Clone, Debug, PartialEq)]
pub struct Champion {
    /// Name and mode of the engine.
    pub name: String,
    /// Millions of rays a second.
    pub mrays: f64,
}

/// A row for each class and scene that both sides have traced.
pub(super) fn best(rows: &[Row]) -> Vec<Best> {
    let mut cells: Vec<(&str, &str)> = Vec::new();
    for row in rows {
        if !cells.contains(&(&row.scene, &row.class)) {
            cells.push((&row.scene, &row.class));
        }
    }
    let one = |(scene, class): (&str, &str)| {
        let champion = |ours: bool, among: &dyn Fn(&Row) -> bool| {
            let is_one = |row: &&Row| {
                let is_side = if ours { row.ours } else { !row.ours && row.engine.starts_with("embree") };
                row.scene == scene && row.class == class && is_side && among(row)
            };
            let row = rows.iter().filter(is_one).max_by(|a, b| a.mrays.total_cmp(&b.mrays))?;
            Some(Champion { name: format!("{} {}", row.engine, row.mode.name()), mrays: row.mrays })
        };
        let is_single = |row: &Row| row.mode == Mode::Single;
        Some(Best {
            ours: champion(true, &|_| true)?,
            embree: champion(false, &|_| true)?,
            single: champion(true, &is_single).zip(champion(false, &is_single)).map(Into::into),
            scene: scene.to_owned(),
            class: class.to_owned(),
        })
    };
    cells.into_iter().filter_map(one).collect()
}

/// Table of the best results; empty without Embree.
pub(super) fn text(rows: &[Row]) -> String {
    let best = best(rows);
    if best.is_empty() {
        return String::new();
    }
    let cells: Vec<Vec<String>> = best
        .iter()
        .map(|row| {
            let single =
                row.single.as_ref().map(|[ours, embree]| format!("{:.2}×", ours.mrays / embree.mrays));
            vec![
                row.scene.clone(),
                row.class.clone(),
                row.ours.name.clone(),
                format!("{:.2}", row.ours.mrays),
                row.embree.name.clone(),
                format!("{:.2}", row.embree.mrays),
                format!("{:.2}×", row.ours.mrays / row.embree.mrays),
                single.unwrap_or_default(),
            ]
        })
        .collect();
    let header =
        ["scene", "class", "our best", "Mrays/s", "Embree's best", "Mrays/s", "ratio", "single rays"];
    format!("\n{}", table("Our best mode against Embree's best mode", &header, &cells))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(class: &str, engine: &str, ours: bool, mode: Mode, mrays: f64) -> Row {
        let (scene, class, engine) = ("room".to_owned(), class.to_owned(), engine.to_owned());
        Row { scene, class, engine, ours, mode, mrays, ..Row::default() }
    }

    #[test]
    fn the_best_of_both_sides_meet() {
        let ours = [row("ao", "bvh8", true, Mode::Single, 6.0), row("ao", "bvh8", true, Mode::Batch, 9.0)];
        assert!(best(&ours).is_empty() && text(&ours).is_empty());
        let others = [
            row("ao", "embree", false, Mode::Single, 8.0),
            row("ao", "embree-high/8", false, Mode::Batch, 4.5),
            row("ao", "obvhs", false, Mode::Single, 90.0),
            row("shadow", "bvh8", true, Mode::Single, 1.0),
        ];
        let rows: Vec<Row> = ours.into_iter().chain(others).collect();
        let best = best(&rows);
        assert_eq!(best.len(), 1);
        let champion = |name: &str, mrays: f64| Champion { name: name.to_owned(), mrays };
        assert_eq!(best[0].ours, champion("bvh8 batch", 9.0));
        assert_eq!(best[0].embree, champion("embree single", 8.0));
        assert_eq!(best[0].single, Some([champion("bvh8 single", 6.0), champion("embree single", 8.0)]));
        assert!(text(&rows).contains("1.12×") && text(&rows).contains("0.75×"), "{}", text(&rows));
    }
}
