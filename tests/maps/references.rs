//! Every implementation of the maps, their differentials and inverses against the same references.
//!
//! Errors are in units of ε·cond, ε the rounding unit of the implementation's numbers and cond the
//! condition of the reference.

use faer::{Mat, c64};
use lieflow::dense::{ComplexExponential, Structure};
use lieflow::groups::{AlgebraMatrix, GroupMatrix};
use lieflow::maps::{
    CCSK123, CCSK321, Cay, CoordinateMap, Exp, Pade22, dexp, distance_to_singular,
};
use lieflow::scalar::{Counted, Trig};
use lieflow::{StepError, so3};
use nalgebra::{Matrix3, Vector3};

use crate::support::references::{Answer, Case, Implementation, Output, cases, rows};

const EPS: f64 = f64::EPSILON;
/// All files with coordinate maps.
const MAPS: &[&str] = &["maps", "so3", "dexp", "hard", "expm"];

fn told<T>(value: Result<T, impl ToString>, entries: impl Fn(T) -> Vec<f64>) -> Answer {
    Some(value.map(entries).map_err(|error| error.to_string()))
}

fn never(_: &Case, _: &str, _: &Output) -> bool {
    false
}

/// The closed forms on so(3), in any numbers.
fn closed<S: Trig + Into<f64>>(case: &Case, function: &str) -> Answer {
    if (case.group.as_str(), case.n) != ("so", 3) || !case.has("u") {
        return None;
    }
    let [u, v] = ["u", "v"].map(|name| {
        let x = if case.has(name) { case.vector(name) } else { Vector3::zeros() };
        x.map(S::lit)
    });
    let matrix = |x: Result<Matrix3<S>, StepError>| {
        told(x, |g| g.transpose().iter().map(|x| (*x).into()).collect())
    };
    let vector =
        |x: Result<Vector3<S>, StepError>| told(x, |w| w.iter().map(|x| (*x).into()).collect());
    macro_rules! ordering {
        ($name:literal, $i:literal, $j:literal, $k:literal) => {
            if let Some(map) = function.strip_suffix($name) {
                return match map {
                    "ccsk" => matrix(so3::ccsk::<S, $i, $j, $k>(&u)),
                    "dccsk" => vector(so3::dccsk::<S, $i, $j, $k>(&u, &v)),
                    _ => vector(so3::dccskinv::<S, $i, $j, $k>(&u, &v)),
                };
            }
        };
    }
    ordering!("123", 0, 1, 2);
    ordering!("132", 0, 2, 1);
    ordering!("213", 1, 0, 2);
    ordering!("231", 1, 2, 0);
    ordering!("312", 2, 0, 1);
    ordering!("321", 2, 1, 0);
    match function {
        "exp" => matrix(so3::exp(&u)),
        "cay" => matrix(so3::cay(&u)),
        "dexp" => vector(so3::dexp(&u, &v)),
        "dexpinv" => vector(so3::dexpinv(&u, &v)),
        "dcay" => vector(so3::dcay(&u, &v)),
        "dcayinv" => vector(so3::dcayinv(&u, &v)),
        _ => None,
    }
}

/// The condition on so(3): of rotations that of the angle, which is exact along an axis.
fn cond_on_so3(case: &Case, function: &str, output: &Output) -> f64 {
    let u = case.vector("u");
    let axis = u.iter().filter(|x| **x != 0.0).count() == 1;
    match function {
        "cay" => 1.0,
        "exp" if axis => 1.0,
        _ if function == "exp" || function.starts_with("ccsk") => u.amax().max(1.0),
        _ => output.cond(),
    }
}

fn four_on_so3(case: &Case, function: &str, output: &Output) -> f64 {
    4.0 * cond_on_so3(case, function, output)
}

/// Where squares of what is squared overflow, and next to a singularity.
fn out_of_reach_on_so3(case: &Case, function: &str, output: &Output) -> bool {
    let u = case.vector("u");
    match function {
        "cay" => false,
        "exp" => u.lp_norm(1).is_infinite(),
        _ => u.amax() > 1e150 || output.cond() > 1e12,
    }
}

#[test]
fn closed_forms() {
    Implementation {
        name: "closed",
        eps: EPS,
        compute: closed::<f64>,
        bound: four_on_so3,
        may_refuse: out_of_reach_on_so3,
    }
    .check(MAPS, 1500);
}

