//! A step on a product, a power, SE(3) or of a problem allocates nothing, nor does taking it back to M.

use faer::{Mat, mat};
use lieflow::actions::{Coadjoint, Conjugation, Each, Lagrangian, LeftTranslation, Linear, Pair};
use lieflow::groups::{
    AlgebraMatrix, LieGroup, MatrixGroup, Power, Product, Sample, Se3, So3, Translations,
};
use lieflow::maps::{CCSK, Cay, Ccsk, Exp, Pade22};
use lieflow::methods::{CommutatorFree, LieSeries, Rkmk, commutator_free::CF4, tableau::RK4};
use lieflow::problems::{
    BodyMotion, BodyTorque, ChargedParticle, Euler, Flow, HeavyTop, IsospectralFlow, Kinetic, Oja,
    SphericalPendulum, SpinChain, TorqueBody, four_velocity, toda_lattice,
};
use lieflow::{Action, CoordinateMap};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::of_steps;

fn check<G: Sample<Scalar = f64> + Clone, A: Action<G>>(group: &G, action: A, y: A::Point)
where
    Exp: CoordinateMap<G>,
    Cay: CoordinateMap<G>,
    Pade22: CoordinateMap<G>,
    Ccsk<0, 1, 2>: CoordinateMap<G>,
    Ccsk<2, 1, 0>: CoordinateMap<G>,
{
    let u = group.sample_algebra(&mut Pcg64::seed_from_u64(1), 0.3);
    let name = group.name();
    let field = |_: f64, v: &mut G::Alg| {
        group.set_zero(v);
        group.axpy(1.0, &u, v);
    };
    let problem = Flow::of_time(group.clone(), action, field);
    assert_eq!(of_steps(&problem, &Rkmk::new(RK4, Exp), &y), 0, "exp on {name}");
    assert_eq!(of_steps(&problem, &Rkmk::new(RK4, Cay), &y), 0, "cay on {name}");
    assert_eq!(of_steps(&problem, &Rkmk::new(RK4, Pade22), &y), 0, "pade22 on {name}");
    assert_eq!(of_steps(&problem, &Rkmk::new(RK4, CCSK), &y), 0, "ccsk on {name}");
    assert_eq!(of_steps(&problem, &CommutatorFree(CF4), &y), 0, "cf4 on {name}");
}

#[test]
fn products_powers_and_motions() {
    let mut rng = Pcg64::seed_from_u64(2);
    let power = Power::new(So3::<f64>::new(), 20).expect("a power");
    check(&power, LeftTranslation, power.identity());
    check(&power, Linear, power.sample_vector(&mut rng));
    check(&power, Coadjoint, power.sample_vector(&mut rng));
    check(&power, Each(LeftTranslation), power.identity());

    let product = Product(So3::<f64>::new(), MatrixGroup::sp(4).expect("a group"));
    let x = product.sample_vector(&mut rng);
    check(&product, LeftTranslation, product.identity());
    check(&product, Pair(Coadjoint, LeftTranslation), (x.0, product.1.identity()));
    check(&product, Linear, x);

    let motions = Se3::<f64>::new();
    check(&motions, LeftTranslation, motions.identity());
    check(&motions, Coadjoint, motions.sample_algebra(&mut rng, 1.0));
}

/// Vectors, rotations and numbers, as many as there are of each.
#[test]
fn unlike_parts() {
    type Many = Box<[Vector3<f64>]>;
    let so3 = So3::<f64>::new();
    let powers = [Power::none(so3), Power::new(so3, 3).expect("a power")];
    for (vectors, rotations, numbers) in [(1, 1, 5), (1, 0, 0), (0, 1, 2), (0, 0, 1)] {
        let (vectors, rotations) = (powers[vectors], powers[rotations]);
        let zero: Box<[f64]> = vec![0.0; numbers].into();
        let start =
            (vectors.sample_vector(&mut Pcg64::seed_from_u64(4)), (rotations.identity(), zero));
        let translations = Translations::new(start.1.1.clone(), numbers);
        let group = Product(vectors, Product(rotations, translations));
        let field = |t: f64, v: &mut (Many, (Many, Box<[f64]>))| {
            v.0.iter_mut().chain(&mut *v.1.0).for_each(|v| *v = Vector3::new(t, 1.0, -0.5));
            v.1.1.fill(1.0);
        };
        let problem = Flow::of_time(group, Pair(Linear, LeftTranslation), field);
        assert_eq!(of_steps(&problem, &Rkmk::new(RK4, Exp), &start), 0);
        assert_eq!(of_steps(&problem, &CommutatorFree(CF4), &start), 0);
    }
}

#[test]
fn problems() {
    let rkmk4 = Rkmk::new(RK4, Exp);
    macro_rules! none {
        ($problem:expr, $y:expr) => {
            assert_eq!(of_steps(&$problem, &rkmk4, &$y), 0, stringify!($problem))
        };
    }
    let v = |x: f64| Vector3::new(x, 0.5, -0.3);
    let pair = (v(0.2), v(1.0));
    let top = HeavyTop::new([1.0, 2.0, 2.5], [0.1, 0.2, 0.3]).expect("a top").problem();
    none!(top, pair);
    assert_eq!(of_steps(&top, &LieSeries::new(8).expect("an order"), &pair), 0, "a top's series");
    let kirchhoff = Kinetic(|m: &(Vector3<f64>, Vector3<f64>), u: &mut (_, _)| *u = *m);
    let euler = Euler::new(Se3::<f64>::new(), kirchhoff);
    none!(euler, pair);
    none!(euler.with_group(), (Se3::<f64>::new().identity(), pair));
    for group in [MatrixGroup::gl(3), MatrixGroup::sp(4), MatrixGroup::indefinite(3, 1)] {
        let group = group.expect("a group");
        let m = group.sample_algebra(&mut Pcg64::seed_from_u64(3), 0.3);
        let inverse = |m: &Mat<f64>, xi: &mut AlgebraMatrix| xi.copy_from(m);
        let start = (group.identity(), m.into_mat());
        none!(Euler::new(group, Kinetic(inverse)).with_group(), start);
    }
    let damping = BodyTorque(|at: &BodyMotion| -at.omega_body);
    let body = TorqueBody::new([1.0, 2.0, 2.5], damping).expect("a body");
    none!(body, (Matrix3::identity(), v(1.0)));
    none!(SphericalPendulum::new(1.0).expect("a pendulum"), pair);
    let chain = SpinChain::new(50).expect("a chain").with_damping(0.1).expect("a chain");
    none!(chain, chain.spins(|i| v(i as f64)).expect("spins"));

    let l = toda_lattice(&[0.0, 0.1, 0.2], &[0.3, 0.1, 0.2]).expect("a lattice");
    none!(IsospectralFlow::toda(3).expect("a flow"), l);
    none!(IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0]).expect("a flow"), l);
    let positive = mat![[3.0, 0.3, 0.1], [0.3, 2.0, 0.2], [0.1, 0.2, 1.0]];
    none!(IsospectralFlow::qr(3).expect("a flow"), positive);
    none!(Oja::new(l.clone(), 2).expect("a flow"), mat![[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
    let particle = ChargedParticle::new(1.0, |_, _: &_| (v(0.1), v(0.2))).expect("a particle");
    none!(particle, four_velocity([0.1, 0.2, 0.3]).expect("a velocity"));
    let sp4 = MatrixGroup::sp(4).expect("a group");
    check(&sp4, Lagrangian, Mat::identity(2, 2));
    let gl3 = MatrixGroup::gl(3).expect("a group");
    check(&gl3, Conjugation, l);
}
