//! Every method for the free body of order 8 and more, by its attitude, its momentum and both in one state.

use lieflow::catalog::Needs;
use lieflow::groups::{LieGroup, So3};
use lieflow::methods::tableau::DOP853;
use lieflow::methods::{
    DMV8, DMV10, KAHAN_LI8, ProjectionMethod, Rk, SOFRONIOU_SPALETTA10, Splitting, Taylor,
    TaylorMomentum,
};
use lieflow::problems::{Projection, RigidBody, RigidBodyAttitude, RigidBodyState};
use lieflow::scalar::Real;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::D;
use super::members::{CANCELLED, STORED, Span, by_name, high_orders, members, rational};

const MEMBERS: u64 = 12;
/// Methods for bodies take larger steps.
const SPAN: Span = Span { length: 4.0, rate: 80.0, gap: 5e-28 };

/// A body that is nothing special, and one that is more even: compositions show their order there before
/// the rounding of their weights.
const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];
const EVEN: [f64; 3] = [1.0, 1.5, 2.2];

/// A momentum of length 3 that is nothing special.
fn momentum(i: u64) -> [f64; 3] {
    let mut rng = Pcg64::seed_from_u64(40 + i);
    let m = Vector3::from_fn(|_, _| rng.random_range(0.3..1.0)).normalize() * 3.0;
    [m[0], m[1], -m[2]]
}

/// Every method for the body, and those that only one of its problems has.
macro_rules! bodies {
    ($body:ident: $($test:ident: $title:literal, $needs:expr, $make:expr, {$($more:tt)*};)*) => {$(
        #[test]
        fn $test() {
            let [$body, even] = [INERTIA, EVEN].map(|inertia| members(MEMBERS, SPAN, $make(inertia)));
            high_orders($title, "SO(3)", &$needs, |spec| by_name!(spec, {
                "mr8" => &even, STORED, Splitting::new([0, 1, 2], KAHAN_LI8);
                "mr10" => &even, CANCELLED, Splitting::new([0, 1, 2], SOFRONIOU_SPALETTA10);
                "dmv8" => &$body, STORED, DMV8;
                "dmv10" => &$body, STORED, DMV10;
                "taylor8" => &$body, rational(8), Taylor::<8>;
                "taylor9" => &$body, rational(9), Taylor::<9>;
                "taylor10" => &$body, rational(10), Taylor::<10>;
                "taylor11" => &$body, rational(11), Taylor::<11>;
                "taylor12" => &$body, rational(12), Taylor::<12>;
                "taylor13" => &$body, rational(13), Taylor::<13>;
                "taylor14" => &$body, rational(14), Taylor::<14>;
                "taylor15" => &$body, rational(15), Taylor::<15>;
                "taylor16" => &$body, rational(16), Taylor::<16>;
                $($more)*
            }));
        }
    )*};
}

bodies! {
    body:
    attitudes: "a body by its attitude", [Needs::Series, Needs::Body, Needs::Attitude],
        |j| move |i| (RigidBodyAttitude::new(j, momentum(i)).unwrap(), So3::new().identity()), {
            "rk-qr" => &body, STORED, ProjectionMethod::new(Rk(DOP853), Projection::Qr);
            "rk-polar" => &body, STORED, ProjectionMethod::new(Rk(DOP853), Projection::Polar);
        };
    momenta: "a body by its momentum",
        [Needs::Series, Needs::Body, Needs::Momentum, Needs::LiePoisson],
        |j| move |i| (RigidBody::new(j).unwrap(), Vector3::from(momentum(i)).map(D::lit)), {
            "taylor12-m" => &body, rational(12), TaylorMomentum::<12>;
            "taylor16-m" => &body, rational(16), TaylorMomentum::<16>;
        };
    states: "a body by both in one state", [Needs::State],
        |j| move |i| {
            let body = RigidBodyState::new(j).unwrap();
            let m = Vector3::from(momentum(i)).map(D::lit);
            (body, lieflow::problems::BodyState { m, g: So3::new().identity() })
        }, {
            "rk-mg" => &body, STORED, Rk(DOP853);
        };
}
