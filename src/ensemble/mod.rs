//! Many free rigid bodies at once, in the widest SIMD lanes of the machine, chosen at run time.
//!
//! Each body has its own inertia, momentum m and, if you ask for it, attitude g from body to space. From ṁ = m × J⁻¹m and
//! ġ = g ω̂ follows ẋ = x × ω for m and for the rows x of g. With f = −ω a step is
//!
//! | | m⁺ | rows of g⁺ |
//! |---|---|---|
//! | [`EnsembleMethod::Rkmk4Exp`], [`Rkmk4Cay`](EnsembleMethod::Rkmk4Cay) | Ψ(v) m, v of Table 1 in Celledoni & Owren | Ψ(v) x |
//! | [`EnsembleMethod::Rk4`] | classical Runge–Kutta on (m, g) | the same |
//!
//! These are the methods `rkmk4` and `rk4-mg` of the catalog, with the same results to rounding. Blocks have 64 bodies. A
//! block takes all its steps before the next block starts, so the cost per body does not grow with their number. The
//! formulas of a block have no branch. If a stage turns by more than one radian, or m is not finite, the step of this
//! body is repeated by the scalar method. It is slower, and it returns the error. [`EnsembleMethod::Rk4`] may blow g up where
//! it keeps m. If a g of a block is not finite at the end, all of its steps are repeated by the scalar method.
//!
//! Blocks are independent: the results are the same to the bit on any number of threads.
//!
//! ```
//! use lieflow::ensemble::{Ensemble, EnsembleMethod};
//! let inertia = vec![[1.0, 2.0, 3.0]; 1000];
//! let momentum: Vec<_> = (0..1000).map(|i| [0.2, 1e-3 * f64::from(i), 3.0]).collect();
//! let mut bodies = Ensemble::new(&inertia, &momentum)?;
//! bodies.advance(EnsembleMethod::Rkmk4Cay, 0.01, 100, 1)?;
//! let m = bodies.momentum(999).expect("the last of a thousand");
//! assert!((m.norm() - (0.04 + 0.999f64.powi(2) + 9.0).sqrt()).abs() < 1e-14);
//! # Ok::<(), lieflow::Error>(())
//! ```

mod step;

use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

use self::step::{Classical, InCay, InExp, MOTION, OneStep};
use crate::error::Error;
use crate::groups::{RESIDUAL_MAX, So3};
use crate::problems::{BodyState, check_moment};
use crate::so3::{Lane, SERIES, SMALL, in_range};

/// How an ensemble takes its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EnsembleMethod {
    /// RKMK4 with the map exp. Order 4; conserves |m|, g m and gᵀg = 𝟙.
    Rkmk4Exp,
    /// RKMK4 with the map cay. Order 4; conserves |m|, g m and gᵀg = 𝟙.
    Rkmk4Cay,
    /// Classical Runge–Kutta on m and the entries of g. Order 4; conserves nothing.
    Rk4,
}

/// The number of bodies in a block. Their data fit into the first cache.
const BLOCK: usize = 64;
/// After this many steps g is corrected to the group, and |m| to its first value, if the method conserves them.
const RESTORE_EVERY: u64 = 64;
/// The allowed distance of an attitude from the rotations.
const ROTATION: f64 = 1e-6;

/// A number of each body of a block.
type Numbers = [f64; BLOCK];
/// A vector of each, by component.
type Vectors = [Numbers; 3];

/// The bodies of a block, with the rows of g: three of them, or none.
#[derive(Clone, Copy, Debug)]
struct Block<const ROWS: usize> {
    /// 1/J.
    inverse: Vectors,
    /// |m|² of the orbit.
    square: Numbers,
    state: State<ROWS>,
}

#[derive(Clone, Copy, Debug)]
struct State<const ROWS: usize> {
    m: Vectors,
    g: [Vectors; ROWS],
}

const ZERO: Vectors = [[0.0; BLOCK]; 3];

impl<const ROWS: usize> Block<ROWS> {
    const EMPTY: Self =
        Block { inverse: ZERO, square: [0.0; BLOCK], state: State { m: ZERO, g: [ZERO; ROWS] } };
}

#[derive(Debug)]
enum Blocks {
    Momentum(Vec<Block<0>>),
    Attitude(Vec<Block<3>>),
}

