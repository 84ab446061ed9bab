//! The processor that is measured on.

use bilux::accel::CpuLevel;
use std::fs;

/// The processor, the number of its cores that there are for us, and the instructions that kernels use.
pub(super) fn cpu() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| {
        let of_line = |line: &str| line.split_once(':').map(|(k, v)| (k.trim() == key, v.trim().to_owned()));
        text.lines().filter_map(of_line).find(|(is_it, _)| *is_it).map(|(_, value)| value)
    };
    let name = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let kind = match (field("cpu family"), field("model")) {
        (Some(family), Some(model)) => format!(" (family {family}, model {model})"),
        _ => String::new(),
    };
    let cores = match cores() {
        1 => "1 core".to_owned(),
        n => format!("{n} cores"),
    };
    format!("{name}{kind}, {cores}, {}", CpuLevel::detect().name())
}

/// The number of cores that there are for us.
pub(super) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
