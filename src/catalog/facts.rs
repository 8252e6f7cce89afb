//! What is known of a method: its order, what it takes, what it preserves, what a step costs.
//!
//! These are types, and listings are printed from them. So a program and its reader have the same facts.

use core::fmt;

use super::recipe::Recipe;
use crate::maps::{MAPS, MapInfo};

/// A method that scene files can name.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct MethodInfo {
    /// The family of the method.
    pub family: Family,
    /// The name of the method.
    pub name: &'static str,
    /// What the method is, in one line.
    pub summary: &'static str,
    /// The order of the method.
    pub order: Order,
    /// The coordinate maps that it takes.
    pub maps: Maps,
    /// Does it take a tableau?
    pub takes_tableau: bool,
    /// What the method preserves to rounding, or for all time within bounds.
    pub preserves: &'static [Property],
    /// What a step costs.
    pub cost: Cost,
    /// Where it comes from.
    pub source: &'static str,
    /// What the method needs of a problem.
    pub needs: Needs,
    /// How it is made.
    pub(crate) recipe: Recipe,
}

impl MethodInfo {
    /// Does the method take a coordinate map?
    pub fn takes_map(&self) -> bool {
        self.maps != Maps::None
    }

    /// Does the method take the cut q of the Baker series, with exp?
    pub fn takes_q(&self) -> bool {
        self.maps == Maps::All
    }

    /// The coordinate maps that the method takes.
    pub fn takes(&self) -> impl Iterator<Item = &'static MapInfo> {
        MAPS.iter().filter(|map| match self.maps {
            Maps::None => false,
            Maps::All => true,
            Maps::Odd => map.odd,
        })
    }

    /// Does the method preserve this?
    pub fn keeps(&self, structure: Property) -> bool {
        self.preserves.iter().any(|kept| [structure, Property::Everything].contains(kept))
    }

    /// Does the method preserve invariants that are polynomials of this degree in the state?
    pub fn keeps_polynomials(&self, degree: u32) -> bool {
        match degree {
            1 => {
                self.keeps(Property::LinearInvariants) || self.keeps(Property::QuadraticInvariants)
            }
            2 => self.keeps(Property::QuadraticInvariants),
            _ => false,
        }
    }

    /// What the method preserves, in words.
    pub fn preserves_in_words(&self) -> String {
        self.preserves.iter().map(Property::to_string).collect::<Vec<_>>().join(", ")
    }
}

macro_rules! named {
    ($(#[$doc:meta])* $name:ident: $($(#[$variant_doc:meta])* $variant:ident = $text:literal,)*) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)*
        }

        impl $name {
            /// The name, as in listings.
            pub const fn name(self) -> &'static str {
                match self {
                    $($name::$variant => $text,)*
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

named! {
    /// A family of methods.
    Family:
    /// Runge–Kutta–Munthe-Kaas: a Runge–Kutta method in coordinates of the group.
    Rkmk = "Runge–Kutta–Munthe-Kaas",
    /// Classical Runge–Kutta on the entries of the state.
    RungeKutta = "Runge–Kutta",
    /// Products of exponentials of sums of stages.
    CommutatorFree = "commutator-free",
    /// Products of exponentials of single stages.
    CrouchGrossman = "Crouch–Grossman",
    /// Magnus expansions.
    Magnus = "Magnus",
    /// Compositions of exact flows.
    Splitting = "splitting",
    /// Methods of Simo and Wong.
    EnergyMomentum = "energy and momentum",
    /// Discrete Moser–Veselov methods.
    DiscreteMechanics = "discrete mechanics",
    /// Taylor methods on the group.
    LieSeries = "Lie series",
    /// Classical methods with a projection after each step.
    Projection = "projection",
    /// Methods for Lie–Poisson systems.
    LiePoisson = "Lie–Poisson",
    /// The exact motion.
    Exact = "exact",
}

named! {
    /// What a method preserves.
    Property:
    /// All of it.
    Everything = "everything",
    /// The energy, to rounding.
    Energy = "energy",
    /// Membership in the group.
    Group = "group",
    /// Casimirs, and whatever else the action leaves invariant.
    Casimirs = "Casimirs",
    /// Invariants that are linear in the entries of the state; no others.
    LinearInvariants = "linear invariants only",
    /// Invariants that are linear or quadratic in the entries of the state.
    QuadraticInvariants = "quadratic invariants",
    /// The symplectic (Lie–Poisson) structure: the energy stays within bounds.
    Symplectic = "symplectic structure",
    /// Symmetry in time: a step back undoes a step.
    TimeSymmetry = "time symmetry",
}

/// The order of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Order {
    /// A number.
    Of(usize),
    /// The order of its tableau.
    Tableau,
    /// One order for the momentum alone, another with the attitude.
    MomentumAndAttitude(usize, usize),
    /// Every step is exact.
    Exact,
}

impl Order {
    /// The order where it is one number.
    pub const fn number(self) -> Option<usize> {
        match self {
            Order::Of(p) => Some(p),
            _ => None,
        }
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Order::Of(p) => write!(f, "{p}"),
            Order::Tableau => f.write_str("tableau's"),
            Order::MomentumAndAttitude(m, g) => write!(f, "{m} or {g}"),
            Order::Exact => f.write_str("exact"),
        }
    }
}

/// The coordinate maps that a method takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maps {
    /// None: it works without coordinates, or in exp alone.
    None,
    /// Every map of the group.
    All,
    /// Those with Ψ(−u) = Ψ(u)⁻¹: exp and cay.
    Odd,
}

/// How often something is done in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// This number of times.
    Exactly(u32),
    /// A number within these bounds, as an iteration has it.
    Between(u32, u32),
    /// As many times as the tableau has stages.
    Stages,
    /// Once less than the tableau has stages.
    StagesLessOne,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Count::Exactly(n) => write!(f, "{n}"),
            Count::Between(a, b) => write!(f, "{a}–{b}"),
            Count::Stages => f.write_str("s"),
            Count::StagesLessOne => f.write_str("s−1"),
        }
    }
}

