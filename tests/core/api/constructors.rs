//! Groups, elements and problems are checked where they are made.

use approx::{AbsDiffEq, RelativeEq, assert_abs_diff_eq, assert_relative_eq};
use faer::{Mat, Scale, mat};
use lieflow::actions::LeftTranslation;
use lieflow::groups::{
    AlgebraMatrix, GroupMatrix, LieAlgebra, MEMBERSHIP, MatrixGroup, RCOND_MIN, So3,
};
use lieflow::maps::{CCSK, CoordinateMap, Exp};
use lieflow::methods::{Rkmk, tableau::DOPRI5};
use lieflow::problems::{
    Exact, Flow, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
};
use lieflow::{Error, Solve};
use nalgebra::Matrix3;

use super::says;

fn so(n: usize) -> MatrixGroup {
    MatrixGroup::so(n).unwrap()
}

#[test]
fn groups_check_their_size() {
    for refused in [MatrixGroup::so(0), MatrixGroup::gl(0), MatrixGroup::indefinite(0, 0)] {
        says(refused.unwrap_err(), &["n = 0", "1 ≤ n"]);
    }
    assert!(MatrixGroup::sp(0).is_err());
    says(MatrixGroup::sp(3).unwrap_err(), &["n = 3", "even"]);
    for huge in [32769, usize::MAX] {
        for refused in [MatrixGroup::so(huge), MatrixGroup::gl(huge)] {
            says(refused.unwrap_err(), &["n = ", "n ≤ 32768"]);
        }
        assert!(MatrixGroup::indefinite(huge, huge).is_err());
    }
    for n in [1, 2, 9] {
        assert_eq!(so(n).n(), n);
    }
}

#[test]
fn the_form_of_a_group_is_checked() {
    says(MatrixGroup::gm(Mat::zeros(2, 3)).unwrap_err(), &["M: 2×3", "square"]);
    says(MatrixGroup::gm(Mat::zeros(0, 0)).unwrap_err(), &["n = 0"]);
    let nan = mat![[1.0, 0.0], [f64::NAN, 1.0]];
    says(MatrixGroup::gm(nan).unwrap_err(), &["M[1,0] = NaN", "finite"]);
    let infinite = mat![[1.0, f64::NEG_INFINITY], [0.0, 1.0]];
    says(MatrixGroup::gm(infinite).unwrap_err(), &["M[0,1] = -inf", "finite"]);
    let rank_one = mat![[1.0, 2.0], [2.0, 4.0]];
    for singular in [rank_one, Mat::zeros(3, 3)] {
        let refused = MatrixGroup::gm(singular).unwrap_err();
        assert!(matches!(refused, Error::Singular { rcond: 0.0, .. }), "{refused}");
        says(refused, &["M", "depend on each other", "rcond = 0", "1e-14"]);
    }
    // Nearly singular: the reciprocal condition number decides, and it is scale-free.
    for scale in [1e-100, 1.0, 1e100] {
        let near = |gap: f64| mat![[1.0, 0.0], [0.0, gap]] * faer::Scale(scale);
        says(MatrixGroup::gm(near(1e-16)).unwrap_err(), &["rcond = 1e-16"]);
        assert!(MatrixGroup::gm(near(2.0 * RCOND_MIN)).is_ok(), "scale {scale}");
    }
}

#[test]
fn elements_of_the_algebra_are_checked() {
    says(so(2).algebra(Mat::zeros(2, 3)).unwrap_err(), &["u: 2×3", "square"]);
    says(so(3).algebra(Mat::zeros(2, 2)).unwrap_err(), &["u: 2×2", "3×3"]);
    let nan = mat![[0.0, f64::NAN], [0.0, 0.0]];
    says(so(2).algebra(nan.clone()).unwrap_err(), &["u[0,1] = NaN", "finite"]);
    says(MatrixGroup::gl(2).unwrap().algebra(nan).unwrap_err(), &["u[0,1] = NaN"]);
    let symmetric = mat![[0.0, 1.0], [1.0, 0.0]];
    says(so(2).algebra(symmetric.clone()).unwrap_err(), &["u", "SO(2)", "residual", "1.0e-12"]);
    assert!(MatrixGroup::gl(2).unwrap().algebra(symmetric.clone()).is_ok());
    assert!(MatrixGroup::sp(2).unwrap().algebra(symmetric).is_ok());
    // The residual is relative: the same answer at every size, without overflow.
    for size in [1e-300, 1e-10, 1.0, 1e300, 1e308] {
        let skewed = |gap: f64| mat![[0.0, -size], [size * (1.0 + gap), 0.0]];
        assert!(so(2).algebra(skewed(0.1 * MEMBERSHIP)).is_ok(), "size {size}");
        assert!(so(2).algebra(skewed(10.0 * MEMBERSHIP)).is_err(), "size {size}");
        assert!(so(2).algebra_within(skewed(1e-3), 1e-2).is_ok(), "size {size}");
    }
    assert!(so(2).algebra(Mat::zeros(2, 2)).is_ok());
}

