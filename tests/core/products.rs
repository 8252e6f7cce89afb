//! Products and powers of groups: the parts agree with each group alone, every map of the catalog by its name, actions put together and taken back to M part by part.

use crate::support::orders::{flow, measure, reference, start, wave};
use crate::support::points::Points;
use crate::support::{EPS, named};
use lieflow::actions::{Coadjoint, Each, LeftTranslation, Linear, Pair};
use lieflow::catalog::MethodSpec;
use lieflow::groups::{Adjoint, LieGroup, MatrixGroup, Power, Product, Sample, So3, Translations};
use lieflow::maps::AllMaps;
use lieflow::maps::{self, CCSK123, CCSK321, Cay, CoordinateMap, Exp};
use lieflow::methods::magnus::{CayleyMagnus4, Magnus4, TripleProduct};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::{BodyMotion, BodyTorque, Flow, TorqueBody};
use lieflow::{Action, Error, LieAlgebra, SaveAt, TimeGrid, integrate};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

type So3Sp4 = Product<So3, MatrixGroup>;

fn product() -> So3Sp4 {
    Product(So3::new(), MatrixGroup::sp(4).unwrap())
}
fn power(n: usize) -> Power<So3> {
    Power::new(So3::new(), n).unwrap()
}

/// Two maps on one product have the order of the method; every map alone is in `orders/products.rs`.
#[test]
fn a_pair_of_maps_has_its_order() {
    let flow = flow(product(), LeftTranslation, wave(7, 0.25, 17));
    let exact = reference(&flow, start(&flow, 8));
    let method = Rkmk::new(RK4, maps::Pair(Exp, Cay));
    measure(&flow, &method, &exact).and_then(|e| e.check()).unwrap();
}

/// The maps of the catalog have types on products: its methods run there by name.
#[test]
fn products_are_catalog_groups() {
    fn every_map_serves<G: AllMaps + TripleProduct + Adjoint>(_: &G) {}
    every_map_serves(&product());
    every_map_serves(&power(2));
    every_map_serves(&Product(power(2), product()));
}

/// Methods by name on a product: a damped body on SO(3) × T(3).
#[test]
fn methods_by_name_run_on_products() {
    let damping = BodyTorque(|at: &BodyMotion| -0.2 * at.omega_body);
    let body = TorqueBody::new([1.0, 2.0, 2.5], damping).unwrap();
    let start = body.state(nalgebra::Matrix3::identity(), [0.5, 0.4, -0.8]).unwrap();
    let run = |name: &str, map| {
        named::explicit(&MethodSpec::new(name, map), |method| {
            let (mut y, grid) = (start, TimeGrid::new([0.0, 0.2], 0.01).unwrap());
            integrate(&body, method, &grid, &SaveAt::Ends, &mut y, |_, _| {}).unwrap();
            y
        })
        .expect("a method")
    };
    let exact = run("rk4", None);
    let methods =
        [("cf4", None), ("magnus43", None), ("rkmk4", Some("cay")), ("rkmk4", Some("ccsk"))];
    for (name, map) in methods {
        let y = run(name, map);
        assert!((y.0 - exact.0).norm() + (y.1 - exact.1).norm() < 1e-9, "{name} {map:?}");
    }
}

/// A map without a formula on one of the parts is refused, with the part's reason.
#[test]
fn a_part_can_refuse_a_map() {
    let group = Product(So3::<f64>::new(), MatrixGroup::indefinite(3, 1).unwrap());
    assert!(matches!(CCSK123.at(&group), Err(Error::Unsupported { .. })));
    assert!(matches!(CCSK321.at(&group), Err(Error::Unsupported { .. })));
    let mixed = maps::Pair(CCSK123, Exp);
    assert!(mixed.at(&group).is_ok());
    assert_eq!((name(&mixed, &group), name(&maps::Pair(Exp, Exp), &group)), ("pair", "exp"));
    assert!(matches!(Power::new(So3::<f64>::new(), 0), Err(Error::OutOfRange { .. })));
}

