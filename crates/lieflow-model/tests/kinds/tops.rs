//! Tops that are nearly upright, and attitudes that are off the group.

use super::*;

const METHOD: &str = "name = \"rkmk\"\ntableau = \"dop853\"";
const TIME: &str = "t_span = [0, 0.1]\ndt = 0.05";

/// The first row of a top with these keys.
fn first(keys: &str, quantities: &str) -> Vec<f64> {
    let top = format!("kind = \"heavy-top\"\n{keys}\nomega_body = [0, 0, 1]\nweight = [0, 0, 1]");
    rows(&scene(&top, METHOD, TIME, quantities))[0][1..].to_vec()
}

/// The attitude that belongs to a vertical has that as its third row, however small its tilt.
#[test]
fn a_small_tilt_has_its_digits() {
    let tensor = "inertia = [[1, 0.1, 0], [0.1, 1.2, 0.2], [0, 0.2, 1.5]]";
    for inertia in ["inertia = [1, 1, 0.5]", tensor] {
        for up in [1.0, -1.0] {
            for tilt in [0.0, 1e-14, 1e-9, 3e-8, 1e-6, 1e-3, 1.0] {
                let length = f64::sqrt(1.25 * tilt * tilt + 1.0);
                let vertical = [tilt / length, -0.5 * tilt / length, up / length];
                let keys = format!("{inertia}\nvertical = {vertical:?}");
                let g = first(&keys, "[\"attitude\"]");
                // A tensor turns the vector to its axes and back.
                let rounding = if inertia == tensor { 1e-15 } else { 1e-15 * tilt };
                let gaps = [0, 1].map(|i| (g[6 + i] - vertical[i]).abs());
                assert!(gaps.iter().all(|gap| *gap <= rounding), "{keys}: {g:?}");
                assert!((g[8] - vertical[2]).abs() < 1e-15, "{keys}: {g:?}");
                let dot =
                    |i: usize, j: usize| (0..3).map(|k| g[3 * i + k] * g[3 * j + k]).sum::<f64>();
                let defect = [dot(0, 0) - 1.0, dot(1, 1) - 1.0, dot(0, 1), dot(0, 2), dot(1, 2)];
                assert!(defect.iter().all(|x| x.abs() < 4e-15), "{keys}: {defect:?}");
            }
        }
    }
}

/// Where a scene has an attitude and a vertical that differ a little, each form of the problem takes the attitude.
#[test]
fn a_vertical_beside_an_attitude_is_that_of_the_attitude() {
    let keys = "inertia = [1, 1, 0.5]\nvertical = [9e-7, 0, 1]\nquaternion = [1, 0, 0, 0]";
    let nutation = |quantities: &str| first(keys, quantities)[0];
    assert_eq!(nutation("[\"nutation\"]"), 0.0);
    assert_eq!(nutation("[\"nutation\", \"axis\"]"), 0.0);
}

/// The fourth integral of Lagrange's top is the momentum along the weight, however its body axes are turned.
#[test]
fn the_integral_of_lagrange_is_along_the_weight() {
    let weight = |tensor: &str, weight: &str, momentum: &str| {
        let top = format!(
            "kind = \"heavy-top\"\ninertia = {tensor}\nweight = {weight}\nmomentum_body = {momentum}\nvertical = [0, 0.6, 0.8]"
        );
        last(&scene(&top, METHOD, TIME, "[\"integral\"]"))[0]
    };
    let sign = |w: &str| weight("[2, 2, 0.7]", w, "[0.5, 0.2, 1.5]");
    assert!((sign("[0, 0, 1]") - 1.5).abs() < 1e-12 && (sign("[0, 0, -1]") + 1.5).abs() < 1e-12);
    for degrees in [0.0_f64, 1.0, 30.0, 89.0, 91.0, 150.0, 200.0, -1e-7] {
        let (s, c) = degrees.to_radians().sin_cos();
        // J = A 𝟙 + (C − A) a aᵀ for the axis a.
        let axis = [s, 0.0, c];
        let tensor: Vec<[f64; 3]> = (0..3)
            .map(|i| [0, 1, 2].map(|j| 2.0 * f64::from(u8::from(i == j)) - 1.3 * axis[i] * axis[j]))
            .collect();
        let momentum = [0.5 * c + 1.5 * s, 0.2, 1.5 * c - 0.5 * s];
        let [tensor, axis, momentum] =
            [format!("{tensor:?}"), format!("{axis:?}"), format!("{momentum:?}")];
        let integral = weight(&tensor, &axis, &momentum);
        assert!((integral - 1.5).abs() < 1e-12, "{degrees}: {integral}");
    }
}

/// A method that leaves the group ends with attitudes that are off it. Each has the quaternion of its polar factor.
#[test]
fn attitudes_off_the_group_have_a_quaternion() {
    let body = "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 0.4, 2]";
    let of = scene(
        body,
        "name = \"rk4\"",
        "t_span = [0, 20]\ndt = 0.1",
        "[\"quaternion\", \"attitude\", \"attitude_defect\"]",
    );
    let all = rows(&of);
    for row in &all {
        let (q, g) = (&row[1..5], &row[5..14]);
        let [w, x, y, z] = [q[0], q[1], q[2], q[3]];
        // The first column of the rotation of q.
        let column = [w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)];
        let gap = (0..3).map(|i| (g[3 * i] - column[i]).abs()).fold(0.0, f64::max);
        assert!(gap <= row[14] + 1e-14, "{row:?}");
    }
    assert!(all.last().unwrap()[14] > 1e-4, "{all:?}");
}
