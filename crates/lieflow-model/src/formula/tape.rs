//! A formula as a list of operations, each on results of earlier ones: no recursion to evaluate it, and
//! what occurs twice is computed once.

use std::collections::HashMap;

use lieflow::samples::Samples;
use lieflow::scalar::{Ops, Real, tally};

use super::functions::{Function, Operator};

/// An operation; an index is that of an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Op {
    /// A number by its bits, so that equal operations are found.
    Number(u64),
    Variable(usize),
    /// The derivative of this order of a column of the samples at t, the first variable; the values for 0.
    Sample(usize, usize),
    Apply(Function, usize),
    Combine(Operator, usize, usize),
    /// xⁿ by products.
    Power(usize, i32),
}

/// The variable that samples are functions of.
pub(super) const TIME: usize = 0;

/// Powers by products up to this; others by exp and ln.
const POWER_MAX: f64 = 64.0;

/// Results that fit on the stack: no formula is longer, so that none allocates while it is evaluated.
pub(super) const LENGTH_MAX: usize = 4096;

/// The operations; the last one is the value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tape {
    ops: Vec<Op>,
    cost: Ops,
}

impl Tape {
    pub(super) fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// The variables that it depends on; some more than once.
    pub(super) fn inputs(&self) -> impl Iterator<Item = usize> {
        self.ops.iter().filter_map(|op| match op {
            Op::Variable(at) => Some(*at),
            Op::Sample(..) => Some(TIME),
            _ => None,
        })
    }

    /// Does it depend on this variable?
    pub(super) fn uses(&self, variable: usize) -> bool {
        self.inputs().any(|at| at == variable)
    }

    /// The variable and the number of a formula x/c; of x, with 1.
    pub(super) fn quotient(&self) -> Option<(usize, f64)> {
        if let [Op::Variable(at)] = *self.ops {
            return Some((at, 1.0));
        }
        let [first, second, Op::Combine(Operator::Div, above, below)] = *self.ops else {
            return None;
        };
        match ([first, second].get(above)?, [first, second].get(below)?) {
            (&Op::Variable(at), &Op::Number(bits)) => Some((at, f64::from_bits(bits))),
            _ => None,
        }
    }

    pub(super) fn value<S: Real + Into<f64>>(
        &self,
        values: &[S],
        samples: Option<&Samples>,
    ) -> f64 {
        tally(|| self.cost);
        match self.ops.len() {
            0..=16 => self.run(values, samples, &mut [0.0; 16]),
            17..=128 => self.run(values, samples, &mut [0.0; 128]),
            129..=1024 => self.run(values, samples, &mut [0.0; 1024]),
            _ => self.run(values, samples, &mut [0.0; LENGTH_MAX]),
        }
    }

    fn run<S: Real + Into<f64>>(
        &self,
        values: &[S],
        samples: Option<&Samples>,
        done: &mut [f64],
    ) -> f64 {
        let mut last = f64::NAN;
        for (i, op) in self.ops.iter().enumerate() {
            last = match *op {
                Op::Number(bits) => f64::from_bits(bits),
                Op::Variable(at) => values.get(at).map_or(f64::NAN, |&x| x.into()),
                Op::Sample(column, order) => match (samples, values.get(TIME)) {
                    (Some(samples), Some(&t)) => {
                        samples.derivative(column, order, t.into()).unwrap_or(f64::NAN)
                    }
                    _ => f64::NAN,
                },
                Op::Apply(function, x) => function.value(done[x]),
                Op::Combine(operator, x, y) => operator.value(done[x], done[y]),
                Op::Power(x, 2) => done[x] * done[x],
                Op::Power(x, n) => done[x].powi(n),
            };
            done[i] = last;
        }
        last
    }
}

/// Operations to which more are added.
#[derive(Debug, Default)]
pub(super) struct Builder {
    ops: Vec<Op>,
    found: HashMap<Op, usize>,
}

impl Builder {
    pub(super) fn from_ops(ops: &[Op]) -> Self {
        let found = ops.iter().enumerate().map(|(i, &op)| (op, i)).collect();
        Builder { ops: ops.to_vec(), found }
    }

    /// The operations of another formula; its value.
    pub(super) fn include(&mut self, tape: &Tape) -> usize {
        let mut place = Vec::with_capacity(tape.ops.len());
        for &op in &tape.ops {
            place.push(self.push(moved(op, &place)));
        }
        place.last().copied().unwrap_or_else(|| self.number(f64::NAN))
    }

