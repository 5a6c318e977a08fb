//! Processor time and memory of this process, as Linux tells them.

use std::time::Instant;

/// Seconds of this thread on a processor; of the wall where the system does not tell.
pub fn processor_seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(wall_seconds, |n| 1e-9 * n)
}

fn wall_seconds() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Seconds that a measurement takes at least: the system counts in slices of some milliseconds.
const LEAST: f64 = 0.1;

/// Processor time of a run, the least of some measurements, and what the last one gave. Short runs are measured many at
/// a time.
pub fn timed<T>(measurements: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut least = f64::INFINITY;
    let mut result = None;
    for _ in 0..measurements.max(1) {
        let (start, mut count, mut taken) = (processor_seconds(), 0.0, 0.0);
        while taken < LEAST {
            result = Some(run());
            count += 1.0;
            taken = processor_seconds() - start;
        }
        least = least.min(taken / count);
    }
    (least, result.expect("at least one run"))
}

/// Greatest memory of this process so far, in megabytes.
pub fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1024.0
}