impl Clone for Blocks {
    fn clone(&self) -> Self {
        match self {
            Blocks::Momentum(blocks) => Blocks::Momentum(blocks.clone()),
            Blocks::Attitude(blocks) => Blocks::Attitude(blocks.clone()),
        }
    }
    fn clone_from(&mut self, other: &Self) {
        match (self, other) {
            (Blocks::Momentum(blocks), Blocks::Momentum(other)) => blocks.clone_from(other),
            (Blocks::Attitude(blocks), Blocks::Attitude(other)) => blocks.clone_from(other),
            (blocks, other) => *blocks = other.clone(),
        }
    }
}

/// Many free rigid bodies, with or without attitudes. Without them no attitude is stored or integrated.
///
/// `clone_from` copies into bodies that are as many without allocating: a caller can go back to them after an error.
#[derive(Debug)]
pub struct Ensemble {
    len: usize,
    blocks: Blocks,
    /// Steps since g and m were last corrected.
    age: u64,
}

impl Clone for Ensemble {
    fn clone(&self) -> Self {
        Ensemble { blocks: self.blocks.clone(), ..*self }
    }
    fn clone_from(&mut self, other: &Self) {
        (self.len, self.age) = (other.len, other.age);
        self.blocks.clone_from(&other.blocks);
    }
}

impl Ensemble {
    /// Makes bodies from their principal moments of inertia and their momenta in the body.
    ///
    /// # Errors
    /// [`Error::Shape`] for lists of different lengths; [`Error::OutOfRange`] for a moment of inertia that
    /// is not positive and finite or has no finite reciprocal, or a momentum that is not finite, with its index.
    pub fn new(inertia: &[[f64; 3]], momentum: &[[f64; 3]]) -> Result<Self, Error> {
        let len = inertia.len();
        check_length("momentum", momentum.len(), len)?;
        let mut blocks = vec![Block::EMPTY; len.div_ceil(BLOCK)];
        for (i, (inertia, momentum)) in inertia.iter().zip(momentum).enumerate() {
            let block = &mut blocks[i / BLOCK];
            for k in 0..3 {
                let (j, m) = (inertia[k], momentum[k]);
                check_moment(j, || format!("inertia[{i}][{k}]"))?;
                if !m.is_finite() {
                    Error::finite(format!("momentum[{i}][{k}]"), m)?;
                }
                block.inverse[k][i % BLOCK] = 1.0 / j;
                block.state.m[k][i % BLOCK] = m;
            }
        }
        blocks.iter_mut().for_each(|block| block.square = squares(&block.state.m));
        Ok(Ensemble { len, blocks: Blocks::Momentum(blocks), age: 0 })
    }

    /// Adds the attitudes of the bodies, rotations from body to space.
    ///
    /// # Errors
    /// [`Error::Shape`] for a list of another length; [`Error::Element`] with the number of the body for a matrix that is not a
    /// rotation, and the reason of [`So3::check_element`](crate::groups::So3::check_element).
    pub fn with_attitudes(self, attitudes: &[Matrix3<f64>]) -> Result<Self, Error> {
        check_length("attitudes", attitudes.len(), self.len)?;
        let mut blocks = vec![Block::EMPTY; self.len.div_ceil(BLOCK)];
        for (b, block) in blocks.iter_mut().enumerate() {
            let (inverse, square, m) = self.block(b);
            (block.inverse, block.square, block.state.m) = (*inverse, *square, *m);
        }
        for (i, g) in attitudes.iter().enumerate() {
            let refused = |source| Error::Element { index: i, source: Box::new(source) };
            So3::new().check_element("attitudes", g, ROTATION).map_err(refused)?;
            for (r, row) in blocks[i / BLOCK].state.g.iter_mut().enumerate() {
                for (c, entry) in row.iter_mut().enumerate() {
                    entry[i % BLOCK] = g[(r, c)];
                }
            }
        }
        Ok(Ensemble { blocks: Blocks::Attitude(blocks), ..self })
    }

    /// The number of bodies.
    pub fn len(&self) -> usize {
        self.len
    }
    /// True if there is no body.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// 1/J, |m|² of the orbit and m of block b, of which there is one.
    fn block(&self, b: usize) -> (&Vectors, &Numbers, &Vectors) {
        fn of<const ROWS: usize>(block: &Block<ROWS>) -> (&Vectors, &Numbers, &Vectors) {
            (&block.inverse, &block.square, &block.state.m)
        }
        match &self.blocks {
            Blocks::Momentum(blocks) => of(&blocks[b]),
            Blocks::Attitude(blocks) => of(&blocks[b]),
        }
    }

