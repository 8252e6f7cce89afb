//! The maps and their inverse differentials against references of 25 digits and more.
//!
//! Errors are in units of eps·max(1, cond)·size, with cond the condition number of the reference.

use faer::Mat;
use lieflow::CoordinateMap;
use lieflow::groups::{AlgebraMatrix, MatrixGroup, So3};
use lieflow::maps::{Cay, Ccsk, Exp};
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

type Entries = Option<Vec<String>>;

#[derive(Deserialize)]
struct References {
    so3: Vec<ClosedCase>,
    general: Vec<GeneralCase>,
}

#[derive(Deserialize)]
struct ClosedCase {
    u: [String; 3],
    v: [String; 3],
    exp: Entries,
    dexpinv: Entries,
    cond_dexpinv: Option<String>,
    cay: Entries,
    dcayinv: Entries,
    cond_dcayinv: Option<String>,
    ccsk123: Entries,
    dccsk123inv: Entries,
    cond_dccsk123inv: Option<String>,
    ccsk321: Entries,
    dccsk321inv: Entries,
    cond_dccsk321inv: Option<String>,
}

#[derive(Deserialize)]
struct GeneralCase {
    id: String,
    group: String,
    n: usize,
    u: Vec<String>,
    v: Vec<String>,
    exp: Entries,
    dexpinv: Entries,
    cay: Entries,
    dcayinv: Entries,
    cond_exp: Option<String>,
    cond_dexpinv: Option<String>,
}

fn references() -> References {
    serde_json::from_str(include_str!("references/maps.json")).expect("references")
}

fn numbers<'a>(text: impl IntoIterator<Item = &'a String>) -> Vec<f64> {
    text.into_iter().map(|x| x.parse().expect("a decimal number")).collect()
}

fn cond(text: &Option<String>) -> f64 {
    text.as_ref().map_or(1.0, |x| x.parse::<f64>().expect("a decimal number")).max(1.0)
}

/// ‖x − r‖/(eps·‖r‖·cond), entries row by row; scaled so that no square leaves the range.
fn units(x: &[f64], r: &[f64], cond: f64) -> f64 {
    let size = r.iter().fold(0.0f64, |s, r| s.max(r.abs()));
    if size == 0.0 {
        return if x.iter().all(|x| *x == 0.0) { 0.0 } else { f64::INFINITY };
    }
    let norm = |y: &mut dyn Iterator<Item = f64>| y.map(|y| (y / size).powi(2)).sum::<f64>().sqrt();
    let gap = norm(&mut x.iter().zip(r).map(|(x, r)| x - r));
    gap / (f64::EPSILON * cond * norm(&mut r.iter().copied()))
}

/// The worst errors by name; a bound that is broken is printed and counted.
#[derive(Default)]
struct Worst {
    rows: std::collections::BTreeMap<&'static str, (f64, String, usize)>,
    broken: usize,
}

impl Worst {
    fn see(&mut self, name: &'static str, case: &str, units: f64, bound: f64) {
        let row = self.rows.entry(name).or_default();
        row.2 += 1;
        if units > row.0 {
            (row.0, row.1) = (units, case.into());
        }
        if units.is_nan() || units > bound {
            println!("{name} at {case}: {units:.2} eps·cond, bound {bound}");
            self.broken += 1;
        }
    }
    fn finish(self) {
        for (name, (units, case, count)) in &self.rows {
            println!("{name:14} {count:3} cases, worst {units:8.2} eps·cond at {case}");
        }
        assert_eq!(self.broken, 0);
    }
}

