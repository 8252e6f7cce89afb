//! The methods of the paper's tables, each on the equation that it integrates.

use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{
    Buss4, DMV4, DMV10, EnergyCasimir, MR2, MR4, Method, Rk, Rkmk, SimoWong, Step,
};
use lieflow::problems::{
    Ambient, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyState, ScalarOf,
};
use lieflow::scalar::{Counted, Ops, Real};
use lieflow::{Error, RunError, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

use lieflow_figures::plot::Marker;

/// A body of the paper with its initial data, angular momentum and attitude in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// J₁, J₂, J₃.
    pub inertia: [f64; 3],
    /// m_s.
    pub momentum_space: [f64; 3],
    /// g(0).
    pub attitude: Matrix3<f64>,
}

/// J = diag(1, 2, 3), ω(0) = (0.2, 0, 1).
pub const EXAMPLE1: Body = Body::new([1.0, 2.0, 3.0], [0.2, 0.0, 3.0]);
/// J = diag(1, 1, 2), ω(0) = (0.2, 0, 1).
pub const EXAMPLE2: Body = Body::new([1.0, 1.0, 2.0], [0.2, 0.0, 2.0]);
/// J⁻¹ = diag(1, 4, 18): the paper prints it as J.
pub const EXAMPLE3: Body = Body::new([1.0, 0.25, 1.0 / 18.0], [0.0, 2.75, 2.75]);

impl Body {
    /// A body with g(0) = 𝟙.
    pub const fn new(inertia: [f64; 3], momentum_space: [f64; 3]) -> Self {
        #[rustfmt::skip]
        let attitude = Matrix3::new(
            1.0, 0.0, 0.0,
            0.0, 1.0, 0.0,
            0.0, 0.0, 1.0,
        );
        Body { inertia, momentum_space, attitude }
    }

    /// The same motion seen from a frame in space that is turned by r: m_s → r m_s, g → r g.
    pub fn turned(&self, r: &Matrix3<f64>) -> Self {
        let m_s = r * Vector3::from(self.momentum_space);
        Body { momentum_space: m_s.into(), attitude: r * self.attitude, ..*self }
    }

    /// m(0) in the body.
    pub fn momentum_body(&self) -> Vector3<f64> {
        self.attitude.transpose() * Vector3::from(self.momentum_space)
    }

    fn problem<S: Real>(&self) -> Result<RigidBodyAttitude<S>, Error> {
        RigidBodyAttitude::new(self.inertia, self.momentum_space)
    }
}

/// A row of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// McLachlan and Reich, order 4.
    Mr,
    /// RKMK4 with exp.
    Exp,
    /// RKMK4 with ccsk, 321 and 123 in turn.
    Ccsk,
    /// RKMK4 with ccsk 321, the paper's ccskb.
    Ccsk321,
    /// RKMK4 with ccsk 123, the paper's ccskf.
    Ccsk123,
    /// RKMK4 with cay.
    Cay,
    /// Buss, order 4.
    B4,
    /// Classical RK4 on the nine entries of g.
    Rk4,
    /// McLachlan and Reich, order 2.
    Mr2,
    /// Simo and Wong.
    S,
    /// Discrete Moser–Veselov, order 4.
    Dmv4,
    /// Discrete Moser–Veselov, order 10.
    Dmv10,
    /// Classical RK4 on the momentum and the entries of g.
    Rk4mg,
    /// The energy and Casimir preserving method, on the momentum alone.
    EnergyCasimir,
}

impl Row {
    /// Those of Table 3, in its order.
    pub const PRINTED: [Row; 8] =
        [Row::Mr, Row::Exp, Row::Ccsk, Row::Ccsk321, Row::Ccsk123, Row::Cay, Row::B4, Row::Rk4];
    /// Those that are added.
    pub const ADDED: [Row; 6] =
        [Row::Mr2, Row::S, Row::Dmv4, Row::Dmv10, Row::Rk4mg, Row::EnergyCasimir];

    /// Every row.
    pub fn all() -> impl Iterator<Item = Row> {
        Self::PRINTED.into_iter().chain(Self::ADDED)
    }