    /// 1/J and m of body i.
    fn body(&self, i: usize) -> Option<(Vector3<f64>, Vector3<f64>)> {
        (i < self.len).then(|| {
            let (inverse, _, m) = self.block(i / BLOCK);
            (vector(inverse, i % BLOCK), vector(m, i % BLOCK))
        })
    }
    /// m of body i; `None` for i ≥ [`len`](Self::len).
    pub fn momentum(&self, i: usize) -> Option<Vector3<f64>> {
        self.body(i).map(|(_, m)| m)
    }
    /// g of body i; `None` for i ≥ [`len`](Self::len), or without attitudes.
    pub fn attitude(&self, i: usize) -> Option<Matrix3<f64>> {
        match &self.blocks {
            Blocks::Attitude(blocks) if i < self.len => {
                let g = &blocks[i / BLOCK].state.g;
                Some(Matrix3::from_fn(|r, c| g[r][c][i % BLOCK]))
            }
            _ => None,
        }
    }
    /// ½ m·J⁻¹m of body i; `None` for i ≥ [`len`](Self::len).
    pub fn energy(&self, i: usize) -> Option<f64> {
        self.body(i).map(|(inverse, m)| 0.5 * inverse.dot(&m.component_mul(&m)))
    }

    /// Takes `steps` steps of size h for every body, on this number of threads. The caller's thread is one of them. Steps do
    /// not allocate; the start of the threads does, on the caller's thread, too.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an h that is not finite, or no threads; [`Error::Element`] with the number
    /// of the first body for which a step failed, and the reason. The bodies of its block have their state before the
    /// step. Some of the others are at the end.
    pub fn advance(
        &mut self,
        method: EnsembleMethod,
        h: f64,
        steps: u64,
        threads: usize,
    ) -> Result<(), Error> {
        Error::finite("h", h)?;
        if threads == 0 {
            return Err(Error::out_of_range("threads", 0.0, "at least 1"));
        }
        let way = Way { method, h, steps, age: self.age };
        match &mut self.blocks {
            Blocks::Momentum(blocks) => on_threads(way, blocks, threads),
            Blocks::Attitude(blocks) => on_threads(way, blocks, threads),
        }?;
        self.age = (self.age + steps % RESTORE_EVERY) % RESTORE_EVERY;
        Ok(())
    }
}

fn check_length(arg: &'static str, rows: usize, expected_rows: usize) -> Result<(), Error> {
    match rows == expected_rows {
        true => Ok(()),
        false => Err(Error::Shape { arg, rows, cols: 1, expected_rows, expected_cols: 1 }),
    }
}

/// What is done to every body.
#[derive(Clone, Copy)]
struct Way {
    method: EnsembleMethod,
    h: f64,
    steps: u64,
    age: u64,
}

fn on_threads<const ROWS: usize>(
    way: Way,
    blocks: &mut [Block<ROWS>],
    threads: usize,
) -> Result<(), Error> {
    let share = blocks.len().div_ceil(threads).max(1);
    let work = |(i, blocks): (usize, &mut [Block<ROWS>])| {
        let first = i * share * BLOCK;
        Arch::new().dispatch(Run { way, blocks, first })
    };
    std::thread::scope(|scope| {
        let mut shares = blocks.chunks_mut(share).enumerate();
        let own = shares.next();
        let others: Vec<_> = shares.map(|share| scope.spawn(move || work(share))).collect();
        let mut done = own.map_or(Ok(()), work);
        for other in others {
            // A thread that panicked has nothing to say but that.
            let result = other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            done = done.and(result);
        }
        done
    })
}

struct Run<'a, const ROWS: usize> {
    way: Way,
    blocks: &'a mut [Block<ROWS>],
    /// The number of the first body.
    first: usize,
}

impl<const ROWS: usize> WithSimd for Run<'_, ROWS> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Run { way, blocks, first } = self;
        // Every x86-64 machine with lanes of four has fused products.
        let fused = S::F64_LANES >= 4;
        for (number, block) in blocks.iter_mut().enumerate() {
            let first = first + number * BLOCK;
            match (way.method, fused) {
                (EnsembleMethod::Rkmk4Exp, true) => steps::<InExp, true, ROWS>(way, block, first)?,
                (EnsembleMethod::Rkmk4Exp, false) => {
                    steps::<InExp, false, ROWS>(way, block, first)?
                }
                (EnsembleMethod::Rkmk4Cay, true) => steps::<InCay, true, ROWS>(way, block, first)?,
                (EnsembleMethod::Rkmk4Cay, false) => {
                    steps::<InCay, false, ROWS>(way, block, first)?
                }
                (EnsembleMethod::Rk4, true) => steps::<Classical, true, ROWS>(way, block, first)?,
                (EnsembleMethod::Rk4, false) => steps::<Classical, false, ROWS>(way, block, first)?,
            }
        }
        Ok(())
    }
}

