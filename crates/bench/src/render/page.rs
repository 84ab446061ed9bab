//! One self-contained page for all results, with pictures, error maps and curves.

use super::curves::{COLOURS, svg};
use super::errors::pixel_errors;
use super::measured::{Measured, Row};
use super::options::Options;
use super::scenes::SIZE;
use super::table::{HEADER, cells, short};
use bilux::Error;
use bilux::pictures::metrics::ramp;
use bilux::pictures::{ColourSpace, Picture, WriteOptions, write_atomically, write_bytes};
use bilux_math::Rgb;
use std::fmt::Write;
use std::path::Path;

/// Writes `index.html` to a folder.
pub(super) fn write(folder: &Path, measured: &[Measured], options: &Options) -> Result<(), Error> {
    let integrators = integrators(measured);
    let mut page = String::from(HEAD);
    let _ = write!(
        page,
        "<h1>Light transport, measured</h1><p>{} scenes, each difficult in its own way, rendered by {}. Pictures of \
         {}×{} pixels; every integrator gets the same CPU time, summed over all threads. Errors are medians over {} \
         seeds, against long renders \
         by two integrators that agree.</p>{LEGEND}",
        measured.len(),
        integrators.join(", "),
        SIZE.0,
        SIZE.1,
        options.seeds.max(1)
    );
    overview(&mut page, measured, &integrators);
    for scene in measured {
        section(&mut page, scene, &integrators)?;
    }
    page += "</main></body></html>\n";
    let path = folder.join("index.html");
    Ok(write_atomically(&path, page.as_bytes()).map_err(|e| e.in_file(&path))?)
}

/// The integrators, in the order in which they were measured.
fn integrators(measured: &[Measured]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for row in measured.iter().flat_map(|scene| &scene.rows) {
        if !names.contains(&row.integrator) {
            names.push(row.integrator.clone());
        }
    }
    names
}

/// Scenes by integrators: the error within the longest budget, and how many times below that of `path` it is.
fn overview(page: &mut String, measured: &[Measured], integrators: &[String]) {
    let _ = write!(page, "<h2>At a glance</h2><table><tr><th>scene</th>");
    for (name, colour) in integrators.iter().zip(COLOURS.iter().cycle()) {
        let _ = write!(page, "<th><i style=\"background:{colour}\"></i>{name}</th>");
    }
    *page += "</tr>";
    for scene in measured {
        let Some(seconds) = longest(scene) else { continue };
        let _ = write!(page, "<tr><td><a href=\"#{0}\">{0}</a></td>", scene.scene);
        let best = scene.best_single(seconds).map(|row| row.integrator.clone());
        for name in integrators {
            let row = scene.find(name, seconds);
            let path = scene.find("path", seconds);
            let factor = row
                .zip(path)
                .map(|(row, path)| format!(" <small>{}×</small>", short(path.relmse / row.relmse)));
            let class = if best.as_deref() == Some(&name[..]) { " class=\"best\"" } else { "" };
            let error = row.map_or("–".to_owned(), |row| short(row.relmse));
            let _ = write!(page, "<td{class}>{error}{}</td>", factor.unwrap_or_default());
        }
        *page += "</tr>";
    }
    *page += "</table><p class=\"note\">relMSE within the longest budget; small: how many times below the error of \
              <code>path</code>; bold: the best single integrator.</p>";
}

fn section(page: &mut String, scene: &Measured, integrators: &[String]) -> Result<(), Error> {
    let _ = write!(
        page,
        "<section id=\"{0}\"><h2>{0}</h2><p>{1}. Reference: {2}; its own relMSE is {3:.1e}, below which errors cannot \
         be distinguished.</p><div class=\"row\"><figure>{4}<figcaption>reference</figcaption></figure><figure \
         class=\"curves\">{5}\
         <figcaption>error over time; dashed: without the worst 0.1% of the pixels; grey: the reference's own</figcaption>\
         </figure></div><div class=\"row\">",
        scene.scene,
        scene.summary,
        scene.reference.origin,
        scene.reference.relmse,
        image(&shown(&scene.reference.pixels, &scene.shown)?, "reference"),
        svg(scene, integrators)
    );
    for row in longest(scene)
        .into_iter()
        .flat_map(|seconds| scene.rows.iter().filter(move |row| row.seconds == seconds))
    {
        let map = error_map(row, &scene.reference.pixels)?;
        let _ = write!(
            page,
            "<figure>{}{}<figcaption><b>{}</b> in {:.1} s, relMSE {}</figcaption></figure>",
            image(&shown(&row.picture, &scene.shown)?, &row.integrator),
            image(&map, "its errors"),
            row.integrator,
            row.took,
            short(row.relmse)
        );
    }
    *page += "</div><table><tr>";
    HEADER.iter().for_each(|name| {
        let _ = write!(page, "<th>{name}</th>");
    });
    *page += "</tr>";
    for row in &scene.rows {
        let cells: String = cells(scene, row).iter().map(|cell| format!("<td>{cell}</td>")).collect();
        let _ = write!(page, "<tr>{cells}</tr>");
    }
    *page += "</table></section>";
    Ok(())
}

