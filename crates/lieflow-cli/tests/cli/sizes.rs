//! The numbers of a scene may be of any size: what is said of a run does not change with a factor of all of them.

use crate::support::Folder;

/// Powers of two. The squares of such numbers overflow, those of their errors underflow, or those of both.
const POWERS: [i32; 7] = [516, 700, 1000, -515, -518, -522, -900];

/// Bodies whose moments and torques are proportional to `s`, with rows of the momentum.
const BODIES: [&str; 3] = [
    "kind = \"rigid-body\"\ninertia = [\"s\", \"2*s\", \"3*s\"]\nomega_body = [0.2, 0.3, 1]\nparameters = { s = SIZE }\n\
     [output]\nquantities = [\"momentum_body\"]\n",
    "kind = \"driven-body\"\ninertia = [\"s\", \"2*s\", \"3*s\"]\nomega_body = [0.2, 0.3, 1]\nparameters = { s = SIZE }\n\
     torque = [\"0.3*s*sin(t)\", \"0\", \"0\"]\n[output]\nquantities = [\"momentum_space\", \"attitude\"]\n",
    "kind = \"heavy-top\"\ninertia = [\"s\", \"2*s\", \"3*s\"]\nomega_body = [0.2, 0.3, 1]\nparameters = { s = SIZE }\n\
     weight = [\"s\", \"s\", \"0.3*s\"]\nvertical = [0, 0.6, 0.8]\n\
     [output]\nquantities = [\"momentum_body\", \"vertical\"]\n",
];

/// What is said of the errors and of the drifts, without the times of a second run.
fn said(folder: &Folder, body: &str, size: f64, dt: &str) -> String {
    let time = format!("[method]\nname = \"rkmk4\"\n[time]\nt_span = [0, 20]\ndt = {dt}\n");
    let body = body.replace("SIZE", &format!("{size:e}"));
    let out = folder.run(&format!("[problem]\n{body}{time}")).ok();
    let is_of = |line: &&str| {
        ["conserved", "energy: ", "momentum_norm: ", "error, ", "about ", "no digit"]
            .iter()
            .any(|word| line.trim_start().starts_with(word))
    };
    let errors = |line: &str| line.split_once(": ").map_or("", |(_, errors)| errors).to_owned();
    let lines = out.lines().filter(is_of).map(|line| match line.contains("error, ") {
        true => errors(line),
        false => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn what_is_said_of_a_run_does_not_depend_on_the_size_of_its_numbers() {
    let folder = Folder::new();
    for body in BODIES {
        for dt in ["0.5", "0.02"] {
            let usual = said(&folder, body, 1.0, dt);
            assert!(
                usual.contains("of its size at") && !usual.contains(" 0 of its size"),
                "{usual}"
            );
            for power in POWERS {
                let said = said(&folder, body, 2.0_f64.powi(power), dt);
                assert_eq!(said, usual, "2^{power}, dt = {dt}: {body}");
            }
        }
    }
}

/// Where the length of a vector is no finite number, its error is not stated.
#[test]
fn an_error_without_a_finite_size_is_not_stated() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"composed\"\n\
                [[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [1.3e308, 1.3e308]\nfield = [\"x2/64\", \"-x1/64\"]\n\
                [[problem.parts]]\nname = \"z\"\nspace = \"numbers\"\nstart = [1, 0]\nfield = [\"3*z2\", \"-3*z1\"]\n\
                [method]\nname = \"rkmk4\"\n[time]\nt_span = [0, 10]\ndt = 0.5\n";
    folder.write("scene.toml", text);
    let out = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let told = [
        "WARNING: the error of `x` cannot be stated: its size, or its distance from what it should be, is not a finite number\n",
        "x not known at ",
        "the number of right digits is not known\n",
        // The other part has an error.
        "WARNING: `z` is wrong by ",
    ];
    for told in told {
        assert!(out.contains(told), "{told}\n{out}");
    }
    for wrong in ["inf", "NaN", "digits are right", "conserved to rounding", "no constant"] {
        assert!(!out.contains(wrong), "{wrong}\n{out}");
    }
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["accuracy"]["digits"], 0);
    assert!(summary["accuracy"]["parts"][0]["relative"].is_null(), "{summary}");
    let page = folder.read("out/index.html");
    assert!(page.contains("the number of right digits is not known") && !page.contains("NaN"));
}

/// Where a quantity is no finite number, its drift is not stated. The errors of the state are.
#[test]
fn a_drift_without_a_finite_value_is_not_stated() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"kirchhoff\"\ninertia = [\"s\", \"2*s\", \"3*s\"]\nmass = [\"1.5*s\", \"1.2*s\", \"s\"]\n\
                angular_momentum = [\"0.3*s\", \"0.6*s\", \"s\"]\nlinear_momentum = [\"0.7*s\", \"0.4*s\", \"s\"]\n\
                parameters = { s = 1e160 }\n[method]\nname = \"rkmk4\"\n[time]\nt_span = [0, 10]\ndt = 0.5\n";
    folder.write("scene.toml", text);
    let out = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    for quantity in ["linear_norm2", "momenta_product"] {
        let told = format!(
            "WARNING: the drift of `{quantity}` cannot be stated: a value of it, or its size, is not a finite number\n"
        );
        assert!(out.contains(&told) && !out.contains(&format!("{quantity}: drifted")), "{out}");
    }
    assert!(out.contains("  energy: drifted by ") && out.contains("about 2 digits"), "{out}");
    assert!(!out.contains("inf") && !out.contains("NaN"), "{out}");
    assert!(!folder.read("out/index.html").contains("NaN"));
}