#[test]
fn elements_of_the_group_are_checked() {
    says(so(2).element(Mat::zeros(3, 2)).unwrap_err(), &["g: 3×2", "square"]);
    says(so(3).element(Mat::identity(2, 2)).unwrap_err(), &["g: 2×2", "3×3"]);
    let nan = mat![[1.0, 0.0], [0.0, f64::INFINITY]];
    says(so(2).element(nan).unwrap_err(), &["g[1,1] = inf", "finite"]);
    let stretched = mat![[1.0, 0.0], [0.0, 1.0 + 1e-9]];
    says(so(2).element(stretched.clone()).unwrap_err(), &["g", "SO(2)", "residual", "1.0e-12"]);
    assert!(so(2).element_within(stretched, 1e-8).is_ok());
    says(so(2).element(Mat::zeros(2, 2)).unwrap_err(), &["g", "SO(2)"]);
    let reflection = mat![[1.0, 0.0], [0.0, -1.0]];
    assert_eq!(so(2).element(reflection), Err(Error::Reflection { arg: "g" }));
    says(Error::Reflection { arg: "g" }, &["g", "determinant is −1", "+1"]);
    says(
        MatrixGroup::gl(2).unwrap().element(mat![[1.0, 1.0], [1.0, 1.0]]).unwrap_err(),
        &["g", "depend on each other", "rcond"],
    );
    let squeeze = mat![[1e5, 0.0], [0.0, 1e-5]];
    assert!(MatrixGroup::sp(2).unwrap().element(squeeze).is_ok());
    for g in [1e200, 1e308] {
        assert!(so(2).element(mat![[g, 0.0], [0.0, g]]).is_err(), "{g}");
    }
}

/// SL(n), U(n) and SU(n) ask for more than their form, of matrices and at the start of a run.
#[test]
fn what_subgroups_ask_for_is_checked() {
    let [sl, u, su] =
        [MatrixGroup::sl(2), MatrixGroup::u(2), MatrixGroup::su(2)].map(Result::unwrap);
    assert_eq!([&sl, &u, &su].map(|group| group.name()), ["SL(2)", "U(2)", "SU(2)"]);
    let scaled = |x: f64| Mat::<f64>::identity(2, 2) * Scale(x);
    assert!(sl.element(mat![[2.0, 7.0], [0.0, 0.5]]).is_ok());
    says(
        sl.element(scaled(2.0)).unwrap_err(),
        &["g: not in SL(2)", "determinant is 4, expected 1"],
    );
    says(sl.element(scaled(1.0 + 1e-8)).unwrap_err(), &["determinant is 1.0000000", "expected 1"]);
    assert!(sl.algebra(mat![[1.0, 5.0], [0.0, -1.0]]).is_ok());
    says(
        sl.algebra(scaled(0.5)).unwrap_err(),
        &["u: not in the Lie algebra of SL(2)", "trace is 1 away"],
    );
    // i·𝟙 is in U(2), and e^{i·𝟙·π/2} has the determinant −1.
    let i = |x: f64| {
        Mat::from_fn(4, 4, |j, k| {
            if j == k + 2 {
                x
            } else if k == j + 2 {
                -x
            } else {
                0.0
            }
        })
    };
    assert!(u.algebra(i(1.0)).is_ok() && u.element(i(1.0)).is_ok());
    says(su.algebra(i(1.0)).unwrap_err(), &["SU(2)", "trace is 2 away from 0"]);
    says(su.element(i(1.0)).unwrap_err(), &["SU(2)", "determinant is -1, expected 1"]);
    // In so(4), and in SO(4), but no complex matrix.
    let mut turned = Mat::<f64>::zeros(4, 4);
    (turned[(0, 1)], turned[(1, 0)]) = (-1.0, 1.0);
    assert!(so(4).algebra(turned.clone()).is_ok());
    says(
        u.algebra(turned.clone()).unwrap_err(),
        &["u: not in the Lie algebra of U(2)", "residual"],
    );
    (turned[(2, 2)], turned[(3, 3)]) = (1.0, 1.0);
    assert!(so(4).element(turned.clone()).is_ok());
    says(u.element(turned).unwrap_err(), &["g: not in U(2)", "residual"]);

    let run = |group: &MatrixGroup, start: Mat<f64>, f: Mat<f64>| {
        let flow = Flow::new(group.clone(), LeftTranslation, move |_, _, v: &mut AlgebraMatrix| {
            v.copy_from(&f);
        });
        let method = Rkmk::new(DOPRI5, Exp);
        let solve = Solve::new(&flow, &method, [0.0, 1.0]);
        let start = GroupMatrix::new_unchecked(start);
        solve.dt(0.1).run(start).map(drop).map_err(|error| error.to_string())
    };
    let told = |result: Result<(), String>, words: &str| {
        assert!(result.as_ref().is_err_and(|told| told.contains(words)), "{result:?}: {words}");
    };
    let (zero, one) = (Mat::zeros(4, 4), Mat::<f64>::identity(4, 4));
    let reflection = Mat::from_fn(4, 4, |j, k| {
        if j != k {
            0.0
        } else if j == 3 {
            -1.0
        } else {
            1.0
        }
    });
    told(run(&so(4), reflection, zero.clone()), "y: its determinant is −1");
    told(run(&sl, scaled(2.0), Mat::zeros(2, 2)), "y: not in SL(2)");
    told(run(&su, i(1.0), zero.clone()), "y: not in SU(2)");
    told(run(&sl, scaled(1.0), scaled(1.0)), "f: not in the Lie algebra of SL(2)");
    told(run(&su, one.clone(), i(1.0)), "f: not in the Lie algebra of SU(2)");
    // A matrix with dependent rows is in no group; small entries and a growth of 1e12 are no reason.
    let gl = MatrixGroup::gl(2).unwrap();
    let zero_of_2 = || Mat::zeros(2, 2);
    told(
        run(&gl, mat![[1.0, 2.0], [2.0, 4.0]], zero_of_2()),
        "y: the columns of y depend on each other",
    );
    told(run(&gl, zero_of_2(), zero_of_2()), "y: the columns of y depend on each other");
    for stretched in [scaled(1e-200), mat![[1e12, 0.0], [0.0, 1e-12]]] {
        assert_eq!(run(&gl, stretched, zero_of_2()), Ok(()));
    }
    assert_eq!(run(&u, i(1.0), i(1.0)), Ok(()));
    assert_eq!(run(&su, one, zero), Ok(()));
}

