//! Elliptic functions and integrals: Carlson's R_C, R_F and R_J, and Jacobi's sn, cn and dn.

use crate::error::{Error, StepError};

fn converged(x: Result<f64, &'static str>) -> Result<f64, Error> {
    x.map_err(|_| StepError::NotConverged { what: "Carlson's elliptic integral" }.into())
}

/// Carlson's R_C(x, y).
pub(crate) fn rc(x: f64, y: f64) -> Result<f64, Error> {
    converged(ellip::elliprc(x, y))
}

/// Carlson's R_F(x, y, z), of the first kind.
pub(crate) fn rf(x: f64, y: f64, z: f64) -> Result<f64, Error> {
    converged(ellip::elliprf(x, y, z))
}

/// Carlson's R_J(x, y, z, p), of the third kind.
pub(crate) fn rj(x: f64, y: f64, z: f64, p: f64) -> Result<f64, Error> {
    converged(ellip::elliprj(x, y, z, p))
}

/// The arithmetic-geometric mean of 1 and k' = √(1 − k²). It gives sn, cn and dn at any u.
///
/// The argument is k', so that k → 1 keeps its digits. Source: R. Bulirsch, Numerical calculation of
/// elliptic integrals and elliptic functions, Numer. Math. 7 (1965): the descending Gauss transformation.
#[derive(Clone, Debug)]
pub(crate) struct Ladder {
    /// Both means at each level.
    means: [(f64, f64); LEVELS],
    levels: usize,
    /// The mean that they come to.
    last: f64,
}

/// The smallest k' of f64 needs fewer.
const LEVELS: usize = 16;

impl Ladder {
    /// The means of k'.
    pub(crate) fn new(kc: f64) -> Self {
        let mut ladder = Ladder { means: [(0.0, 0.0); LEVELS], levels: 0, last: 1.0 };
        let (mut a, mut b) = (1.0, kc);
        if kc == 0.0 {
            return ladder;
        }
        for level in &mut ladder.means {
            *level = (a, b);
            ladder.levels += 1;
            ladder.last = 0.5 * (a + b);
            if (a - b).abs() <= 1e-9 * a {
                break;
            }
            b = (a * b).sqrt();
            a = ladder.last;
        }
        ladder
    }

    /// sn, cn, dn of u.
    pub(crate) fn jacobi(&self, u: f64) -> (f64, f64, f64) {
        if self.levels == 0 {
            let cn = 1.0 / u.cosh();
            return (u.tanh(), cn, cn);
        }
        let (s, k) = (self.last * u).sin_cos();
        if s == 0.0 {
            return (s, k, 1.0);
        }
        let mut dn = 1.0;
        let mut ratio = k / s;
        let mut cot = self.last * ratio;
        for &(mean, root) in self.means[..self.levels].iter().rev() {
            ratio *= cot;
            cot *= dn;
            dn = (root + ratio) / (mean + ratio);
            ratio = cot / mean;
        }
        let sn = (1.0 / (cot * cot + 1.0).sqrt()).copysign(s);
        (sn, cot * sn, dn)
    }
}
