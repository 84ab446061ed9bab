//! A plot of error over time: both axes logarithmic, one line per integrator.

use super::measured::{Measured, Row};
use super::table::short;
use bilux_math::transcendental::{ln_f64, powf_f64};
use std::f64::consts::LN_10;
use std::fmt::Write;

/// One colour per integrator, distinguishable by colour-blind readers too. [Wong 2011]
pub(super) const COLOURS: [&str; 7] =
    ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#7f7f7f"];

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 280.0;
/// Left, top, right, bottom.
const MARGIN: [f64; 4] = [62.0, 14.0, 92.0, 40.0];

/// The plot, as an `svg` element. Solid lines are relMSE, dashed ones the trimmed error, and the grey line is the
/// reference's own error.
pub(super) fn svg(scene: &Measured, integrators: &[String]) -> String {
    let axes = Axes::over(scene);
    let mut out =
        format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"error over time\">");
    axes.grid(&mut out);
    let floor = axes.y(scene.reference.relmse);
    if floor < HEIGHT - MARGIN[3] {
        let _ = write!(
            out,
            "<path class=\"floor\" d=\"M{:.1} {floor:.1}H{:.1}\"/>",
            MARGIN[0],
            WIDTH - MARGIN[2]
        );
    }
    let mut labels = Vec::new();
    for (name, colour) in integrators.iter().zip(COLOURS.iter().cycle()) {
        let rows: Vec<&Row> = scene.rows.iter().filter(|row| row.integrator == *name).collect();
        for (error, dashes) in
            [((|row| row.relmse) as fn(&Row) -> f64, ""), (|row| row.relmse_trimmed, "4 4")]
        {
            let points: Vec<String> =
                rows.iter().map(|row| format!("{:.1},{:.1}", axes.x(row.took), axes.y(error(row)))).collect();
            let _ = write!(
                out,
                "<polyline points=\"{}\" stroke=\"{colour}\" stroke-dasharray=\"{dashes}\"/>",
                points.join(" ")
            );
        }
        for row in &rows {
            let _ = write!(
                out,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>",
                axes.x(row.took),
                axes.y(row.relmse)
            );
        }
        labels.extend(rows.last().map(|row| (axes.y(row.relmse), name, *colour)));
    }
    name_lines(&mut out, labels);
    out + "</svg>"
}

/// Writes the names at the ends of the lines, spaced so that they do not overlap.
fn name_lines(out: &mut String, mut labels: Vec<(f64, &String, &str)>) {
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut lowest = f64::NEG_INFINITY;
    for (y, name, colour) in labels {
        let y = y.max(lowest + 13.0);
        lowest = y;
        let x = WIDTH - MARGIN[2] + 8.0;
        let _ = write!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" style=\"fill:{colour}\">{name}</text>", y + 4.0);
    }
}

/// The ranges of both axes, as powers of ten that frame all points.
struct Axes {
    seconds: [f64; 2],
    errors: [f64; 2],
}

impl Axes {
    fn over(scene: &Measured) -> Axes {
        let seconds: Vec<f64> = scene.rows.iter().map(|row| log(row.took)).collect();
        let errors = scene.rows.iter().flat_map(|row| [row.relmse, row.relmse_trimmed]);
        let errors: Vec<f64> = errors.map(log).filter(|e| e.is_finite()).collect();
        let range = |values: &[f64], margin: f64| {
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if least > most { [-1.0, 1.0] } else { [least - margin, most + margin] }
        };
        Axes { seconds: range(&seconds, 0.1), errors: range(&errors, 0.15) }
    }

    fn x(&self, seconds: f64) -> f64 {
        let [least, most] = self.seconds;
        MARGIN[0] + (log(seconds) - least) / (most - least) * (WIDTH - MARGIN[0] - MARGIN[2])
    }

    fn y(&self, error: f64) -> f64 {
        let [least, most] = self.errors;
        MARGIN[1] + (most - log(error)) / (most - least) * (HEIGHT - MARGIN[1] - MARGIN[3])
    }

    /// Draws lines at 1, 2 and 5 times every power of ten.
    fn grid(&self, out: &mut String) {
        let (bottom, right) = (HEIGHT - MARGIN[3], WIDTH - MARGIN[2]);
        for value in steps(self.seconds) {
            let x = self.x(value);
            let _ = write!(out, "<path class=\"grid\" d=\"M{x:.1} {:.1}V{bottom:.1}\"/>", MARGIN[1]);
            let _ = write!(
                out,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{value}</text>",
                bottom + 16.0
            );
        }
        for value in steps(self.errors) {
            let y = self.y(value);
            let _ = write!(out, "<path class=\"grid\" d=\"M{:.1} {y:.1}H{right:.1}\"/>", MARGIN[0]);
            let _ = write!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                MARGIN[0] - 6.0,
                y + 4.0,
                plain(value)
            );
        }
        let _ = write!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">CPU seconds</text>",
            0.5 * (MARGIN[0] + right),
            HEIGHT - 6.0
        );
        let _ = write!(
            out,
            "<text x=\"12\" y=\"{:.1}\" transform=\"rotate(-90 12 {0:.1})\" text-anchor=\"middle\">relMSE</text>",
            0.5 * (MARGIN[1] + bottom)
        );
    }
}

/// The logarithm to base 10 of `x`, or of a billionth if that is larger.
fn log(x: f64) -> f64 {
    ln_f64(x.max(1e-9)) / LN_10
}

/// Round numbers between two powers of ten.
fn steps([least, most]: [f64; 2]) -> Vec<f64> {
    let powers = least.floor() as i32..=most.ceil() as i32;
    let wide = most - least > 2.2;
    let factors: &[f64] = if wide { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all = powers.flat_map(|power| factors.iter().map(move |f| f * powf_f64(10.0, f64::from(power))));
    // 10^-2 as the number nearest to 0.01.
    let rounded = all.map(|x| short(x).parse().unwrap_or(x));
    rounded.filter(|x: &f64| (least..=most).contains(&log(*x))).collect()
}

fn plain(x: f64) -> String {
    if x < 1e-4 { format!("{x:e}") } else { format!("{x}") }
}
