//! The maps as functions have the same names on every group, and are each other's inverses.

use lieflow::groups::{LieAlgebra, MatrixGroup, Sample, Se3, So3, UnitQuaternions, Unitary};
use lieflow::maps::{cay, cay_inv, dcay, dcayinv, dexp, dexpinv, exp, log};
use lieflow::so3::{self, batch};
use lieflow::{Error, LieGroup, StepError};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// ‖u − v‖.
fn distance<G: LieGroup<Scalar = f64>>(group: &G, u: &G::Alg, v: &G::Alg) -> f64 {
    let mut difference = group.zero();
    group.combine(1.0, &[1.0, -1.0], &[u.clone(), v.clone()], &mut difference);
    group.norm(&difference)
}

/// On each group: an expression in small elements u and v of its algebra gives one of them back.
macro_rules! back {
    ($($group:expr),*; |$g:ident, $u:ident, $v:ident| $back:expr => $to:ident) => {$({
        let (group, mut rng) = ($group, Pcg64Mcg::seed_from_u64(7));
        let $g = &group;
        let ($u, $v) = (&$g.sample_algebra(&mut rng, 0.4), &$g.sample_algebra(&mut rng, 1.0));
        let back = $back;
        assert_ne!($u, $v);
        let off = distance($g, &back, $to);
        assert!(off < 1e-13, "{}: {off:e}", $g.name());
    })*};
}

#[test]
fn each_function_has_its_inverse_on_every_group() -> Result<(), Error> {
    let (so5, sp4) = (|| MatrixGroup::so(5), || MatrixGroup::sp(4));
    back!(So3::new(), UnitQuaternions, Se3::new(), so5()?, sp4()?;
        |g, u, v| log(g, &exp(g, u)?)? => u);
    back!(So3::new(), UnitQuaternions, Se3::new(), Unitary::new(3)?, so5()?, sp4()?;
        |g, u, v| dexpinv(g, u, &dexp(g, u, v)?)? => v);
    back!(So3::new(), so5()?, sp4()?; |g, u, v| cay_inv(g, &cay(g, u)?)? => u);
    back!(So3::new(), so5()?, sp4()?; |g, u, v| dcayinv(g, u, &dcay(g, u, v)?)? => v);
    Ok(())
}

type OfPairs = fn([&[f64]; 3], [&[f64]; 3], [&mut [f64]; 3]) -> Result<(), Error>;
type OfTurns = fn([&[f64]; 9], [&mut [f64]; 3]) -> Result<(), Error>;

/// A function of an array does what the function of the same name does on each element.
#[test]
fn arrays_have_the_same_functions() -> Result<(), Error> {
    let (so3, mut rng, n) = (So3::<f64>::new(), Pcg64Mcg::seed_from_u64(11), 70);
    let mut vectors = || (0..n).map(|_| so3.sample_algebra(&mut rng, 1.0)).collect::<Vec<_>>();
    let (u, v) = (vectors(), vectors());
    let columns =
        |list: &[Vector3<f64>]| [0, 1, 2].map(|i| list.iter().map(|u| u[i]).collect::<Vec<f64>>());
    let (us, vs) = (columns(&u), columns(&v));
    let mut w = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for (batch, one) in
        [(batch::dcay as OfPairs, so3::dcay as fn(&_, &_) -> _), (batch::dcayinv, so3::dcayinv)]
    {
        let [us, vs] = [&us, &vs].map(|x| x.each_ref().map(|x| &x[..]));
        batch(us, vs, w.each_mut().map(|w| &mut w[..]))?;
        for i in 0..n {
            assert_eq!(Vector3::new(w[0][i], w[1][i], w[2][i]), one(&u[i], &v[i])?);
        }
    }
    for (batch, one, map) in [
        (
            batch::log as OfTurns,
            so3::log as fn(&_) -> _,
            so3::exp as fn(&Vector3<f64>) -> Result<Matrix3<f64>, StepError>,
        ),
        (batch::cay_inv, so3::cay_inv, so3::cay),
    ] {
        let turns = u.iter().map(map).collect::<Result<Vec<_>, _>>()?;
        let mut rows: [Vec<f64>; 9] =
            core::array::from_fn(|k| turns.iter().map(|g| g[(k / 3, k % 3)]).collect());
        batch(rows.each_ref().map(|x| &x[..]), w.each_mut().map(|w| &mut w[..]))?;
        for i in 0..n {
            // Lanes and the scalar form agree to rounding, as for exp.
            let (lane, one) = (Vector3::new(w[0][i], w[1][i], w[2][i]), one(&turns[i])?);
            let gap = (lane - one).norm() / ((1.0 + one.norm()) * one.norm());
            assert!(gap <= 4.0 * f64::EPSILON, "{lane} beside {one}");
        }
        // What is no rotation is refused with its number.
        rows[0][n - 1] = 7.0;
        let refused = batch(rows.each_ref().map(|x| &x[..]), w.each_mut().map(|w| &mut w[..]));
        assert!(matches!(refused, Err(Error::Element { index, .. }) if index == n - 1));
        let refused = batch(rows.each_ref().map(|x| &x[..]), w.each_mut().map(|w| &mut w[1..]));
        assert!(matches!(refused, Err(Error::Shape { .. })));
    }
    Ok(())
}
