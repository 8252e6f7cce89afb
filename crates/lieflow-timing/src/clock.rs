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

/// The CPU time of a call, which is repeated until all have taken `shortest` seconds.
pub fn seconds_of(shortest: f64, mut call: impl FnMut()) -> f64 {
    let (start, mut calls) = (cpu_seconds(), 0.0);
    loop {
        call();
        calls += 1.0;
        let took = cpu_seconds() - start;
        if took >= shortest {
            return took / calls;
        }
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
