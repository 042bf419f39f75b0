//! Peak resident memory of this process.

/// Peak resident set in bytes since the start of the process; none where the operating system does
/// not tell (it is `VmHWM` of Linux' `/proc/self/status`).
pub(super) fn peak() -> Option<u64> {
    high_water_mark(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn high_water_mark(status: &str) -> Option<u64> {
    let value = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_read_in_kibibytes() {
        let status = "Name:\tasperity\nVmPeak:\t  900000 kB\nVmHWM:\t   20480 kB\n";
        assert_eq!(high_water_mark(status), Some(20 << 20));
        assert_eq!(high_water_mark("Name:\tasperity\n"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn memory_that_is_used_is_seen() {
        let before = peak().unwrap();
        let block = std::hint::black_box(vec![1_u8; 256 << 20]);
        assert!(peak().unwrap() >= before.max(200 << 20), "{}", block.len());
    }
}
