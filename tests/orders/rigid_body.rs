//! Measured orders of the methods that ask more of a problem than a field: rigid bodies, Taylor
//! coefficients, Lie–Poisson systems. The harness is that of `fields.rs`; what is measured follows from
//! the catalog's lists, and a list without a problem here makes a test fail.

use crate::support::orders::{Problems, Report, every_explicit_method_on};
use crate::support::points::Points;
use crate::support::represent::Represent;
use crate::support::{named, systems};
use faer::Scale;
use lieflow::catalog::{MethodSpec, Needs};
use lieflow::groups::Sample;
use lieflow::maps::Cay;
use lieflow::problems::{
    Ambient, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
    RigidBodyState,
};
use lieflow::{CoordinateMap, LieAlgebra};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];

/// Momenta of length 2 that are nothing special.
fn momentum(i: u64) -> Vector3<f64> {
    let mut rng = Pcg64::seed_from_u64(40 + i);
    let mut entry = || rng.random_range(0.3..1.0);
    Vector3::new(entry(), entry(), -entry()).normalize() * 2.0
}

fn ensemble<P: Ambient>(make: impl Fn(Vector3<f64>) -> (P, PointOf<P>)) -> Problems<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    Problems::many(|i| make(momentum(i)))
}

fn attitude(title: &str, needs: &[Needs]) {
    let problems = ensemble(|m| {
        let body = RigidBodyAttitude::new(INERTIA, m.into()).unwrap();
        (body, Matrix3::identity())
    });
    let measured =
        |spec: &MethodSpec| named::attitude(spec, |method| problems.measure(method, true));
    Report::of(title, "SO(3)", needs, measured);
}

fn momentum_alone(title: &str, needs: &[Needs]) {
    let problems = ensemble(|m| (RigidBody::new(INERTIA).unwrap(), m));
    let measured =
        |spec: &MethodSpec| named::momentum(spec, |method| problems.measure(method, true));
    Report::of(title, "SO(3)", needs, measured);
}

fn both_in_one_state(title: &str, needs: &[Needs]) {
    let problems = ensemble(|m| {
        let body = RigidBodyState::new(INERTIA).unwrap();
        (body, body.state(m.into(), Matrix3::identity()).unwrap())
    });
    let measured = |spec: &MethodSpec| named::state(spec, |method| problems.measure(method, true));
    Report::of(title, "SO(3)", needs, measured);
}

/// On SO(5), Sp(4), GL(3) and SO(3,1).
fn quadratic_systems(title: &str, needs: &[Needs]) {
    for (group, start) in systems::systems() {
        let name = group.name();
        // Near one another, so that none of them is at rounding before the others.
        let make = |length: f64| {
            let (group, start) = (group.clone(), &start);
            move |i| {
                let aside = group.sample_algebra(&mut Pcg64::seed_from_u64(60 + i), 1.0);
                let m = start + Scale(0.4 / group.norm(&aside)) * aside.into_mat();
                let length = length / m.norm_l2();
                (systems::quadratic(group.clone()), m * Scale(length))
            }
        };
        // Where the group is not compact the motion runs away.
        let problems = Problems::many(make(if name == "SO(5)" { 3.0 } else { 0.7 }));
        let measured =
            |spec: &MethodSpec| named::lie_poisson(spec, |method| problems.measure(method, true));
        Report::of(&format!("{title}, {name}"), &name, needs, measured);
    }
}

/// One test a problem, with the lists that are measured on it.
macro_rules! suites {
    ($($name:ident: [$($needs:ident),*];)*) => {
        const MEASURED: &[Needs] = &[$($(Needs::$needs),*),*];
        mod suites {
            use lieflow::catalog::Needs;
            $(
                #[test]
                fn $name() {
                    super::$name(stringify!($name), &[$(Needs::$needs),*]);
                }
            )*
        }
    };
}

suites! {
    attitude: [Series, Body, Attitude];
    momentum_alone: [Series, Body, Momentum, LiePoisson];
    both_in_one_state: [State];
    quadratic_systems: [Series, LiePoisson, Isospectral];
}

/// Every list of the catalog is measured, here, in `fields.rs` or, the implicit methods, in
/// `implicit.rs`.
#[test]
fn every_list_has_its_problems() {
    let fields = [Needs::Field, Needs::Norm, Needs::LinearType];
    for needs in Needs::ALL {
        assert!(fields.contains(&needs) != MEASURED.contains(&needs), "{needs:?}");
    }
}

/// The methods for any field, on bodies: here, where these are compiled anyway.
#[test]
fn rigid_bodies() {
    let (inertia, momentum) = ([1.0, 2.0, 3.5], [1.0, 0.8, -1.2]);
    let body = RigidBody::new(inertia).unwrap();
    every_explicit_method_on("the rigid body", Problems::one(body, momentum.into()));
    let attitude = RigidBodyAttitude::new(inertia, momentum).unwrap();
    every_explicit_method_on("its attitude", Problems::one(attitude, Matrix3::identity()));

    let manakov = RigidBodyN::manakov(&[0.4, 1.1, 1.9, 2.5]).unwrap();
    let group = manakov.group().clone();
    let mut rng = Pcg64::seed_from_u64(8);
    let start = group.sample_algebra(&mut rng, 2.0).into_mat();
    every_explicit_method_on(
        "Manakov's body, n = 4",
        Problems::one(manakov.clone(), start.clone()),
    );
    let attitude = RigidBodyNAttitude::new(manakov, start).unwrap();
    every_explicit_method_on(
        "its attitude, n = 4",
        Problems::one(attitude, group.sample_element(&mut rng)),
    );
}
