//! What the catalog says that a step costs is what it costs: evaluations of f, Ψ, dΨ⁻¹, commutators and
//! triple products of each method for fields are counted on a group and a field that count.

use std::cell::Cell;

use lieflow::actions::LeftTranslation;
use lieflow::catalog::{Count, MethodInfo, MethodSpec, Needs, Operation, TABLEAUS, WorkItem};
use lieflow::groups::So3;
use lieflow::maps::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use lieflow::methods::{Method, Step, magnus::TripleProduct};
use lieflow::problems::{Flow, Problem};
use lieflow::{Error, LieAlgebra, LieGroup, StepError};
use nalgebra::{Matrix3, Vector3};

use crate::support::named;

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
    fn tangent(&self, v: &V, g: &M, out: &mut M) {
        self.0.tangent(v, g, out);
    }
    fn apply_algebra(&self, v: &V, x: &V, y: &mut V) {
        self.0.apply_algebra(v, x, y);
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

/// Take one step and say what it asked for, with the evaluations that the method states.
fn take<P>(problem: &P, method: &impl Method<P>) -> (Asked, Option<u64>)
where
    P: Problem<Group = Counting, Action = LeftTranslation>,
{
    let mut y = M::identity();
    let mut work = method.work(problem, &y).expect("it fits");
    ASKED.set(Asked::default());
    let step = Step { n: 0, t: 0.2, h: 0.1 };
    let from = y;
    method.step(problem, step, &mut y, &mut work).expect("a step");
    let asked = ASKED.replace(Asked::default());
    // A point within the step costs what the method says.
    method.prepare(problem, step, &from, &y, &mut work).expect("the stages of the extension");
    let prepared = ASKED.replace(Asked::default()).field;
    method.interpolate(problem, step, 0.4, &from, &mut work, &mut y).expect("a point");
    let stated = method.dense_evaluations(problem);
    assert_eq!(stated[0], Some(prepared));
    assert!(stated[1].is_none_or(|n| n == ASKED.get().field), "{stated:?} {:?}", ASKED.get());
    (asked, method.evaluations(problem))
}

/// What the work of a step asks for.
fn stated(work: &[WorkItem]) -> Asked {
    let count = |operations: &[Operation]| {
        let work = work.iter().find(|work| operations.contains(&work.operation));
        work.map_or(0, |work| match work.count {
            Count::Exactly(n) => u64::from(n),
            other => panic!("{other} is no number"),
        })
    };
    Asked {
        field: count(&[Operation::Field, Operation::AmbientField, Operation::LinearField]),
        psi: count(&[Operation::Exp, Operation::Cay, Operation::Psi]),
        dpsi_inv: count(&[Operation::DpsiInv]),
        brackets: count(&[Operation::Bracket]),
        triples: count(&[Operation::TripleProduct]),
    }
}

/// What a step costs that is not asked for its error.
fn plain(info: &MethodInfo) -> Asked {
    stated(info.cost.work)
}

fn one_step(spec: &MethodSpec) -> (Asked, Option<u64>) {
    let problem = Flow::new(Counting(So3::new()), LeftTranslation, |t, g, v| {
        count(|asked| asked.field += 1);
        *v = V::new(t.cos(), g[(0, 1)], 0.5);
    });
    named::field(spec, |method| take(&problem, method)).expect("a method")
}

#[test]
fn methods_for_fields() {
    for info in Needs::Field.methods().iter().filter(|info| !info.takes_tableau) {
        let map = info.takes_map().then_some("exp");
        let (asked, evaluations) = one_step(&MethodSpec::new(info.name, map));
        assert_eq!(asked, plain(info), "{}: {}", info.name, info.cost);
        assert_eq!(evaluations, Some(asked.field), "{}", info.name);
    }
}

#[test]
fn methods_for_fields_of_linear_type() {
    for info in Needs::LinearType.methods() {
        let problem = Flow::of_time(Counting(So3::new()), LeftTranslation, |t, v| {
            count(|asked| asked.field += 1);
            *v = V::new(t.cos(), t, 0.5);
        });
        let (asked, evaluations) =
            named::linear(&MethodSpec::new(info.name, None), |method| take(&problem, method))
                .expect("a method");
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
            let spec = MethodSpec { tableau: Some(tableau.name.into()), ..spec };
            let (asked, evaluations) = one_step(&spec);
            let s = evaluations.expect("a number");
            let expected = Asked { field: s, psi: s, dpsi_inv: s - 1, ..Asked::default() };
            assert_eq!(asked, expected, "{}", spec.label());
        }
        let spec = MethodSpec::new("rk", None);
        let spec = MethodSpec { tableau: Some(tableau.name.into()), ..spec };
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
        let map = info.takes_map().then_some("cay");
        let (asked, _) = one_step(&MethodSpec::new(info.name, map));
        assert_eq!(info.cost.iterations, Some((5, 20)));
        let each = stated(info.cost.work);
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
