//! The derivative of a formula by one variable, operation by operation in the order of evaluation, so that
//! it is no longer than a few times the formula.
//!
//! | f | f′ |
//! |---|---|
//! | u ± v, uv, u/v | u′ ± v′, u′v + uv′, (u′ − (u/v)v′)/v |
//! | uⁿ, uᵛ | n uⁿ⁻¹u′, v uᵛ⁻¹u′ + uᵛ ln u v′ |
//! | sin, cos, tan | cos u u′, −sin u u′, (1 + tan²u)u′ |
//! | asin, acos, atan | u′/√(1 − u²), −u′/√(1 − u²), u′/(1 + u²) |
//! | sinh, cosh, tanh | cosh u u′, sinh u u′, (1 − tanh²u)u′ |
//! | exp, ln, log10, sqrt | exp u u′, u′/u, u′/(u ln 10), ½u′/√u |
//! | abs, sign | sign u u′, 0 |
//! | atan2(u, v) | (v u′ − u v′)/(u² + v²) |
//! | samples | the polynomial's derivative; at a knot that of the one after it |
//! | min, max | ½(1 ∓ sign(u − v))u′ + ½(1 ± sign(u − v))v′ |
//!
//! Where the slope u′ of an argument is 0, so is that of the function, also if f′(u) is infinite: `sqrt(max(x, 0))` has the
//! slope 0 for x < 0.

use super::functions::{Function, Operator};
use super::tape::{Builder, Op, TIME, Tape};

/// The derivative. None if it has too many operations.
pub(super) fn derivative(tape: &Tape, variable: usize) -> Option<Tape> {
    if !tape.uses(variable) {
        let mut build = Builder::default();
        let zero = build.number(0.0);
        return build.finish(zero);
    }
    let mut build = Builder::from_ops(tape.ops());
    // Nothing stands for 0.
    let mut slopes: Vec<Option<usize>> = Vec::with_capacity(tape.ops().len());
    for (at, &op) in tape.ops().iter().enumerate() {
        let slope = match op {
            Op::Number(_) => None,
            Op::Variable(index) => (index == variable).then(|| build.number(1.0)),
            Op::Sample(column, order) => {
                (variable == TIME).then(|| build.sample(column, order + 1))
            }
            Op::Apply(Function::Neg, x) => slopes[x].map(|du| build.apply(Function::Neg, du)),
            Op::Apply(function, x) => match (slopes[x], build.of_function(function, x, at)) {
                (Some(du), Some(outer)) => Some(build.chain(outer, du)),
                _ => None,
            },
            Op::Power(x, n) => slopes[x].map(|du| {
                let (factor, power) = (build.number(f64::from(n)), build.power(x, n - 1));
                let outer = build.times(factor, power);
                build.chain(outer, du)
            }),
            Op::Combine(operator, x, y) => {
                build.of_operator(operator, (x, slopes[x]), (y, slopes[y]), at)
            }
        };
        slopes.push(slope);
    }
    let root = slopes.last().copied().flatten().unwrap_or_else(|| build.number(0.0));
    build.finish(root)
}

/// A part of a formula and its derivative.
type Part = (usize, Option<usize>);

impl Builder {
    fn times(&mut self, x: usize, y: usize) -> usize {
        self.combine(Operator::Mul, x, y)
    }
    /// The slope of a function times that of its argument.
    fn chain(&mut self, outer: usize, inner: usize) -> usize {
        self.combine(Operator::Chain, outer, inner)
    }
    /// x + y.
    fn plus(&mut self, x: Option<usize>, y: Option<usize>) -> Option<usize> {
        match (x, y) {
            (Some(x), Some(y)) => Some(self.combine(Operator::Add, x, y)),
            (x, y) => x.or(y),
        }
    }
    /// x − y.
    fn minus(&mut self, x: Option<usize>, y: Option<usize>) -> Option<usize> {
        match (x, y) {
            (Some(x), Some(y)) => Some(self.combine(Operator::Sub, x, y)),
            (None, Some(y)) => Some(self.apply(Function::Neg, y)),
            (x, None) => x,
        }
    }
    /// 1 + x² or 1 − x².
    fn one_and_square(&mut self, sum: Operator, x: usize) -> usize {
        let (one, square) = (self.number(1.0), self.power(x, 2));
        self.combine(sum, one, square)
    }
    /// a/x.
    fn over(&mut self, a: f64, x: usize) -> usize {
        let a = self.number(a);
        self.combine(Operator::Div, a, x)
    }