/// All steps of a block.
#[inline(always)]
fn steps<Rule: OneStep, const FUSED: bool, const ROWS: usize>(
    way: Way,
    block: &mut Block<ROWS>,
    first: usize,
) -> Result<(), Error> {
    let start = block.state;
    let (mut spare, mut is_spare, mut done) = (block.state, false, Ok(()));
    let mut work = Scratch { guard: [0.0; BLOCK], motion: [[0.0; BLOCK]; MOTION] };
    for n in 1..=way.steps {
        let Block { inverse, square, state } = block;
        let step = OneOf { way, n, first, inverse, square };
        // Each state has one role in each call. With one call for both the compiler was seen to mix up the turns of a
        // loop (docs/compiler-fault.md).
        done = match is_spare {
            false => step.take::<Rule, FUSED, ROWS>(state, &mut spare, &mut work),
            true => step.take::<Rule, FUSED, ROWS>(&spare, state, &mut work),
        };
        if done.is_err() {
            break;
        }
        is_spare = !is_spare;
    }
    if is_spare {
        block.state = spare;
    }
    if !Rule::KEEPS_GROUP && !are_finite(&block.state.g) {
        block.state = start;
        done = alone::<Rule, ROWS>(way, block, first);
    }
    if !Rule::KEEPS_GROUP {
        block.square = squares(&block.state.m);
    }
    done
}

/// What a step leaves for the attitudes, and the largest |u|² of its stages.
struct Scratch {
    motion: [Numbers; MOTION],
    guard: Numbers,
}

/// Step number n of a block.
struct OneOf<'a> {
    way: Way,
    n: u64,
    first: usize,
    inverse: &'a Vectors,
    square: &'a Numbers,
}

impl OneOf<'_> {
    #[inline(always)]
    fn take<Rule: OneStep, const FUSED: bool, const ROWS: usize>(
        self,
        from: &State<ROWS>,
        to: &mut State<ROWS>,
        Scratch { motion, guard }: &mut Scratch,
    ) -> Result<(), Error> {
        let OneOf { way, n, first, inverse, square } = self;
        momenta::<Rule, FUSED>(way.h, inverse, &from.m, &mut to.m, motion, guard);
        for (from, to) in from.g.iter().zip(&mut to.g) {
            rows::<Rule, FUSED>(way.h, motion, from, to);
        }
        if !guard.iter().fold(true, |all, g| all & (*g < SERIES)) {
            again::<Rule, ROWS>(way.h, guard, inverse, from, to, first)?;
        }
        if Rule::KEEPS_GROUP && (way.age + n).is_multiple_of(RESTORE_EVERY) {
            restore(&mut to.g);
            restore_momenta(square, &mut to.m);
        }
        Ok(())
    }
}

/// A step of all momenta, the numbers for the attitudes, and the largest |u|² of its stages; NaN if m is not finite.
/// Inputs and outputs are separate arguments, so that the compiler knows that they do not overlap.
#[inline(always)]
fn momenta<Rule: OneStep, const FUSED: bool>(
    h: f64,
    inverse: &Vectors,
    from: &Vectors,
    to: &mut Vectors,
    motion: &mut [Numbers; MOTION],
    guard: &mut Numbers,
) {
    for i in 0..BLOCK {
        let lane = |x: &Vectors| vector(x, i).map(Lane::<FUSED, SMALL>);
        let step = Rule::step(Lane(h), &lane(inverse), &lane(from));
        for k in 0..3 {
            to[k][i] = step.m[k].0;
        }
        for k in 0..MOTION {
            motion[k][i] = step.motion[k].0;
        }
        // 0·m is NaN where m is not finite.
        guard[i] = step.largest.0 + 0.0 * (step.m[0].0 + step.m[1].0 + step.m[2].0);
    }
}

/// The step of the momenta, for a row of all attitudes.
#[inline(always)]
fn rows<Rule: OneStep, const FUSED: bool>(
    h: f64,
    motion: &[Numbers; MOTION],
    from: &Vectors,
    to: &mut Vectors,
) {
    for i in 0..BLOCK {
        let motion = core::array::from_fn(|k| Lane::<FUSED, SMALL>(motion[k][i]));
        let row = Rule::carry(Lane(h), &motion, &vector(from, i).map(Lane));
        for k in 0..3 {
            to[k][i] = row[k].0;
        }
    }
}