/// Coordinates of the second kind turn single pairs of real axes, and so leave the complex matrices.
#[test]
fn ccsk_is_not_for_complex_matrices() {
    let u = MatrixGroup::u(2).unwrap();
    says(CCSK.at(&u).unwrap_err(), &["ccsk cannot be used with U(2)", "use exp or cay"]);
    assert!(CCSK.at(&so(4)).is_ok() && Exp.at(&u).is_ok());
}

#[test]
fn rotations_in_closed_form_are_checked() {
    let check = |g: Matrix3<f64>| So3::new().check_element("g", &g, MEMBERSHIP);
    assert_eq!(check(Matrix3::identity()), Ok(()));
    let mut g = Matrix3::identity();
    g[(2, 1)] = f64::NAN;
    says(check(g).unwrap_err(), &["g[2,1] = NaN", "finite"]);
    says(check(Matrix3::identity() * 1.01).unwrap_err(), &["g", "SO(3)", "residual"]);
    assert_eq!(check(-Matrix3::identity()), Err(Error::Reflection { arg: "g" }));
    assert!(check(Matrix3::identity() * 1e200).is_err());
}

#[test]
fn problems_check_their_parameters() {
    let wrong =
        [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e-320, "1e-320")];
    for (bad, digits) in wrong {
        let value = format!("inertia[1] = {digits}");
        let words = [value.as_str(), "finite number > 0"];
        says(RigidBody::<f64>::new([1.0, bad, 2.0]).unwrap_err(), &words);
        says(RigidBodyN::from_principal([1.0, bad, 2.0]).unwrap_err(), &words);
        says(Exact::new([1.0, bad, 2.0], [1.0; 3], Matrix3::identity()).unwrap_err(), &words);
    }
    let refused = RigidBodyAttitude::<f64>::new([1.0; 3], [0.0, 0.0, f64::NAN]).unwrap_err();
    says(refused, &["momentum_space[2] = NaN", "finite"]);
    says(RigidBodyN::from_pairs(4, &[1.0; 5]).unwrap_err(), &["inertia: 5×1", "6×1"]);
    assert!(RigidBodyN::from_pairs(0, &[]).is_err());
    says(RigidBodyN::manakov(&[1.0, f64::NAN]).unwrap_err(), &["lambda[1] = NaN"]);
    assert!(RigidBodyN::manakov(&[1.0, -1.0, 2.0]).is_err(), "J = 0");
    let body = RigidBodyN::from_principal([1.0, 2.0, 3.0]).unwrap();
    assert!(RigidBodyNAttitude::new(body, Mat::identity(3, 3)).is_err(), "not skew");
}

#[test]
fn elements_compare_approximately() {
    let u = |x: f64| so(2).algebra(mat![[0.0, -x], [x, 0.0]]).unwrap();
    assert_abs_diff_eq!(u(1.0), u(1.0 + 1e-10), epsilon = 1e-9);
    assert_relative_eq!(u(1e8), u(1e8 + 1e-2), max_relative = 1e-9);
    assert!(!u(1.0).abs_diff_eq(&u(1.1), 1e-3));
    assert!(!u(1.0).relative_eq(&u(1.1), 1e-3, 1e-3));
    let one = |n: usize| so(n).element(Mat::identity(n, n)).unwrap();
    assert_abs_diff_eq!(one(3), one(3));
    assert!(!one(2).abs_diff_eq(&one(3), 1e9), "matrices of different sizes differ");
    assert_eq!(u(0.5).into_mat()[(1, 0)], 0.5);
}
