//! What the catalog says that a step costs is what it costs: evaluations of f, Ψ, dΨ⁻¹, commutators and
//! triple products of each method for fields are counted on a group and a field that count.

use std::cell::Cell;

use lieflow::actions::LeftTranslation;
use lieflow::catalog::{
    MethodInfo, MethodSpec, Needs, OnMethod, TABLEAUS, with_implicit_method, with_linear_method,
};
use lieflow::groups::So3;
use lieflow::maps::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use lieflow::methods::{Method, Step, magnus::TripleProduct};
use lieflow::problems::{Ambient, LinearField, Problem};
use lieflow::{Error, LieAlgebra, LieGroup, StepError};
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;
type M = Matrix3<f64>;

/// How often each was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Asked {
    field: u64,
    psi: u64,
    dpsi_inv: u64,
    brackets: u64,
    triples: u64,
}

thread_local! {
    static ASKED: Cell<Asked> = Cell::default();
}

fn count(which: impl FnOnce(&mut Asked)) {
    let mut asked = ASKED.get();
    which(&mut asked);
    ASKED.set(asked);
}

/// SO(3), counting.
struct Counting(So3);

impl LieAlgebra for Counting {
    type Scalar = f64;
    type Alg = V;
    fn name(&self) -> String {
        self.0.name()
    }
    fn dim(&self) -> usize {
        3
    }
    fn zero(&self) -> V {
        self.0.zero()
    }
    fn set_zero(&self, u: &mut V) {
        self.0.set_zero(u);
    }
    fn axpy(&self, a: f64, x: &V, y: &mut V) {
        self.0.axpy(a, x, y);
    }
    fn bracket(&self, u: &V, v: &V, out: &mut V) {
        count(|asked| asked.brackets += 1);
        self.0.bracket(u, v, out);
    }
    fn norm(&self, u: &V) -> f64 {
        self.0.norm(u)
    }
    fn is_finite(&self, u: &V) -> bool {
        self.0.is_finite(u)
    }
}

impl LieGroup for Counting {
    type Elem = M;
    type Vector = V;
    fn identity(&self) -> M {
        self.0.identity()
    }
    fn compose(&self, a: &M, b: &M, out: &mut M) {
        self.0.compose(a, b, out);
    }
    fn apply(&self, g: &M, x: &V, y: &mut V) {
        self.0.apply(g, x, y);
    }
    fn distance(&self, a: &M, b: &M) -> f64 {
        self.0.distance(a, b)
    }
    fn defect(&self, g: &M) -> f64 {
        self.0.defect(g)
    }
}

impl TripleProduct for Counting {
    fn triple(&self, u: &V, v: &V, w: &V, work: &mut V, out: &mut V) {
        count(|asked| asked.triples += 1);
        self.0.triple(u, v, w, work, out);
    }
}

/// Each map of the catalog, counting. `psi_on` is Ψ by default, and is not used on matrices.
macro_rules! counting {
    ($($map:ty),*) => {$(
        impl CoordinateMap<Counting> for $map {
            type At = <$map as CoordinateMap<So3>>::At;
            fn name(&self) -> &'static str {
                CoordinateMap::<So3>::name(self)
            }
            fn order(&self, group: &Counting) -> usize {
                CoordinateMap::<So3>::order(self, &group.0)
            }
            fn at(&self, group: &Counting) -> Result<Self::At, Error> {
                CoordinateMap::<So3>::at(self, &group.0)
            }
            fn psi(&self, group: &Counting, u: &V, at: &mut Self::At, g: &mut M) -> Result<(), StepError> {
                count(|asked| asked.psi += 1);
                CoordinateMap::<So3>::psi(self, &group.0, u, at, g)
            }
            fn dpsi_inv(&self, group: &Counting, u: &V, at: &mut Self::At, v: &mut V) -> Result<(), StepError> {
                count(|asked| asked.dpsi_inv += 1);
                CoordinateMap::<So3>::dpsi_inv(self, &group.0, u, at, v)
            }
        }
    )*};
}
counting!(Exp, TruncatedExp, Cay, Pade22, Ccsk<0, 1, 2>, Ccsk<2, 1, 0>);

/// A field that counts: one that looks at the state, or one of time alone.
struct Watched(Counting);

impl Problem for Watched {
    type Group = Counting;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &Counting {
        &self.0
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    fn f(&self, t: f64, g: &M, v: &mut V, _: &mut ()) {
        count(|asked| asked.field += 1);
        *v = V::new(t.cos(), g[(0, 1)], 0.5);
    }
}

impl Ambient for Watched {
    fn field(&self, t: f64, g: &M, dg: &mut M, _: &mut ()) {
        count(|asked| asked.field += 1);
        *dg = lieflow::groups::hat(&V::new(t.cos(), g[(0, 1)], 0.5)) * g;
    }
    fn copy(&self, x: &M, y: &mut M) {
        *y = *x;
    }
    fn add(&self, a: f64, x: &M, y: &mut M) {
        *y += a * x;
    }
    fn is_finite(&self, y: &M) -> bool {
        y.iter().all(|x| x.is_finite())
    }
}

impl LinearField for Watched {
    fn a(&self, t: f64, v: &mut V, _: &mut ()) {
        count(|asked| asked.field += 1);
        *v = V::new(t.cos(), t, 0.5);
    }
}

/// Take one step and say what it asked for, with the evaluations that the method states.
struct OneStep<'a>(&'a Watched);