fn longest(scene: &Measured) -> Option<f64> {
    scene.rows.iter().map(|row| row.seconds).max_by(f64::total_cmp)
}

fn shown(pixels: &[Rgb], options: &WriteOptions) -> Result<Vec<u8>, Error> {
    let picture = Picture::from_rgb(SIZE.0 as usize, SIZE.1 as usize, pixels.to_vec())?;
    Ok(write_bytes("png", &picture, options)?)
}

/// The square root of each pixel's relative squared error, from 0 (black) to 1 (pale yellow).
fn error_map(row: &Row, reference: &[Rgb]) -> Result<Vec<u8>, Error> {
    let colours = pixel_errors(&row.picture, reference).into_iter().map(|e| ramp(e.sqrt() as f32)).collect();
    let mut picture = Picture::from_rgb(SIZE.0 as usize, SIZE.1 as usize, colours)?;
    picture.colour_space = ColourSpace::Srgb;
    Ok(write_bytes("png", &picture, &WriteOptions::default())?)
}

fn image(png: &[u8], what: &str) -> String {
    let (w, h) = SIZE;
    format!("<img width=\"{w}\" height=\"{h}\" alt=\"{what}\" src=\"data:image/png;base64,{}\">", base64(png))
}

/// Encodes bytes as base64. [Josefsson 2006]
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |chunk: &[u8]| {
        let word = (0..3).fold(0, |word, i| word << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        let digit = |i: usize| char::from(DIGITS[(word >> (18 - 6 * i) & 63) as usize]);
        (0..4).map(move |i| if i <= chunk.len() { digit(i) } else { '=' }).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

const LEGEND: &str = "<p class=\"note\"><b>relMSE</b>: the mean of (x − r)² / (r² + 0.01) over pixels and channels. \
    <b>trimmed</b>: without the worst 0.1% of the pixels. <b>bias² of it</b>: the fraction of the error that would remain with any number of seeds, from means over blocks of 8×8 pixels. <b>mean</b>: brighter or darker than the reference. <b>/ path</b>: error \
    over that of <code>path</code> in the same time. <b>s to 0.01</b>: CPU seconds to a relMSE of 0.01, if the error falls with time as noise does. <b>predicted</b>, <b>measured</b>, <b>and trimmed</b>: time to the same error as a multiple of the time that <code>auto</code> takes: as its pilot render predicted it, by relMSE, and without the worst 0.1% of the pixels. Maps of errors go from black (none) to pale yellow (as large as the light itself).</p>";

const HEAD: &str = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Bilux: light transport, measured\
</title><meta name=\"viewport\" content=\"width=device-width\"><style>\
body{margin:0;background:#fafaf8;color:#222;font:15px/1.5 system-ui,sans-serif}\
main{max-width:1180px;margin:0 auto;padding:24px}\
h1{font-weight:600}h2{margin-top:2em;font-weight:600;border-bottom:1px solid #ddd}\
table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums;font-size:14px}\
th,td{padding:3px 12px;text-align:right;border-bottom:1px solid #e6e6e2}th{font-weight:600}\
td:first-child,th:first-child{text-align:left}td.best{font-weight:700}small{color:#777;font-weight:400}\
th i{display:inline-block;width:10px;height:10px;border-radius:5px;margin-right:6px}\
.row{display:flex;flex-wrap:wrap;gap:14px;align-items:flex-start}figure{margin:0;width:215px}\
figure.curves{width:520px}figcaption{font-size:13px;color:#555;margin-top:4px}\
img{width:100%;height:auto;display:block;image-rendering:pixelated;background:#000;margin-bottom:3px}\
.row:first-of-type figure:first-child{width:430px}.note{color:#555;font-size:13px;max-width:900px}\
svg{width:100%;height:auto;font-size:11px}svg text{fill:#555}svg polyline{fill:none;stroke-width:2}\
svg .grid{stroke:#e2e2de;fill:none}svg .floor{stroke:#999;stroke-width:1.5;fill:none}\
a{color:inherit}</style></head><body><main>";