/// What comes to rest is not wrong by the rounding of its motion.
#[test]
fn a_body_that_comes_to_rest_is_right() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0, 0, 0]\n\
                euler.zyx = [0.3, 1.2, 0.4]\ncontrol = [3, 4]\n\
                [method]\nname = \"cf4\"\n[time]\nt_span = [0, END]\ndt = 0.02\n\
                [output]\nquantities = [\"omega_body\"]\nevery = 10\n";
    for end in ["20", "1000"] {
        folder.write("scene.toml", &text.replace("END", end));
        let args = ["run", "scene.toml", "--no-page", "--out", "out", "--error-check", "always"];
        let out = folder.lieflow(&args).ok();
        let digits = folder.digits();
        assert!(digits.is_some_and(|digits| digits >= 5), "{end}: {digits:?}");
        assert!(!out.contains("WARNING"), "{end}: {out}");
    }
}

/// A time far from 0 is told with the digits that it needs.
#[test]
fn times_far_from_zero_have_their_digits() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 3, 1]\n\
                [method]\nname = \"rkmk4\"\n[time]\nt_span = [1700000000, 1700000040]\ndt = 0.5\n";
    folder.write("scene.toml", text);
    let out = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert!(out.contains("t = 1700000000 to 1700000040, 80 steps"), "{out}");
    assert!(!out.contains("1.7e9"), "{out}");
    assert!(folder.read("out/index.html").contains("t = 1700000000 to 1700000040"));
}

/// Where a run has 0 and passed over a pulse, the error has no size.
#[test]
fn an_error_beside_nothing_is_told_by_itself() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0, 0, 0]\n\
                torque = [\"(sign(t-100)-sign(t-100.5))/2\", 0, 0]\n[time]\nt_span = [0, 1000]\n\
                [output]\nquantities = [\"omega_body\"]\n";
    folder.write("scene.toml", text);
    let out = folder.lieflow(&["run", "scene.toml", "--no-page"]).ok();
    assert!(out.contains("momentum_space 0.5, of a size of 0, at the end"), "{out}");
    assert!(!out.contains("inf"), "{out}");
}
