//! What time is measured with, and on what machine.

/// CPU time of this thread in seconds: what other programs do to the machine is not in it.
#[cfg(unix)]
pub fn cpu_seconds() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Wall time in seconds, where the system has no clock of CPU time that we know.
#[cfg(not(unix))]
pub fn cpu_seconds() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// The CPU time of a call, from a batch of calls that takes `shortest` seconds. The clock is read at the ends of a batch
/// only, because reading it takes longer than a short call. Batches before it are too short, and say how many calls
/// are enough.
///
/// # Errors
/// Those of a call, which ends the measurement.
pub fn seconds_of<E>(shortest: f64, call: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    seconds_by(cpu_seconds, shortest, call)
}

/// [`seconds_of`] by this clock.
fn seconds_by<E>(
    mut clock: impl FnMut() -> f64,
    shortest: f64,
    mut call: impl FnMut() -> Result<(), E>,
) -> Result<f64, E> {
    let mut calls = 1.0;
    loop {
        let start = clock();
        for _ in 0..calls as u64 {
            call()?;
        }
        let took = clock() - start;
        if took >= shortest {
            return Ok(took / calls);
        }
        // A little more than is left, so that one more batch is enough. A short batch says little of the next one.
        let growth = (1.2 * shortest / took).clamp(2.0, 16.0);
        calls = (calls * growth).ceil();
    }
}

/// The machine in words: processor, cores, system, and how the program was built.
pub fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or("unknown processor", |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let build = if cfg!(debug_assertions) { "debug build" } else { "release build" };
    format!("{model}, {cores} cores, {} {}, {build}", std::env::consts::OS, std::env::consts::ARCH)
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;
    use core::convert::Infallible;

    use super::*;

    /// A look at this clock takes a thousand times as long as a call.
    #[test]
    fn the_time_of_a_call_is_without_that_of_the_clock() {
        let now = Cell::new(0.0);
        let clock = || {
            now.set(now.get() + 1e-6);
            now.get()
        };
        let call = || {
            now.set(now.get() + 1e-9);
            Ok::<_, Infallible>(())
        };
        let Ok(seconds) = seconds_by(clock, 1e-3, call);
        assert!((1e-9..1.01e-9).contains(&seconds), "{seconds:e}");
    }

    #[test]
    fn a_call_that_fails_ends_the_measurement() {
        let mut left = 5;
        let call = || {
            left -= 1;
            if left == 0 { Err("over") } else { Ok(()) }
        };
        assert_eq!((seconds_of(f64::INFINITY, call), left), (Err("over"), 0));
    }
}
