//! `bilux bench render`: its rows, its references, its page, and the scenes that it measures on.

use bilux::scene::{Parameters, Spec, Value};
use bilux::{Job, Quiet};
use bilux_bench::render::{Options, Reference, SCENES, SIZE, run};
use bilux_math::Rgb;
use bilux_testing::effort;
use tempfile::TempDir;

fn quick() -> Options {
    Options {
        scenes: vec!["daylight".to_owned()],
        integrators: vec!["path".to_owned(), "bdpt".to_owned()],
        seconds: vec![0.05],
        seeds: 2,
        ..Options::default()
    }
}

#[test]
fn rows_have_what_programs_ask_for_and_the_page_shows_it() {
    let folder = TempDir::new().unwrap();
    let report = run(&Options { report: Some(folder.path().join("page")), ..quick() }, &|_| {}).unwrap();
    let names: Vec<_> = report.rows.iter().map(|row| row["integrator"].as_str().unwrap()).collect();
    assert_eq!(names, ["path", "bdpt"]);
    for row in &report.rows {
        assert_eq!((row["scene"].as_str(), row["seconds"].as_f64()), (Some("daylight"), Some(0.05)));
        let number = |key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key} of {row}"));
        assert!(number("samples") >= 1.0 && number("bias2") >= 0.0, "{row}");
        assert!(number("relmse") > number("relmse_trimmed") && number("relmse_trimmed") > 0.0, "{row}");
        assert!((number("mean") / number("reference_mean") - 1.0).abs() < 0.05, "{row}");
        assert!(row["peak_mb"].is_null() || number("peak_mb") > 1.0, "{row}");
    }
    assert!(report.text.contains("daylight") && report.text.contains("bdpt"), "{}", report.text);
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    // The reference, and for each integrator a picture and an error map; nothing is loaded from elsewhere.
    assert_eq!(page.matches("data:image/png;base64,").count(), 5);
    assert_eq!(page.matches("<svg").count(), 1);
    assert!(!page.contains("http"));
}

#[test]
fn files_are_measured_with_the_predictions_of_auto() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("own.toml");
    let scene = "[[model]]\ngenerate = \"cornell\"\nwith = [\"lights\", \"cameras\"]\n";
    std::fs::write(&file, scene).unwrap();
    let options = Options {
        scenes: Vec::new(),
        files: vec![file.clone()],
        reference_seconds: 0.2,
        integrators: ["auto", "path", "auto:bdpt"].map(str::to_owned).to_vec(),
        ..quick()
    };
    let report = run(&options, &|_| {}).unwrap();
    assert_eq!(report.rows.len(), 3);
    for row in &report.rows {
        assert_eq!(row["scene"].as_str(), file.to_str());
        let number = |key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key} of {row}"));
        assert!(["predicted", "measured", "measured_trimmed"].map(number).iter().all(|x| *x > 0.0), "{row}");
    }
    assert_eq!(report.rows[0]["predicted"], 1.0);
    assert!(report.rows[0]["chosen"].is_string() && report.rows[1]["chosen"].is_null());
    assert!(report.text.contains("predicted") && report.text.contains("and trimmed"), "{}", report.text);
}

#[test]
fn unknown_names_are_reported() {
    let error = |options: Options| run(&options, &|_| {}).err().unwrap().to_string();
    let named = |name: &str| vec![name.to_owned()];
    assert!(error(Options { scenes: named("poll"), ..quick() }).contains("did you mean 'pool'?"));
    assert!(error(Options { integrators: named("bdtp"), ..quick() }).contains("did you mean 'bdpt'?"));
    assert!(error(Options { seconds: vec![0.0], ..quick() }).contains("above 0"));
}

/// The width and height of small pictures: each of their pixels covers 4 × 4 of a reference.
const SMALL: [usize; 2] = [32, 24];

fn small(scene: &str, integrator: &str, samples: i64) -> Vec<Rgb> {
    let mut settings = Parameters::default();
    settings.set("integrator", integrator);
    settings.set("size", "32x24");
    settings.set("spp", Value::Integer(samples));
    let job = Job::new(&bilux::generate(&Spec::new("", scene)).unwrap(), &settings).unwrap();
    assert!(job.warnings().is_empty(), "{scene}: {:?}", job.warnings());
    let pixels = job.render(&Quiet).unwrap().rendered.film.to_rgb();
    assert!(pixels.iter().all(|p| p.is_finite()), "{scene}, {integrator}");
    pixels
}

fn downscaled(pixels: &[Rgb]) -> Vec<Rgb> {
    let mut small = vec![Rgb::BLACK; SMALL[0] * SMALL[1]];
    for (i, pixel) in pixels.iter().enumerate() {
        let (x, y) = (i % SIZE.0 as usize / 4, i / SIZE.0 as usize / 4);
        small[y * SMALL[0] + x] += *pixel / 16.0;
    }
    small
}

/// The mean of the light, clamped: with few samples there are fireflies, each of which would outweigh all the rest.
fn seen(pixels: &[Rgb]) -> f64 {
    let samples = pixels.iter().flat_map(|p| p.to_array()).map(|c| f64::from(c.min(2.0)));
    samples.sum::<f64>() / (3 * pixels.len()) as f64
}

#[test]
fn path_and_bdpt_match_the_reference_of_every_scene() {
    for (i, (name, bytes)) in SCENES.iter().enumerate() {
        let reference = Reference::read(bytes).unwrap();
        assert_eq!(reference.pixels.len(), (SIZE.0 * SIZE.1) as usize);
        assert!(reference.relmse > 0.0 && reference.relmse < 0.05, "{name}: {}", reference.relmse);
        assert!(reference.origin.contains("path") && reference.origin.contains("bdpt"), "{name}");
        assert!(bytes.len() < 100_000, "{name}");
        let wanted = seen(&downscaled(&reference.pixels));
        assert!(wanted > 0.02, "{name} is dark");
        // In the short form one of them in turn.
        for (integrator, samples) in &[("path", 96), ("bdpt", 48)][effort(i % 2..i % 2 + 1, 0..2)] {
            let found = seen(&small(name, integrator, *samples));
            assert!((found / wanted - 1.0).abs() < 0.1, "{name}, {integrator}: {found} for {wanted}");
        }
    }
}
