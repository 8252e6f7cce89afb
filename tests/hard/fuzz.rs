//! The bodies of the fuzz targets on random bytes: no panic, no hang, no NaN in an `Ok`, and errors that
//! name the argument, for every public entry. A fixed seed and a fresh one, which is printed.
//!
//! `LIEFLOW_SEED=7 LIEFLOW_CASES=1000000 cargo test --release --test fuzz` runs longer.
#![allow(unreachable_pub)] // the bodies are public to the crate in fuzz/

#[path = "../../fuzz/src/bodies.rs"]
mod bodies;

use bodies::TARGETS;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

fn setting(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

fn fresh_seed() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    setting("LIEFLOW_SEED").unwrap_or(now.map_or(0, |t| t.as_nanos() as u64))
}

fn run(name: &str, cases: u64) {
    let (_, body) = TARGETS.iter().find(|(target, _)| *target == name).expect("a target");
    let cases = setting("LIEFLOW_CASES").unwrap_or(cases);
    for seed in [1, fresh_seed()] {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut bytes = vec![0; 2048];
        for case in 0..cases {
            rng.fill(&mut bytes[..]);
            let length = rng.random_range(0..bytes.len());
            let start = Instant::now();
            let found = std::panic::catch_unwind(|| body(&bytes[..length]));
            // 1 s is the promise; a loaded machine and a debug build get more.
            let late = start.elapsed() > Duration::from_secs(10);
            assert!(found.is_ok() && !late, "{name}: case {case} of seed {seed}, late: {late}");
        }
    }
}

/// What cargo-fuzz found: cay on U(4) at entries of 5e14 beside ordinary ones, and a start that is no number
/// with an empty span.
#[rustfmt::skip]
const FOUND: [(&str, &[u8]); 2] = [
    ("unitary", &[255, 255, 3, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 50, 50, 50, 54, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 255, 255, 255, 255, 255, 255, 255, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 50, 50, 50, 50, 50, 50, 50, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 50, 50, 50, 50, 50, 50, 50, 255, 255, 255, 255, 255, 255, 255, 1, 1, 0, 253, 255, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 206, 191, 18, 0, 255, 0, 0, 0, 254, 255, 255, 255, 255, 255, 255, 255, 50, 50, 50, 50, 50, 50, 255, 255, 255, 255, 255, 255, 10]),
    ("integrate", &[10, 232, 20, 111, 10, 232, 20, 111, 111, 111, 111, 111, 111, 0, 0, 0, 0, 0, 0, 0, 54, 111, 231, 230, 20, 20, 20, 20, 20, 20, 216, 216, 216, 216, 216, 0, 0, 0, 0, 0, 0, 0, 233, 0, 0, 0, 254, 255, 255, 255, 0, 0, 39, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 216, 216, 216, 216, 216, 216, 216, 216, 20, 20, 20, 20, 20, 20, 20, 20, 20, 20, 18, 20, 20, 20, 20, 20, 20, 20, 20, 20, 20, 20, 20, 20]),
];

#[test]
fn what_was_found() {
    for (name, bytes) in FOUND {
        let (_, body) = TARGETS.iter().find(|(target, _)| *target == name).expect("a target");
        body(bytes);
    }
}

/// So many cases a seed, fewer where one works on matrices.
macro_rules! targets {
    ($($name:ident: $cases:literal;)*) => {
        $(#[test]
        fn $name() {
            run(stringify!($name), $cases);
        })*
        #[test]
        fn every_target_has_its_test() {
            let here = [$(stringify!($name)),*];
            assert_eq!(TARGETS.iter().map(|(name, _)| *name).collect::<Vec<_>>(), here);
        }
    };
}
targets! {
    so3_exp: 10_000;
    so3_log: 10_000;
    so3_cay: 10_000;
    so3_ccsk: 10_000;
    so3_batch: 2_000;
    groups: 2_000;
    exp: 1_000;
    dexp: 600;
    cay: 1_000;
    pade22: 1_000;
    ccsk: 1_000;
    log: 600;
    adjoint: 1_000;
    unitary: 1_000;
    integrate: 2_000;
    adaptive: 1_000;
}