    /// f′(u), with f(u) known; none for 0.
    fn of_function(&mut self, function: Function, u: usize, value: usize) -> Option<usize> {
        Some(match function {
            Function::Neg => self.number(-1.0),
            Function::Sin => self.apply(Function::Cos, u),
            Function::Cos => {
                let sine = self.apply(Function::Sin, u);
                self.apply(Function::Neg, sine)
            }
            Function::Tan => self.one_and_square(Operator::Add, value),
            Function::Asin | Function::Acos => {
                let square = self.one_and_square(Operator::Sub, u);
                let root = self.apply(Function::Sqrt, square);
                self.over(if function == Function::Asin { 1.0 } else { -1.0 }, root)
            }
            Function::Atan => {
                let square = self.one_and_square(Operator::Add, u);
                self.over(1.0, square)
            }
            Function::Sinh => self.apply(Function::Cosh, u),
            Function::Cosh => self.apply(Function::Sinh, u),
            Function::Tanh => self.one_and_square(Operator::Sub, value),
            Function::Exp => value,
            Function::Ln => self.over(1.0, u),
            Function::Log10 => self.over(core::f64::consts::LOG10_E, u),
            Function::Sqrt => self.over(0.5, value),
            Function::Abs => self.apply(Function::Sign, u),
            Function::Sign => return None,
        })
    }

    fn of_operator(
        &mut self,
        operator: Operator,
        (u, du): Part,
        (v, dv): Part,
        value: usize,
    ) -> Option<usize> {
        match operator {
            Operator::Add => self.plus(du, dv),
            Operator::Sub => self.minus(du, dv),
            Operator::Mul | Operator::Chain => {
                let (first, second) = (
                    du.map(|du| self.combine(operator, du, v)),
                    dv.map(|dv| self.combine(operator, u, dv)),
                );
                self.plus(first, second)
            }
            Operator::Div => {
                let moved = dv.map(|dv| self.times(value, dv));
                let above = self.minus(du, moved)?;
                Some(self.combine(Operator::Div, above, v))
            }
            Operator::Pow => {
                let base = du.map(|du| {
                    let one = self.number(1.0);
                    let less = self.combine(Operator::Sub, v, one);
                    let power = self.combine(Operator::Pow, u, less);
                    let outer = self.times(v, power);
                    self.chain(outer, du)
                });
                let exponent = dv.map(|dv| {
                    let ln = self.apply(Function::Ln, u);
                    let outer = self.chain(ln, value);
                    self.chain(outer, dv)
                });
                self.plus(base, exponent)
            }
            Operator::Atan2 => {
                let (first, second) =
                    (du.map(|du| self.times(v, du)), dv.map(|dv| self.times(u, dv)));
                let above = self.minus(first, second)?;
                let (uu, vv) = (self.power(u, 2), self.power(v, 2));
                let below = self.combine(Operator::Add, uu, vv);
                Some(self.combine(Operator::Div, above, below))
            }
            Operator::Min | Operator::Max => {
                let difference = self.combine(Operator::Sub, u, v);
                let sign = self.apply(Function::Sign, difference);
                let (half, one) = (self.number(0.5), self.number(1.0));
                let mut part = |slope: Option<usize>, with: Operator| {
                    let twice = self.combine(with, one, sign);
                    let weight = self.times(half, twice);
                    slope.map(|slope| self.chain(slope, weight))
                };
                let (greater, less) = match operator {
                    Operator::Max => (part(du, Operator::Add), part(dv, Operator::Sub)),
                    _ => (part(du, Operator::Sub), part(dv, Operator::Add)),
                };
                self.plus(greater, less)
            }
        }
    }
}
