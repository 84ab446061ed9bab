//! A row of the table: what was measured, on both sides, and the goal for it.

use crate::table;
use serde_json::{Value, json};

/// A measured quantity, and the goal for it.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) what: String,
    /// `None` if it could not be measured.
    pub(super) ours: Option<f64>,
    /// The number that ours is compared with; `None` if there is none, or it could not be measured.
    pub(super) peer: Option<f64>,
    pub(super) goal: Goal,
    /// Note on what the numbers leave out; may be empty.
    pub(super) note: String,
}

/// Goal for a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// By our side alone.
    AtLeast(f64),
    AtMost(f64),
    /// By ours divided by the other side's.
    RatioAtLeast(f64),
    RatioAtMost(f64),
    /// None was set.
    Unset,
}

impl Row {
    pub(super) fn new(what: impl Into<String>, ours: f64, goal: Goal) -> Row {
        Row { what: what.into(), ours: Some(ours), peer: None, goal, note: String::new() }
    }

    /// A row that could not be measured, and why.
    pub(super) fn skipped(what: impl Into<String>, goal: Goal, why: impl Into<String>) -> Row {
        Row { what: what.into(), ours: None, peer: None, goal, note: why.into() }
    }

    pub(super) fn against(self, peer: f64) -> Row {
        Row { peer: Some(peer), ..self }
    }

    pub(super) fn with_note(self, note: impl Into<String>) -> Row {
        Row { note: note.into(), ..self }
    }

    fn ratio(&self) -> Option<f64> {
        Some(self.ours? / self.peer?)
    }

    /// `None` where a number is missing.
    fn is_met(&self) -> Option<bool> {
        match self.goal {
            Goal::AtLeast(bound) => Some(self.ours? >= bound),
            Goal::AtMost(bound) => Some(self.ours? <= bound),
            Goal::RatioAtLeast(bound) => Some(self.ratio()? >= bound),
            Goal::RatioAtMost(bound) => Some(self.ratio()? <= bound),
            Goal::Unset => None,
        }
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "what": self.what, "ours": self.ours, "peer": self.peer, "ratio": self.ratio(),
            "goal": self.goal.text(), "met": self.is_met(), "note": self.note,
        })
    }

    /// The row that [`Row::json`] describes; what is missing stays empty.
    pub(super) fn from_json(row: &Value) -> Row {
        let text = |key: &str| row[key].as_str().unwrap_or_default();
        Row {
            what: text("what").to_owned(),
            ours: row["ours"].as_f64(),
            peer: row["peer"].as_f64(),
            goal: Goal::from_text(text("goal")),
            note: text("note").to_owned(),
        }
    }
}

/// The rows as another process has printed them.
pub(super) fn rows_of(printed: &Value) -> Vec<Row> {
    printed["rows"].as_array().into_iter().flatten().map(Row::from_json).collect()
}

impl Goal {
    fn text(self) -> String {
        match self {
            Goal::AtLeast(bound) => format!("≥ {bound}"),
            Goal::AtMost(bound) => format!("≤ {bound}"),
            Goal::RatioAtLeast(bound) => format!("ratio ≥ {bound}"),
            Goal::RatioAtMost(bound) => format!("ratio ≤ {bound}"),
            Goal::Unset => String::new(),
        }
    }

    fn from_text(text: &str) -> Goal {
        let (is_ratio, rest) = match text.strip_prefix("ratio ") {
            Some(rest) => (true, rest),
            None => (false, text),
        };
        let of = |sign: &str| rest.strip_prefix(sign)?.trim().parse::<f64>().ok();
        match (is_ratio, of("≥"), of("≤")) {
            (false, Some(bound), _) => Goal::AtLeast(bound),
            (false, _, Some(bound)) => Goal::AtMost(bound),
            (true, Some(bound), _) => Goal::RatioAtLeast(bound),
            (true, _, Some(bound)) => Goal::RatioAtMost(bound),
            _ => Goal::Unset,
        }
    }
}

/// The rows as a table, and below it their notes.
pub(super) fn text(rows: &[Row], title: &str) -> String {
    let number = |x: Option<f64>| x.map_or("–".to_owned(), short);
    let mut notes: Vec<&str> = Vec::new();
    let mut cells = Vec::new();
    for row in rows {
        let mut mark = String::new();
        if !row.note.is_empty() {
            let place = notes.iter().position(|note| *note == row.note).unwrap_or_else(|| {
                notes.push(&row.note);
                notes.len() - 1
            });
            mark = format!(" [{}]", place + 1);
        }
        let met = match row.is_met() {
            Some(true) => "met",
            Some(false) => "no",
            None => "–",
        };
        let columns = [
            row.what.clone() + &mark,
            number(row.ours),
            number(row.peer),
            number(row.ratio()),
            row.goal.text(),
        ];
        cells.push(columns.into_iter().chain([met.to_owned()]).collect::<Vec<_>>());
    }
    let header = ["what", "ours", "other", "ratio", "goal", ""];
    let notes = notes.iter().enumerate().map(|(i, note)| format!("[{}] {note}\n", i + 1));
    table(title, &header, &cells) + &notes.collect::<String>()
}

/// Three significant digits.
fn short(x: f64) -> String {
    match x.abs() {
        size if size >= 100.0 => format!("{x:.0}"),
        size if size >= 10.0 => format!("{x:.1}"),
        size if size >= 1.0 => format!("{x:.2}"),
        size if size >= 0.01 => format!("{x:.3}"),
        _ => format!("{x:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_judged_by_the_side_that_they_are_about() {
        let met = |row: Row| row.json()["met"].clone();
        let row = |goal: Goal| Row::new("speed", 3.0, goal);
        assert_eq!(met(row(Goal::AtLeast(3.0))), true);
        assert_eq!(met(row(Goal::AtMost(2.9))), false);
        assert_eq!(met(row(Goal::RatioAtLeast(1.5)).against(2.0)), true);
        assert_eq!(met(row(Goal::RatioAtMost(1.4)).against(2.0)), false);
        assert!(met(row(Goal::RatioAtMost(1.4))).is_null() && met(row(Goal::Unset)).is_null());
        assert!(met(Row::skipped("speed", Goal::AtLeast(1.0), "no model")).is_null());
    }

    #[test]
    fn a_row_comes_back_from_its_json_and_notes_stand_below_the_table() {
        let goals = [
            Goal::AtLeast(40.0),
            Goal::AtMost(1.05),
            Goal::RatioAtLeast(1.5),
            Goal::RatioAtMost(0.5),
            Goal::Unset,
        ];
        let rows = goals.map(|goal| Row::new("speed", 1.25, goal).against(2.5).with_note("a note"));
        for row in &rows {
            let again = Row::from_json(&row.json());
            assert_eq!((again.goal, again.json()), (row.goal, row.json()));
        }
        let text = text(&rows, "Title");
        assert_eq!(text.matches("a note").count(), 1, "{text}");
        assert!(
            text.contains("speed [1]") && text.contains("0.500") && text.contains("ratio ≤ 0.5"),
            "{text}"
        );
    }
}
