//! Motions in which small errors grow: digits are not stated that rounding takes, and no pulse is seen in them.

use crate::support::Folder;

/// The run of a pendulum of this equation in these times.
fn pendulum(start: &str, field: &str, time: &str) -> String {
    let scene = format!(
        "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"y\"\nspace = \"numbers\"\nstart = {start}\n\
         field = {field}\n[time]\n{time}\n"
    );
    Folder::new().run(&scene).ok()
}

/// The path to the upright position, y = 4 atan(eᵗ) − π: at t = 38 rounding decides on which side the pendulum falls. Two
/// runs in large steps round alike.
#[test]
fn rounding_that_two_runs_share_is_counted() {
    let field = "[\"y2\", \"-sin(y1)\"]";
    for time in
        ["t_span = [0, 38]", "t_span = [0, 38]\nh_max = 0.019", "t_span = [0, 38]\ndt = 0.02"]
    {
        let out = pendulum("[0, 2]", field, time);
        assert!(out.contains("no digit is right"), "{time}: {out}");
        assert!(!out.contains("pulse") && !out.contains("lieflow gives"), "{time}: {out}");
    }
    let short = pendulum("[0, 2]", field, "t_span = [0, 5]");
    assert!(short.contains("about 12 digits") && !short.contains("WARNING"), "{short}");
}

/// From a start whose number is not quite the upright position the pendulum falls, but in steps that are small enough the
/// change of the angle is lost in each sum. Right is y₁ = 2.938.
#[test]
fn increments_that_are_lost_in_sums_are_counted() {
    let field = "[\"y2\", \"-9.81*sin(y1) - 0.05*y2\"]";
    for limit in ["", "\nh_max = 0.00575"] {
        let time = format!("t_span = [0, 11.5]{limit}");
        let out = pendulum("[3.141592653589793, 0]", field, &time);
        assert!(out.contains("no digit is right"), "{limit}: {out}");
        assert!(
            out.contains("WARNING: a change of 1.4e-14 of the start moves `y`"),
            "{limit}: {out}"
        );
    }
}

/// A run of this scene, without a page.
fn told(scene: &str) -> String {
    Folder::new().run(scene).ok()
}

/// A pulse that the run from the changed start sees, and the run itself does not, is no growth of small errors.
#[test]
fn a_pulse_is_not_taken_for_growth() {
    for (width, at) in [(0.05, 50.0), (0.1, 62.1), (0.15, 37.3), (0.2, 50.0)] {
        let out = told(&format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0, 0, 0.01]\n\
             torque = [\"0\", \"0\", \"exp(-((t-{at})/{width})^2)/{width}\"]\n[time]\nt_span = [0, 100]\n\
             [output]\nquantities = [\"omega_body\", \"attitude\"]\n"
        ));
        let tells = out.contains("WARNING: ") && out.contains("h_max = 0.05");
        assert!(tells && !out.contains("small errors grow"), "{width}, {at}: {out}");
        assert!(!out.contains("at the end 0"), "{width}, {at}: {out}");
    }
}

/// The digits that are promised of other settings are those of their run: q' = sign(sin 3t) is exact by its default.
#[test]
fn the_digits_of_an_advice_are_those_of_its_run() {
    let scene = "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"q\"\nspace = \"numbers\"\nstart = [0]\n\
                 field = [\"sign(sin(3*t))\"]\n[time]\nt_span = [0, 20]\n";
    // A change of the start moves the end of this run by a hundredth, and that of the default by rounding.
    let out = told(&format!("{scene}rtol = 1e-8\natol = 1e-8\n[method]\nname = \"gauss4\"\n"));
    let own = told(scene);
    assert!(own.contains("about 12 digits are right"), "{own}");
    let promised = ["11", "12"].map(|digits| format!("lieflow gives about {digits} digits"));
    assert!(promised.iter().any(|promised| out.contains(promised)), "{out}");
}

