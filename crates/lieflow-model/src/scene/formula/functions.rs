//! The functions and operators of formulas: names, values, costs.

use lieflow::scalar::Ops;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Function {
    Neg,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Sign,
}

/// A function of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Atan2,
    Min,
    Max,
}

/// What a name followed by a parenthesis calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Called {
    One(Function),
    Two(Operator),
}

/// Every name that can be called.
pub(super) const CALLED: &[(&str, Called)] = &[
    ("sin", Called::One(Function::Sin)),
    ("cos", Called::One(Function::Cos)),
    ("tan", Called::One(Function::Tan)),
    ("asin", Called::One(Function::Asin)),
    ("acos", Called::One(Function::Acos)),
    ("atan", Called::One(Function::Atan)),
    ("atan2", Called::Two(Operator::Atan2)),
    ("sinh", Called::One(Function::Sinh)),
    ("cosh", Called::One(Function::Cosh)),
    ("tanh", Called::One(Function::Tanh)),
    ("exp", Called::One(Function::Exp)),
    ("ln", Called::One(Function::Ln)),
    ("log10", Called::One(Function::Log10)),
    ("sqrt", Called::One(Function::Sqrt)),
    ("abs", Called::One(Function::Abs)),
    ("sign", Called::One(Function::Sign)),
    ("min", Called::Two(Operator::Min)),
    ("max", Called::Two(Operator::Max)),
];

/// Numbers that have a name.
pub(super) const CONSTANTS: &[(&str, f64)] =
    &[("pi", core::f64::consts::PI), ("e", core::f64::consts::E)];

impl Function {
    pub(super) fn value(self, x: f64) -> f64 {
        match self {
            Function::Neg => -x,
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Sinh => x.sinh(),
            Function::Cosh => x.cosh(),
            Function::Tanh => x.tanh(),
            Function::Exp => x.exp(),
            Function::Ln => x.ln(),
            Function::Log10 => x.log10(),
            Function::Sqrt => x.sqrt(),
            Function::Abs => x.abs(),
            // signum(0) is 1 in Rust.
            Function::Sign if x == 0.0 => 0.0,
            Function::Sign => x.signum(),
        }
    }

    /// As [`Counted`](lieflow::scalar::Counted) counts: signs and comparisons are free.
    pub(super) fn cost(self) -> Ops {
        match self {
            Function::Neg | Function::Abs | Function::Sign => Ops::NONE,
            Function::Sqrt => Ops::sqrts(1),
            _ => Ops::trigs(1),
        }
    }
}

impl Operator {
    pub(super) fn value(self, x: f64, y: f64) -> f64 {
        match self {
            Operator::Add => x + y,
            Operator::Sub => x - y,
            Operator::Mul => x * y,
            Operator::Div => x / y,
            Operator::Pow => x.powf(y),
            Operator::Atan2 => x.atan2(y),
            // min and max of Rust hide a NaN.
            Operator::Min | Operator::Max if x.is_nan() || y.is_nan() => f64::NAN,
            Operator::Min => x.min(y),
            Operator::Max => x.max(y),
        }
    }

    pub(super) fn cost(self) -> Ops {
        match self {
            Operator::Add | Operator::Sub => Ops::adds(1),
            Operator::Mul => Ops::muls(1),
            Operator::Div => Ops::divs(1),
            Operator::Pow => Ops::trigs(2) + Ops::muls(1), // exp(y ln x)
            Operator::Atan2 => Ops::trigs(1) + Ops::divs(1),
            Operator::Min | Operator::Max => Ops::NONE,
        }
    }
}