    fn push(&mut self, op: Op) -> usize {
        let next = self.ops.len();
        let at = *self.found.entry(op).or_insert(next);
        if at == next {
            self.ops.push(op);
        }
        at
    }
    fn known(&self, at: usize) -> Option<f64> {
        match self.ops[at] {
            Op::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    pub(super) fn number(&mut self, x: f64) -> usize {
        self.push(Op::Number(x.to_bits()))
    }
    pub(super) fn variable(&mut self, index: usize) -> usize {
        self.push(Op::Variable(index))
    }
    pub(super) fn sample(&mut self, column: usize, order: usize) -> usize {
        self.push(Op::Sample(column, order))
    }
    pub(super) fn apply(&mut self, function: Function, x: usize) -> usize {
        match self.known(x) {
            Some(known) => self.number(function.value(known)),
            None => self.push(Op::Apply(function, x)),
        }
    }
    /// Numbers are combined at once; 1·x, x·1, x/1, x + 0, 0 + x and x − 0 are x. 0·x is not 0: x may have
    /// no value. (2x)/c is x/(c/2), with the same bits.
    pub(super) fn combine(&mut self, operator: Operator, x: usize, y: usize) -> usize {
        match (operator, self.known(x), self.known(y)) {
            (Operator::Pow, _, Some(n)) if n.fract() == 0.0 && n.abs() <= POWER_MAX => {
                self.power(x, n as i32)
            }
            (_, Some(a), Some(b)) => self.number(operator.value(a, b)),
            (Operator::Mul | Operator::Div | Operator::Chain, _, Some(1.0)) => x,
            (Operator::Add | Operator::Sub, _, Some(0.0)) => x,
            (Operator::Mul | Operator::Chain, Some(1.0), _) | (Operator::Add, Some(0.0), _) => y,
            (Operator::Div, None, Some(divisor)) => match self.half_of(x) {
                Some(half) if (divisor / 2.0).is_normal() => {
                    let divisor = self.number(divisor / 2.0);
                    self.combine(operator, half, divisor)
                }
                _ => self.push(Op::Combine(operator, x, y)),
            },
            _ => self.push(Op::Combine(operator, x, y)),
        }
    }
    /// The x of an operation 2x.
    fn half_of(&self, double: usize) -> Option<usize> {
        match self.ops[double] {
            Op::Combine(Operator::Mul, two, x) if self.known(two) == Some(2.0) => Some(x),
            _ => None,
        }
    }
    /// xⁿ.
    pub(super) fn power(&mut self, x: usize, n: i32) -> usize {
        match (self.known(x), n) {
            (_, 0) => self.number(1.0),
            (_, 1) => x,
            (Some(known), _) => self.number(known.powi(n)),
            (None, _) => self.push(Op::Power(x, n)),
        }
    }

    /// The operations that `root` needs, and no others. None if they are too many.
    pub(super) fn finish(&self, root: usize) -> Option<Tape> {
        let mut needed = vec![false; root + 1];
        needed[root] = true;
        for i in (0..=root).rev() {
            if needed[i] {
                operands(self.ops[i]).for_each(|x| needed[x] = true);
            }
        }
        let (mut ops, mut place) = (Vec::new(), vec![0; root + 1]);
        for i in (0..=root).filter(|&i| needed[i]) {
            place[i] = ops.len();
            ops.push(moved(self.ops[i], &place));
        }
        let cost = ops.iter().fold(Ops::NONE, |sum, &op| sum + cost(op));
        (ops.len() <= LENGTH_MAX).then_some(Tape { ops, cost })
    }
}

/// The operation with its operands at new places.
fn moved(op: Op, place: &[usize]) -> Op {
    match op {
        Op::Apply(function, x) => Op::Apply(function, place[x]),
        Op::Combine(operator, x, y) => Op::Combine(operator, place[x], place[y]),
        Op::Power(x, n) => Op::Power(place[x], n),
        op => op,
    }
}

fn operands(op: Op) -> impl Iterator<Item = usize> {
    let (first, second) = match op {
        Op::Number(_) | Op::Variable(_) | Op::Sample(..) => (None, None),
        Op::Apply(_, x) | Op::Power(x, _) => (Some(x), None),
        Op::Combine(_, x, y) => (Some(x), Some(y)),
    };
    first.into_iter().chain(second)
}

fn cost(op: Op) -> Ops {
    match op {
        Op::Number(_) | Op::Variable(_) => Ops::NONE,
        // A cubic in t less the time of a row.
        Op::Sample(..) => Ops::adds(1) + Ops::muladds(3),
        Op::Apply(function, _) => function.cost(),
        Op::Combine(operator, ..) => operator.cost(),
        Op::Power(_, n) => {
            let size = n.unsigned_abs();
            let products = size.checked_ilog2().unwrap_or(0) + size.count_ones().saturating_sub(1);
            Ops::muls(products as usize) + Ops::divs(usize::from(n < 0))
        }
    }
}