/// What happens in one part is bit for bit what happens in that group alone.
#[test]
fn parts_are_the_groups_alone() {
    let mut rng = Pcg64::seed_from_u64(3);
    let (group, so3, sp4) = (product(), So3::<f64>::new(), MatrixGroup::sp(4).unwrap());
    for _ in 0..100 {
        let u = group.sample_algebra(&mut rng, 0.5);
        let v = group.sample_algebra(&mut rng, 1.0);
        assert_eq!(Exp.eval(&group, &u), Ok((eval(&Exp, &so3, &u.0), eval(&Exp, &sp4, &u.1))));
        let pair = maps::Pair(Cay, Exp);
        assert_eq!(pair.eval(&group, &u), Ok((eval(&Cay, &so3, &u.0), eval(&Exp, &sp4, &u.1))));
        let w = pair.eval_dpsi_inv(&group, &u, &v).unwrap();
        assert_eq!(w.0, Cay.eval_dpsi_inv(&so3, &u.0, &v.0).unwrap());
        assert_eq!(w.1, Exp.eval_dpsi_inv(&sp4, &u.1, &v.1).unwrap());
    }
    let group = power(5);
    let u = group.sample_algebra(&mut rng, 1.0);
    let g = Exp.eval(&group, &u).unwrap();
    for (u, g) in u.iter().zip(&g) {
        assert_eq!(*g, eval(&Exp, &so3, u));
    }
}

/// G⁰ and T(0) as parts change nothing; numbers and pairs of them are translations as vectors are.
#[test]
fn a_part_may_be_empty() {
    let mut rng = Pcg64::seed_from_u64(7);
    let so3 = So3::<f64>::new();
    let nothing: Box<[f64]> = [].into();
    let group = Product(so3, Product(Power::none(so3), Translations::new(nothing, 0)));
    assert_eq!((group.dim(), group.name().as_str()), (3, "SO(3) × SO(3)^0 × T(0)"));
    let [u, v] = [(); 2].map(|()| {
        let mut u = group.zero();
        u.0 = so3.sample_algebra(&mut rng, 1.0);
        u
    });
    macro_rules! is_alone {
        ($psi:expr) => {
            let (g, w) =
                ($psi.eval(&group, &u).unwrap(), $psi.eval_dpsi_inv(&group, &u, &v).unwrap());
            assert_eq!((g.0, g.1.0.len(), g.1.1.len()), (eval(&$psi, &so3, &u.0), 0, 0));
            assert_eq!(w.0, $psi.eval_dpsi_inv(&so3, &u.0, &v.0).unwrap());
        };
    }
    is_alone!(Exp);
    is_alone!(Cay);
    assert_eq!(group.norm(&u), so3.norm(&u.0));

    let pairs = Translations::new((0.0, Box::from([0.0])), 2);
    let g = eval(&Cay, &pairs, &(1.0, Box::from([2.0])));
    let mut y = pairs.identity();
    pairs.apply(&g, &(0.5, Box::from([0.25])), &mut y);
    assert_eq!(y, (1.5, Box::from([2.25])));
    assert_eq!(pairs.norm(&(3.0, Box::from([-4.0]))), 5.0);
    assert!(!pairs.is_finite(&(1.0, Box::from([f64::NAN]))));
}

fn name<G: LieGroup, Psi: CoordinateMap<G>>(psi: &Psi, _: &G) -> &'static str {
    psi.name()
}
fn eval<G: LieGroup, Psi: CoordinateMap<G>>(psi: &Psi, group: &G, u: &G::Alg) -> G::Elem {
    psi.eval(group, u).unwrap()
}

/// ⟨ad*_u m, v⟩ = ⟨m, [u, v]⟩ and ⟨Ad*_g m, v⟩ = ⟨m, Ad_g v⟩ hold for the sums over the parts.
#[test]
fn duals_pair_over_all_parts() {
    fn check<G: Adjoint<Scalar = f64> + Sample>(group: &G, m: G::Dual, rng: &mut Pcg64) {
        let [u, v] = [(); 2].map(|()| group.sample_algebra(rng, 1.0));
        let g = group.sample_element(rng);
        let (mut moved, mut w) = (m.clone(), group.zero());
        let bound = 256.0 * EPS * group.dim() as f64;
        group.coad(&u, &m, &mut moved);
        group.bracket(&u, &v, &mut w);
        assert!((group.pair(&moved, &v) - group.pair(&m, &w)).abs() < bound);
        group.coad_group(&g, &m, &mut moved).unwrap();
        group.big_ad(&g, &v, &mut w).unwrap();
        let size = (1.0 + group.distance(&g, &group.identity())).powi(4);
        assert!((group.pair(&moved, &v) - group.pair(&m, &w)).abs() < bound * size);
    }
    let mut rng = Pcg64::seed_from_u64(5);
    for _ in 0..20 {
        let m = Points::<So3Sp4>::draw(&Coadjoint, &product(), &mut rng);
        check(&product(), m, &mut rng);
        let m = Points::<Power<So3>>::draw(&Coadjoint, &power(4), &mut rng);
        check(&power(4), m, &mut rng);
    }
}