/// A part that is smaller than atol: rtol alone has its digits.
#[test]
fn a_part_below_atol_is_told_to_leave_atol_out() {
    let out = told(
        "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [1e-16, 0]\n\
         field = [\"10*x2\", \"-10*x1\"]\n[[problem.parts]]\nname = \"z\"\nspace = \"numbers\"\nstart = [0.9]\n\
         field = [\"-0.01*z\"]\n[time]\nt_span = [0, 50]\n",
    );
    assert!(out.contains("rtol = 1e-14 alone, with atol = 0, would give about"), "{out}");
    assert!(!out.contains("small errors grow"), "{out}");
}

/// An oscillator by these numbers.
fn oscillator(start: &str, field: &str, rest: &str) -> String {
    told(&format!(
        "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = {start}\n\
         field = {field}\n{rest}\n"
    ))
}

/// Rows once in a period: x is 0 at each, and its error is relative to what it is between them.
#[test]
fn a_part_that_returns_to_zero_at_each_row_has_its_digits() {
    let out = told(
        "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [0]\n\
         field = [\"v\"]\n[[problem.parts]]\nname = \"v\"\nspace = \"numbers\"\nstart = [1]\nfield = [\"-x\"]\n\
         [time]\nt_span = [0, \"20*pi\"]\n[output]\ninterval = \"2*pi\"\n",
    );
    assert!(!out.contains("WARNING") && out.contains("digits are right"), "{out}");
}

/// Errors of `order` are not relative to the rounding of a part that is 0 after a whole period.
#[test]
fn orders_are_measured_over_a_whole_period() {
    let folder = Folder::new();
    let scene = "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [0]\n\
                 field = [\"v\"]\n[[problem.parts]]\nname = \"v\"\nspace = \"numbers\"\nstart = [1]\nfield = [\"-x\"]\n\
                 [time]\nt_span = [0, \"2*pi\"]\n";
    folder.write("scene.toml", scene);
    let out = folder.lieflow(&["order", "scene.toml", "--method", "rk4", "--json"]).ok();
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let (floor, curve) = (json["reference_error"].as_f64(), &json["methods"][0]);
    assert!(floor.is_some_and(|floor| floor < 1e-11), "{out}");
    let order = curve["measured_order"].as_f64();
    assert!(order.is_some_and(|order| (order - 4.0).abs() < 0.05), "{out}");
}

/// From a tiny start that grows, the tolerances that are chosen by the start cannot be met. What to set is told, and is
/// enough.
#[test]
fn the_tolerance_of_a_start_that_grows_is_told() {
    let folder = Folder::new();
    let scene = "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"q\"\nspace = \"numbers\"\nstart = [1e-8]\n\
                 field = [\"p\"]\n[[problem.parts]]\nname = \"p\"\nspace = \"numbers\"\nstart = [0]\n\
                 field = [\"sin(q)\"]\n[time]\nt_span = [0, 60]\n";
    let told = folder.run(scene).refused();
    let (_, atol) = told.split_once("take atol = ").expect(&told);
    let atol: f64 = atol.split(',').next().unwrap().parse().unwrap();
    assert!(1e-16 < atol && atol < 1e-14, "{told}");
    folder.run(&format!("{scene}rtol = 1e-14\natol = {atol:e}\n")).ok();
}

/// A run of the settings that are advised states the digits that were promised, also where f jumps.
#[test]
fn the_digits_of_an_advice_hold_at_jumps() {
    let folder = Folder::new();
    let said = |rtol: &str| {
        let scene = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [0.476897896587, 0.730901154392, 0.98286786027]\n\
             omega_body = [-0.4477, -0.8995, -0.543]\ntorque = [0, 0, \"0.3474*sign(sin(1.285*t))\"]\n[method]\n\
             name = \"cf-ls4\"\n[time]\nt_span = [0, 17.7]\nrtol = {rtol}\n[output]\n\
             quantities = [\"momentum_space\", \"attitude\"]\ncount = 20\n"
        );
        folder.run(&scene).ok()
    };
    let digits = |text: &str| -> u32 {
        let (_, digits) = text.split_once("about ").expect(text);
        digits.split(' ').next().unwrap().parse().expect(text)
    };
    let poor = said("0.1");
    let (_, advice) = poor.split_once("rtol = ").expect(&poor);
    let promised = digits(advice);
    let good = said(advice.split(' ').next().unwrap());
    assert!(digits(&good) >= promised, "{poor}\n{good}");
}

