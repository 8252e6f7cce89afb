//! A field in the body frame and the same field in space are one motion.

use lieflow::groups::{Adjoint, LieGroup, MatrixGroup, Sample, Se3, Se23, So3, UnitQuaternions};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::methods::tableau::DOP853;
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
