//! The program for `instructions.sh`: it calls one function again and again.
//!
//! `instructions NAME CALLS` calls the function NAME that many times. Without arguments it lists the names.

use std::hint::black_box;

use faer::Mat;
use lieflow::dense::{Exponential, Structure};
use lieflow::groups::So3;
use lieflow::maps::{Cay, CoordinateMap, Exp};
use nalgebra::{Matrix3, Vector3};

const NAMES: [&str; 9] = [
    "so3_exp",
    "so3_exp_dexpinv",
    "so3_cay",
    "so3_cay_dcayinv",
    "exp_so_3",
    "exp_so_8",
    "exp_gl_8",
    "exp_so_32",
    "exp_gl_32",
];

/// u with ‖u‖₁ = 1.
fn element(n: usize, skew: bool) -> Mat<f64> {
    let entry = |i: usize, j: usize| ((7 * i * j + 3 * i + 5 * j + 1) % 13) as f64 - 6.0;
    let u = Mat::from_fn(n, n, |i, j| if skew { entry(i, j) - entry(j, i) } else { entry(i, j) });
    let columns = (0..n).map(|j| u.col(j).iter().map(|x| x.abs()).sum::<f64>());
    let norm = columns.fold(0.0, f64::max);
    u * faer::Scale(1.0 / norm)
}

fn dense(n: usize, skew: bool, calls: usize) {
    let structure = if skew { Structure::Skew } else { Structure::General };
    let (u, mut g) = (element(n, skew), Mat::zeros(n, n));
    let mut exponential = Exponential::new(n);
    for _ in 0..calls {
        let _ = black_box(exponential.exp(black_box(&u), structure, &mut g));
    }
}

fn closed<Psi: CoordinateMap<So3>>(psi: &Psi, inverse: bool, calls: usize) {
    let group = So3::new();
    let Ok(mut at) = psi.at(&group) else { return };
    let (u, mut g) = (Vector3::new(0.3, -0.5, 0.2), Matrix3::identity());
    for _ in 0..calls {
        let u = black_box(&u);
        let _ = black_box(psi.psi(&group, u, &mut at, &mut g));
        if inverse {
            let mut v = black_box(Vector3::new(0.1, 0.2, -0.4));
            let _ = black_box(psi.dpsi_inv(&group, u, &mut at, &mut v));
        }
        black_box(&g);
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let (name, calls) = match &args[..] {
        [name, calls] => (name.as_str(), calls.parse().unwrap_or(0)),
        _ => return NAMES.iter().for_each(|name| println!("{name}")),
    };
    match name {
        "so3_exp" => closed(&Exp, false, calls),
        "so3_exp_dexpinv" => closed(&Exp, true, calls),
        "so3_cay" => closed(&Cay, false, calls),
        "so3_cay_dcayinv" => closed(&Cay, true, calls),
        "exp_so_3" => dense(3, true, calls),
        "exp_so_8" => dense(8, true, calls),
        "exp_gl_8" => dense(8, false, calls),
        "exp_so_32" => dense(32, true, calls),
        "exp_gl_32" => dense(32, false, calls),
        _ => eprintln!("{name}: not one of {NAMES:?}"),
    }
}
