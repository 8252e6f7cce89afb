//! The dense output (continuous extension) of tableaus, as data.

/// The continuous extension of a tableau: u(θ) for 0 ≤ θ ≤ 1, with u(0) = 0 and u(1) = v = h Σ_j b_j k_j.
///
/// λ_p(u(θ)) is the approximation at t + θh; on a linear space it is y + u(θ). Each begins with the cubic of
/// Hermite between both ends, with the slopes h k₁ and h e:
///
/// u(θ) = θ²(3 − 2θ) v + θ(1 − θ)² h k₁ − θ²(1 − θ) h e + what raises the order.
///
/// The rows are shorter than the stages where the last weights are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dense {
    /// Only the cubic: the stages of the step give the slope e = Σ_j end_j k_j. It evaluates nothing.
    Cubic {
        /// The error at a fixed θ is O(h^(order + 1)).
        order: usize,
        /// The weights of the stages in e.
        end: &'static [f64],
    },
    /// The extension of Dormand and Prince: e = f̃(v) is the first extra stage, and
    /// θ²(1 − θ)² h (r₀ + θ r₁ + θ(1 − θ) r₂ + θ²(1 − θ) r₃) is added.
    Raised {
        /// The error at a fixed θ is O(h^(order + 1)).
        order: usize,
        /// The nodes and weights of the extra stages after the first, at most three.
        stages: &'static [(f64, Row)],
        /// The weights in r₀ to r₃.
        rows: &'static [Row],
    },
    /// The extension for any tableau: Hermite's interpolation from v, k₁ and values of f̃ at the end and within the step.
    ///
    /// Its order is the smaller of p and q for a method of order p: q = 3 with one evaluation for p ≤ 4, q = 4 with
    /// two for p = 5, and q = 5 with four above.
    General,
}

/// The weights of a combination of stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The weights of the stages of the step.
    pub stages: &'static [f64],
    /// The weights of the extra stages.
    pub extra: &'static [f64],
}
