//! A field in the body frame and the same field in space are one motion.

use lieflow::groups::{Adjoint, LieGroup, MatrixGroup, Sample, Se3, Se23, So3, UnitQuaternions};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::methods::magnus::{Magnus4, Magnus6};
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::prelude::{LeftTranslation, Rkmk, Solve};
use lieflow::problems::Flow;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// f depends on t and on y: f(t, y) = cos(t) a + Ad_y(b)/4, which do not commute.
fn one_motion<G>(group: G)
where
    G: Adjoint + LieGroup<Scalar = f64> + Sample + Clone,
    Exp: CoordinateMap<G>,
{
    let mut rng = Pcg64::seed_from_u64(3);
    let [a, b] = [(); 2].map(|()| group.sample_algebra(&mut rng, 0.4));
    let start = group.sample_element(&mut rng);
    let g = &group;
    let field = |t: f64, y: &G::Elem, v: &mut G::Alg| {
        g.big_ad(y, &b, v).unwrap();
        let turned = v.clone();
        g.combine(1.0, &[t.cos(), 0.25], &[a.clone(), turned], v);
    };
    let in_body = Flow::in_body(group.clone(), field);
    let in_space = Flow::new(group.clone(), LeftTranslation, |t, y: &G::Elem, v: &mut G::Alg| {
        let mut body = g.zero();
        field(t, y, &mut body);
        g.big_ad(y, &body, v).unwrap();
    });
    let method = Rkmk::new(DOP853, Exp);
    let end = |steps| Solve::new(&in_body, &method, [0.0, 2.0]).steps(steps).run(start.clone());
    let body = end(400).unwrap().y;
    let space = Solve::new(&in_space, &method, [0.0, 2.0]).steps(400).run(start.clone()).unwrap().y;
    assert!(group.distance(&body, &space) < 1e-12, "{}", group.name());
    // They are not the motion of the same closure read as a field in space.
    let wrong = Flow::new(group.clone(), LeftTranslation, field);
    let wrong = Solve::new(&wrong, &method, [0.0, 2.0]).steps(400).run(start.clone()).unwrap().y;
    assert!(group.distance(&body, &wrong) > 1e-2, "{}", group.name());
}

#[test]
fn both_frames_are_one_motion_on_every_group() {
    one_motion(So3::<f64>::new());
    one_motion(Se3::<f64>::new());
    one_motion(Se23::<f64>::new());
    one_motion(UnitQuaternions);
    one_motion(MatrixGroup::so(4).unwrap());
    one_motion(MatrixGroup::gl(3).unwrap());
}

/// f(t) in the body is a linear equation: Magnus methods have their order, on every group.
fn is_linear<G>(group: G)
where
    G: Adjoint + LieGroup<Scalar = f64> + Sample + Clone,
    Exp: CoordinateMap<G>,
{
    let mut rng = Pcg64::seed_from_u64(4);
    let [a, b] = [(); 2].map(|()| group.sample_algebra(&mut rng, 0.5));
    let start = group.sample_element(&mut rng);
    let field = |t: f64, _: &G::Elem, v: &mut G::Alg| {
        group.combine(1.0, &[t.cos(), t], &[a.clone(), b.clone()], v);
    };
    let flow = Flow::in_body(group.clone(), field).linear();
    let fine = Rkmk::new(DOP853, Exp);
    let fine = Solve::new(&flow, &fine, [0.0, 1.0]).steps(200).run(start.clone()).unwrap().y;
    macro_rules! order {
        ($method:expr, $order:expr) => {
            let error = |steps| {
                let run = Solve::new(&flow, &$method, [0.0, 1.0]).steps(steps).run(start.clone());
                group.distance(&run.unwrap().y, &fine)
            };
            let order = (error(8) / error(16)).log2();
            assert!((order - $order).abs() < 0.4, "{}: {order} of {}", group.name(), $order);
        };
    }
    order!(Magnus4, 4.0);
    order!(Magnus6, 6.0);
}

#[test]
fn a_field_of_time_in_the_body_is_linear() {
    is_linear(So3::<f64>::new());
    is_linear(Se3::<f64>::new());
    is_linear(UnitQuaternions);
    is_linear(MatrixGroup::so(4).unwrap());
    is_linear(MatrixGroup::gl(3).unwrap());
}

/// The place of a vehicle says nothing of its twist: far from the origin the steps are those at the origin.
#[test]
fn steps_do_not_depend_on_the_place() {
    use nalgebra::{Matrix3, Vector3};
    let twist = |t: f64, _: &_, v: &mut (Vector3<f64>, Vector3<f64>)| {
        *v = (Vector3::new(0.2, t.sin(), 1.0), Vector3::new(1.0, 0.1 * t.cos(), 0.0));
    };
    let vehicle = Flow::in_body(Se3::new(), twist);
    let method = Rkmk::new(DOPRI5, Exp);
    let from = |place: f64| {
        let start = (Matrix3::identity(), Vector3::repeat(place));
        Solve::new(&vehicle, &method, [0.0, 20.0]).tolerances(1e-9, 1e-9).run(start).unwrap()
    };
    let (near, far) = (from(1.0), from(5e6));
    let [few, many] = [&near, &far].map(|run| run.stats.accepted);
    assert!(10 * many < 12 * few, "{few} steps, and {many} far away");
    let moved = |run: &lieflow::Solution<(Matrix3<f64>, Vector3<f64>)>, place| {
        run.y.1 - Vector3::repeat(place)
    };
    assert!((moved(&near, 1.0) - moved(&far, 5e6)).norm() < 1e-3);
    // A matrix that grows takes the steps of its field.
    let sp = MatrixGroup::sp(2).unwrap();
    let growing =
        Flow::in_body(sp.clone(), |t: f64, _: &_, v: &mut lieflow::groups::AlgebraMatrix| {
            (v[(0, 0)], v[(1, 1)], v[(0, 1)], v[(1, 0)]) = (1.0, -1.0, 0.3 * t.cos(), 0.3);
        });
    let solve = Solve::new(&growing, &method, [0.0, 16.0]).tolerances(1e-9, 1e-9);
    let run = solve.run(sp.identity()).unwrap();
    assert!(run.y[(0, 0)].abs() > 1e6 && run.stats.accepted < 1000, "{:?}", run.stats);
}
