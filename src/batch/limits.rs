//! What the workers of a run may use together: processes, memory, time.

use std::num::NonZeroUsize;
use std::str::FromStr;
use std::time::Duration;

/// Limits of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Workers at a time, at least 1.
    pub jobs: usize,
    /// Bytes of memory that all workers may have together; `None` where there is no limit to be had.
    pub memory: Option<u64>,
    /// Time that one part may take.
    pub time: Duration,
}

/// An hour: what a part takes that is far beyond any that was measured, and still leaves a night for the others.
pub const TIME: Duration = Duration::from_secs(3600);

impl Limits {
    /// One worker for each processor, three quarters of the memory that the process may use, an hour for each part.
    #[must_use]
    pub fn of_machine() -> Self {
        let jobs = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Self { jobs, memory: machine_memory().map(|bytes| bytes / 4 * 3), time: TIME }
    }

    /// The ceiling of one worker while all work.
    #[must_use]
    pub fn share(&self) -> Option<u64> {
        self.memory.map(|bytes| bytes / self.jobs as u64)
    }

    /// Threads that a worker may use, so that all together use each processor once.
    #[must_use]
    pub fn threads(&self) -> usize {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        (processors / self.jobs).max(1)
    }
}

/// Memory that the process may use: the machine's, or less where a control group says so.
fn machine_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let total = line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? * 1024;
    let group = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let group = group.iter().find_map(|path| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok());
    Some(group.map_or(total, |limit| limit.min(total)))
}

/// A size of memory: `512 MB`, `8G`, a number of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemorySize(pub u64);

/// The least that a worker starts with.
const LEAST: u64 = 16_000_000;

impl FromStr for MemorySize {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let split = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
        let (number, unit) = (text[..split].trim(), text[split..].trim().to_ascii_lowercase());
        let factor = match unit.trim_end_matches('b').trim_end_matches('i') {
            "" => 1.0,
            "k" => 1e3,
            "m" => 1e6,
            "g" => 1e9,
            "t" => 1e12,
            _ => {
                return Err(format!("`{text}` is not a size of memory; expected such as `800 MB` or `8 GB`"));
            }
        };
        let bytes = number.parse::<f64>().map_err(|_| format!("`{text}` is not a size of memory"))? * factor;
        // The cast is of a number between the least and 2^53.
        if bytes >= LEAST as f64 && bytes < 9e15 {
            Ok(Self(bytes as u64))
        } else {
            Err(format!("{text} is not enough for a worker, or beyond any machine; expected at least 16 MB"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_units() {
        let read = |text: &str| text.parse::<MemorySize>().map(|size| size.0);
        assert_eq!(read("800 MB"), Ok(800_000_000));
        assert_eq!(read("1.5g"), Ok(1_500_000_000));
        assert_eq!(read("20000000"), Ok(20_000_000));
        for wrong in ["", "12 parsecs", "1 kB", "-5 GB", "1e400 GB", "GB"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_shares_of_all_workers_are_within_the_budget() {
        for jobs in 1..9 {
            let limits = Limits { jobs, memory: Some(1_000_003), time: TIME };
            assert!(limits.share().expect("a budget") * jobs as u64 <= 1_000_003);
        }
    }
}