/// Steps end within a pulse that is stated by its centre and its width: it is not passed over. Right is
/// sin²(10 · 0.01 · √π).
#[test]
fn a_pulse_that_is_stated_is_met() {
    let folder = Folder::new();
    for (kind, start) in
        [("schrodinger", "amplitudes = [1, 0]"), ("density-matrix", "density = [[1, 0], [0, 0]]")]
    {
        let scene = format!(
            "[problem]\nkind = \"{kind}\"\n{start}\nenergies = [0, 0.01]\ncoupling = [[0, 10], [10, 0]]\n\
             pulse = [317.73, 0.01]\n[time]\nt_span = [0, 1000]\n[output]\nquantities = [\"populations\"]\n"
        );
        folder.run(&scene).ok();
        let p = folder.json("out/summary.json")["final"]["p2"].as_f64().unwrap();
        assert!(
            (p - (0.1 * std::f64::consts::PI.sqrt()).sin().powi(2)).abs() < 1e-8,
            "{kind}: {p}"
        );
    }
}

/// Where rounding decides the error, a run at ten times the tolerance is as far from the motion as the run itself: the distance
/// is stated, and no part of it. By a series of 45 digits this run is wrong by 0.0103.
#[test]
fn errors_of_rounding_are_not_divided() {
    let folder = Folder::new();
    folder.lieflow(&["run", "lorenz", "--out", "out", "--no-page"]).ok();
    let summary = folder.json("out/summary.json");
    let parts = summary["accuracy"]["parts"].as_array().unwrap();
    let x = parts.iter().find(|part| part["name"] == "x").unwrap();
    let stated = x["absolute"].as_f64().unwrap();
    assert!((0.004..0.05).contains(&stated), "{stated}");
}

/// Columns of formulas are no numbers of the state: their rounding is not that of the run.
#[test]
fn formulas_do_not_count_as_rounding() {
    let folder = Folder::new();
    let told = |formula: &str| {
        let scene = format!(
            "[problem]\nkind = \"composed\"\ninvariants = {{ total = \"a3 + 0.1*a1\" }}\n[[problem.parts]]\nname = \"a\"\n\
             space = \"vector\"\nstart = [0.6, 0, 0.8]\nfield = [0, 0, 1]\n[method]\nname = \"rkmk4\"\n[time]\n\
             t_span = [0, 20]\ndt = 0.02\n[output]\nquantities = [\"invariants\"]\n{formula}"
        );
        folder.run(&scene).ok()
    };
    for formula in ["", "[output.formulas]\nhuge = \"1e13*a3\"\n"] {
        let out = told(formula);
        assert!(out.contains("it is no constant of this motion"), "{out}");
    }
}

/// Near a saddle small errors grow, and no pulse is passed over.
#[test]
fn growth_is_not_taken_for_a_pulse() {
    let out =
        oscillator("[1e-7, 0]", "[\"x2\", \"sin(x1)\"]", "[time]\nt_span = [0, 60]\nrtol = 1e-10");
    assert!(!out.contains("pass over something short"), "{out}");
}

/// A pulse within a step of one size is looked for, too; and the default method, which passes over it, is not advised.
#[test]
fn a_pulse_within_a_step_of_one_size_is_told() {
    let scene = |middle: f64| {
        format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0.1, 0.2, 0.3]\n\
             parameters = {{a = {middle}, b = {}}}\n\
             torque = [\"0\", \"10*(sign(t - a) - sign(t - b))\", \"0\"]\n[method]\nname = \"rkmk4\"\n\
             [time]\nt_span = [0, 10]\ndt = 0.05\n",
            middle + 0.01
        )
    };
    for middle in [3.002, 3.005, 3.012, 3.025, 3.037] {
        let out = told(&scene(middle));
        assert!(out.contains("WARNING: "), "{middle}: {out}");
        assert!(!out.contains("lieflow gives") && !out.contains("errors grow"), "{middle}: {out}");
    }
}
