//! Memory that the system lets this process use: less than the machine has, where a control group (of a container, a service or
//! a job) or `ulimit` says so. A process that takes more is killed without a word, or gets none.

use bilux_scene::{Parameters, Value};
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Bytes per thread: 16 MB of stack, and the paths that it traces.
const THREAD: u64 = 24 << 20;
/// Threads take at most one part in this many.
const THREADS_PART: u64 = 4;
/// Bytes for everything that no estimate counts.
const RESERVE: u64 = 12 << 20;
/// Not even a small scene can be read with less; whether there is so much, allocations show.
const LEAST: u64 = 1 << 20;

/// Source of a limit of the memory of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitSource {
    /// The control group that the process is in, or one that contains it: `memory.max`, or `memory.limit_in_bytes` in the
    /// older form.
    Group,
    /// The size of its address space: `ulimit -v`.
    AddressSpace,
    /// The size of its data: `ulimit -d`.
    Data,
    /// The memory of the machine.
    Machine,
}

impl fmt::Display for LimitSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LimitSource::Group => "the memory limit of its control group",
            LimitSource::AddressSpace => "ulimit -v",
            LimitSource::Data => "ulimit -d",
            LimitSource::Machine => "the memory of this machine",
        })
    }
}

/// The tightest limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryLimit {
    /// The source.
    pub source: LimitSource,
    /// The limit in bytes.
    pub limit: u64,
    /// The bytes of it that are not in use yet.
    pub left: u64,
}

impl MemoryLimit {
    /// The one with the least left for this process; `None` on systems that are not Linux.
    pub fn of_process() -> Option<MemoryLimit> {
        MemoryLimit::within(Path::new("/"))
    }

    /// Finds the tightest limit, with the system's files in another folder.
    fn within(root: &Path) -> Option<MemoryLimit> {
        let all = [of_groups(root), of_process(root), of_machine(root)];
        all.into_iter().flatten().min_by_key(|limit| limit.left)
    }

    /// True if it is not just the size of the machine.
    pub fn is_imposed(&self) -> bool {
        self.source != LimitSource::Machine
    }

    /// The number of threads for which there is memory, if it is lower than the number of cores.
    pub fn threads(&self) -> Option<usize> {
        let fits = usize::try_from(self.left / THREADS_PART / THREAD).unwrap_or(usize::MAX).max(1);
        (self.is_imposed() && fits < cores()).then_some(fits)
    }

    /// Sets the number of threads to what there is memory for, unless somebody has.
    pub fn set_threads(&self, settings: &mut Parameters) {
        if let (Some(threads), None) = (self.threads(), settings.find("threads")) {
            settings.set("threads", Value::Integer(threads as i64));
        }
    }

