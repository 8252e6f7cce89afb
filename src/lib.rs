//! Lie group integrators: ordinary differential equations on matrix Lie groups and on the
//! manifolds they act on.
//!
//! ```text
//!            Ψ                 Λ_p
//!     𝔤  ─────────▶   G   ─────────────▶  M          (Figure 2 of Celledoni & Owren)
//!     │                                   ▲
//!     └───────────────────────────────────┘
//!                  λ_p = Λ_p ∘ Ψ
//! ```
//!
//! An equation is given as f : M → 𝔤, ẏ = λ_*(f(t, y))(y); a step is taken in 𝔤 and carried to M,
//! so that the result never leaves M.
//!
//! # The rooms
//! A file uses what is in its own room and in those above it in this table.
//!
//! | room | symbol | what it has |
//! |---|---|---|
//! | [`scalar`] | | numbers: `f64`, double-double, numbers that count operations |
//! | [`names`] | | other spellings and other names of methods, maps, tableaus |
//! | [`error`] | | [`Error`], [`StepError`] |
//! | `quadrature` | | nodes and weights |
//! | `elliptic` | | Carlson's integrals, Jacobi's functions |
//! | [`samples`] | | tables of times and values as functions of time |
//! | [`dense`] | | exponentials of matrices: real and complex, in `f32`, and of many at once |
//! | [`so3`] | | the closed forms on so(3) ≅ ℝ³ |
//! | [`tolerance`] | | what the error of a step is compared with |
//! | [`space`] | | the linear space around M, and its metric |
//! | [`groups`] | 𝔤, G | [`LieAlgebra`], [`LieGroup`]; [`So3`](groups::So3), [`Se3`](groups::Se3), [`MatrixGroup`](groups::MatrixGroup), [`Product`](groups::Product), [`Power`](groups::Power) |
//! | [`maps`] | Ψ, dΨ⁻¹ | [`CoordinateMap`]; [`Exp`](maps::Exp), [`Cay`](maps::Cay), [`CCSK123`](maps::CCSK123), [`CCSK321`](maps::CCSK321) |
//! | [`actions`] | Λ, M | [`Action`]; left translation, coadjoint, linear, conjugation |
//! | [`problems`] | f : M → 𝔤 | [`Problem`]; rigid bodies, tops, Lie–Poisson, isospectral and other flows |
//! | [`chart`] | λ_p, f̃ | the chart around a point |
//! | [`methods`] | one step | [`Method`]; [`Rkmk`](methods::Rkmk), [`Rk`](methods::Rk) |
//! | [`solve`] | many steps | [`Solve`], [`Solution`], [`Event`], [`Integrator`] |
//! | [`floquet`] | | the monodromy of a linear system with periodic coefficients |
//! | [`ensemble`] | | many bodies at once |
//! | [`check`] | | the laws of groups and maps, for groups of other crates |
//! | [`catalog`] | | methods by name |
//!
//! Two layers share every trait: closed forms on so(3) ≅ ℝ³ over nalgebra, and any n over faer. The
//! same [`Rkmk`](methods::Rkmk) runs on both, and they agree to rounding.
//!
//! # Features
//! - `dense`, on by default: the layer of any n. It has [`dense`], [`MatrixGroup`](groups::MatrixGroup),
//!   [`Unitary`](groups::Unitary), their maps, actions, problems and methods, [`floquet`], [`check`] and [`catalog`].
//! - `tally`, off by default: matrices report how many operations they did.
//!
//! Without `dense` a build is small: rotations, unit quaternions, SE(3), SE₂(3), translations, and products and powers
//! of them. `prelude` then has neither `MatrixGroup` nor `MethodsByName`.
//!
//! # Conventions
//! Left actions, right-trivialised differentials (d/dε Ψ(u + εv) = dΨ_u(v)·Ψ(u)), hat and vee as in
//! equation (2), g maps body to space. They are stated once, in `docs/maths.md`; there is no switch.
//!
//! # A first run
//! ```
//! use lieflow::prelude::*;
//! use lieflow::problems::{Exact, RigidBodyAttitude};
//! use lieflow::nalgebra::Matrix3;
//!
//! let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.2, 0.0, 3.0]);
//! let body = RigidBodyAttitude::new(inertia, momentum)?;
//! let mut g = Matrix3::identity();
//! let grid = TimeGrid::new([0.0, 1.0], 0.01)?;
//! integrate(&body, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut g, |_, _| {})?;
//!
//! let (_, exact) = Exact::new(inertia, momentum, Matrix3::identity())?.state(1.0)?;
//! assert!((g - exact).norm() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![deny(missing_docs, rustdoc::broken_intra_doc_links)]
// The tables link to all that there is.
#![cfg_attr(not(feature = "dense"), allow(rustdoc::broken_intra_doc_links))]

pub mod actions;
#[cfg(feature = "dense")]
pub mod catalog;
pub mod chart;
#[cfg(feature = "dense")]
pub mod check;
#[cfg(feature = "dense")]
pub mod dense;
mod elliptic;
pub mod ensemble;
pub mod error;
#[cfg(feature = "dense")]
pub mod floquet;
pub mod groups;
pub mod maps;
pub mod methods;
pub mod names;
pub mod prelude;
pub mod problems;
mod quadrature;
pub mod samples;
pub mod scalar;
pub mod so3;
pub mod solve;
pub mod space;
pub mod tolerance;

/// The matrices of n rows and n columns that this library takes and gives.
#[cfg(feature = "dense")]
pub use faer;
/// The vectors and matrices of three dimensions that this library takes and gives.
pub use nalgebra;

pub use actions::Action;
pub use error::{Error, Failure, NoLogarithm, StepError};
pub use groups::{LieAlgebra, LieGroup};
pub use maps::CoordinateMap;
pub use methods::{Method, Step};
pub use problems::Problem;
pub use solve::{
    Direction, Event, Integrator, RESTORE_EVERY, RunError, SaveAt, Solution, Solve, Stats,
    StepControl, Stops, TimeGrid, integrate, integrate_adaptive,
};
