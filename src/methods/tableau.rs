//! Explicit Butcher tableaus as constants. Tests run the order conditions over every one.

/// An explicit Runge–Kutta tableau with S stages; `a[i]` is used for j < i only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau<const S: usize> {
    /// Its name in scene files.
    pub name: &'static str,
    /// Its classical order.
    pub order: usize,
    /// Stage weights a_ij.
    pub a: [[f64; S]; S],
    /// Update weights b_j.
    pub b: [f64; S],
    /// Nodes c_i.
    pub c: [f64; S],
}

/// Euler's method, order 1.
pub const EULER: Tableau<1> = Tableau { name: "euler", order: 1, a: [[0.0]], b: [1.0], c: [0.0] };

/// The explicit midpoint rule (Runge), order 2.
pub const MIDPOINT: Tableau<2> =
    Tableau { name: "midpoint", order: 2, a: [[0.0; 2], [0.5, 0.0]], b: [0.0, 1.0], c: [0.0, 0.5] };

/// Heun's method (the explicit trapezoidal rule), order 2.
pub const HEUN: Tableau<2> =
    Tableau { name: "heun", order: 2, a: [[0.0; 2], [1.0, 0.0]], b: [0.5, 0.5], c: [0.0, 1.0] };

/// The classical method of order 4 (Hairer, Nørsett, Wanner I, p. 138).
pub const RK4: Tableau<4> = Tableau {
    name: "rk4",
    order: 4,
    a: [[0.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
    b: [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: [0.0, 0.5, 0.5, 1.0],
};

/// Kutta's 3/8 rule, order 4 (Hairer, Nørsett, Wanner I, p. 138).
pub const THREE_EIGHTHS: Tableau<4> = Tableau {
    name: "three-eighths",
    order: 4,
    a: [[0.0; 4], [1.0 / 3.0, 0.0, 0.0, 0.0], [-1.0 / 3.0, 1.0, 0.0, 0.0], [1.0, -1.0, 1.0, 0.0]],
    b: [1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0, 1.0 / 8.0],
    c: [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0],
};
