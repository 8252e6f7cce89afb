//! What is known of a method before any step: its orders and costs.

use super::MapCounts;
use crate::error::Error;

/// The cost of a step. A number is `None` if steps have different ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepCost {
    /// Evaluations of f. A method that needs F, A or Taylor coefficients counts these.
    pub evaluations: Option<u64>,
    /// Evaluations of Ψ and dΨ⁻¹, and brackets.
    pub maps: Option<MapCounts>,
}

impl StepCost {
    /// The cost of n steps.
    pub fn times(self, n: u64) -> Self {
        StepCost {
            evaluations: self.evaluations.map(|evaluations| n * evaluations),
            maps: self.maps.map(|maps| maps.times(n)),
        }
    }
}

/// Which steps of a method are taken in two halves. The point half way is kept; another point within is a shorter step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halves {
    /// None.
    Never,
    /// Those with an error estimate. Each half has the cost of a [`step`](Facts::step).
    ForError,
    /// All, as by [`Doubling`](super::Doubling).
    Always,
}

/// What is known of a method on a problem before any step.
///
/// ```
/// use lieflow::methods::{Facts, Method, Rkmk, tableau::RK4};
/// use lieflow::{maps::Exp, problems::RigidBody};
///
/// let facts: Facts = Rkmk::new(RK4, Exp).facts(&RigidBody::<f64>::new([1.0, 2.0, 3.0])?);
/// assert_eq!((facts.order, facts.step.evaluations), (4, Some(4)));
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facts {
    /// The order of the method. Tests measure it.
    pub order: usize,
    /// The order of [`interpolate`](super::Method::interpolate): its error at a fixed θ is O(h^(dense_order + 1)).
    pub dense_order: usize,
    /// The order of the error estimate: it behaves like h to the power error_order + 1. `None` without an estimate.
    pub error_order: Option<usize>,
    /// The name of the tableau, for messages.
    pub tableau: &'static str,
    /// The cost of a step.
    pub step: StepCost,
    /// The cost of a step with an error estimate.
    pub step_with_error: StepCost,
    /// The evaluations of f in [`prepare`](super::Method::prepare), and in each
    /// [`interpolate`](super::Method::interpolate).
    pub dense_evaluations: [Option<u64>; 2],
    /// Which steps are taken in two halves.
    pub halves: Halves,
    /// True if a step stays on M up to rounding. Then the driver corrects the state to M from time to time
    /// ([`Action::restore`](crate::Action::restore)). The state of other methods is not corrected.
    pub stays_on_manifold: bool,
    /// True if f is evaluated only within a step, not at its start or end, also for points between. Then a step to a stop has
    /// its whole size ([`Solve::stops`](crate::Solve::stops)).
    pub stages_within: bool,
    /// True if steps by error have to turn the state by 8 radians at most: those in halves of methods with dΨ⁻¹, and others
    /// that say so. Points within longer steps may have no digits, where no error estimate sees it. Pairs of `Rkmk` choose such
    /// steps themselves.
    pub short_turns: bool,
}

impl Facts {
    /// A method of this order that stays on M. The cost of its steps is not known. It has no error estimate. Points within
    /// a step are shorter steps.
    pub const fn of_order(order: usize) -> Self {
        let unknown = StepCost { evaluations: None, maps: None };
        Facts {
            order,
            dense_order: order,
            error_order: None,
            tableau: "",
            step: unknown,
            step_with_error: unknown,
            dense_evaluations: [Some(0), None],
            halves: Halves::Never,
            stays_on_manifold: true,
            stages_within: false,
            short_turns: false,
        }
    }

    /// Sets the cost of a step. It is that of a step with an error estimate, too. A point within a step has the same
    /// evaluations of f.
    pub const fn cost(self, evaluations: Option<u64>, maps: MapCounts) -> Self {
        let step = StepCost { evaluations, maps: Some(maps) };
        let dense_evaluations = [Some(0), evaluations];
        Facts { step, step_with_error: step, dense_evaluations, ..self }
    }

    /// Says that f is evaluated only within a step, as at Gauss–Legendre nodes.
    pub const fn stages_within(self) -> Self {
        Facts { stages_within: true, ..self }
    }

    /// Says that steps by error have to turn the state by 8 radians at most.
    pub const fn short_turns(self) -> Self {
        Facts { short_turns: true, ..self }
    }

    /// Sets the order of the error estimate of a tableau; `None` for a tableau without an embedded row.
    pub const fn estimate(self, tableau: &'static str, error_order: Option<usize>) -> Self {
        Facts { tableau, error_order, ..self }
    }

    /// Sets the order of dense output, and the evaluations of f that prepare it. A point costs no evaluation.
    pub const fn dense(self, order: usize, evaluations: usize) -> Self {
        Facts { dense_order: order, dense_evaluations: [Some(evaluations as u64), Some(0)], ..self }
    }

    /// The order of the error estimate.
    ///
    /// # Errors
    /// [`Error::Unsupported`] without an estimate.
    pub fn order_of_estimate(&self) -> Result<usize, Error> {
        self.error_order.ok_or_else(|| Error::Unsupported {
            what: "a step size of its own choice",
            with: format!("tableau `{}`", self.tableau),
            why: "it has no embedded row; use a pair such as `dopri5`, or step doubling",
        })
    }

    /// Takes each step in two halves; a step with an error estimate takes a long one, too.
    pub(crate) fn doubled(self) -> Self {
        Facts {
            dense_order: self.order,
            step: self.step.times(2),
            dense_evaluations: [Some(0), self.step.evaluations],
            halves: Halves::Always,
            ..self.doubled_for_error()
        }
    }

    /// The facts of a method whose steps are doubled where an error is asked for. A point within a doubled step is a shorter
    /// step.
    pub(crate) fn doubled_for_error(self) -> Self {
        let has_dpsi_inv = self.step.maps.is_some_and(|maps| maps.dpsi_inv > 0);
        Facts {
            short_turns: self.short_turns || has_dpsi_inv,
            error_order: Some(self.order),
            step_with_error: self.step.times(3),
            halves: Halves::ForError,
            ..self
        }
    }
}
