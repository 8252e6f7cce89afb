//! Systems on spheres: the conical pendulum, spin waves, damping.

use super::*;
use lieflow::methods::EnergyCasimir;
use lieflow::problems::{
    Bond, Constant, CoupledSpins, Couplings, LiePoisson, Site, SphericalPendulum, SpinChain,
};
use nalgebra::Vector3;

type V = Vector3<f64>;

/// At the height q₃ = −cos θ the pendulum goes round at Ω² = (g/ℓ)/cos θ.
#[test]
fn the_conical_pendulum() {
    let (g, theta) = (9.81, 0.6f64);
    let rate = (g / theta.cos()).sqrt();
    let pendulum = SphericalPendulum::new(g).unwrap();
    let at = |t: f64| {
        let (s, c) = (rate * t).sin_cos();
        let q = [theta.sin() * c, theta.sin() * s, -theta.cos()];
        pendulum.state(q, [-theta.sin() * rate * s, theta.sin() * rate * c, 0.0]).unwrap()
    };
    let far = [100, 200, 400].map(|n| flow(&pendulum, 2.0, n, &at(0.0)).distance(&at(2.0)));
    assert!(far[2] < 1e-6 && ((far[1] / far[2]).log2() - 4.0).abs() < 0.2, "{far:?}");
}

#[test]
fn the_spherical_pendulum_stays_on_its_sphere() {
    let pendulum = SphericalPendulum::new(1.0).unwrap();
    let y = pendulum.state([0.6, 0.0, -0.8], [0.3, 0.7, 0.2]).unwrap();
    assert!(y.0.dot(&y.1).abs() < EPS, "the velocity along q is left out");
    has_order_4(&pendulum, &y, 2.0, 16);
    keeps_its_invariants(&pendulum, &y, 20.0, 4000, 1e-9);
    assert!(SphericalPendulum::new(f64::NAN).is_err());
    assert!(pendulum.state([0.0; 3], [1.0, 0.0, 0.0]).is_err());
    // Upright at rest is an equilibrium, bit for bit.
    let upright = pendulum.state([0.0, 0.0, 2.0], [0.0; 3]).unwrap();
    assert_eq!(flow(&pendulum, 5.0, 50, &upright), upright);
}

fn chain() -> SpinChain {
    SpinChain::new(8).unwrap().with_anisotropy(0.3).unwrap().with_field([0.0, 0.0, 0.2]).unwrap()
}

fn crooked(chain: &SpinChain) -> Box<[V]> {
    chain.spins(|i| V::new((1.3 * i as f64).sin(), (0.7 * i as f64).cos(), 0.4)).unwrap()
}

/// A spin wave of wave number k on a ring: each spin turns about e₃ at 2 cos θ (1 − cos k).
#[test]
fn spin_waves() {
    let (n, theta) = (10, 0.8f64);
    let k = 2.0 * core::f64::consts::TAU / n as f64;
    let rate = 2.0 * theta.cos() * (1.0 - k.cos());
    let ring = SpinChain::new(n).unwrap();
    let at = |t: f64| {
        ring.spins(|i| {
            let phase = k * i as f64 + rate * t;
            V::new(theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos())
        })
        .unwrap()
    };
    let far = [50, 100, 200].map(|steps| flow(&ring, 3.0, steps, &at(0.0)).distance(&at(3.0)));
    assert!(far[2] < 1e-6 && ((far[1] / far[2]).log2() - 4.0).abs() < 0.2, "{far:?}");
}

#[test]
fn spins_keep_their_invariants() {
    for chain in [chain(), chain().open()] {
        let y = crooked(&chain);
        assert_eq!(chain.invariants().len(), 3);
        has_order_4(&chain, &y, 1.0, 16);
        keeps_its_invariants(&chain, &y, 10.0, 4000, 1e-8);
    }
    let tilted = chain().with_field([0.1, 0.0, 0.2]).unwrap();
    assert_eq!(tilted.invariants().len(), 2, "the total spin along e₃ is no longer kept");
    keeps_its_invariants(&tilted, &crooked(&tilted), 10.0, 4000, 1e-8);
}

