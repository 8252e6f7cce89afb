//! The measure sees methods of order 8 that are broken on purpose, and refuses claims that are off by one.

use lieflow::groups::So3;
use lieflow::maps::Cay;
use lieflow::methods::magnus::{CFM8_11, CfMagnusTableau};
use lieflow::methods::tableau::DOP853;
use lieflow::methods::{CfMagnus, Method, Rkmk, Tableau};

use super::D;
use super::fields::{CoupledField, Kind};
use super::members::{Member, STORED, UNIT, members, order};
use crate::support::orders::{Estimate, Outcome};

type OnSo3 = CoupledField<So3<D>>;

fn on_so3(kind: Kind, strength: f64) -> Vec<Member<OnSo3>> {
    members(8, UNIT, |i| CoupledField::new(&So3::new(), kind, strength, 71 + i))
}

fn measured<M: Method<OnSo3>>(members: &[Member<OnSo3>], method: &M) -> Estimate {
    match order(members, STORED, method) {
        Outcome::Measured(Ok(found)) => found,
        _ => panic!("a run failed"),
    }
}

/// The order has fallen below 6, or no step is small enough to see it: that takes no ensemble.
#[track_caller]
fn falls<M: Method<OnSo3>>(members: &[Member<OnSo3>], method: &M) {
    let found = measured(&members[..2], method);
    let low = found.slopes.iter().all(|slope| *slope < 6.0);
    assert!(low && found.check().is_err(), "{found:?}");
}

#[test]
fn rkmk_with_a_fault() {
    let members = on_so3(Kind::Wave, 1.0);
    let rkmk = |tableau: Tableau<12>| Rkmk::new(tableau, Cay);
    measured(&members, &rkmk(DOP853)).check().unwrap();
    for order in [7, 9] {
        assert!(measured(&members, &rkmk(Tableau { order, ..DOP853 })).check().is_err());
    }
    // Two a_ij exchanged in one row; two that are off. Both keep the sum of the row, without which no run starts.
    let mut exchanged = DOP853;
    exchanged.a[7].swap(3, 4);
    falls(&members, &rkmk(exchanged));
    let mut off = DOP853;
    off.a[9][6] += 1e-7;
    off.a[9][5] -= 1e-7;
    falls(&members, &rkmk(off));
}

#[test]
fn magnus_with_a_fault() {
    let members = on_so3(Kind::Clock, 2.0);
    measured(&members, &CfMagnus(CFM8_11)).check().unwrap();
    // Two exponentials exchanged; a weight that is off; time frozen.
    let mut exchanged = CFM8_11;
    exchanged.factors.swap(1, 2);
    falls(&members, &CfMagnus(exchanged));
    let mut off = CFM8_11;
    off.factors[3][1] += 1e-7;
    falls(&members, &CfMagnus(off));
    falls(&members, &CfMagnus(CfMagnusTableau { nodes: [0.5; 4], ..CFM8_11 }));
}