    /// Its name in files.
    pub fn key(self) -> &'static str {
        match self {
            Row::Mr => "mr",
            Row::Exp => "exp",
            Row::Ccsk => "ccsk",
            Row::Ccsk321 => "ccsk321",
            Row::Ccsk123 => "ccsk123",
            Row::Cay => "cay",
            Row::B4 => "b4",
            Row::Rk4 => "rk4",
            Row::Mr2 => "mr2",
            Row::S => "simo-wong",
            Row::Dmv4 => "dmv4",
            Row::Dmv10 => "dmv10",
            Row::Rk4mg => "rk4-mg",
            Row::EnergyCasimir => "energy-casimir",
        }
    }

    /// Its name for people, the paper's where it has one.
    pub fn name(self) -> &'static str {
        match self {
            Row::Mr => "MR",
            Row::Exp => "exp",
            Row::Ccsk => "ccsk",
            Row::Ccsk321 => "ccskb (321)",
            Row::Ccsk123 => "ccskf (123)",
            Row::Cay => "cay",
            Row::B4 => "B4",
            Row::Rk4 => "RK4",
            Row::Mr2 => "MR2",
            Row::S => "S",
            Row::Dmv4 => "DMV4",
            Row::Dmv10 => "DMV10",
            Row::Rk4mg => "RK4 on (m, g)",
            Row::EnergyCasimir => "energy-Casimir",
        }
    }

    /// Its colour in figures.
    pub fn colour(self) -> usize {
        match self {
            Row::Exp => 0,
            Row::Cay => 1,
            Row::Ccsk123 => 2,
            Row::Ccsk321 => 3,
            Row::Ccsk => 4,
            Row::Rk4 | Row::Rk4mg => 5,
            Row::Mr | Row::Mr2 => 6,
            Row::B4 | Row::S | Row::Dmv4 | Row::Dmv10 | Row::EnergyCasimir => 7,
        }
    }

    /// Its marker in figures: rows of one colour have different ones.
    pub fn marker(self) -> Marker {
        let place = match self {
            Row::S => 3,
            Row::Dmv4 => 1,
            Row::Dmv10 => 2,
            Row::EnergyCasimir => 4,
            row => row.colour(),
        };
        Marker::cycle(place)
    }

    /// Is it one of those that the paper does not have?
    pub fn is_added(self) -> bool {
        Self::ADDED.contains(&self)
    }

    /// Hand over its problem, its method and the initial state.
    ///
    /// # Errors
    /// A body that cannot be.
    pub fn visit<V: Visit>(self, body: &Body, visitor: V) -> Result<V::Out, Error> {
        let problem = body.problem::<f64>()?;
        let g = body.attitude;
        Ok(match self {
            Row::Mr => visitor.call(&problem, &MR4, g),
            Row::Exp => visitor.call(&problem, &Rkmk::new(RK4, Exp), g),
            Row::Ccsk => visitor.call(&problem, &Rkmk::new(RK4, CCSK), g),
            Row::Ccsk321 => visitor.call(&problem, &Rkmk::new(RK4, CCSK321), g),
            Row::Ccsk123 => visitor.call(&problem, &Rkmk::new(RK4, CCSK123), g),
            Row::Cay => visitor.call(&problem, &Rkmk::new(RK4, Cay), g),
            Row::B4 => visitor.call(&problem, &Buss4, g),
            Row::Rk4 => visitor.call(&problem, &Rk(RK4), g),
            Row::Mr2 => visitor.call(&problem, &MR2, g),
            Row::S => visitor.call(&problem, &SimoWong::TAN, g),
            Row::Dmv4 => visitor.call(&problem, &DMV4, g),
            Row::Dmv10 => visitor.call(&problem, &DMV10, g),
            Row::Rk4mg => {
                let problem = RigidBodyState::new(body.inertia)?;
                let state = problem.state(body.momentum_body().into(), g)?;
                visitor.call(&problem, &Rk(RK4), state)
            }
            Row::EnergyCasimir => {
                let problem = RigidBody::new(body.inertia)?;
                visitor.call(&problem, &EnergyCasimir::new(Exp), body.momentum_body())
            }
        })
    }

    /// The operations of a step of this length from the initial state; none where the step fails.
    ///
    /// # Errors
    /// A body that cannot be.
    pub fn counted(self, body: &Body, h: f64) -> Result<Option<Ops>, Error> {
        let problem = body.problem::<Counted>()?;
        let g = body.attitude.map(Counted::lit);
        Ok(match self {
            Row::Mr => counted(&problem, &MR4, g, h),
            Row::Exp => counted(&problem, &Rkmk::new(RK4, Exp), g, h),
            Row::Ccsk => counted(&problem, &Rkmk::new(RK4, CCSK), g, h),
            Row::Ccsk321 => counted(&problem, &Rkmk::new(RK4, CCSK321), g, h),
            Row::Ccsk123 => counted(&problem, &Rkmk::new(RK4, CCSK123), g, h),
            Row::Cay => counted(&problem, &Rkmk::new(RK4, Cay), g, h),
            Row::B4 => counted(&problem, &Buss4, g, h),
            Row::Rk4 => counted(&problem, &Rk(RK4), g, h),
            Row::Mr2 => counted(&problem, &MR2, g, h),
            Row::S => counted(&problem, &SimoWong::TAN, g, h),
            Row::Rk4mg => {
                let problem = RigidBodyState::<Counted>::new(body.inertia)?;
                let m = body.momentum_body().map(Counted::lit);
                counted(&problem, &Rk(RK4), lieflow::problems::BodyState { m, g }, h)
            }
            Row::Dmv4 => counted(&problem, &DMV4, g, h),
            Row::Dmv10 => counted(&problem, &DMV10, g, h),
            Row::EnergyCasimir => {
                let problem = RigidBody::<Counted>::new(body.inertia)?;
                let m = body.momentum_body().map(Counted::lit);
                counted(&problem, &EnergyCasimir::new(Exp), m, h)
            }
        })
    }
}

