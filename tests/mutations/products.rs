//! Product groups that are broken on purpose: a part's bracket is dropped, or the parts' actions are
//! swapped. What holds of the whole one must fail on each.

use lieflow::actions::Linear;
use lieflow::check::laws;
use lieflow::groups::{Product, Sample, So3};
use lieflow::maps::Exp;
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::Flow;
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, SaveAt, StepError, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

type V = Vector3<f64>;
type Whole = Product<So3, So3>;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    DroppedBracket,
    SwappedAction,
    SwappedProduct,
    WrongTangent,
    WrongVelocity,
    KeptCombination,
    ShortCombination,
    WrongShortcut,
    ForgetfulShortcut,
    MovingCorrection,
    MovingVectors,
}

/// SO(3) × SO(3) with a fault.
#[derive(Clone)]
struct Broken(Whole, Fault);

impl Broken {
    fn new(fault: Fault) -> Self {
        Broken(Product(So3::new(), So3::new()), fault)
    }
}

impl LieAlgebra for Broken {
    type Scalar = f64;
    type Alg = (V, V);
    fn name(&self) -> String {
        format!("{:?}", self.1)
    }
    fn dim(&self) -> usize {
        6
    }
    fn zero(&self) -> (V, V) {
        self.0.zero()
    }
    fn set_zero(&self, u: &mut (V, V)) {
        self.0.set_zero(u);
    }
    fn axpy(&self, a: f64, x: &(V, V), y: &mut (V, V)) {
        self.0.axpy(a, x, y);
    }
    fn bracket(&self, u: &(V, V), v: &(V, V), out: &mut (V, V)) {
        self.0.bracket(u, v, out);
        if self.1 == Fault::DroppedBracket {
            out.1 = V::zeros();
        }
    }
    fn combine(&self, h: f64, weights: &[f64], terms: &[(V, V)], u: &mut (V, V)) {
        let kept = u.1;
        self.0.combine(h, weights, terms, u);
        match self.1 {
            Fault::KeptCombination => u.1 += kept,
            Fault::ShortCombination => {
                *u = (h * weights[0] * terms[0].0, h * weights[0] * terms[0].1)
            }
            _ => {}
        }
    }
    fn norm(&self, u: &(V, V)) -> f64 {
        self.0.norm(u)
    }
    fn is_finite(&self, u: &(V, V)) -> bool {
        self.0.is_finite(u)
    }
}

impl LieGroup for Broken {
    type Elem = (Matrix3<f64>, Matrix3<f64>);
    type Vector = (V, V);
    fn identity(&self) -> Self::Elem {
        self.0.identity()
    }
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem) {
        self.0.compose(a, b, out);
        if self.1 == Fault::SwappedProduct {
            core::mem::swap(&mut out.0, &mut out.1);
        }
    }
    fn apply(&self, g: &Self::Elem, x: &(V, V), y: &mut (V, V)) {
        match self.1 {
            Fault::SwappedAction => self.0.apply(&(g.1, g.0), x, y),
            _ => self.0.apply(g, x, y),
        }
    }
    fn tangent(&self, v: &(V, V), g: &Self::Elem, out: &mut Self::Elem) {
        match self.1 {
            Fault::WrongTangent => self.0.tangent(&(v.0, -v.1), g, out),
            _ => self.0.tangent(v, g, out),
        }
    }
    fn apply_algebra(&self, v: &(V, V), x: &(V, V), y: &mut (V, V)) {
        match self.1 {
            Fault::WrongVelocity => self.0.apply_algebra(&(v.0, -v.1), x, y),
            _ => self.0.apply_algebra(v, x, y),
        }
    }
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> f64 {
        self.0.distance(a, b)
    }
    fn defect(&self, g: &Self::Elem) -> f64 {
        self.0.defect(g)
    }
    fn correct(&self, g: &mut Self::Elem, _: [&mut Self::Elem; 2]) -> f64 {
        if self.1 == Fault::MovingCorrection {
            g.1[(0, 1)] += 1e-9;
        }
        0.0
    }
    fn correct_vector(&self, _: &(V, V), x: &mut (V, V)) -> Option<f64> {
        if self.1 == Fault::MovingVectors {
            x.1 *= 1.0 + 1e-9;
        }
        Some(0.0)
    }
}

