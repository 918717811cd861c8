//! What memory there is for this process: the machine's, or less where its control group has a limit.

use std::fs;
use std::path::Path;

/// Where the machine does not tell its memory, bytes.
const FALLBACK: u64 = 4 << 30;

/// Bytes of memory that this process may use.
pub fn memory() -> u64 {
    let text = |path| fs::read_to_string(path).unwrap_or_default();
    let physical = total(&text("/proc/meminfo")).unwrap_or(FALLBACK);
    group_limits(&text("/proc/self/cgroup"), Path::new("/sys/fs/cgroup")).into_iter().fold(physical, u64::min)
}

/// Physical memory, from the text of `/proc/meminfo`.
fn total(text: &str) -> Option<u64> {
    let kilobytes = text.lines().find_map(|line| line.strip_prefix("MemTotal:")?.trim().strip_suffix(" kB"))?;
    Some(kilobytes.parse::<u64>().ok()? * 1024)
}

/// The limits of the control groups that a `/proc/self/cgroup` names and of those around them, of both versions.
fn group_limits(text: &str, root: &Path) -> Vec<u64> {
    let mut limits = Vec::new();
    for line in text.lines() {
        // hierarchy:controllers:path; version 2 has no controllers.
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (top, file) = match controllers {
            "" => (root.to_owned(), "memory.max"),
            _ if controllers.split(',').any(|name| name == "memory") => (root.join("memory"), "memory.limit_in_bytes"),
            _ => continue,
        };
        let group = top.join(path.trim_start_matches('/'));
        // In a container the path may be the host's: then only the top is there.
        let groups = group.ancestors().take_while(|group| group.starts_with(&top));
        limits.extend(groups.filter_map(|group| fs::read_to_string(group.join(file)).ok()?.trim().parse::<u64>().ok()));
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_in_kilobytes() {
        assert_eq!(total("MemFree: 1 kB\nMemTotal:       16 kB\n"), Some(16384));
        assert_eq!(total("nothing"), None);
        assert!(memory() > 0);
    }

    #[test]
    fn limits_of_all_groups_around_are_found_in_both_versions() {
        let root = tempfile::tempdir().unwrap();
        for (group, file, text) in [
            ("", "memory.max", "max\n"),
            ("slice", "memory.max", "5000\n"),
            ("slice/job", "memory.max", "3000\n"),
            ("memory", "memory.limit_in_bytes", "9000\n"),
        ] {
            std::fs::create_dir_all(root.path().join(group)).unwrap();
            std::fs::write(root.path().join(group).join(file), text).unwrap();
        }
        assert_eq!(group_limits("0::/slice/job\n", root.path()), [3000, 5000]);
        assert_eq!(group_limits("3:cpu:/slice\n4:hugetlb,memory:/of/the/host\n", root.path()), [9000]);
    }
}