named! {
    /// What a step does.
    Operation:
    /// An evaluation of f ∈ 𝔤.
    Field = "f",
    /// An evaluation of F = λ_*(f) on the linear space around M.
    AmbientField = "F",
    /// An evaluation of A(t).
    LinearField = "A",
    /// A gradient of the Hamiltonian.
    Gradient = "∇H",
    /// A coordinate map.
    Psi = "Ψ",
    /// An inverse differential of the map.
    DpsiInv = "dΨ⁻¹",
    /// An exponential.
    Exp = "exp",
    /// A Cayley map.
    Cay = "cay",
    /// An action on a point.
    Act = "Λ",
    /// A bracket.
    Bracket = "bracket",
    /// A triple product u v w.
    TripleProduct = "triple product",
    /// A product of matrices.
    Product = "product",
    /// A rotation about a principal axis.
    AxisRotation = "axis rotation",
    /// An iteration of Newton's method.
    NewtonIteration = "Newton iteration",
    /// An orthogonalisation by Gram and Schmidt.
    GramSchmidt = "Gram–Schmidt",
    /// A step of Newton and Schulz.
    NewtonSchulz = "Newton–Schulz",
    /// A cross product.
    CrossProduct = "×",
    /// An application of the inverse inertia.
    InverseInertia = "K",
    /// A multiplication of numbers, for a vector in ℝ³.
    Multiplication = "multiplication in ℝ³",
    /// The constants of an orbit, and its point at one time, whatever the step.
    Orbit = "orbit by elliptic functions",
    /// A step of energy-casimir.
    EnergyCasimirStep = "energy-casimir",
    /// A step of isospectral2.
    IsospectralStep = "isospectral2",
    /// A step of simo-wong.
    SimoWongStep = "simo-wong",
}

impl Operation {
    const fn plural(self) -> &'static str {
        match self {
            Operation::Bracket => "brackets",
            Operation::TripleProduct => "triple products",
            Operation::Product => "products",
            Operation::AxisRotation => "axis rotations",
            Operation::NewtonIteration => "Newton iterations",
            Operation::Multiplication => "multiplications in ℝ³",
            other => other.name(),
        }
    }
}

/// Something that is done in a step, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct WorkItem {
    /// How often the operation is done.
    pub count: Count,
    /// The operation.
    pub operation: Operation,
}

/// `count` times this operation.
pub(super) const fn times(count: u32, operation: Operation) -> WorkItem {
    WorkItem { count: Count::Exactly(count), operation }
}

impl fmt::Display for WorkItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.count {
            Count::Exactly(1) => self.operation.name(),
            _ => self.operation.plural(),
        };
        write!(f, "{} {name}", self.count)
    }
}

/// What a step costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Cost {
    /// The iterations of an implicit method; every one does [`work`](Self::work).
    pub iterations: Option<(u32, u32)>,
    /// What is done.
    pub work: &'static [WorkItem],
    /// What is done instead in another case.
    pub other_case: OtherCase,
}

