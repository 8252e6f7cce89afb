//! The body by its quaternion: every method that the catalog has for it, against the exact motion.

use lieflow::catalog::{MethodInfo, MethodSpec, Needs, Property, all_methods};
use lieflow::problems::{Exact, RigidBodyQuaternion};
use lieflow::{Error, Method, SaveAt, TimeGrid, integrate};
use lieflow::{StepControl, integrate_adaptive};
use nalgebra::{Matrix3, UnitQuaternion};

use crate::support::named;

type Body = RigidBodyQuaternion;
const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: [f64; 3] = [0.9, 1.0, 2.1];
const T: f64 = 0.8;

fn body() -> Body {
    RigidBodyQuaternion::new(INERTIA, MOMENTUM).expect("a body")
}

/// Of the rotation, from that of the exact motion.
fn error(q: &UnitQuaternion<f64>) -> f64 {
    let exact = Exact::new(INERTIA, MOMENTUM, Matrix3::identity()).expect("a body");
    let (_, g) = exact.state(T).expect("a state");
    (q.to_rotation_matrix().matrix() - g).norm()
}

/// q after so many steps.
fn run(body: &Body, method: &impl Method<Body>, steps: u64) -> UnitQuaternion<f64> {
    let mut q = UnitQuaternion::identity();
    let grid = TimeGrid::with_steps([0.0, T], steps).expect("a grid");
    integrate(body, method, &grid, &SaveAt::Ends, &mut q, |_, _| {}).expect("a run");
    q
}

fn specs(info: &MethodInfo) -> Vec<MethodSpec> {
    let maps: &[_] = if info.takes_map() { &[Some("exp"), Some("cay")] } else { &[None] };
    maps.iter().map(|map| MethodSpec::new(info.name, *map)).collect()
}

#[test]
fn every_method_has_its_order_and_keeps_the_length() {
    let body = body();
    let mut seen = Vec::new();
    for info in all_methods() {
        for spec in specs(info) {
            let end = |steps| named::quaternion(&spec, |method| run(&body, method, steps));
            let coarse = match end(8) {
                Ok(q) => q,
                Err(error) => {
                    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
                    continue;
                }
            };
            let fine = end(16).expect("it fits");
            let (e, finer) = (error(&coarse), error(&fine));
            let slope = (e / finer).log2();
            // `lewis-simo` has order 4 in the momentum alone; an exact method has none.
            let order = info.order.number().unwrap_or(if info.takes_tableau { 4 } else { 2 });
            let (label, rounding) = (spec.label(), 1e-13);
            assert!(
                finer < rounding || info.name != "exact" && slope > order as f64 - 0.4,
                "{label}: {slope:.2}, {e:.1e} {finer:.1e}"
            );
            let off = (coarse.coords.norm() - 1.0).abs();
            let keeps = info.keeps(Property::Group) || info.keeps_polynomials(2);
            assert!(!keeps || off < 1e-14, "{label}: |q| is off by {off:.1e}");
            // The path on S³ is followed, not only that of rotations.
            assert!((coarse.coords - fine.coords).norm() < 0.2, "{label}");
            seen.push((label, info.needs));
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
            let control = StepControl::new(1e-10, 1e-10).expect("tolerances");
            named::pair(&spec, |method| {
                integrate_adaptive(
                    &body,
                    method,
                    [0.0, T],
                    &control,
                    &SaveAt::Ends,
                    &mut q,
                    |_, _| {},
                )
            })
            .expect("it fits")
            .expect("a run");
            assert!(error(&q) < 1e-8, "{}: {:.1e}", spec.label(), error(&q));
        }
    }
    let refused = named::pair(&MethodSpec::new("cf4", None), |method| method.facts(&body).order);
    assert!(matches!(refused, Err(Error::Unsupported { .. })));
}