impl OnMethod<Watched> for OneStep<'_> {
    type Out = (Asked, Option<u64>);
    fn call<Me: Method<Watched>>(self, method: Me) -> Self::Out {
        let mut y = M::identity();
        let mut work = method.work(self.0, &y).expect("it fits");
        ASKED.set(Asked::default());
        let step = Step { n: 0, t: 0.2, h: 0.1 };
        method.step(self.0, step, &mut y, &mut work).expect("a step");
        (ASKED.get(), method.evaluations(self.0))
    }
}

/// The number before one of these words in a cost such as `4 f, 5 exp`; 1 where none stands before it, 0
/// where the word is missing.
fn stated(cost: &str, words: &[&str]) -> u64 {
    let number = |piece: &str| {
        let (number, word) = piece.split_once(' ').unwrap_or(("1", piece));
        words.contains(&word).then(|| number.parse().expect("a number"))
    };
    cost.split(", ").find_map(number).unwrap_or(0)
}

fn parsed(cost: &str) -> Asked {
    Asked {
        field: stated(cost, &["f", "F", "A"]),
        psi: stated(cost, &["exp", "cay", "Ψ"]),
        dpsi_inv: stated(cost, &["dΨ⁻¹"]),
        brackets: stated(cost, &["bracket", "brackets"]),
        triples: stated(cost, &["triple product", "triple products"]),
    }
}

/// What a step costs that is not asked for its error: that comes after a semicolon.
fn plain(info: &MethodInfo) -> Asked {
    parsed(info.cost.split(';').next().unwrap_or_default())
}

fn one_step(spec: &MethodSpec) -> (Asked, Option<u64>) {
    with_implicit_method(spec, OneStep(&Watched(Counting(So3::new())))).expect("a method")
}

#[test]
fn methods_for_fields() {
    for info in Needs::Field.methods().iter().filter(|info| !info.takes_tableau) {
        let map = info.takes_map.then_some("exp");
        let (asked, evaluations) = one_step(&MethodSpec::new(info.name, map));
        assert_eq!(asked, plain(info), "{}: {}", info.name, info.cost);
        assert_eq!(evaluations, Some(asked.field), "{}", info.name);
    }
}

#[test]
fn methods_for_fields_of_linear_type() {
    for info in Needs::LinearType.methods() {
        let problem = Watched(Counting(So3::new()));
        let (asked, evaluations) =
            with_linear_method(info.name, OneStep(&problem)).expect("a method");
        assert_eq!(asked, plain(info), "{}: {}", info.name, info.cost);
        assert_eq!(evaluations, Some(asked.field), "{}", info.name);
    }
}

/// s f, s Ψ and s − 1 dΨ⁻¹ with every tableau and map; s F on the entries.
#[test]
fn tableaus() {
    for tableau in TABLEAUS {
        for map in ["exp", "cay", "pade22", "ccsk123", "ccsk321", "ccsk"] {
            let spec = MethodSpec::new("rkmk", Some(map));
            let spec = MethodSpec { tableau: Some((*tableau).into()), ..spec };
            let (asked, evaluations) = one_step(&spec);
            let s = evaluations.expect("a number");
            let expected = Asked { field: s, psi: s, dpsi_inv: s - 1, ..Asked::default() };
            assert_eq!(asked, expected, "{}", spec.label());
        }
        let spec = MethodSpec::new("rk", None);
        let spec = MethodSpec { tableau: Some((*tableau).into()), ..spec };
        let (asked, evaluations) = one_step(&spec);
        let expected = Asked { field: evaluations.expect("a number"), ..Asked::default() };
        assert_eq!(asked, expected, "{}", spec.label());
    }
}

/// 5 to 20 iterations, each with what stands in the brackets; the values of f that an iteration begins
/// with, and the Ψ of the update, come once.
#[test]
fn implicit_methods() {
    for info in Needs::Norm.methods() {
        let map = info.takes_map.then_some("cay");
        let (asked, _) = one_step(&MethodSpec::new(info.name, map));
        let each = info.cost.trim_start_matches("5–20").trim_start_matches(" ×");
        let each = parsed(each.trim_matches([' ', '(', ')']));
        let iterations = asked.field / each.field - 1;
        assert!((5..=20).contains(&iterations), "{}: {iterations}", info.name);
        // The symmetric ones go to the middle and on.
        let once = each.psi.min(1) + u64::from(info.name.ends_with("symmetric"));
        let expected = Asked {
            field: each.field * (iterations + 1),
            psi: each.psi * iterations + once,
            dpsi_inv: each.dpsi_inv * iterations,
            ..Asked::default()
        };
        assert_eq!(asked, expected, "{}: {}", info.name, info.cost);
    }
}
