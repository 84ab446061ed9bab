//! Time to read scene files, and the memory that it takes compared with the size of the scene.

mod made;

use crate::{ProgressFn, Report, median, table};
use bilux::Error;
use bilux::formats::{ReadOptions, read};
use bilux::scene::SceneBuilder;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

pub use made::make;

/// Files to read, and options for reading.
#[derive(Clone, Debug)]
pub struct Options {
    /// The scene files.
    pub files: Vec<PathBuf>,
    /// The number of repeats; the median is reported.
    pub repeats: u32,
    /// The limits and options for reading.
    pub read: ReadOptions,
}

/// Reads each file several times. The memory is that of the first read, so it is right only in a process that has read
/// nothing else.
///
/// # Errors
/// If a file cannot be read.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let mut rows = Vec::new();
    for file in &options.files {
        progress(&file.display().to_string());
        rows.push(one(file, options)?);
    }
    Ok(report(rows))
}

/// Makes the table from rows that [`run`] has measured, in this process or in others.
pub fn report(rows: Vec<Value>) -> Report {
    let number = |row: &Value, key: &str, digits: usize| match row[key].as_f64() {
        Some(x) => format!("{x:.digits$}"),
        None => "-".to_owned(),
    };
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let name = row["file"].as_str().unwrap_or_default();
            let name =
                Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
            vec![
                name,
                number(row, "megabytes", 1),
                number(row, "seconds", 3),
                number(row, "megabytes_per_second", 0),
                number(row, "megabytes_per_core_second", 0),
                number(row, "decoded_megabytes", 1),
                number(row, "peak_megabytes", 0),
                number(row, "peak_of_decoded", 2),
                number(row, "build_seconds", 2),
                number(row, "peak_megabytes_with_build", 0),
            ]
        })
        .collect();
    let header = [
        "file",
        "MB",
        "seconds",
        "MB/s",
        "MB/s a core",
        "decoded MB",
        "peak MB",
        "peak/decoded",
        "build s",
        "peak MB",
    ];
    let title = "Reading scene files: median seconds, and peak memory besides that of the process; then with its \
                 acceleration structures";
    Report { text: table(title, &header, &cells), rows, ..Report::default() }
}

fn one(file: &Path, options: &Options) -> Result<Value, Error> {
    let size = fs::metadata(file).map_or(0, |metadata| metadata.len()) as f64 / 1e6;
    reset_peak();
    let before = memory("VmRSS:");
    let (mut seconds, mut processor) = (Vec::new(), Vec::new());
    let mut peak = None;
    let mut scene = None;
    for _ in 0..options.repeats.max(1) {
        drop(scene.take());
        let (began, busy) = (Instant::now(), processor_seconds());
        let found = read(file, &options.read)?;
        seconds.push(began.elapsed().as_secs_f64());
        processor.extend(busy.and_then(|busy| Some(processor_seconds()? - busy)));
        peak = peak.or_else(|| Some(memory("VmHWM:")?.saturating_sub(before?)));
        scene = Some(found);
    }
    let scene = scene.unwrap_or_default();
    let decoded = decoded(&scene) as f64 / 1e6;
    let began = Instant::now();
    let built =
        scene.build(&Default::default(), [0.0, 0.0], 1.0).map_err(bilux::formats::FormatError::from)?;
    let build_seconds = began.elapsed().as_secs_f64();
    drop(built);
    let with_build = memory("VmHWM:").zip(before).map(|(peak, before)| peak.saturating_sub(before));
    let seconds = median(seconds);
    // The system counts in hundredths of a second, too coarse for reads that take only a few of them.
    let processor = Some(median(processor)).filter(|busy| *busy >= 0.05);
    let megabytes = |kilobytes: u64| kilobytes as f64 * 1024.0 / 1e6;
    Ok(json!({
        "file": file.display().to_string(),
        "megabytes": size,
        "seconds": seconds,
        "megabytes_per_second": size / seconds,
        "processor_seconds": processor,
        "megabytes_per_core_second": processor.map(|busy| size / busy),
        "decoded_megabytes": decoded,
        "peak_megabytes": peak.map(megabytes),
        "peak_of_decoded": peak.map(|peak| megabytes(peak) / decoded),
        "objects": scene.objects.len(),
        "build_seconds": build_seconds,
        "peak_megabytes_with_build": with_build.map(megabytes),
    }))
}

/// The bytes that a scene holds: each mesh and image once, and its objects.
fn decoded(scene: &SceneBuilder) -> u64 {
    let mut meshes = HashSet::new();
    let places: usize = scene.objects.iter().map(|object| object.motion.heap_bytes()).sum();
    let mut bytes = (size_of_val(scene.objects.as_slice()) + places) as u64;
    for object in &scene.objects {
        if meshes.insert(Arc::as_ptr(&object.mesh)) {
            let mesh = &*object.mesh;
            bytes += (size_of_val(mesh.positions.as_slice())
                + size_of_val(mesh.normals.as_slice())
                + size_of_val(mesh.uvs.as_slice())
                + size_of_val(mesh.uvs2.as_slice())
                + size_of_val(mesh.tangents.as_slice())
                + size_of_val(mesh.vertex_kd.as_slice())
                + size_of_val(mesh.vertex_ks.as_slice())
                + size_of_val(mesh.triangles.as_slice())) as u64;
        }
    }
    let mut images = HashSet::new();
    let new = scene.textures.iter().filter(|texture| images.insert(Arc::as_ptr(&texture.image)));
    bytes + new.map(|texture| texture.image.size()).sum::<u64>()
}

/// A value in kilobytes from the system's status of this process; `None` if it is not available.
fn memory(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Resets the system's record of the peak memory.
fn reset_peak() {
    // If the system cannot reset it, the peak is that of the whole process.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// CPU seconds of all threads of this process.
fn processor_seconds() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The name, in parentheses, may contain spaces.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |i: usize| fields.get(i)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_of_a_file_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let files = make(folder.path(), 100_000, 1000).unwrap();
        let options = Options { files: files.clone(), repeats: 1, read: ReadOptions::default() };
        let report = run(&options, &|_| {}).unwrap();
        assert_eq!(report.rows.len(), 6);
        for (row, file) in report.rows.iter().zip(&files) {
            assert!(row["decoded_megabytes"].as_f64().unwrap() > 0.01, "{row}");
            assert!(row["megabytes_per_second"].as_f64().unwrap() > 0.0, "{row}");
            assert!(report.text.contains(&*file.file_name().unwrap().to_string_lossy()), "{}", report.text);
        }
        let instances = report.rows.last().unwrap();
        assert_eq!(instances["objects"], 1000, "{instances}");
        for row in &report.rows[..4] {
            let size = row["megabytes"].as_f64().unwrap();
            assert!((0.05..0.3).contains(&size), "asked for a tenth of a megabyte: {row}");
        }
    }
}
