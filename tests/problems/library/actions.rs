//! The actions and the group that the problems brought: Λ(𝟙, p) = p, Λ(ab, p) = Λ(a, Λ(b, p)).

use super::*;
use faer::Mat;
use lieflow::Action;
use lieflow::actions::{Conjugation, Lagrangian};
use lieflow::groups::{LieGroup, MatrixGroup, Product, Sample, Se3, So3, Translations};
use lieflow::maps::AllMaps;
use lieflow::problems::FromTheBody;
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// To `bound` roundings of the sizes of what is multiplied.
fn is_an_action<G, A>(group: &G, action: &A, p: &A::Point, bound: f64)
where
    G: Sample<Scalar = f64>,
    A: Action<G>,
    A::Point: Metric<Scalar = f64>,
{
    let (mut rng, mut work) = (Pcg64::seed_from_u64(1), action.work(group));
    let mut act = |g: &G::Elem, p: &A::Point| {
        let mut q = p.clone();
        action.act(group, g, p, &mut q, &mut work);
        q
    };
    assert!(act(&group.identity(), p).distance(p) <= bound * EPS * p.size());
    for _ in 0..50 {
        let [a, b] = [(); 2].map(|()| group.sample_element(&mut rng));
        let mut ab = group.identity();
        group.compose(&a, &b, &mut ab);
        let (once, half) = (act(&ab, p), act(&b, p));
        let twice = act(&a, &half);
        let size = |g: &G::Elem| (1.0 + group.distance(g, &group.identity())).powi(4);
        let room = size(&a) * size(&b) * (1.0 + p.size() + half.size() + twice.size()).powi(2);
        let far = once.distance(&twice);
        assert!(far <= bound * EPS * room, "{}: {far:e}", group.name());
    }
}

#[test]
fn actions() {
    let mut rng = Pcg64::seed_from_u64(2);
    for group in [MatrixGroup::so(4), MatrixGroup::gl(3), MatrixGroup::sp(4)] {
        let group = group.unwrap();
        let p = MatrixGroup::gl(group.n()).unwrap().sample_algebra(&mut rng, 1.0).into_mat();
        is_an_action(&group, &Conjugation, &p, 16.0);
        // It keeps the trace, which is the sum of the eigenvalues.
        let (mut q, mut work) = (p.clone(), Conjugation.work(&group));
        let g = group.sample_element(&mut rng);
        Conjugation.act(&group, &g, &p, &mut q, &mut work);
        let trace = |x: &Mat<f64>| (0..x.nrows()).map(|i| x[(i, i)]).sum::<f64>();
        assert!((trace(&p) - trace(&q)).abs() < 1e-12 * g.norm_l2().powi(2));
    }
    let sp = MatrixGroup::sp(4).unwrap();
    let p = Mat::from_fn(2, 2, |i, j| [[0.4, -0.3], [-0.3, 0.1]][i][j]);
    is_an_action(&sp, &Lagrangian, &p, 64.0);
    let se3 = Se3::<f64>::new();
    let m = se3.sample_algebra(&mut rng, 1.0);
    is_an_action(&se3, &FromTheBody, &(se3.sample_element(&mut rng), m), 16.0);
}

/// Translations take every map, as the identity, alone and in products.
#[test]
fn translations() {
    fn every_map_serves<G: AllMaps>(_: &G) {}
    let group = Translations::new(Vector3::<f64>::zeros(), 3);
    every_map_serves(&group);
    every_map_serves(&Product(So3::<f64>::new(), group.clone()));
    let (u, v) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 0.3));
    assert_eq!(Exp.eval(&group, &u), Ok(u));
    assert_eq!(Cay.eval_dpsi_inv(&group, &u, &v), Ok(v));
    let mut sum = group.identity();
    group.compose(&u, &v, &mut sum);
    assert_eq!((sum, group.defect(&sum), group.dim()), (u + v, 0.0, 3));
    group.bracket(&u, &v, &mut sum);
    assert_eq!(sum, Vector3::zeros());
    assert!(Exp.eval(&group, &Vector3::repeat(f64::NAN)).is_err());
    assert_eq!(group.name(), "T(3)");
}