fn counted<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    mut y: PointOf<P>,
    h: f64,
) -> Option<Ops> {
    let mut work = method.work(problem, &y).ok()?;
    let step = Step { n: 0, t: ScalarOf::<P>::lit(0.0), h: ScalarOf::<P>::lit(h) };
    let (done, ops) = Counted::count(|| method.step(problem, step, &mut y, &mut work));
    done.ok().map(|()| ops)
}

/// A body by what a table can ask of it.
pub trait Seen: Ambient {
    /// The momentum in the body.
    fn momentum(&self, y: &PointOf<Self>) -> Vector3<f64>;
    /// The attitude, where it is in the state.
    fn attitude(&self, y: &PointOf<Self>) -> Option<Matrix3<f64>>;
}

impl Seen for RigidBody {
    fn momentum(&self, m: &Vector3<f64>) -> Vector3<f64> {
        *m
    }
    fn attitude(&self, _: &Vector3<f64>) -> Option<Matrix3<f64>> {
        None
    }
}

impl Seen for RigidBodyAttitude {
    fn momentum(&self, g: &Matrix3<f64>) -> Vector3<f64> {
        self.momentum_body(g)
    }
    fn attitude(&self, g: &Matrix3<f64>) -> Option<Matrix3<f64>> {
        Some(*g)
    }
}

impl Seen for RigidBodyState {
    fn momentum(&self, y: &PointOf<Self>) -> Vector3<f64> {
        y.m
    }
    fn attitude(&self, y: &PointOf<Self>) -> Option<Matrix3<f64>> {
        Some(y.g)
    }
}

/// What to do with a row.
pub trait Visit {
    /// The answer.
    type Out;
    /// Do it.
    fn call<P: Seen, M: Method<P>>(self, problem: &P, method: &M, start: PointOf<P>) -> Self::Out;
}

/// Show t, m and g after every so many steps.
#[allow(missing_debug_implementations)] // it holds a closure
pub struct Watch<'a, F> {
    /// The steps.
    pub grid: &'a TimeGrid,
    /// Where to look.
    pub save: SaveAt,
    /// Who looks.
    pub see: F,
}

impl<F: FnMut(f64, Vector3<f64>, Option<Matrix3<f64>>)> Visit for Watch<'_, F> {
    type Out = Result<(), RunError>;
    fn call<P: Seen, M: Method<P>>(
        mut self,
        problem: &P,
        method: &M,
        mut y: PointOf<P>,
    ) -> Self::Out {
        integrate(problem, method, self.grid, &self.save, &mut y, |t, y| {
            (self.see)(t, problem.momentum(y), problem.attitude(y));
        })
        .map(|_| ())
    }
}
