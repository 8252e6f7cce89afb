//! The body by its quaternion: every method that the catalog has for it, against the exact motion.

use lieflow::adaptive::{Adaptive, AdaptiveError, AdaptiveStats, integrate_adaptive};
use lieflow::catalog::{
    MethodInfo, MethodSpec, Needs, OnEmbedded, OnMethod, all_methods, with_exp_cay_pair,
    with_quaternion_method,
};
use lieflow::methods::Embedded;
use lieflow::problems::{Exact, PointOf, RigidBodyQuaternion};
use lieflow::{Error, Method, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, UnitQuaternion};

type Body = RigidBodyQuaternion;
const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: [f64; 3] = [0.9, 1.0, 2.1];
const T: f64 = 0.8;

/// q after so many steps.
struct Run<'a>(&'a Body, u64);

impl OnMethod<Body> for Run<'_> {
    type Out = UnitQuaternion<f64>;
    fn call<M: Method<Body>>(self, method: M) -> UnitQuaternion<f64> {
        let mut q = UnitQuaternion::identity();
        let grid = TimeGrid::with_steps([0.0, T], self.1).expect("a grid");
        integrate(self.0, &method, &grid, &SaveAt::Ends, &mut q, |_, _| {}).expect("a run");
        q
    }
}

struct Adapt<'a>(&'a Body, &'a mut PointOf<Body>);

impl OnEmbedded<Body> for Adapt<'_> {
    type Out = Result<AdaptiveStats, AdaptiveError>;
    fn call<M: Embedded<Body>>(self, method: M) -> Self::Out {
        let control = Adaptive::new(1e-10, 1e-10)?;
        integrate_adaptive(self.0, &method, [0.0, T], &control, &SaveAt::Ends, self.1, |_, _| {})
    }
}

fn body() -> Body {
    RigidBodyQuaternion::new(INERTIA, MOMENTUM).expect("a body")
}

/// Of the rotation, from that of the exact motion.
fn error(q: &UnitQuaternion<f64>) -> f64 {
    let exact = Exact::new(INERTIA, MOMENTUM, Matrix3::identity()).expect("a body");
    let (_, g) = exact.state(T).expect("a state");
    (q.to_rotation_matrix().matrix() - g).norm()
}

fn specs(info: &MethodInfo) -> Vec<MethodSpec> {
    let maps: &[_] = if info.takes_map { &[Some("exp"), Some("cay")] } else { &[None] };
    maps.iter().map(|map| MethodSpec::new(info.name, *map)).collect()
}

#[test]
fn every_method_has_its_order_and_keeps_the_length() {
    let body = body();
    let mut seen = Vec::new();
    for (info, needs) in all_methods() {
        for spec in specs(info) {
            let run = |steps| with_quaternion_method(&spec, Run(&body, steps));
            let coarse = match run(8) {
                Ok(q) => q,
                Err(error) => {
                    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
                    continue;
                }
            };
            let fine = run(16).expect("it fits");
            let (e, finer) = (error(&coarse), error(&fine));
            let slope = (e / finer).log2();
            // `lewis-simo` has order 4 in the momentum alone; an exact method has none.
            let order = if info.name == "lewis-simo" { 2 } else { info.order.unwrap_or(4) };
            let (label, rounding) = (spec.label(), 1e-13);
            assert!(
                finer < rounding || info.name != "exact" && slope > order as f64 - 0.4,
                "{label}: {slope:.2}, {e:.1e} {finer:.1e}"
            );
            let off = (coarse.coords.norm() - 1.0).abs();
            let keeps = info
                .preserves
                .split(", ")
                .any(|kept| ["everything", "group", "quadratic invariants"].contains(&kept));
            assert!(!keeps || off < 1e-14, "{label}: |q| is off by {off:.1e}");
            // The path on S³ is followed, not only that of rotations.
            assert!((coarse.coords - fine.coords).norm() < 0.2, "{label}");
            seen.push((label, needs));
        }
    }
    let some = |needs: Needs| seen.iter().filter(|(_, n)| *n == needs).count();
    assert!(some(Needs::Field) >= 16 && some(Needs::Norm) == 15, "{seen:?}");
    for name in ["mr4", "mr10", "dmv10", "simo-wong6", "buss4", "taylor16", "exact"] {
        assert!(seen.iter().any(|(label, _)| label == name), "{name} is not among {seen:?}");
    }
}

#[test]
fn steps_of_its_own_choice() {
    let body = body();
    for tableau in ["dopri5", "dop853"] {
        for name in ["rkmk", "rk"] {
            let spec = MethodSpec { tableau: Some(tableau.into()), ..MethodSpec::new(name, None) };
            let mut q = UnitQuaternion::identity();
            with_exp_cay_pair(&spec, Adapt(&body, &mut q)).expect("it fits").expect("a run");
            assert!(error(&q) < 1e-8, "{}: {:.1e}", spec.label(), error(&q));
        }
    }
    let refused = with_exp_cay_pair(
        &MethodSpec::new("cf4", None),
        Adapt(&body, &mut UnitQuaternion::identity()),
    );
    assert!(matches!(refused, Err(Error::Unsupported { .. })));
}
