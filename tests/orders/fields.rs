//! Measured orders: the methods of the catalog that ask for a field, or for one of linear type, on
//! problems that do not commute, depend on time and depend on the state. By the same harness: products
//! and SE(3) in `products.rs`, orders from 8 on in `wide.rs`, methods that ask for
//! more in `rigid_body.rs`.
//! `cargo test --release --test orders -- --nocapture` prints the table.

use crate::support::orders::{
    clocks, estimate, every_explicit_method_on, every_linear_method_on, every_method_on, grid,
    inertia, waves,
};
use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::groups::{MatrixGroup, So3};

crate::orders! {
    every_method_on:
    translation_on_so3_closed: many, So3::new(), LeftTranslation, waves(3, 0.5, 11);
    translation_on_so5: many, MatrixGroup::so(5).unwrap(), LeftTranslation, waves(5, 0.5, 11);
    translation_on_gl3: many, MatrixGroup::gl(3).unwrap(), LeftTranslation, waves(3, 0.2, 12);
    translation_on_sp4: many, MatrixGroup::sp(4).unwrap(), LeftTranslation, waves(4, 0.25, 12);
    translation_on_so31: many, MatrixGroup::indefinite(3, 1).unwrap(), LeftTranslation, waves(4, 0.35, 11);
    translation_on_so3: one, MatrixGroup::so(3).unwrap(), LeftTranslation, waves(3, 0.5, 11);
}

crate::orders! {
    every_explicit_method_on:
    orbits_of_so3_closed: one, So3::new(), Coadjoint, |_| inertia(3);
    orbits_of_so4: one, MatrixGroup::so(4).unwrap(), Coadjoint, |_| inertia(4);
    orbits_of_sp4: one, MatrixGroup::sp(4).unwrap(), Coadjoint, waves(4, 0.25, 16);
    vectors_of_so3_closed: one, So3::new(), Linear, waves(3, 1.0, 17);
    vectors_of_gl3: one, MatrixGroup::gl(3).unwrap(), Linear, waves(3, 0.25, 18);
}

crate::orders! {
    every_linear_method_on:
    linear_on_so3_closed: many, So3::new(), LeftTranslation, clocks(3, 1.5);
    linear_on_so5: many, MatrixGroup::so(5).unwrap(), LeftTranslation, clocks(5, 1.0);
    linear_on_gl3: many, MatrixGroup::gl(3).unwrap(), LeftTranslation, clocks(3, 0.7);
    linear_on_sp4: many, MatrixGroup::sp(4).unwrap(), LeftTranslation, clocks(4, 0.7);
    linear_on_so31: many, MatrixGroup::indefinite(3, 1).unwrap(), LeftTranslation, clocks(4, 1.0);
}

#[test]
fn the_estimator_reads_the_ratios_of_the_grid() {
    let steps = grid(4);
    let errors = |p: i32, size: f64| steps.map(|n| size * (n as f64).powi(-p));
    // Exact powers are read exactly, and a wrong claim is refused.
    let measured = estimate(3, &steps, &errors(3, 0.1)).unwrap();
    assert!((measured.order() - 3.0).abs() < 1e-12);
    assert!(measured.check().is_ok());
    assert!(estimate(4, &steps, &errors(3, 0.1)).unwrap().check().is_err());
    // An average would hide one bad pair; the pairwise rule does not.
    let mut dented = errors(4, 1.0);
    dented[5] *= 1.1;
    assert!(estimate(4, &steps, &dented).unwrap().check().is_err());
    // Errors at the level of rounding, too large or not numbers are not points.
    for flat in [1e-14, 0.5, f64::NAN] {
        assert!(estimate(4, &steps, &[flat; 7]).is_err());
    }
}