impl Sample for Broken {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> (V, V) {
        self.0.sample_algebra(rng, sigma)
    }
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Elem {
        self.0.sample_element(rng)
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> (V, V) {
        self.0.sample_vector(rng)
    }
}

impl CoordinateMap<Broken> for Exp {
    type At = <Exp as CoordinateMap<Whole>>::At;
    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &Broken) -> Result<Self::At, Error> {
        CoordinateMap::<Whole>::at(self, &group.0)
    }
    fn psi(
        &self,
        group: &Broken,
        u: &(V, V),
        at: &mut Self::At,
        g: &mut (Matrix3<f64>, Matrix3<f64>),
    ) -> Result<(), StepError> {
        CoordinateMap::<Whole>::psi(self, &group.0, u, at, g)
    }
    fn psi_on(
        &self,
        group: &Broken,
        u: &(V, V),
        at: &mut Self::At,
        g: &mut (Matrix3<f64>, Matrix3<f64>),
        x: &(V, V),
        y: &mut (V, V),
    ) -> Result<(), StepError> {
        let mut fresh = self.at(group).expect("storage");
        let at = if group.1 == Fault::ForgetfulShortcut { &mut fresh } else { at };
        self.psi(group, u, at, g)?;
        group.apply(g, x, y);
        if group.1 == Fault::WrongShortcut {
            y.1 += 1e-9 * u.1;
        }
        Ok(())
    }
    fn dpsi_inv(
        &self,
        group: &Broken,
        u: &(V, V),
        at: &mut Self::At,
        v: &mut (V, V),
    ) -> Result<(), StepError> {
        CoordinateMap::<Whole>::dpsi_inv(self, &group.0, u, at, v)
    }
}

/// The names of the laws that do not hold.
fn broken_laws(fault: Fault) -> Vec<String> {
    let mut rng = Pcg64::seed_from_u64(1);
    let found = laws(&Broken::new(fault), &Exp, &mut rng, 50, 0.5).expect("laws");
    found.into_iter().filter(|law| !law.holds()).map(|law| law.name).collect()
}

/// exp(δu) exp(δv) exp(−δu) exp(−δv) = exp(δ²[u, v]) up to δ³: the gap, over δ². The laws of a bracket
/// alone hold of a dropped part too: it is abelian.
fn commutator_gap(fault: Fault) -> f64 {
    let (group, mut rng, delta) = (Broken::new(fault), Pcg64::seed_from_u64(2), 1e-4);
    let (u, v) = (group.sample_algebra(&mut rng, 1.0), group.sample_algebra(&mut rng, 1.0));
    let exp = |a: f64, u: &(V, V)| Exp.eval(&group, &(a * u.0, a * u.1)).expect("exp");
    let mut product = group.identity();
    for factor in [exp(delta, &u), exp(delta, &v), exp(-delta, &u), exp(-delta, &v)] {
        let mut next = group.identity();
        group.compose(&product, &factor, &mut next);
        product = next;
    }
    let mut bracket = group.zero();
    group.bracket(&u, &v, &mut bracket);
    group.distance(&product, &exp(delta * delta, &bracket)) / (delta * delta)
}

/// Two vectors that turn at rates of their own: how far from where they should be.
fn two_spins(fault: Fault) -> f64 {
    let (a, b) = (V::new(0.3, -0.2, 0.9), V::new(-1.1, 0.4, 0.2));
    let field = move |_: f64, v: &mut (V, V)| *v = (a, b);
    let problem = Flow::of_time(Broken::new(fault), Linear, field);
    let (x, y) = (V::new(1.0, 0.5, 0.2), V::new(-0.3, 0.8, 0.1));
    let mut p = (x, y);
    let grid = TimeGrid::with_steps([0.0, 1.0], 20).expect("a grid");
    integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut p, |_, _| {})
        .expect("a run");
    let exact = |u: &V, x: &V| lieflow::so3::exp(u).expect("a rotation") * x;
    (p.0 - exact(&a, &x)).norm() + (p.1 - exact(&b, &y)).norm()
}

#[test]
fn the_whole_product_holds_and_each_fault_is_found() {
    assert_eq!(broken_laws(Fault::None), Vec::<String>::new());
    assert!(two_spins(Fault::None) < 1e-13);

    assert!(commutator_gap(Fault::None) < 1e-2, "{}", commutator_gap(Fault::None));

    assert!(commutator_gap(Fault::DroppedBracket) > 0.5);
    assert!(!broken_laws(Fault::SwappedProduct).is_empty());
    assert!(!broken_laws(Fault::WrongTangent).is_empty());
    assert!(!broken_laws(Fault::WrongVelocity).is_empty());
    for shortcut in [
        Fault::KeptCombination,
        Fault::ShortCombination,
        Fault::WrongShortcut,
        Fault::ForgetfulShortcut,
        Fault::MovingCorrection,
        Fault::MovingVectors,
    ] {
        let found = broken_laws(shortcut);
        assert!(found.len() == 1 && found[0].starts_with("shortcuts"), "{shortcut:?}: {found:?}");
    }
    assert!(two_spins(Fault::SwappedAction) > 0.1);
}
