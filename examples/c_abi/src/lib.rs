//! lieflow's matrix exponential for C, Python or any language that loads a shared library.
//!
//! ```c
//! // Returns the CPU seconds of `reps` evaluations; NaN for an unknown name or n. Matrices by columns.
//! double lieflow_run(const char* name, size_t n, const double* a, double* out, size_t reps);
//! ```
//!
//! | name | computes |
//! |---|---|
//! | `exp` | exp(a); a rotation if a is exactly skew |
//! | `exp_pade` | the same by Padé approximants only |
//! | `exp_batch` | 1000 copies of a at once, n ≤ 16; returns the time of one |
//! | `rodrigues` | the closed form on so(3), n = 3 |
//!
//! The loop runs inside the library, so the time has no calls from an interpreter. `cargo build --release -p
//! lieflow-c-abi` makes `liblieflow_c.so`.

use core::ffi::{CStr, c_char};
use std::hint::black_box;

use lieflow::dense::{Exponential, ExponentialBatch, Structure};
use lieflow::faer::Mat;
use lieflow::groups::So3;
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::nalgebra::Vector3;

/// Copies in a batch. Not a power of two, because then entries of one matrix would share one set of the cache.
const COPIES: usize = 1000;

/// CPU time of this thread in seconds.
#[cfg(target_os = "linux")]
fn now() -> f64 {
    #[repr(C)]
    struct Time {
        seconds: i64,
        nanoseconds: i64,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Time) -> i32;
    }
    const THREAD: i32 = 3;
    let mut t = Time { seconds: 0, nanoseconds: 0 };
    // SAFETY: the call writes one timespec, which `Time` is on 64-bit Linux.
    unsafe { clock_gettime(THREAD, &mut t) };
    t.seconds as f64 + 1e-9 * t.nanoseconds as f64
}

#[cfg(not(target_os = "linux"))]
fn now() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

fn timed(reps: usize, mut f: impl FnMut() -> bool) -> f64 {
    let start = now();
    for _ in 0..reps {
        if !f() {
            return f64::NAN;
        }
    }
    now() - start
}

fn run(name: &str, n: usize, a: &[f64], out: &mut [f64], reps: usize) -> f64 {
    let u = Mat::from_fn(n, n, |i, j| a[j * n + i]);
    let skew = (0..n).all(|j| (0..=j).all(|i| u[(i, j)] == -u[(j, i)]));
    let structure = if skew { Structure::Skew } else { Structure::General };
    let mut g = Mat::zeros(n, n);
    let time = match name {
        "exp" | "exp_pade" => {
            let mut exponential = Exponential::new(n);
            if name == "exp_pade" {
                exponential = exponential.insist_on_pade();
            }
            timed(reps, || exponential.exp(black_box(&u), structure, &mut g).is_ok())
        }
        "exp_batch" if n <= 16 => {
            let many: Vec<f64> = a.iter().flat_map(|x| [*x; COPIES]).collect();
            let (mut batch, mut result) = (ExponentialBatch::new(n), many.clone());
            // One batch for each COPIES evaluations.
            let rounds = reps.div_ceil(COPIES);
            let time =
                timed(rounds, || batch.exp(black_box(&many), structure, &mut result).is_ok());
            for j in 0..n {
                for i in 0..n {
                    g[(i, j)] = result[(j * n + i) * COPIES + COPIES - 1];
                }
            }
            time * reps as f64 / (rounds * COPIES) as f64
        }
        "rodrigues" if n == 3 && skew => {
            let (group, u) = (So3::new(), Vector3::new(u[(2, 1)], u[(0, 2)], u[(1, 0)]));
            let Ok(mut at) = Exp.at(&group) else { return f64::NAN };
            let mut rotation = lieflow::nalgebra::Matrix3::identity();
            let time =
                timed(reps, || Exp.psi(&group, black_box(&u), &mut at, &mut rotation).is_ok());
            g = Mat::from_fn(3, 3, |i, j| rotation[(i, j)]);
            time
        }
        _ => return f64::NAN,
    };
    for j in 0..n {
        out[j * n..(j + 1) * n].copy_from_slice(g.col_as_slice(j));
    }
    time
}

/// Runs and times one function; the documentation of the crate has the arguments.
///
/// # Safety
/// `name` is a C string; `a` and `out` are n² doubles, by columns.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lieflow_run(
    name: *const c_char,
    n: usize,
    a: *const f64,
    out: *mut f64,
    reps: usize,
) -> f64 {
    if name.is_null() || a.is_null() || out.is_null() {
        return f64::NAN;
    }
    // SAFETY: the caller guarantees it, see above.
    let (name, a, out) = unsafe {
        let a = core::slice::from_raw_parts(a, n * n);
        (CStr::from_ptr(name), a, core::slice::from_raw_parts_mut(out, n * n))
    };
    name.to_str().map_or(f64::NAN, |name| run(name, n, a, out, reps))
}
