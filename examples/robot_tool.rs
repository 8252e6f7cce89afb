//! The tool of a robot on SE(3): a twist in the axes of the tool, a target, and how errors of a twist spread.
//!
//! 1. A camera measures the twist of the tool in its own axes, a function of t: `Flow::in_body` integrates the pose.
//! 2. A controller reads the pose, and moves the tool to a target along the screw between both. It needs the logarithm, which no
//!    formula of a scene has. The screw that is left shrinks like exp(−kt).
//! 3. An error in a twist moves the pose by the left Jacobian of SE(3): J(u) = dexp_u.
//!
//! Poses are converted from and to the `Isometry3` of nalgebra.
//!
//! ```sh
//! cargo run --release --example robot_tool
//! ```

use lieflow::Error;
use lieflow::groups::{Adjoint, LieGroup, Se3};
use lieflow::maps::{dexp, exp, left_jacobian_se3, log};
use lieflow::nalgebra::{Isometry3, Matrix3, Point3, Vector3, Vector6};
use lieflow::prelude::*;

type V = Vector3<f64>;
/// A rotation and a position.
type Pose = (Matrix3<f64>, V);
/// An angular and a linear velocity.
type Twist = (V, V);

/// The twist from the pose g to the target, in the axes of the tool: log(g⁻¹ target).
fn screw_to(target: &Pose, g: &Pose) -> Result<Twist, Error> {
    let se3 = Se3::<f64>::new();
    let (mut back, mut between) = (se3.identity(), se3.identity());
    se3.inverse(g, &mut back)?;
    se3.compose(&back, target, &mut between);
    log(&se3, &between)
}

fn size((omega, v): &Twist) -> f64 {
    (omega.norm_squared() + v.norm_squared()).sqrt()
}

/// A twist in the axes of the tool: the tool moves along its first axis, turns left and rolls.
fn measured(t: f64) -> Twist {
    (V::new(0.4 * (2.0 * t).sin(), 0.0, 0.5), V::new(0.3, 0.0, 0.05))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let se3 = Se3::<f64>::new();
    let method = Rkmk::new(DOP853, Exp);

    // 1. From a pose of nalgebra, and back to one.
    let start = Isometry3::new(V::new(0.5, 0.0, 0.8), V::new(0.0, 0.3, 0.0));
    let moving = Flow::in_body(se3, |t, _: &Pose, twist: &mut Twist| *twist = measured(t));
    let run = |tolerance: f64| {
        let start = Se3::from_isometry(start);
        Solve::new(&moving, &method, [0.0, 10.0]).tolerances(tolerance, tolerance).run(start)
    };
    let (end, finer) = (run(1e-10)?.y, run(1e-13)?.y);
    let pose = Se3::to_isometry(&end)?;
    let tip = pose * Point3::new(0.0, 0.0, 0.1);
    println!("after 10 s the tip is at ({:.6}, {:.6}, {:.6})", tip.x, tip.y, tip.z);
    assert!((end.1 - finer.1).norm() < 1e-8 && (end.0 - finer.0).norm() < 1e-8);
    // The same in space: ġ = (Ad_g ξ) g.
    let in_space = Flow::new(se3, LeftTranslation, |t, g: &Pose, v: &mut Twist| {
        se3.big_ad(g, &measured(t), v).expect("a finite pose");
    });
    let same = Solve::new(&in_space, &method, [0.0, 10.0])
        .tolerances(1e-10, 1e-10)
        .run(Se3::from_isometry(start))?
        .y;
    assert!((same.1 - end.1).norm() < 1e-12);

    // 2. To a target, from far away: twist = k log(g⁻¹ target).
    let (k, target) = (0.8, Se3::from_isometry(Isometry3::new(V::new(0.2, 0.6, 0.3), V::z())));
    let to_target = Flow::in_body(se3, |_, g: &Pose, twist: &mut Twist| {
        // Near a half turn there is no one screw: then the tool waits.
        if let Ok((omega, v)) = screw_to(&target, g) {
            *twist = (k * omega, k * v);
        }
    });
    let first = size(&screw_to(&target, &end)?);
    let run =
        Solve::new(&to_target, &method, [0.0, 10.0]).tolerances(1e-11, 1e-11).count(5).run(end)?;
    for (t, g) in run.times.iter().zip(&run.points) {
        let left = size(&screw_to(&target, g)?);
        println!("t = {t:4.1}: {left:.3e} of the screw is left");
        // The tool stays on the screw on which it began.
        assert!((left - first * (-k * t).exp()).abs() < 1e-9 * first);
    }

    // 3. exp(u + δ) = exp(J δ) exp(u) to first order in δ.
    let u = (V::new(0.9, -0.4, 0.7), V::new(0.2, 1.0, -0.5));
    let jacobian = left_jacobian_se3(&u)?;
    let delta = Vector6::new(1.0, -0.5, 0.3, 0.2, 0.8, -0.6);
    let part =
        |x: &Vector6<f64>| -> Twist { (x.fixed_rows::<3>(0).into(), x.fixed_rows::<3>(3).into()) };
    let moved = part(&(jacobian * delta));
    let direct = dexp(&se3, &u, &part(&delta))?;
    assert!((moved.0 - direct.0).norm() + (moved.1 - direct.1).norm() < 1e-13);
    let step = 1e-5;
    let beside = |sign: f64| {
        let (omega, v) = part(&(sign * step * delta));
        exp(&se3, &(u.0 + omega, u.1 + v))
    };
    // The central difference of log(exp(u ± δ) exp(u)⁻¹).
    let mut back = se3.identity();
    se3.inverse(&exp(&se3, &u)?, &mut back)?;
    let difference = |g: Pose| -> Result<Twist, Error> {
        let mut left = se3.identity();
        se3.compose(&g, &back, &mut left);
        log(&se3, &left)
    };
    let (ahead, behind) = (difference(beside(1.0)?)?, difference(beside(-1.0)?)?);
    let slope = ((ahead.0 - behind.0) / (2.0 * step), (ahead.1 - behind.1) / (2.0 * step));
    let away = (slope.0 - moved.0).norm() + (slope.1 - moved.1).norm();
    println!("the left Jacobian is {away:.1e} from differences");
    assert!(away < 1e-8);
    Ok(())
}
