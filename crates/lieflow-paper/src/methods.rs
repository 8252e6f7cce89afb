//! The methods of the paper's tables, each on the equation that it integrates.

use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{
    AnyMethod, Buss4, DMV4, DMV10, EnergyCasimir, MR2, MR4, Method, Rk, Rkmk, SimoWong, Step,
};
use lieflow::problems::{
    Ambient, BodyState, Exact, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyState,
    ScalarOf,
};
use lieflow::scalar::{Counted, Ops, Real};
use lieflow::{Error, RunError, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

use lieflow_figures::{Marker, Point, Series};

use lieflow_timing::seconds_of;

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

    /// The body seen from a frame in space that is turned by r: m_s → r m_s, g → r g.
    pub fn turned(&self, r: &Matrix3<f64>) -> Self {
        let m_s = r * Vector3::from(self.momentum_space);
        Body { momentum_space: m_s.into(), attitude: r * self.attitude, ..*self }
    }

    /// m(0) in the body.
    pub fn momentum_body(&self) -> Vector3<f64> {
        self.attitude.transpose() * Vector3::from(self.momentum_space)
    }

    /// The exact momentum in the body and attitude at t.
    ///
    /// # Errors
    /// A body that cannot be.
    pub fn exact(&self, t: f64) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        Exact::new(self.inertia, self.momentum_body().into(), self.attitude)?.state(t)
    }
}

/// A method of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperMethod {
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

/// `$call` on the problem, the method and the start of a method, on numbers of a type.
macro_rules! on_method {
    ($row:expr, $body:expr, $number:ty, |$problem:ident, $method:ident, $start:ident| $call:expr) => {{
        let body: &Body = $body;
        let attitude = body.attitude.map(<$number>::lit);
        let on_g = RigidBodyAttitude::<$number>::new(body.inertia, body.momentum_space)?;
        let momentum = body.momentum_body().map(<$number>::lit);
        macro_rules! arm {
            ($of:expr, $by:expr, $from:expr) => {{
                let ($problem, $method, $start) = ($of, $by, $from);
                $call
            }};
        }
        match $row {
            PaperMethod::Mr => arm!(&on_g, &MR4, attitude),
            PaperMethod::Exp => arm!(&on_g, &Rkmk::new(RK4, Exp), attitude),
            PaperMethod::Ccsk => arm!(&on_g, &Rkmk::new(RK4, CCSK), attitude),
            PaperMethod::Ccsk321 => arm!(&on_g, &Rkmk::new(RK4, CCSK321), attitude),
            PaperMethod::Ccsk123 => arm!(&on_g, &Rkmk::new(RK4, CCSK123), attitude),
            PaperMethod::Cay => arm!(&on_g, &Rkmk::new(RK4, Cay), attitude),
            PaperMethod::B4 => arm!(&on_g, &Buss4, attitude),
            PaperMethod::Rk4 => arm!(&on_g, &Rk(RK4), attitude),
            PaperMethod::Mr2 => arm!(&on_g, &MR2, attitude),
            PaperMethod::S => arm!(&on_g, &SimoWong::TAN, attitude),
            PaperMethod::Dmv4 => arm!(&on_g, &DMV4, attitude),
            PaperMethod::Dmv10 => arm!(&on_g, &DMV10, attitude),
            PaperMethod::Rk4mg => {
                let state = BodyState { m: momentum, g: attitude };
                arm!(&RigidBodyState::<$number>::new(body.inertia)?, &Rk(RK4), state)
            }
            PaperMethod::EnergyCasimir => {
                let on_m = RigidBody::<$number>::new(body.inertia)?;
                arm!(&on_m, &EnergyCasimir::new(Exp), momentum)
            }
        }
    }};
}

impl PaperMethod {
    /// The methods of Table 3, in its order.
    pub const PRINTED: [PaperMethod; 8] = [
        PaperMethod::Mr,
        PaperMethod::Exp,
        PaperMethod::Ccsk,
        PaperMethod::Ccsk321,
        PaperMethod::Ccsk123,
        PaperMethod::Cay,
        PaperMethod::B4,
        PaperMethod::Rk4,
    ];
    /// The methods that the paper does not have.
    pub const ADDED: [PaperMethod; 6] = [
        PaperMethod::Mr2,
        PaperMethod::S,
        PaperMethod::Dmv4,
        PaperMethod::Dmv10,
        PaperMethod::Rk4mg,
        PaperMethod::EnergyCasimir,
    ];

    /// Every method.
    pub fn all() -> impl Iterator<Item = PaperMethod> {
        Self::PRINTED.into_iter().chain(Self::ADDED)
    }

