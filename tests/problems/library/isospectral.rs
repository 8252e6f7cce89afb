//! Isospectral flows: Toda in closed form, QR's iterates, Brockett's sorting.

use super::*;
use faer::{Mat, Side, mat};
use lieflow::groups::{MatrixGroup, Sample};
use lieflow::problems::{IsospectralFlow, toda_lattice};
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn symmetric(n: usize, seed: u64) -> Mat<f64> {
    let group = MatrixGroup::gl(n).unwrap();
    let a = group.sample_algebra(&mut Pcg64::seed_from_u64(seed), 0.5).into_mat();
    (&a + a.transpose()) * faer::Scale(0.5)
}

fn spectrum(l: &Mat<f64>) -> Vec<f64> {
    l.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

/// The spectra differ by at most this, relatively to the largest eigenvalue.
fn spectra_differ(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let (a, b) = (spectrum(a), spectrum(b));
    let size = a.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    a.iter().zip(&b).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) / size
}

/// exp(s log x) or exp(s x), by the eigenvectors of a symmetric x.
fn function(x: &Mat<f64>, f: impl Fn(f64) -> f64) -> Mat<f64> {
    let eigen = x.self_adjoint_eigen(Side::Lower).unwrap();
    let (q, d) = (eigen.U(), eigen.S().column_vector());
    let scaled = Mat::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)] * f(d[j]));
    scaled * q.transpose()
}

/// Qᵀ L Q with x = QR and positive diagonal of R.
fn by_qr_of(x: &Mat<f64>, l: &Mat<f64>) -> Mat<f64> {
    let qr = x.qr();
    let (q, r) = (qr.compute_Q(), qr.R());
    let q = Mat::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)] * r[(j, j)].signum());
    q.transpose() * l * &q
}

/// Symes: Toda's flow is L(t) = QᵀL₀Q with the QR factors of exp(tL₀).
#[test]
fn toda_in_closed_form() {
    for n in [2, 3, 6] {
        let (flow_n, l) = (IsospectralFlow::toda(n).unwrap(), symmetric(n, 1));
        let exact = by_qr_of(&function(&l, |x| (1.5 * x).exp()), &l);
        let far = [30, 60, 120].map(|s| (flow(&flow_n, 1.5, s, &l) - &exact).norm_l2());
        assert!(far[2] < 1e-6 && (far[1] / far[2]).log2() > 3.7, "n = {n}: {far:?}");
    }
}

/// The QR flow passes through the iterates of the QR algorithm at integer times.
#[test]
fn qr_iterates_at_integer_times() {
    let l = function(&symmetric(4, 2), f64::exp); // positive definite
    let one_step = by_qr_of(&l, &l); // RQ = QᵀLQ
    let qr = IsospectralFlow::qr(4).unwrap();
    let far = (flow(&qr, 1.0, 200, &l) - &one_step).norm_l2();
    assert!(far < 1e-8, "{far:e}");
    // It has no value where L is not positive definite.
    let mut bad = mat![[1.0, 0.0], [0.0, -1.0]];
    let grid = TimeGrid::with_steps([0.0, 1.0], 10).unwrap();
    let (qr, method) = (IsospectralFlow::qr(2).unwrap(), Rkmk::new(RK4, Exp));
    let failed = integrate(&qr, &method, &grid, &SaveAt::Ends, &mut bad, |_, _| {});
    assert!(failed.unwrap_err().to_string().contains("not finite at stage 1"));
}

#[test]
fn orders() {
    let l = symmetric(4, 3);
    has_order_4(&IsospectralFlow::toda(4).unwrap(), &l, 1.0, 16);
    has_order_4(&IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0, 4.0]).unwrap(), &l, 0.5, 16);
    has_order_4(&IsospectralFlow::qr(4).unwrap(), &function(&l, f64::exp), 1.0, 16);
}

/// Eigenvalues to rounding over 10 000 steps, where a classical method loses them.
#[test]
fn eigenvalues_are_kept_to_rounding() {
    for system in [
        IsospectralFlow::toda(5).unwrap(),
        IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap(),
    ] {
        let l = symmetric(5, 4);
        let end = flow(&system, 100.0, 10_000, &l);
        assert!(spectra_differ(&end, &l) < 1e-12, "{:e}", spectra_differ(&end, &l));
        keeps_its_invariants(&system, &l, 10.0, 1000, 0.0);
        let classical = run(&system, &Rk(RK4), 5.0, 50, &l);
        assert!(spectra_differ(&classical, &l) > 1e-9);
        // Symmetric to rounding, and diagonal: sorted as the flow promises.
        let off: f64 = (&end - end.transpose()).norm_l2();
        assert!(off < 1e-12, "{off:e}");
    }
}

#[test]
fn they_sort() {
    let q = MatrixGroup::so(4).unwrap().sample_element(&mut Pcg64::seed_from_u64(5));
    let mut values = vec![-1.0, 0.5, 1.5, 3.0];
    let l = Mat::from_fn(4, 4, |i, j| q[(i, j)] * values[j]) * q.transpose();
    let l = (&l + l.transpose()) * faer::Scale(0.5);
    let diagonal = |l: &Mat<f64>| (0..4).map(|i| l[(i, i)]).collect::<Vec<_>>();
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    let brockett = IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0, 4.0]).unwrap();
    let up = diagonal(&flow(&brockett, 60.0, 3000, &l));
    assert!(close(&up, &values), "{up:?} {values:?}");
    values.reverse();
    let down = diagonal(&flow(&IsospectralFlow::toda(4).unwrap(), 60.0, 3000, &l));
    assert!(close(&down, &values), "{down:?} {values:?}");
}

/// Two particles of Toda's lattice meet and part: momenta are exchanged, −½p are the eigenvalues; and
/// L follows Hamilton's equations.
#[test]
fn the_toda_lattice() {
    let (q, p) = ([-1.0, 0.2, 0.9], [0.8, -0.1, -0.7]);
    let l = toda_lattice(&q, &p).unwrap();
    // One small step of Hamilton's equations, by their slopes.
    let force = |i: usize| (q[i] - q[i + 1]).exp();
    let slopes = [-force(0), force(0) - force(1), force(1)];
    let h = 1e-5;
    let moved = toda_lattice(
        &core::array::from_fn::<_, 3, _>(|i| q[i] + h * p[i]),
        &core::array::from_fn::<_, 3, _>(|i| p[i] + h * slopes[i]),
    )
    .unwrap();
    let toda = IsospectralFlow::toda(3).unwrap();
    let far = (flow(&toda, h, 1, &l) - &moved).norm_l2();
    assert!(far < 10.0 * h * h, "{far:e}");
    let end = flow(&toda, 60.0, 6000, &l);
    assert!(end[(0, 0)] > end[(1, 1)] && end[(1, 1)] > end[(2, 2)]);
    assert!(end[(1, 0)].abs() < 1e-6 && end[(2, 1)].abs() < 1e-6, "the particles have parted");
    assert!(toda_lattice(&q, &p[..2]).is_err() && toda_lattice(&[f64::NAN], &[0.0]).is_err());
    let apart = toda_lattice(&[3000.0, 0.0], &[0.0; 2]).unwrap_err().to_string();
    assert!(apart.contains("two neighbours = 3000"), "{apart}");
}