/// What a step costs in another case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OtherCase {
    /// There is no other case.
    Nothing,
    /// With an estimate of its error.
    WithError(&'static [WorkItem]),
    /// On matrices of any n.
    OnMatrices(&'static [WorkItem]),
}

impl Cost {
    /// A step that does this.
    pub(super) const fn of(work: &'static [WorkItem]) -> Self {
        Cost { iterations: None, work, other_case: OtherCase::Nothing }
    }
    /// A step that does this in each of its iterations.
    pub(super) const fn iterated(iterations: (u32, u32), work: &'static [WorkItem]) -> Self {
        Cost { iterations: Some(iterations), work, other_case: OtherCase::Nothing }
    }

    /// How often a step of an explicit method does an operation; 0 where it does not.
    pub fn count(&self, operation: Operation) -> Count {
        let work = self.work.iter().find(|work| work.operation == operation);
        work.map_or(Count::Exactly(0), |work| work.count)
    }

    /// Evaluations of f, F or A in a step with a tableau of `stages` stages. `None` for an implicit method, whose
    /// number depends on the step, and for a method that evaluates no field.
    pub fn evaluations(&self, stages: u64) -> Option<u64> {
        use Operation::{AmbientField, Field, LinearField};
        let first = self.work.first().filter(|_| self.iterations.is_none())?;
        let is_field = [Field, AmbientField, LinearField].contains(&first.operation);
        match first.count {
            Count::Exactly(n) if is_field => Some(n.into()),
            Count::Stages if is_field => Some(stages),
            _ => None,
        }
    }
}

fn join(work: &[WorkItem]) -> String {
    work.iter().map(WorkItem::to_string).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.iterations, self.work) {
            (None, work) => f.write_str(&join(work))?,
            (Some((a, b)), [WorkItem { count: Count::Exactly(1), operation }]) => {
                write!(f, "{a}–{b} {operation}")?;
            }
            (Some((a, b)), [work]) => write!(f, "{a}–{b} × {work}")?,
            (Some((a, b)), work) => {
                let each = work.iter().map(|work| match work.count {
                    Count::Exactly(1) => work.operation.to_string(),
                    _ => work.to_string(),
                });
                write!(f, "{a}–{b} × ({})", each.collect::<Vec<_>>().join(", "))?;
            }
        }
        match self.other_case {
            OtherCase::Nothing => Ok(()),
            OtherCase::WithError(work) => write!(f, "; {} with the error", join(work)),
            OtherCase::OnMatrices(work) => write!(f, "; {}", join(work)),
        }
    }
}

/// What a method needs of a problem beyond f, and so what a problem may offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Needs {
    /// F on the linear space around M ([`Ambient`](crate::problems::Ambient)).
    Field,
    /// f that depends on time alone ([`LinearField`](crate::problems::LinearField)).
    LinearType,
    /// A norm of the points.
    Norm,
    /// Taylor coefficients ([`TaylorField`](crate::problems::TaylorField)).
    Series,
    /// The free rigid body in ℝ³ ([`FreeBody`](crate::problems::FreeBody), [`Split`](crate::problems::Split)).
    Body,
    /// The momentum of the free rigid body in ℝ³, without its attitude ([`RigidBody`](crate::problems::RigidBody)).
    Momentum,
    /// An orthogonal matrix in the state ([`Orthogonal`](crate::problems::Orthogonal)).
    Attitude,
    /// The momentum and the attitude as one state ([`RigidBodyState`](crate::problems::RigidBodyState)).
    State,
    /// A Hamiltonian on 𝔤* ([`LiePoisson`](crate::problems::LiePoisson)).
    LiePoisson,
    /// The coadjoint action on matrices ([`Coadjoint`](crate::actions::Coadjoint)): Ẇ = \[f, W\] for W = mᵀ.
    Isospectral,
}

impl Needs {
    /// Every need, in the order of listings.
    pub const ALL: [Needs; 10] = [
        Needs::Field,
        Needs::LinearType,
        Needs::Norm,
        Needs::Series,
        Needs::Body,
        Needs::Momentum,
        Needs::Attitude,
        Needs::State,
        Needs::LiePoisson,
        Needs::Isospectral,
    ];
}

/// What each need is, and why a method is refused where a problem does not offer it.
macro_rules! needs_in_words {
    ($($needs:ident = $text:literal,)*) => {
        impl Needs {
            /// What the need is, in words.
            pub const fn describe(self) -> &'static str {
                match self {
                    $(Needs::$needs => $text,)*
                }
            }
            pub(super) const fn why(self) -> &'static str {
                match self {
                    $(Needs::$needs => concat!("it needs ", $text),)*
                }
            }
        }
    };
}
needs_in_words! {
    Field = "a vector field on the linear space around M",
    LinearType = "an equation of linear type, f(t, y) = A(t)",
    Norm = "a norm of the states",
    Series = "a field with Taylor coefficients",
    Body = "a free rigid body in three dimensions",
    Momentum = "the momentum of a free rigid body in three dimensions, without its attitude",
    Attitude = "an attitude alone as its state",
    State = "a rigid body in three dimensions by its momentum and its attitude",
    LiePoisson = "a Lie–Poisson system, given by its momentum",
    Isospectral = "momenta as matrices",
}