#[test]
fn closed_forms_on_numbers_that_count() {
    Implementation {
        name: "counting",
        eps: EPS,
        compute: closed::<Counted>,
        bound: four_on_so3,
        may_refuse: out_of_reach_on_so3,
    }
    .check(MAPS, 1500);
}

/// Half a unit more for each input, which is rounded to `f32`.
#[test]
fn closed_forms_in_single_precision() {
    Implementation {
        name: "f32",
        eps: f64::from(f32::EPSILON),
        compute: |case, function| {
            let range = |x: Vector3<f64>| x.amax() < 1e15;
            let inputs = ["u", "v"].into_iter().filter(|name| case.has(name));
            match (case.group.as_str(), case.n) {
                ("so", 3) if inputs.clone().all(|name| range(case.vector(name))) => {
                    closed::<f32>(case, function)
                }
                _ => None,
            }
        },
        bound: |case, function, output| {
            5.0 * cond_on_so3(case, function, output).max(case.vector("u").amax())
        },
        may_refuse: |_, _, output| output.cond() > 1e4,
    }
    .check(MAPS, 1000);
}

/// One vector in every lane.
#[test]
fn lanes_on_so3() {
    fn compute(case: &Case, function: &str) -> Answer {
        if (case.group.as_str(), case.n) != ("so", 3) || !case.has("u") {
            return None;
        }
        const LANES: usize = 11;
        let columns = |x: Vector3<f64>| [0, 1, 2].map(|k| vec![x[k]; LANES]);
        let u = columns(case.vector("u"));
        let v = columns(if case.has("v") { case.vector("v") } else { Vector3::zeros() });
        let [u, v] = [&u, &v].map(|x| x.each_ref().map(|x| &x[..]));
        let (mut g, mut w) =
            ([(); 9].map(|()| vec![0.0; LANES]), [(); 3].map(|()| vec![0.0; LANES]));
        let done = {
            let g = g.each_mut().map(|x| &mut x[..]);
            let w = w.each_mut().map(|x| &mut x[..]);
            match function {
                "exp" => so3::batch::exp(u, g),
                "cay" => so3::batch::cay(u, g),
                "dexp" => so3::batch::dexp(u, v, w),
                "dexpinv" => so3::batch::dexpinv(u, v, w),
                _ => return None,
            }
        };
        let lane = |x: &[Vec<f64>]| x.iter().map(|x| x[4]).collect();
        told(done, |()| if function.starts_with('d') { lane(&w) } else { lane(&g) })
    }
    Implementation {
        name: "lanes",
        eps: EPS,
        compute,
        bound: four_on_so3,
        may_refuse: out_of_reach_on_so3,
    }
    .check(MAPS, 300);
}

/// ‖x‖‖x⁻¹‖.
fn cond_of(x: &Mat<f64>) -> f64 {
    let svd = x.svd().expect("singular values");
    let s = svd.S().column_vector();
    s[0] / s[x.nrows() - 1]
}

