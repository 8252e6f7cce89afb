//! Two coupled Mathieu oscillators ẍ = −K(t)x: a linear Hamiltonian system ġ = A(t)g on Sp(4).
//!
//! The monodromy matrix, the solution after one period, decides whether small motions stay small.
//!
//! ```sh
//! cargo run --release --example symplectic
//! ```

use lieflow::prelude::*;
use std::f64::consts::TAU;

use faer::Mat;
use lieflow::floquet::monodromy;
use lieflow::groups::AlgebraMatrix;
use lieflow::problems::LinearHamiltonian;

/// ġ = A(t)g, A(t) = [0 𝟙; −K(t) 0] with K(t) = diag(stiffness) + drive·cos t·𝟙 + coupling.
fn mathieu(
    group: MatrixGroup,
    stiffness: [f64; 2],
    coupling: f64,
    drive: f64,
) -> LinearHamiltonian<impl Fn(f64, &mut AlgebraMatrix)> {
    Flow::of_time(group, LeftTranslation, move |t, a: &mut AlgebraMatrix| {
        a.fill(0.0);
        for i in 0..2 {
            a[(i, 2 + i)] = 1.0;
            a[(2 + i, i)] = -(stiffness[i] + drive * t.cos());
            a[(2 + i, 1 - i)] = -coupling;
        }
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A drive of frequency 1 resonates with an oscillator of frequency 1/2.
    for (name, stiffness) in [("off resonance", [0.49, 0.64]), ("in resonance", [0.25, 0.64])] {
        let group = MatrixGroup::sp(4)?;
        let system = mathieu(group.clone(), stiffness, 0.05, 0.1);
        let by_exp = |steps| monodromy(&system, &Rkmk::new(RK4, Exp), [0.0, TAU], steps);
        let by_cay = |steps| monodromy(&system, &Rkmk::new(RK4, Cay), [0.0, TAU], steps);
        let reference = by_exp(2560)?;
        println!("{name}: steps, error with exp (order), with cay (order), |gᵀJg − J|");
        let mut coarser = [f64::NAN; 2];
        for steps in [40, 80, 160] {
            let both = [by_exp(steps)?, by_cay(steps)?];
            let error = both.each_ref().map(|g| group.distance(g, &reference));
            let order = [0, 1].map(|i| (coarser[i] / error[i]).log2());
            let defect = both.each_ref().map(|g| group.defect(g));
            println!(
                "{steps:6} {:9.1e} ({:4.2}) {:9.1e} ({:4.2}) {:8.0e}",
                error[0],
                order[0],
                error[1],
                order[1],
                defect[0].max(defect[1])
            );
            assert!(defect.iter().all(|&d| d < 1e-12), "g stays symplectic to rounding");
            assert!(order.iter().all(|p| p.is_nan() || (p - 4.0).abs() < 0.3), "order 4");
            coarser = error;
        }

        let g: &Mat<f64> = &reference;
        let multipliers = g.eigenvalues().map_err(|e| format!("{e:?}"))?;
        let sizes: Vec<_> = multipliers.iter().map(|z| format!("{:.4}", z.norm())).collect();
        let largest = multipliers.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let stable = largest < 1.0 + 1e-6;
        let verdict = if stable { "stable" } else { "unstable" };
        println!("       moduli of the multipliers: {}: {verdict}", sizes.join(", "));
        assert!((g.determinant() - 1.0).abs() < 1e-12);
        for z in &multipliers {
            let partner = multipliers.iter().map(|w| (z * w - 1.0).norm()).fold(1.0, f64::min);
            assert!(partner < 1e-9, "with λ, 1/λ is a multiplier too");
        }
        assert_eq!(stable, name == "off resonance");
    }
    Ok(())
}
