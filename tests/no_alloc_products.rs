//! A step on a product, a power or SE(3) allocates nothing, and neither does taking it back to M.
#![allow(unsafe_code)] // the counting allocator

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use lieflow::actions::{Coadjoint, Each, LeftTranslation, Linear, Pair};
use lieflow::groups::{LieGroup, MatrixGroup, Power, Product, Sample, Se3, So3};
use lieflow::maps::{CCSK, Cay, Ccsk, Exp, Pade22};
use lieflow::methods::{CommutatorFree, Rkmk, commutator_free::CF4, tableau::RK4};
use lieflow::problems::LinearEquation;
use lieflow::{Action, CoordinateMap, LieAlgebra, Method, Problem, Step};
use rand::SeedableRng;
use rand_pcg::Pcg64;

struct Counting;

thread_local!(static ALLOCATIONS: Cell<usize> = const { Cell::new(0) });

fn count() {
    ALLOCATIONS.with(|n| n.set(n.get() + 1));
}

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, p: *mut u8, layout: Layout) {
        unsafe { System.dealloc(p, layout) }
    }
    unsafe fn realloc(&self, p: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(p, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn steps_allocate<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    y: &<P::Action as Action<P::Group>>::Point,
) -> usize
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    let (mut y, before) = (y.clone(), ALLOCATIONS.get());
    let mut work = method.work(problem, &y).expect("the method fits");
    let mut mend = problem.action().work(problem.group());
    assert!(ALLOCATIONS.get() > before || size_of_val(&work) > 0, "the counter does not count");
    let before = ALLOCATIONS.get();
    for n in 0..10 {
        method.step(problem, Step { n, t: 0.0, h: 0.05 }, &mut y, &mut work).expect("a step");
        problem.action().restore(problem.group(), &mut y, &mut mend);
    }
    ALLOCATIONS.get() - before
}

fn check<G: Sample<Scalar = f64> + Clone, A: Action<G>>(group: &G, action: A, y: A::Point)
where
    Exp: CoordinateMap<G>,
    Cay: CoordinateMap<G>,
    Pade22: CoordinateMap<G>,
    Ccsk<0, 1, 2>: CoordinateMap<G>,
    Ccsk<2, 1, 0>: CoordinateMap<G>,
{
    let u = group.sample_algebra(&mut Pcg64::seed_from_u64(1), 0.3);
    let name = group.name();
    let field = |_: f64, v: &mut G::Alg| {
        group.set_zero(v);
        group.axpy(1.0, &u, v);
    };
    let problem = LinearEquation::new(group.clone(), action, field);
    assert_eq!(steps_allocate(&problem, &Rkmk::new(RK4, Exp), &y), 0, "exp on {name}");
    assert_eq!(steps_allocate(&problem, &Rkmk::new(RK4, Cay), &y), 0, "cay on {name}");
    assert_eq!(steps_allocate(&problem, &Rkmk::new(RK4, Pade22), &y), 0, "pade22 on {name}");
    assert_eq!(steps_allocate(&problem, &Rkmk::new(RK4, CCSK), &y), 0, "ccsk on {name}");
    assert_eq!(steps_allocate(&problem, &CommutatorFree(CF4), &y), 0, "cf4 on {name}");
}

#[test]
fn products_powers_and_motions() {
    let mut rng = Pcg64::seed_from_u64(2);
    let power = Power::new(So3::<f64>::new(), 20).expect("a power");
    check(&power, LeftTranslation, power.identity());
    check(&power, Linear, power.sample_vector(&mut rng));
    check(&power, Coadjoint, power.sample_vector(&mut rng));
    check(&power, Each(LeftTranslation), power.identity());

    let product = Product(So3::<f64>::new(), MatrixGroup::sp(4).expect("a group"));
    let x = product.sample_vector(&mut rng);
    check(&product, LeftTranslation, product.identity());
    check(&product, Pair(Coadjoint, LeftTranslation), (x.0, product.1.identity()));
    check(&product, Linear, x);

    let motions = Se3::<f64>::new();
    check(&motions, LeftTranslation, motions.identity());
    check(&motions, Coadjoint, motions.sample_algebra(&mut rng, 1.0));
}