/// The vector of body i.
#[inline(always)]
fn vector(x: &Vectors, i: usize) -> Vector3<f64> {
    Vector3::new(x[0][i], x[1][i], x[2][i])
}

/// Are all rows of g finite?
#[inline(always)]
fn are_finite<const ROWS: usize>(g: &[Vectors; ROWS]) -> bool {
    let all_below = |x: &Numbers| x.iter().fold(true, |all, x| all & (x.abs() <= f64::MAX));
    g.iter().flatten().fold(true, |all, x| all & all_below(x))
}

/// All steps of a block by the scalar method, or those before the first one that fails.
#[cold]
#[inline(never)]
fn alone<Rule: OneStep, const ROWS: usize>(
    way: Way,
    block: &mut Block<ROWS>,
    first: usize,
) -> Result<(), Error> {
    // Lanes without a body have 1/J = 0.
    let guard = block.inverse[0].map(|inverse| if inverse > 0.0 { f64::NAN } else { 0.0 });
    for _ in 0..way.steps {
        let from = block.state;
        let mut to = from;
        again::<Rule, ROWS>(way.h, &guard, &block.inverse, &from, &mut to, first)?;
        block.state = to;
    }
    Ok(())
}

/// Repeats the bodies with a large guard by the scalar method.
#[cold]
#[inline(never)]
fn again<Rule: OneStep, const ROWS: usize>(
    h: f64,
    guard: &Numbers,
    inverse: &Vectors,
    from: &State<ROWS>,
    to: &mut State<ROWS>,
    first: usize,
) -> Result<(), Error> {
    for (i, guard) in guard.iter().enumerate() {
        if *guard < SERIES {
            continue;
        }
        let (mut y, inverse) = (
            BodyState { m: vector(&from.m, i), g: Matrix3::identity() },
            vector(inverse, i).into(),
        );
        for (r, row) in from.g.iter().enumerate() {
            y.g.set_row(r, &vector(row, i).transpose());
        }
        Rule::one(inverse, h, &mut y)
            .map_err(|error| Error::Element { index: first + i, source: Box::new(error.into()) })?;
        for k in 0..3 {
            to.m[k][i] = y.m[k];
            for r in 0..ROWS {
                to.g[r][k][i] = y.g[(r, k)];
            }
        }
    }
    Ok(())
}

/// g ← g − ½ g (gᵀg − 𝟙): a step of Newton–Schulz. It converges for a small residual, and a larger one is left.
#[inline(always)]
fn restore<const ROWS: usize>(g: &mut [Vectors; ROWS]) {
    for i in 0..BLOCK {
        let (mut e, mut square) = ([[0.0; 3]; 3], 0.0);
        for (a, e) in e.iter_mut().enumerate() {
            for (b, e) in e.iter_mut().enumerate() {
                let products = g.iter().map(|row| row[a][i] * row[b][i]);
                *e = 0.5 * products.sum::<f64>() - if a == b { 0.5 } else { 0.0 };
                square += 4.0 * *e * *e;
            }
        }
        let is_near = square < RESIDUAL_MAX * RESIDUAL_MAX;
        for row in g.iter_mut() {
            let x = vector(row, i);
            for c in 0..3 {
                let change = x[0] * e[0][c] + x[1] * e[1][c] + x[2] * e[2][c];
                row[c][i] -= if is_near { change } else { 0.0 };
            }
        }
    }
}

/// |m|².
fn squares(m: &Vectors) -> Numbers {
    core::array::from_fn(|i| m[0][i] * m[0][i] + m[1][i] * m[1][i] + m[2][i] * m[2][i])
}

/// m ← m + ½m(1 − |m|²/|m₀|²), as [`LieGroup::correct_vector`](crate::LieGroup::correct_vector) has it.
#[inline(always)]
fn restore_momenta(square: &Numbers, m: &mut Vectors) {
    for (i, found) in squares(m).into_iter().enumerate() {
        let missing = 1.0 - found / square[i];
        let is_near = in_range(square[i]) && missing.abs() < RESIDUAL_MAX;
        let step = if is_near { 0.5 * missing } else { 0.0 };
        for m in m.iter_mut() {
            m[i] += step * m[i];
        }
    }
}
