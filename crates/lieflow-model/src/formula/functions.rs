//! The functions and operators of formulas: names, values, costs.

use core::f64::consts::{PI, TAU};

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
    /// The product of two slopes: 0 where the second is 0, also if the first is infinite.
    Chain,
}

/// A function of vectors and matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OfVectors {
    Dot,
    Cross,
    Norm,
    Transpose,
}

/// The function that a name followed by a parenthesis calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Called {
    One(Function),
    Two(Operator),
    OfVectors(OfVectors),
}

/// The functions of numbers. Nothing else may have these names.
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

/// The functions of vectors. Only in front of a parenthesis do these names mean them.
const CALLED_OF_VECTORS: &[(&str, OfVectors)] = &[
    ("dot", OfVectors::Dot),
    ("cross", OfVectors::Cross),
    ("norm", OfVectors::Norm),
    ("transpose", OfVectors::Transpose),
];

impl Called {
    /// The function of that name.
    pub(super) fn named(name: &str) -> Option<Called> {
        let of_numbers = CALLED.iter().find(|(known, _)| *known == name).map(|(_, called)| *called);
        let of_vectors = CALLED_OF_VECTORS.iter().find(|(known, _)| *known == name);
        of_numbers.or(of_vectors.map(|(_, function)| Called::OfVectors(*function)))
    }

    /// The names of all.
    pub(super) fn names() -> impl Iterator<Item = &'static str> {
        CALLED.iter().map(|(name, _)| *name).chain(CALLED_OF_VECTORS.iter().map(|(name, _)| *name))
    }

    /// The arguments of the function, in words.
    pub(super) fn takes(self) -> &'static str {
        match self {
            Called::One(_) => "a number",
            Called::Two(_) => "two numbers",
            Called::OfVectors(OfVectors::Dot) => "two vectors of one length",
            Called::OfVectors(OfVectors::Cross) => "two vectors of 3",
            Called::OfVectors(OfVectors::Norm) => "a vector",
            Called::OfVectors(OfVectors::Transpose) => "a matrix",
        }
    }

    /// The arguments in words, if the function takes two.
    pub(super) fn second(self) -> Option<&'static str> {
        let of_two =
            matches!(self, Called::Two(_) | Called::OfVectors(OfVectors::Dot | OfVectors::Cross));
        of_two.then(|| self.takes())
    }
}

/// Numbers that have a name. Those of angles are units in radians: 5 degrees are `5*deg`, 3 turns a minute `3*rpm`.
pub(super) const CONSTANTS: &[(&str, f64)] = &[
    ("pi", PI),
    ("e", core::f64::consts::E),
    ("rad", 1.0),
    ("deg", PI / 180.0),
    ("arcmin", PI / 10_800.0),
    ("arcsec", PI / 648_000.0),
    ("turn", TAU),
    ("rev", TAU),
    ("rpm", TAU / 60.0),
];

/// Is it the name of a unit of angles?
pub(super) fn angle_unit(name: &str) -> bool {
    CONSTANTS.iter().any(|(constant, _)| *constant == name) && !["pi", "e"].contains(&name)
}

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
            Operator::Chain => {
                if y == 0.0 {
                    0.0
                } else {
                    x * y
                }
            }
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
            Operator::Mul | Operator::Chain => Ops::muls(1),
            Operator::Div => Ops::divs(1),
            Operator::Pow => Ops::trigs(2) + Ops::muls(1), // exp(y ln x)
            Operator::Atan2 => Ops::trigs(1) + Ops::divs(1),
            Operator::Min | Operator::Max => Ops::NONE,
        }
    }
}
