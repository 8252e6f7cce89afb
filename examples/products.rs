//! Systems of unlike parts, on products of groups: a spin with an oscillator, and a satellite with a wheel.
//!
//! The first has a solution in closed form. The total angular momentum in space of the second is constant.
//!
//! ```sh
//! cargo run --release --example products
//! ```

use lieflow::actions::Pair;
use lieflow::groups::{Product, Translations};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::prelude::*;

/// The exact solution from (−e₃, (2, 0)).
///
/// In the frame that turns with the field, the angle a of the spin from −e₃ is that of a pendulum which comes to rest at
/// the top: sin(a/2) = tanh kt.
fn exact(w: f64, k: f64, t: f64) -> (Vector3<f64>, (f64, f64)) {
    let (half, (sine, cosine)) = ((k * t).tanh(), (w * t).sin_cos());
    let rest = 1.0 / (k * t).cosh();
    let (across, q) = (2.0 * half * rest, 2.0 * rest);
    let s = Vector3::new(-sine * across, cosine * across, 2.0 * half * half - 1.0);
    (s, (cosine * q, -sine * q))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // H = w s₃ + w (q² + p²)/2 + k (q s₁ − p s₂): ṡ = ∇_s H × s, q̇ = ∂H/∂p, ṗ = −∂H/∂q. A rotation
    // turns s, and a translation moves (q, p).
    let (w, k) = (3.0, 0.5);
    let pair = Product(So3::<f64>::new(), Translations::new((0.0, 0.0), 2));
    let system = Flow::new(pair, Linear, |_, (s, (q, p)), v| {
        v.0 = Vector3::new(k * q, -k * p, w);
        v.1 = (w * p - k * s[1], -w * q - k * s[0]);
    });
    println!("a spin and an oscillator, error at t = 8:");
    for steps in [200, 400, 800, 1600] {
        let (mut y, grid) = (exact(w, k, 0.0), TimeGrid::with_steps([0.0, 8.0], steps)?);
        integrate(&system, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
        let (s, (q, p)) = exact(w, k, 8.0);
        let error = (y.0 - s).norm() + (y.1.0 - q).hypot(y.1.1 - p);
        println!("  {steps:4} steps: {error:.1e}, |s| − 1 = {:8.1e}", y.0.norm() - 1.0);
    }

    // The state is m in the body, g from body to space, and the momentum h of the wheel about the first axis. A motor
    // turns the wheel with the torque u: ṁ = m × ω, ġ = gω̂, ḣ = u, with ω = J⁻¹(m − h e₁). The group turns m, and
    // multiplies g and h.
    let (inertia, torque) = (Vector3::new(2.0, 2.5, 3.0), 0.002);
    let parts = Product(So3::<f64>::new(), Product(So3::new(), Translations::new(0.0, 1)));
    let satellite = Flow::new(parts, Pair(Linear, LeftTranslation), |_, (m, (g, h)), v| {
        let omega = (m - Vector3::x() * *h).component_div(&inertia);
        *v = (-omega, (g * omega, torque));
    });
    let start = Vector3::new(0.1, 0.0, 1.0);
    let mut y = (start, (Matrix3::identity(), 0.0));
    let grid = TimeGrid::new([0.0, 450.0], 0.1)?;
    println!("a satellite whose wheel takes up its angular momentum:");
    let report = |t: f64, (m, (g, h)): &(Vector3<f64>, (Matrix3<f64>, f64))| {
        let (kept, off) = ((g * m - start).norm(), So3::new().defect(g));
        println!(
            "  t = {t:3}: m = {m:5.2?}, wheel {h:.2}, error in space {kept:.0e}, of g {off:.0e}",
            m = m.as_slice()
        );
    };
    integrate(&satellite, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Every(900), &mut y, report)?;
    Ok(())
}
