//! A step allocates nothing, on either layer, with any map and action, at any n.

use faer::Mat;
use lieflow::actions::{Coadjoint, Conjugation, Lagrangian, LeftTranslation, Linear, Pair};
use lieflow::groups::{AlgebraMatrix, LieGroup, MatrixGroup, Power, Product, Sample, Translations};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::{Flow, PointOf, RigidBody};
use lieflow::{CoordinateMap, LieAlgebra, Problem, SaveAt, TimeGrid, integrate};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::of_steps;
use crate::counting;

#[test]
fn every_group_and_action() {
    for n in [2usize, 3, 4, 6, 8, 10, 20, 50, 100, 150] {
        for group in [MatrixGroup::so(n), MatrixGroup::gl(n), MatrixGroup::indefinite(n - 1, 1)]
            .into_iter()
            .chain((n % 2 == 0).then(|| MatrixGroup::sp(n)))
        {
            let group = group.expect("a group");
            let mut rng = Pcg64::seed_from_u64(n as u64);
            for size in [0.1, 30.0] {
                let compact = group.name().starts_with("SO(") && !group.name().contains(',');
                let size = if compact { size } else { 0.1 };
                let direction = group.sample_algebra(&mut rng, 1.0);
                let mut u = group.zero();
                group.axpy(size / group.norm(&direction), &direction, &mut u);
                let x = group.sample_vector(&mut rng);
                let g = group.identity();
                let m = group.sample_algebra(&mut rng, 1.0).into_mat();
                macro_rules! check {
                    ($action:expr, $y:expr) => {{
                        // Large enough for every branch of exp and dexp⁻¹.
                        let problem =
                            Flow::of_time(group.clone(), $action, |_, v| v.copy_from(&*u));
                        for (name, count) in [
                            ("exp", of_steps(&problem, &Rkmk::new(RK4, Exp), &$y)),
                            ("cay", of_steps(&problem, &Rkmk::new(RK4, Cay), &$y)),
                        ] {
                            assert_eq!(count, 0, "{name} on {} at {size}", group.name());
                        }
                    }};
                }
                check!(LeftTranslation, g);
                check!(Linear, x);
                check!(Coadjoint, m);
            }
        }
    }
}

/// A run to t = 1 with this many output times between its steps: the allocations.
fn allocations_beside<P: Problem>(problem: &P, y: &PointOf<P>, times: usize) -> usize
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
{
    let grid = TimeGrid::with_steps([0.0, 1.0], 10).expect("a grid");
    let save = SaveAt::Times((0..times).map(|i| (i as f64 + 0.5) / times as f64).collect());
    let (mut y, method) = (y.clone(), Rkmk::new(RK4, Exp));
    let before = counting::total();
    let stats = integrate(problem, &method, &grid, &save, &mut y, |_, _| {}).expect("a run");
    let count = counting::total() - before;
    assert_eq!(stats.points_within, times as u64);
    count
}

/// A step aside, to a time between two steps, is a step like the others.
#[test]
fn steps_aside() {
    macro_rules! check {
        ($group:expr, $action:expr, $u:expr, $y:expr) => {
            let (group, u, y) = ($group, $u, $y);
            let field = |_: f64, v: &mut _| {
                group.set_zero(v);
                group.axpy(1.0, &u, v);
            };
            let problem = Flow::of_time(group.clone(), $action, field);
            let (few, many) =
                (allocations_beside(&problem, &y, 4), allocations_beside(&problem, &y, 300));
            assert_eq!(few, many, "{} on {}", stringify!($action), group.name());
        };
    }
    let mut rng = Pcg64::seed_from_u64(6);
    let so5 = &MatrixGroup::so(5).expect("SO(5)");
    let u = so5.sample_algebra(&mut rng, 0.1);
    let (m, x) = (u.clone().into_mat(), so5.sample_vector(&mut rng));
    check!(so5, LeftTranslation, u.clone(), so5.identity());
    check!(so5, Linear, u.clone(), x.clone());
    check!(so5, Coadjoint, u.clone(), m.clone());
    check!(so5, Conjugation, u.clone(), m.clone());
    let sp4 = &MatrixGroup::sp(4).expect("Sp(4)");
    check!(sp4, Lagrangian, sp4.sample_algebra(&mut rng, 0.1), Mat::identity(2, 2));
    let (one, shift) = (so5.identity(), Translations::new(Mat::zeros(2, 2), 4));
    let pair = &Product(so5.clone(), shift.clone());
    let (uu, zero) = ((u.clone(), shift.zero()), shift.zero());
    check!(pair, LeftTranslation, uu.clone(), (one, zero.clone()));
    check!(pair, Pair(Coadjoint, Linear), uu.clone(), (m.clone(), zero));
    let power = &Power::new(so5.clone(), 2).expect("SO(5)²");
    let two: Box<[AlgebraMatrix]> = vec![u.clone(), u].into();
    check!(power, Linear, two.clone(), vec![x.clone(), x].into());
    check!(power, Coadjoint, two.clone(), vec![m.clone(), m].into());
}

/// The driver allocates before the first step only.
#[test]
fn a_long_run_allocates_as_often_as_a_short_one() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let run = |steps| {
        let grid = TimeGrid::with_steps([0.0, 1.0], steps).expect("a grid");
        let mut m = Vector3::new(0.2, 0.5, 3.0);
        let before = counting::total();
        let method = Rkmk::new(RK4, Exp);
        integrate(&body, &method, &grid, &SaveAt::Every(7), &mut m, |_, _| {}).expect("a run");
        counting::total() - before
    };
    assert_eq!(run(10), run(10_000));
}