/// The layer of matrices, on every group.
#[test]
fn matrices() {
    fn compute(case: &Case, function: &str) -> Answer {
        if ["u", "se"].contains(&case.group.as_str()) {
            return None;
        }
        let group = case.matrix_group();
        let of = |name| AlgebraMatrix::new_unchecked(case.matrix(name));
        if function == "log" {
            case.output[function].measure("cond")?; // on so(3): `core/so3_closed.rs`
            let log = group.log(&GroupMatrix::new_unchecked(case.matrix("g")));
            return told(log, |u| {
                let in_algebra = group.algebra((*u).clone());
                assert!(in_algebra.is_ok(), "{}: {in_algebra:?}", case.id);
                rows(&u)
            });
        }
        let u = of("u");
        let v = if case.has("v") { of("v") } else { u.clone() };
        let element = |x: Result<GroupMatrix, _>| told(x, |g| rows(&g));
        let in_algebra = |x: Result<AlgebraMatrix, _>| {
            told(x, |w| {
                // Inputs in the algebra to the last bit are those of matrices.
                let tolerance = 4.0 * case.n as f64 * EPS;
                let found = group.algebra_within((*w).clone(), tolerance);
                assert!(found.is_ok() || function != "dexpinv", "{}: {found:?}", case.id);
                rows(&w)
            })
        };
        match function {
            "exp" => element(Exp.eval(&group, &u)),
            "cay" => element(Cay.eval(&group, &u)),
            "pade" => element(Pade22.eval(&group, &u)),
            "ccsk123" => element(CCSK123.eval(&group, &u)),
            "ccsk321" => element(CCSK321.eval(&group, &u)),
            "dexp" => in_algebra(dexp(&group, &u, &v)),
            "dexpinv" => in_algebra(Exp.eval_dpsi_inv(&group, &u, &v)),
            "dcayinv" => in_algebra(Cay.eval_dpsi_inv(&group, &u, &v)),
            "dpadeinv" => in_algebra(Pade22.eval_dpsi_inv(&group, &u, &v)),
            "distance" => told(distance_to_singular(&group, &u), |x| vec![x]),
            _ => None,
        }
    }
    fn bound(case: &Case, function: &str, output: &Output) -> f64 {
        let n = case.n;
        if function == "log" {
            return 10.0 * n as f64 * output.cond();
        }
        let u = case.matrix("u");
        let size = u.norm_l2().max(1.0);
        let one = Mat::<f64>::identity(n, n);
        let half = || &one - faer::Scale(0.5) * &u;
        let pade = || half() + faer::Scale(1.0 / 12.0) * (&u * &u);
        match function {
            "exp" => 4.0 * output.cond().max(if case.n == 3 { size / 2f64.sqrt() } else { 1.0 }),
            "cay" if output.measure("cond").is_some() => 10.0 * output.cond(),
            "cay" | "dcayinv" => 4.0 * cond_of(&half()),
            "pade" => 10.0 * cond_of(&pade()),
            "dpadeinv" => 10.0 * size * size * cond_of(&pade()),
            // dexp: |u| φ₁'/φ₁ ≤ |u|, and what non-normality adds is in the condition of dexp⁻¹.
            "dexp" => 10.0 * output.cond().max(size),
            "distance" => 20.0 * size / output.numbers()[0],
            "ccsk123" | "ccsk321" => 4.0 * size,
            _ => 10.0 * output.cond(),
        }
    }
    Implementation {
        name: "matrices",
        eps: EPS,
        compute,
        bound,
        may_refuse: |case, function, output| {
            let huge = || case.n == 3 && case.matrix("u").norm_l2() > 1e15;
            function == "dexpinv" && output.cond() > 1e11 || case.has("u") && huge()
        },
    }
    .check(&["maps", "so3", "dexp", "hard", "log"], 1100);
    for case in cases("maps").iter().filter(|case| !case.output["cay"].is_defined()) {
        assert!(compute(case, "cay").is_some_and(|cay| cay.is_err()), "{}: 𝟙 − u/2", case.id);
    }
}

/// Complex matrices, with those of U(m) as real matrices of twice the size, and real ones.
#[test]
fn complex_matrices() {
    fn structure(case: &Case) -> Structure {
        if ["u", "so"].contains(&case.group.as_str()) {
            Structure::Skew
        } else {
            Structure::General
        }
    }
    fn compute(case: &Case, function: &str) -> Answer {
        if function != "exp" || case.group == "se" {
            return None;
        }
        let u = case.complex("u");
        let mut g = u.clone();
        let done = ComplexExponential::new(case.n).exp(&u, structure(case), &mut g);
        told(done, |choice| {
            if structure(case) == Structure::Skew {
                // Twice that of real rotations, as a complex product is four real ones.
                let defect = (g.adjoint() * &g - Mat::<c64>::identity(case.n, case.n)).norm_l2();
                let units = defect / (EPS * (case.n as f64).sqrt());
                assert!(units <= 8.0, "{}: {units:.2} {choice:?}", case.id);
            }
            (0..case.n)
                .flat_map(|i| (0..case.n).map(move |j| (i, j)))
                .flat_map(|(i, j)| [g[(i, j)].re, g[(i, j)].im])
                .collect()
        })
    }
    Implementation {
        name: "complex",
        eps: EPS,
        compute,
        // ‖u‖ where the condition is not known: what it is on u(n).
        bound: |case, _, output| {
            4.0 * output.measure("cond").unwrap_or_else(|| case.complex("u").norm_l2()).max(1.0)
        },
        may_refuse: never,
    }
    .check(&["expm_complex"], 80);
}