#[test]
fn damping_leads_to_the_ground_state() {
    let chain = chain().with_damping(0.5).unwrap();
    let mut y = crooked(&chain);
    has_order_4(&chain, &y, 1.0, 16);
    assert_eq!(chain.invariants().len(), 1);
    let mut last = chain.energy(&y);
    for _ in 0..20 {
        y = flow(&chain, 2.0, 100, &y);
        assert!(chain.energy(&y) <= last + 1e-12);
        last = chain.energy(&y);
    }
    // All along e₃: −N(1 + K/2 + B).
    assert!((last + 8.0 * (1.0 + 0.15 + 0.2)).abs() < 1e-6, "{last}");
    assert!(y.iter().all(|s| (s.norm() - 1.0).abs() < 1e-13));
    assert!(SpinChain::new(1).is_err() && chain.with_damping(-0.1).is_err());
    assert!(chain.spins(|_| V::zeros()).is_err());
}

/// The couplings of that chain, ring or open.
fn couplings(bonds: usize) -> Couplings {
    let bond = |i| Bond { sites: [i, (i + 1) % 8], exchange: V::repeat(1.0), dm: V::zeros() };
    let site = Site { anisotropy: V::new(0.0, 0.0, 0.3), field: V::new(0.0, 0.0, 0.2) };
    Couplings { bonds: (0..bonds).map(bond).collect(), sites: [site; 8].into() }
}

/// Spins on the bonds of a chain are the chain: the field, the energy and its discrete gradient.
#[test]
fn coupled_spins_are_the_chain() {
    for (chain, bonds) in [(chain(), 8), (chain().open(), 7)] {
        for damping in [0.0, 0.3] {
            let chain = chain.with_damping(damping).unwrap();
            let spins = CoupledSpins::new(couplings(bonds), damping, Constant).unwrap();
            let y = crooked(&chain);
            let far = flow(&chain, 1.0, 50, &y).distance(&flow(&spins, 1.0, 50, &y));
            assert!(far < 1e-13, "{far:e}");
            assert!((chain.energy(&y) - spins.hamiltonian(&y)).abs() < 1e-13);
        }
    }
}

/// With all couplings the method has its order, E is kept by the flow and, to rounding, by the discrete gradient. With
/// couplings in time too, order 4.
#[test]
fn coupled_spins_keep_their_energy() {
    let mut all = couplings(8);
    for (i, bond) in all.bonds.iter_mut().enumerate() {
        bond.exchange = V::new(1.0, 0.5 + 0.1 * i as f64, -0.3);
        bond.dm = V::new(0.2, -0.1 * i as f64, 0.4);
    }
    all.sites[3] = Site { anisotropy: V::new(0.4, -0.2, 0.0), field: V::new(0.3, 0.1, 0.0) };
    let (y, spins) = (crooked(&chain()), CoupledSpins::new(all.clone(), 0.0, Constant).unwrap());
    has_order_4(&spins, &y, 1.0, 16);
    let energy = spins.hamiltonian(&y);
    let far = (spins.hamiltonian(&flow(&spins, 4.0, 200, &y)) - energy).abs();
    assert!(far < 1e-8, "{far:e}");
    let kept = run(&spins, &EnergyCasimir::new(Cay), 4.0, 100, &y);
    assert!((spins.hamiltonian(&kept) - energy).abs() < 1e-12);
    assert!(kept.distance(&y) > 0.1);

    let at = |t: f64, couplings: &mut Couplings| {
        couplings.bonds[2].exchange = V::repeat(t.cos());
        couplings.sites[1].field = V::new(t.sin(), 0.0, t);
    };
    let moving = CoupledSpins::new(all.clone(), 0.1, at).unwrap();
    has_order_4(&moving, &y, 1.0, 16);

    // What is written for some times only is no part of f at others.
    let pulse = |t: f64, couplings: &mut Couplings| {
        if t > 1.0 {
            couplings.sites[0].field[2] += 3.0;
        }
    };
    let pulsed = CoupledSpins::new(all.clone(), 0.0, pulse).unwrap();
    let mut work = pulsed.work();
    let mut f = |t: f64| {
        let mut v = y.clone();
        pulsed.f(t, &y, &mut v, &mut work);
        v
    };
    let (first, _, after) = (f(0.5), f(1.5), f(0.5));
    assert!(first == after && f(1.5) != first);

    let wrong = |sites: [usize; 2]| {
        let mut wrong = all.clone();
        wrong.bonds[1].sites = sites;
        CoupledSpins::new(wrong, 0.0, Constant).unwrap_err().to_string()
    };
    assert!(wrong([2, 2]).contains("bonds[1].sites") && wrong([2, 8]).contains("below 8"));
    assert!(CoupledSpins::new(all, f64::NAN, Constant).is_err());
}