    /// The bytes that are left for a scene and its picture beside the threads.
    pub fn for_pictures(&self) -> u64 {
        let threads = self.threads().unwrap_or_else(cores) as u64 * THREAD;
        let reserve = if self.is_imposed() { threads + RESERVE.min(self.left / THREADS_PART) } else { 0 };
        self.left.saturating_sub(reserve).max(LEAST)
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Names of control groups in one form: their folder, the files of their limit and of what is in use, and the fields that count
/// the files in memory, which the system drops first.
struct Hierarchy {
    folder: &'static str,
    limit: &'static str,
    used: &'static str,
    files: [&'static str; 2],
}

const UNIFIED: Hierarchy = Hierarchy {
    folder: "sys/fs/cgroup",
    limit: "memory.max",
    used: "memory.current",
    files: ["inactive_file", "active_file"],
};

/// The unified form beside the older one.
const HYBRID: Hierarchy = Hierarchy { folder: "sys/fs/cgroup/unified", ..UNIFIED };

const OLDER: Hierarchy = Hierarchy {
    folder: "sys/fs/cgroup/memory",
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    files: ["total_inactive_file", "total_active_file"],
};

/// The tightest of the groups that the process is in, from its own to the one that contains all.
fn of_groups(root: &Path) -> Option<MemoryLimit> {
    let text = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let lines = text.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        Some((parts.next()?, parts.next()?))
    });
    let groups = lines.flat_map(|(controllers, path)| {
        let hierarchies = match controllers {
            "" => vec![UNIFIED, HYBRID],
            named if named.split(',').any(|name| name == "memory") => vec![OLDER],
            _ => vec![],
        };
        hierarchies.into_iter().map(move |hierarchy| (hierarchy, path.trim_start_matches('/').to_owned()))
    });
    let limits = groups.flat_map(|(hierarchy, path)| {
        let folder = root.join(hierarchy.folder);
        // Where a container sees only its own group, the path may be that outside, which is not there.
        let above: Vec<PathBuf> = Path::new(&path).ancestors().map(|above| folder.join(above)).collect();
        above.into_iter().filter_map(move |group| hierarchy.limit_of(&group)).collect::<Vec<_>>()
    });
    limits.min_by_key(|limit| limit.left)
}

impl Hierarchy {
    /// The limit of one group, if it has one.
    fn limit_of(&self, group: &Path) -> Option<MemoryLimit> {
        let number = |name: &str| fs::read_to_string(group.join(name)).ok()?.trim().parse::<u64>().ok();
        let limit = number(self.limit)?;
        let statistics = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
        let files: u64 = self.files.iter().filter_map(|name| field(&statistics, name)).sum();
        let used = number(self.used).unwrap_or(0).saturating_sub(files);
        Some(MemoryLimit { source: LimitSource::Group, limit, left: limit.saturating_sub(used) })
    }
}

/// The tighter of the process's own limits.
fn of_process(root: &Path) -> Option<MemoryLimit> {
    let limits = fs::read_to_string(root.join("proc/self/limits")).ok()?;
    let status = fs::read_to_string(root.join("proc/self/status")).unwrap_or_default();
    let rows = [
        ("Max address space", "VmSize:", LimitSource::AddressSpace),
        ("Max data size", "VmData:", LimitSource::Data),
    ];
    let rows = rows.into_iter().filter_map(|(name, used, source)| {
        let limit = field(&limits, name)?;
        let used = field(&status, used).unwrap_or(0) << 10;
        Some(MemoryLimit { source, limit, left: limit.saturating_sub(used) })
    });
    rows.min_by_key(|limit| limit.left)
}

/// The memory of the machine, with what it can swap.
fn of_machine(root: &Path) -> Option<MemoryLimit> {
    let text = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let limit = (field(&text, "MemTotal:")? + field(&text, "SwapTotal:").unwrap_or(0)) << 10;
    Some(MemoryLimit { source: LimitSource::Machine, limit, left: limit })
}

/// The first number after a name at the beginning of a line; `None` if there is a word, such as `unlimited`.
fn field(text: &str, name: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root with these files.
    fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    const MACHINE: (&str, &str) =
        ("proc/meminfo", "MemTotal:       16000000 kB\nMemFree: 1 kB\nSwapTotal:       1000 kB\n");
    const UNLIMITED: &str = "Limit                     Soft Limit           Hard Limit           Units\n\
        Max data size             unlimited            unlimited            bytes\n\
        Max address space         unlimited            unlimited            bytes\n";

    fn found(files: &[(&str, &str)]) -> MemoryLimit {
        MemoryLimit::within(root(files).path()).unwrap()
    }

    #[test]
    fn without_a_limit_it_is_the_machine() {
        let all = found(&[
            MACHINE,
            ("proc/self/limits", UNLIMITED),
            ("proc/self/cgroup", "0::/user.slice\n"),
            ("sys/fs/cgroup/user.slice/memory.max", "max\n"),
        ]);
        assert_eq!((all.source, all.limit), (LimitSource::Machine, 16_001_000 << 10));
        assert!(!all.is_imposed());
        assert_eq!(MemoryLimit::within(root(&[]).path()), None);
    }

    /// The kernel's documentation, *Control Group v2*: the limit of each group holds for all that is below it.
    #[test]
    fn the_tightest_group_on_the_path_counts() {
        let files = [
            MACHINE,
            ("proc/self/cgroup", "0::/pod/box/inner\n"),
            ("sys/fs/cgroup/pod/memory.max", "700000000\n"),
            ("sys/fs/cgroup/pod/memory.current", "450000000\n"),
            ("sys/fs/cgroup/pod/memory.stat", "anon 1\ninactive_file 50000000\nactive_file 100000000\n"),
            ("sys/fs/cgroup/pod/box/memory.max", "max\n"),
            ("sys/fs/cgroup/pod/box/inner/memory.max", "500000000\n"),
            ("sys/fs/cgroup/pod/box/inner/memory.current", "1000000\n"),
        ];
        let all = found(&files);
        // The pod has 700 MB, of which 300 are in use by others and cannot be dropped.
        assert_eq!((all.source, all.limit, all.left), (LimitSource::Group, 700_000_000, 400_000_000));
        // Without the pod's own limit it is that of the inner group.
        let all = found(&[&files[..2], &files[6..]].concat());
        assert_eq!((all.limit, all.left), (500_000_000, 499_000_000));
    }

    #[test]
    fn groups_of_the_older_form_count_also_where_the_path_is_that_of_the_host() {
        let all = found(&[
            MACHINE,
            ("proc/self/cgroup", "5:cpu,cpuacct:/docker/1\n4:memory:/docker/1\n0::/\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "268435456\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "68435456\n"),
            ("sys/fs/cgroup/memory/memory.stat", "total_inactive_file 8435456\n"),
        ]);
        assert_eq!((all.source, all.limit, all.left), (LimitSource::Group, 268_435_456, 208_435_456));
        // What the older form writes where there is no limit.
        let all = found(&[
            MACHINE,
            ("proc/self/cgroup", "4:memory:/\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
        ]);
        assert_eq!(all.source, LimitSource::Machine);
    }

    #[test]
    fn threads_and_pictures_share_what_is_left() {
        let of = |source, left| MemoryLimit { source, limit: left, left };
        let machine = of(LimitSource::Machine, 4 << 30);
        assert_eq!((machine.threads(), machine.for_pictures()), (None, 4 << 30));
        let tight = of(LimitSource::Group, 200 << 20);
        assert_eq!(tight.threads(), (cores() > 2).then_some(2));
        assert_eq!(tight.for_pictures(), (200 << 20) - cores().min(2) as u64 * THREAD - RESERVE);
        assert_eq!(of(LimitSource::AddressSpace, 0).for_pictures(), LEAST);
        let (mut asked, mut open) = (Parameters::default(), Parameters::default());
        asked.set("threads", Value::Integer(7));
        let one = of(LimitSource::Group, 1);
        [&mut asked, &mut open].into_iter().for_each(|settings| one.set_threads(settings));
        assert_eq!(asked.find("threads").map(|(value, _)| value.clone()), Some(Value::Integer(7)));
        let few = (cores() > 1).then_some(Value::Integer(1));
        assert_eq!(open.find("threads").map(|(value, _)| value.clone()), few);
    }

    #[test]
    fn limits_of_the_shell_count() {
        let limits = |data: &str, space: &str| {
            format!(
                "Max data size             {data}  unlimited  bytes\nMax address space         {space}  unlimited  bytes\n"
            )
        };
        let status = ("proc/self/status", "VmPeak:\t 9 kB\nVmSize:\t   30000 kB\nVmData:\t   1000 kB\n");
        let text = limits("unlimited", "209715200");
        let all = found(&[MACHINE, status, ("proc/self/limits", &text)]);
        assert_eq!((all.source, all.left), (LimitSource::AddressSpace, 209_715_200 - (30_000 << 10)));
        let text = limits("104857600", "209715200");
        let all = found(&[MACHINE, status, ("proc/self/limits", &text)]);
        assert_eq!((all.source, all.left), (LimitSource::Data, 104_857_600 - (1000 << 10)));
    }
}
