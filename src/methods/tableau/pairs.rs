//! Embedded pairs: a step and an error estimate from the same stages.
//!
//! | name | order | stages of the step | of the error | source |
//! |---|---|---|---|---|
//! | [`BS3`] | 3(2) | 3 | 4 | Bogacki, Shampine 1989 |
//! | [`RKF45`] | 5(4) | 6 | 6 | Fehlberg 1969; Hairer, Nørsett, Wanner I, p. 177 |
//! | [`DOPRI5`] | 5(4) | 6 | 7 | Dormand, Prince 1980; the same, p. 178 |
//! | [`VERNER6`] | 6(5) | 8 | 8 | Verner 1978; the same, p. 181 |
//!
//! The last stage of BS3 and DOPRI5 is f at the end of the step ("first same as last"). The step itself does not use it, but
//! the error estimate and dense output do. In steps by error [`Rk`](crate::methods::Rk) takes it as the first stage of the next
//! step, if that begins at the same t and y. [`Rkmk`](crate::methods::Rkmk) evaluates f again. The result of a step depends only
//! on its arguments.

use super::{Dense, ErrorEstimate, Row, Tableau, lower};

const BS3_B: [f64; 4] = [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0];

/// Bogacki–Shampine 3(2).
pub const BS3: Tableau<4> = Tableau {
    name: "bs3",
    order: 3,
    a: lower([&[], &[0.5], &[0.0, 0.75], &BS3_B]),
    b: BS3_B,
    c: [0.0, 0.5, 0.75, 1.0],
    error: Some(ErrorEstimate::of_pair(2, BS3_B, [7.0 / 24.0, 0.25, 1.0 / 3.0, 0.125])),
    dense: Dense::General,
};

const RKF45_B: [f64; 6] =
    [16.0 / 135.0, 0.0, 6656.0 / 12825.0, 28561.0 / 56430.0, -9.0 / 50.0, 2.0 / 55.0];

/// Runge–Kutta–Fehlberg 4(5), continued with the weights of order 5.
pub const RKF45: Tableau<6> = Tableau {
    name: "rkf45",
    order: 5,
    a: lower([
        &[],
        &[0.25],
        &[3.0 / 32.0, 9.0 / 32.0],
        &[1932.0 / 2197.0, -7200.0 / 2197.0, 7296.0 / 2197.0],
        &[439.0 / 216.0, -8.0, 3680.0 / 513.0, -845.0 / 4104.0],
        &[-8.0 / 27.0, 2.0, -3544.0 / 2565.0, 1859.0 / 4104.0, -11.0 / 40.0],
    ]),
    b: RKF45_B,
    c: [0.0, 0.25, 0.375, 12.0 / 13.0, 1.0, 0.5],
    error: Some(ErrorEstimate::of_pair(
        4,
        RKF45_B,
        [25.0 / 216.0, 0.0, 1408.0 / 2565.0, 2197.0 / 4104.0, -0.2, 0.0],
    )),
    dense: Dense::General,
};

const DOPRI5_B: [f64; 7] =
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0, 0.0];

/// Shampine's extension (Hairer, Nørsett, Wanner I, II.6, and their code DOPRI5).
const DOPRI5_DENSE: Dense = Dense::Raised {
    order: 4,
    stages: &[],
    rows: &[Row {
        stages: &[
            -12715105075.0 / 11282082432.0,
            0.0,
            87487479700.0 / 32700410799.0,
            -10690763975.0 / 1880347072.0,
            701980252875.0 / 199316789632.0,
            -1453857185.0 / 822651844.0,
        ],
        extra: &[69997945.0 / 29380423.0],
    }],
};

/// Dormand–Prince 5(4).
pub const DOPRI5: Tableau<7> = Tableau {
    name: "dopri5",
    order: 5,
    a: lower([
        &[],
        &[0.2],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        &DOPRI5_B,
    ]),
    b: DOPRI5_B,
    c: [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0],
    error: Some(ErrorEstimate::of_pair(
        4,
        DOPRI5_B,
        [
            5179.0 / 57600.0,
            0.0,
            7571.0 / 16695.0,
            393.0 / 640.0,
            -92097.0 / 339200.0,
            187.0 / 2100.0,
            1.0 / 40.0,
        ],
    )),
    dense: DOPRI5_DENSE,
};

const VERNER6_B: [f64; 8] = [
    3.0 / 40.0,
    0.0,
    875.0 / 2244.0,
    23.0 / 72.0,
    264.0 / 1955.0,
    0.0,
    125.0 / 11592.0,
    43.0 / 616.0,
];

/// Verner 6(5), continued with the weights of order 6.
#[rustfmt::skip]
pub const VERNER6: Tableau<8> = Tableau {
    name: "verner6",
    order: 6,
    a: lower([
        &[],
        &[1.0 / 6.0],
        &[4.0 / 75.0, 16.0 / 75.0],
        &[5.0 / 6.0, -8.0 / 3.0, 5.0 / 2.0],
        &[-165.0 / 64.0, 55.0 / 6.0, -425.0 / 64.0, 85.0 / 96.0],
        &[12.0 / 5.0, -8.0, 4015.0 / 612.0, -11.0 / 36.0, 88.0 / 255.0],
        &[-8263.0 / 15000.0, 124.0 / 75.0, -643.0 / 680.0, -81.0 / 250.0, 2484.0 / 10625.0, 0.0],
        &[
            3501.0 / 1720.0, -300.0 / 43.0, 297275.0 / 52632.0, -319.0 / 2322.0, 24068.0 / 84065.0,
            0.0, 3850.0 / 26703.0,
        ],
    ]),
    b: VERNER6_B,
    c: [0.0, 1.0 / 6.0, 4.0 / 15.0, 2.0 / 3.0, 5.0 / 6.0, 1.0, 1.0 / 15.0, 1.0],
    error: Some(ErrorEstimate::of_pair(
        5,
        VERNER6_B,
        [13.0 / 160.0, 0.0, 2375.0 / 5984.0, 5.0 / 16.0, 12.0 / 85.0, 3.0 / 44.0, 0.0, 0.0],
    )),
    dense: Dense::General,
};
