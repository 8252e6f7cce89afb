//! Lyapunov exponents: of linear systems in closed form, of Lorenz's, and the sum that is exact.

use super::*;
use faer::{Mat, mat};
use lieflow::problems::Lyapunov;

/// A vector field with its Jacobian.
trait Field: Fn(f64, &Mat<f64>, &mut Mat<f64>, &mut Mat<f64>) {}
impl<F: Fn(f64, &Mat<f64>, &mut Mat<f64>, &mut Mat<f64>)> Field for F {}

fn linear(a: Mat<f64>) -> Lyapunov<impl Field> {
    Lyapunov::new(a.nrows(), move |_, x: &Mat<f64>, dx: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
        dx.copy_from(&a * x);
        jacobian.copy_from(&a);
    })
    .unwrap()
}

fn lorenz() -> Lyapunov<impl Field> {
    Lyapunov::new(3, |_, u: &Mat<f64>, du: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
        let (x, y, z) = (u[(0, 0)], u[(1, 0)], u[(2, 0)]);
        let (sigma, rho, beta) = (10.0, 28.0, 8.0 / 3.0);
        du.copy_from(mat![[sigma * (y - x)], [x * (rho - z) - y], [x * y - beta * z]]);
        jacobian.copy_from(mat![[-sigma, sigma, 0.0], [rho - z, -1.0, -x], [y, x, -beta]]);
    })
    .unwrap()
}

/// Y(t) = exp(tA) has R with Π_{i≤k} R_ii = the volume of its first k columns.
#[test]
fn growth_of_a_linear_system() {
    let a = mat![[0.5, 1.0, -0.3], [0.2, -1.0, 0.4], [0.0, 0.7, 0.1]];
    let system = linear(a.clone());
    let start = system.state(&[0.3, -0.2, 0.1]).unwrap();
    has_order_4(&system, &start, 1.0, 16);
    let (q, (sigma, x)) = flow(&system, 2.0, 400, &start);
    let grown = {
        // exp(2A) by 2¹⁰ squarings' worth of a Taylor polynomial.
        let (h, one) = (2.0 / 1024.0, Mat::<f64>::identity(3, 3));
        let mut y = one.clone();
        for k in (1..=10).rev() {
            y = &one + &a * y * faer::Scale(h / f64::from(k));
        }
        (0..10).fold(y, |y, _| &y * &y)
    };
    assert!((&grown * start.1.1.as_ref() - &x).norm_l2() < 1e-9);
    let r = q.transpose() * &grown;
    for i in 0..3 {
        assert!((r[(i, i)].abs().ln() - sigma[(i, 0)]).abs() < 1e-8, "{i}");
        assert!((0..i).all(|j| r[(i, j)].abs() < 1e-8), "R is upper triangular");
    }
    let exponents = system.exponents(2.0, &(q, (sigma, x)));
    assert!((exponents.iter().sum::<f64>() + 0.4).abs() < 1e-9); // tr A
}

/// Lorenz's attractor: 0.906, 0, −14.572 (J. C. Sprott, Chaos and Time-Series Analysis, 2003), and
/// the sum −(σ + 1 + β) exactly.
#[test]
fn lorenzs_attractor() {
    let system = lorenz();
    let (_, (_, x)) = flow(&system, 20.0, 2000, &system.state(&[1.0, 1.0, 20.0]).unwrap());
    let start = system.state(x.col_as_slice(0)).unwrap();
    let end = flow(&system, 300.0, 30_000, &start);
    let exponents = system.exponents(300.0, &end);
    assert!((exponents.iter().sum::<f64>() + 41.0 / 3.0).abs() < 1e-9, "{exponents:?}");
    assert!((exponents[0] - 0.906).abs() < 0.05 && exponents[1].abs() < 0.03, "{exponents:?}");
    assert!((exponents[2] + 14.572).abs() < 0.06, "{exponents:?}");
    let q = &end.0;
    assert!((q.transpose() * q.as_ref() - Mat::<f64>::identity(3, 3)).norm_l2() < 1e-13);
    assert!(system.state(&[1.0]).is_err() && system.state(&[f64::NAN; 3]).is_err());
}
