//! The groups and maps of this test are those of the library: for the same u and v both have the same
//! results, to the rounding of `f64`; and so have steps of the Lie series.

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, MatrixGroup, Sample};
use lieflow::maps::{CCSK123, CCSK321, Cay, CoordinateMap, Exp, Pade22};
use lieflow::methods::{LieSeries, Method, Metric};
use lieflow::problems::{PointOf, TaylorField};
use lieflow::scalar::Real;
use lieflow::{Action, LieAlgebra, LieGroup, Step};

use super::D;
use super::group::Matrices;
use super::square::Square;
use crate::support::{EPS, Verdict, gap, holds, scale, within};

/// Roundings of some twenty products of n×n matrices.
const ROUNDING: f64 = 40.0 * EPS;

pub(crate) fn wide(x: &Mat<f64>) -> Square {
    Square::from_fn(x.nrows(), |i, j| D::lit(x[(i, j)]))
}
/// ‖ours − library‖ is rounding.
pub(crate) fn near(claim: &str, ours: &Square, library: &Mat<f64>) -> Verdict {
    let ours = Mat::from_fn(ours.n(), ours.n(), |i, j| ours[(i, j)].value());
    within(claim, gap(&ours, library), ROUNDING * library.norm_l2().max(1.0))
}

/// Ψ(u) and dΨ_u⁻¹ v by both, or that neither has the map.
fn same_map<Psi>(
    psi: &Psi,
    library: &MatrixGroup,
    ours: &Matrices,
    [u, v]: [&AlgebraMatrix; 2],
) -> Verdict
where
    Psi: CoordinateMap<MatrixGroup> + CoordinateMap<Matrices>,
{
    let name = format!("{} on {}", CoordinateMap::<Matrices>::name(psi), ours.name());
    let Ok(g) = psi.eval(library, u) else {
        return match CoordinateMap::<Matrices>::at(psi, ours) {
            Err(_) => Ok(()),
            Ok(_) => Err(format!("{name}: the library has none")),
        };
    };
    let (u_wide, v_wide) = (wide(u), wide(v));
    let evaluated = |e: lieflow::Error| format!("{name}: {e}");
    near(&name, &psi.eval(ours, &u_wide).map_err(evaluated)?, &g)?;
    let pulled = psi.eval_dpsi_inv(library, u, v).map_err(evaluated)?;
    near(
        &format!("d {name}"),
        &psi.eval_dpsi_inv(ours, &u_wide, &v_wide).map_err(evaluated)?,
        &pulled,
    )
}

#[test]
fn groups_and_maps_are_those_of_the_library() {
    let pairs = [
        (MatrixGroup::so(5).unwrap(), Matrices::so5()),
        (MatrixGroup::gl(3).unwrap(), Matrices::gl3()),
        (MatrixGroup::sp(4).unwrap(), Matrices::sp4()),
        (MatrixGroup::indefinite(3, 1).unwrap(), Matrices::so31()),
    ];
    for (library, ours) in &pairs {
        assert_eq!((library.name(), library.dim()), (ours.name(), ours.dim()));
        holds(20, |rng| {
            // ‖u‖ ≤ 1: well inside of every chart.
            let drawn = [library.sample_algebra(rng, 1.0), library.sample_algebra(rng, 1.0)];
            let [u, v] = drawn.map(|x| {
                let size = library.norm(&x).max(1.0);
                library.algebra(scale(1.0 / size, &x)).unwrap()
            });
            let pair = [&u, &v];
            let (mut expected, mut found) = (library.zero(), ours.zero());
            library.bracket(&u, &v, &mut expected);
            ours.bracket(&wide(&u), &wide(&v), &mut found);
            near("[u, v]", &found, &expected)?;
            // A point that is off the group, and is brought back.
            let g = Exp.eval(library, &u).unwrap();
            let mut off = g.clone();
            off[(1, 0)] += 1e-3;
            let mut narrow = wide(&off);
            let scratch = [&mut ours.identity(), &mut ours.identity()];
            ours.correct(&mut narrow, scratch);
            library.correct(&mut off, [&mut library.identity(), &mut library.identity()]);
            near("correct", &narrow, &off)?;

            same_map(&Exp, library, ours, pair)?;
            same_map(&Exp.truncated(6), library, ours, pair)?;
            same_map(&Cay, library, ours, pair)?;
            same_map(&Pade22, library, ours, pair)?;
            same_map(&CCSK321, library, ours, pair)?;
            same_map(&CCSK123, library, ours, pair)
        })
        .unwrap();
    }
}

/// One step of the Lie series of each order by the library and here. Each term must be far above rounding.
pub(crate) fn same_steps<P, Q>(
    (library, start): (&P, PointOf<P>),
    matrix: impl Fn(&PointOf<P>) -> &Mat<f64>,
    (ours, start_here): (Q, Square),
    h: f64,
) where
    P: TaylorField<Group = MatrixGroup>,
    Q: TaylorField<Group = Matrices, Action: Action<Matrices, Point = Square>>,
{
    let mut before = ours.group().zero();
    for order in 8..=16 {
        let (method, claim) =
            (LieSeries::new(order).unwrap(), format!("order {order} on {}", ours.group().name()));
        let mut here = start_here;
        let mut work = method.work(&ours, &here).unwrap();
        let step = Step { n: 0, t: D::lit(0.0), h: D::lit(h) };
        method.step(&ours, step, &mut here, &mut work).unwrap();
        let mut there = start.clone();
        let mut work = method.work(library, &there).unwrap();
        method.step(library, Step { n: 0, t: 0.0, h }, &mut there, &mut work).unwrap();
        near(&claim, &here, matrix(&there)).unwrap();
        assert!(here.distance(&before).value() > 1e-10, "{claim}");
        before = here;
    }
}