/// Every closed form on so(3) within 4 eps·cond, from |u| = 1e-320 to 1e15.
#[test]
fn closed_forms() {
    let mut worst = Worst::default();
    let so3 = So3::<f64>::new();
    for case in references().so3 {
        let u = Vector3::from_vec(numbers(&case.u));
        let v = Vector3::from_vec(numbers(&case.v));
        let id = format!("u = {:?}", case.u);
        let row_major = |g: Matrix3<f64>| g.transpose().as_slice().to_vec();
        macro_rules! check {
            ($map:expr, $psi:literal, $value:ident, $inverse:literal, $derivative:ident, $cond:ident) => {
                // Beyond 1e150 squares overflow, and the maps say so.
                if let (Some(r), true) = (&case.$value, u.norm() < 1e150) {
                    let g = $map.eval(&so3, &u).expect("Ψ(u)");
                    let cond = u.norm().max(1.0);
                    worst.see($psi, &id, units(&row_major(g), &numbers(r), cond), 4.0);
                }
                if let (Some(r), true) = (&case.$derivative, u.norm() < 1e150) {
                    let cond = cond(&case.$cond);
                    match $map.eval_dpsi_inv(&so3, &u, &v) {
                        Ok(w) => {
                            worst.see($inverse, &id, units(w.as_slice(), &numbers(r), cond), 4.0)
                        }
                        Err(error) => assert!(cond > 1e12, "{id}: {error}"),
                    }
                }
            };
        }
        check!(Exp, "exp", exp, "dexpinv", dexpinv, cond_dexpinv);
        check!(Cay, "cay", cay, "dcayinv", dcayinv, cond_dcayinv);
        let (c123, c321) = (Ccsk::<0, 1, 2>::with_min_cos(0.0), Ccsk::<2, 1, 0>::with_min_cos(0.0));
        check!(c123, "ccsk123", ccsk123, "dccsk123inv", dccsk123inv, cond_dccsk123inv);
        check!(c321, "ccsk321", ccsk321, "dccsk321inv", dccsk321inv, cond_dccsk321inv);
    }
    worst.finish();
}

/// Any n: exp and cay within 4 eps·cond (as hyperbolic boosts need), dexp⁻¹ within 100, on so(n)
/// within 10, or a refusal where the Baker series does not converge.
#[test]
fn general_maps() {
    let mut worst = Worst::default();
    let mut refused = Vec::new();
    for case in references().general {
        let n = case.n;
        let group = match case.group.as_str() {
            "so" => MatrixGroup::so(n),
            "sp" => MatrixGroup::sp(n),
            "gl" => MatrixGroup::gl(n),
            _ => MatrixGroup::indefinite(3, 1),
        }
        .expect("a group");
        let element = |x: &[String]| -> AlgebraMatrix {
            let x = numbers(x);
            group.algebra(Mat::from_fn(n, n, |i, j| x[i * n + j])).expect("in the algebra")
        };
        let row_major =
            |x: &Mat<f64>| -> Vec<f64> { (0..n * n).map(|k| x[(k / n, k % n)]).collect() };
        let (u, v) = (element(&case.u), element(&case.v));
        if let Some(r) = &case.exp {
            let g = Exp.eval(&group, &u).expect("exp(u)");
            let cond = cond(&case.cond_exp);
            worst.see("exp", &case.id, units(&row_major(&g), &numbers(r), cond), 4.0);
        }
        if let Some(r) = &case.dexpinv {
            let cond = cond(&case.cond_dexpinv);
            match Exp.eval_dpsi_inv(&group, &u, &v) {
                Ok(w) if case.group == "so" => worst.see(
                    "dexpinv so",
                    &case.id,
                    units(&row_major(&w), &numbers(r), cond),
                    10.0,
                ),
                Ok(w) => {
                    worst.see("dexpinv", &case.id, units(&row_major(&w), &numbers(r), cond), 100.0)
                }
                Err(_) => refused.push(case.id.clone()),
            }
        }
        let half = Mat::<f64>::identity(n, n) - faer::Scale(0.5) * u.as_ref();
        let svd = half.svd().expect("singular values");
        let s = svd.S().column_vector();
        let cond_half = s[0] / s[n - 1];
        if let Some(r) = &case.cay {
            let g = Cay.eval(&group, &u).expect("cay(u)");
            worst.see("cay", &case.id, units(&row_major(&g), &numbers(r), cond_half), 4.0);
        } else {
            assert!(Cay.eval(&group, &u).is_err(), "{}: 𝟙 − u/2 is singular", case.id);
        }
        if let Some(r) = &case.dcayinv {
            let w = Cay.eval_dpsi_inv(&group, &u, &v).expect("dcay⁻¹");
            worst.see("dcayinv", &case.id, units(&row_major(&w), &numbers(r), cond_half), 4.0);
        }
    }
    println!("dexp⁻¹ refused beyond the series' radius: {refused:?}");
    assert!(refused.iter().all(|id| !id.starts_with("so")), "{refused:?}");
    worst.finish();
}
