//! A step of a fluid allocates nothing, by its own methods and by the general ones.
#![allow(unsafe_code)] // the counting allocator

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use lieflow::maps::{Cay, Exp};
use lieflow::methods::{EnergyCasimir, GAUSS4, GAUSS6, IsospectralGauss, Rkmk, tableau::RK4};
use lieflow::problems::{FluidMidpoint, Surface, Zeitlin};
use lieflow::{Method, Step, groups::ComplexMatrix};
use rand::SeedableRng;
use rand_pcg::Pcg64;

struct Counting;

thread_local!(static ALLOCATIONS: Cell<usize> = const { Cell::new(0) });

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, p: *mut u8, layout: Layout) {
        unsafe { System.dealloc(p, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn steps_allocate<S: Surface, M: Method<Zeitlin<S>>>(
    fluid: &Zeitlin<S>,
    method: &M,
    w: &ComplexMatrix,
) -> usize {
    let (mut w, before) = (w.clone(), ALLOCATIONS.get());
    let mut work = method.work(fluid, &w).expect("a workspace");
    assert!(ALLOCATIONS.get() > before, "the counter does not count");
    let mut step = |n| {
        let before = ALLOCATIONS.get();
        method.step(fluid, Step { n, t: 0.0, h: 0.01 }, &mut w, &mut work).expect("a step");
        ALLOCATIONS.get() - before
    };
    step(0); // which may make a thread's packing buffers
    (1..12).map(step).sum()
}

fn check<S: Surface>(fluid: &Zeitlin<S>, w: &ComplexMatrix) {
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        assert_eq!(steps_allocate(fluid, &method, w), 0, "{method:?}, N = {}", fluid.n());
    }
    assert_eq!(steps_allocate(fluid, &Rkmk::new(RK4, Exp), w), 0, "exp, N = {}", fluid.n());
    assert_eq!(steps_allocate(fluid, &Rkmk::new(RK4, Cay), w), 0, "cay, N = {}", fluid.n());
    assert_eq!(steps_allocate(fluid, &EnergyCasimir::new(Cay), w), 0, "N = {}", fluid.n());
    assert_eq!(steps_allocate(fluid, &IsospectralGauss(GAUSS4), w), 0, "N = {}", fluid.n());
    assert_eq!(steps_allocate(fluid, &IsospectralGauss(GAUSS6), w), 0, "N = {}", fluid.n());
}

#[test]
fn nothing_in_a_step() {
    let mut rng = Pcg64::seed_from_u64(1);
    for n in [2, 7, 33, 65] {
        let sphere = Zeitlin::sphere(n).expect("a sphere");
        check(&sphere, &sphere.random(&mut rng, 2.max(n / 3)).expect("a field"));
    }
    let torus = Zeitlin::torus(33).expect("a torus");
    check(&torus, &torus.random(&mut rng, 5).expect("a field"));
}