/// Magnus methods, in both coordinates, follow each spin's own equation.
#[test]
fn linear_equations_on_a_power() {
    let turning = |i: usize, t: f64| Vector3::new((t * i as f64).cos(), 0.3 * i as f64, t);
    let field = move |t: f64, v: &mut Box<[Vector3<f64>]>| {
        v.iter_mut().enumerate().for_each(|(i, v)| *v = turning(i, t));
    };
    let spins = Flow::of_time(power(4), Linear, field);
    let grid = TimeGrid::new([0.0, 1.0], 0.125).unwrap();
    let start = Vector3::new(0.0, 0.6, 0.8);
    for cayley in [false, true] {
        let mut x: Box<[Vector3<f64>]> = vec![start; 4].into();
        match cayley {
            false => integrate(&spins, &Magnus4, &grid, &SaveAt::Ends, &mut x, |_, _| {}),
            true => integrate(&spins, &CayleyMagnus4, &grid, &SaveAt::Ends, &mut x, |_, _| {}),
        }
        .unwrap();
        for (i, x) in x.iter().enumerate() {
            let alone = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
                *v = turning(i, t);
            });
            let mut y = start;
            match cayley {
                false => integrate(&alone, &Magnus4, &grid, &SaveAt::Ends, &mut y, |_, _| {}),
                true => integrate(&alone, &CayleyMagnus4, &grid, &SaveAt::Ends, &mut y, |_, _| {}),
            }
            .unwrap();
            assert_eq!(*x, y, "spin {i}");
        }
    }
}

/// Each part is taken back to its group, and the largest residual is what is reported.
#[test]
fn drift_is_corrected_part_by_part() {
    let mut rng = Pcg64::seed_from_u64(9);
    let group = power(3);
    let mut g = group.sample_element(&mut rng);
    let exact = g.clone();
    g[0][(0, 0)] += 1e-9;
    g[2][(1, 2)] += 1e-8;
    let mut work = LeftTranslation.work(&group);
    let residual = LeftTranslation.restore(&group, &mut g, &mut work).unwrap();
    assert!((1e-9..4e-8).contains(&residual), "{residual:e}");
    assert!(group.defect(&g) < 16.0 * EPS, "{:e}", group.defect(&g));
    assert!(group.distance(&g, &exact) < 2e-8);

    // A part that has nothing to restore leaves the other's residual.
    let group = Product(So3::<f64>::new(), So3::new());
    let action = Pair(LeftTranslation, Linear);
    let mut p = (group.0.sample_element(&mut rng), Vector3::new(1.0, 2.0, 3.0));
    p.0[(0, 0)] += 1e-8;
    let mut work = action.work(&group);
    let residual = action.restore(&group, &mut p, &mut work).unwrap();
    assert!(residual > 1e-9 && group.0.defect(&p.0) < 16.0 * EPS);
    let vectors = Pair(Linear, Linear);
    let mut p = (p.1, p.1);
    assert_eq!(vectors.restore(&group, &mut p, &mut vectors.work(&group)), None);
}

/// A field that leaves one part's algebra, and points of the wrong size, are refused before a run.
#[test]
fn what_does_not_fit_a_part_is_refused() {
    let (group, spins) = (product(), power(4));
    let mut u = group.zero();
    group.check("f", &u).unwrap();
    u.1[(0, 0)] = 1.0;
    let error = group.check("f", &u).unwrap_err().to_string();
    assert!(error.starts_with("f: not in the Lie algebra of Sp(4)"), "{error}");
    let short = vec![Vector3::zeros(); 3].into_boxed_slice();
    for refused in [
        spins.check("f", &short),
        Linear.check(&spins, &short),
        Each(Linear).check(&spins, &short),
        Coadjoint.check(&spins, &short),
        LeftTranslation.check(&spins, &power(3).identity()),
    ] {
        let error = refused.unwrap_err().to_string();
        assert!(error.ends_with("3×1, expected 4×1"), "{error}");
    }
    let so5 = MatrixGroup::so(5).unwrap();
    let wrong = (group.0.identity(), so5.identity());
    let refused = Pair(LeftTranslation, LeftTranslation).check(&group, &wrong);
    assert!(refused.unwrap_err().to_string().contains("5×5, expected 4×4"));
    assert!(LeftTranslation.check(&group, &wrong).is_err());
}