    /// Its name in files and for people, the paper's where it has one, its colour and its marker in
    /// figures: methods of one colour have different markers.
    #[rustfmt::skip]
    const fn look(self) -> (&'static str, &'static str, usize, usize) {
        match self {
            PaperMethod::Mr => ("mr", "MR", 6, 6),
            PaperMethod::Exp => ("exp", "exp", 0, 0),
            PaperMethod::Ccsk => ("ccsk", "ccsk", 4, 4),
            PaperMethod::Ccsk321 => ("ccsk321", "ccskb (321)", 3, 3),
            PaperMethod::Ccsk123 => ("ccsk123", "ccskf (123)", 2, 2),
            PaperMethod::Cay => ("cay", "cay", 1, 1),
            PaperMethod::B4 => ("b4", "B4", 7, 7),
            PaperMethod::Rk4 => ("rk4", "RK4", 5, 5),
            PaperMethod::Mr2 => ("mr2", "MR2", 6, 6),
            PaperMethod::S => ("simo-wong", "S", 8, 3),
            PaperMethod::Dmv4 => ("dmv4", "DMV4", 1, 1),
            PaperMethod::Dmv10 => ("dmv10", "DMV10", 2, 2),
            PaperMethod::Rk4mg => ("rk4-mg", "RK4 on (m, g)", 5, 5),
            PaperMethod::EnergyCasimir => ("energy-casimir", "energy-Casimir", 9, 4),
        }
    }

    /// Its name in files; of RKMK4 that of its map.
    pub fn key(self) -> &'static str {
        self.look().0
    }

    /// Its name for people.
    pub fn name(self) -> &'static str {
        self.look().1
    }

    /// Its line in a figure, dashed where the paper does not have it.
    pub fn line<P: Into<Point>>(self, points: impl IntoIterator<Item = P>) -> Series {
        Series::line(self.name(), self.look().2, points).with_dash(Self::ADDED.contains(&self))
    }

    /// Its line with a marker at each point.
    pub fn marked_line<P: Into<Point>>(self, points: impl IntoIterator<Item = P>) -> Series {
        self.line(points).with_marker(Marker::cycle(self.look().3))
    }

    /// Run it from the initial data, and show t, the momentum in the body and the attitude, where it is in
    /// the state, after every given number of steps.
    ///
    /// # Errors
    /// A body that cannot be, or a step that fails.
    pub fn run(
        self,
        body: &Body,
        grid: &TimeGrid,
        save: SaveAt,
        see: &mut See<'_>,
    ) -> Result<(), RunError> {
        on_method!(self, body, f64, |problem, method, start| {
            run(problem, AnyMethod::new(*method), start, (grid, save), see)
        })
    }

    /// The CPU time of a run, which is repeated until `shortest` seconds are over.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn seconds(self, body: &Body, grid: &TimeGrid, shortest: f64) -> Result<f64, RunError> {
        on_method!(self, body, f64, |problem, method, start| {
            seconds(problem, AnyMethod::new(*method), &start, grid, shortest)
        })
    }

    /// The operations of a step of this length from the initial state. `None` if the step fails.
    ///
    /// # Errors
    /// A body that cannot be.
    pub fn counted(self, body: &Body, h: f64) -> Result<Option<Ops>, Error> {
        on_method!(self, body, Counted, |problem, method, start| Ok(counted(
            problem, method, start, h
        )))
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

/// A body whose momentum and attitude can be read from its state.
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

/// What gets t, m and g.
pub type See<'a> = dyn FnMut(f64, Vector3<f64>, Option<Matrix3<f64>>) + 'a;

fn run<P: Seen + 'static>(
    problem: &P,
    method: AnyMethod<'static, P>,
    mut y: PointOf<P>,
    (grid, save): (&TimeGrid, SaveAt),
    see: &mut See<'_>,
) -> Result<(), RunError> {
    let see = |t, y: &PointOf<P>| see(t, problem.momentum(y), problem.attitude(y));
    integrate(problem, &method, grid, &save, &mut y, see).map(|_| ())
}

fn seconds<P: Seen + 'static>(
    problem: &P,
    method: AnyMethod<'static, P>,
    start: &PointOf<P>,
    grid: &TimeGrid,
    shortest: f64,
) -> Result<f64, RunError> {
    seconds_of(shortest, || {
        let mut y = start.clone();
        let see = |_, y: &PointOf<P>| {
            core::hint::black_box(y);
        };
        integrate(problem, &method, grid, &SaveAt::Ends, &mut y, see).map(|_| ())
    })
}
