//! The figures of a run: what a scene asks for by `plot`, and `lieflow plot` of several runs.

use crate::support::{Folder, SCENE};

/// The scene with these keys in its output.
fn with_output(keys: &str) -> String {
    SCENE.replace("every = 10", &format!("every = 1\n{keys}"))
}

#[test]
fn a_scene_decides_its_figures_their_order_and_their_words() {
    let folder = Folder::new();
    let keys = "plot = [\"energy\", { columns = [\"m1\", \"m3\"], title = \"Two of three\", x_label = \"t (s)\", \
                y_label = \"m (kg m²/s)\" }, { columns = [\"m2\"], against = \"m1\" }]";
    folder.write("scene.toml", &with_output(keys));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let page = folder.read("out/index.html");
    let places = [
        "What was asked for",
        "id=\"plot\"",
        "Two of three",
        "m₂ against m₁",
        "<h2 id=\"s3-the-motion",
    ];
    let places = places.map(|part| page.find(part).unwrap_or_else(|| panic!("{part}")));
    assert!(places.is_sorted(), "{places:?}");
    assert!(!page.contains("id=\"time-"), "nothing else is drawn over time");
    let figure = folder.read("out/plot-2.svg");
    for part in
        [">Two of three<", ">t (s)<", ">m (kg m²/s)<", "data-series=\"m₁\"", "data-series=\"m₃\""]
    {
        assert!(figure.contains(part), "{part}");
    }
    // Names alone are a figure of each quantity, as before.
    folder.write("scene.toml", &with_output("plot = [\"m3\", \"energy\", \"m1\"]"));
    folder.lieflow(&["run", "scene.toml", "--out", "names"]).ok();
    let figure = folder.read("names/plot.svg");
    assert!(figure.contains("data-series=\"m₁\"") && figure.contains("data-series=\"m₃\""));
    assert!(!figure.contains("m₂") && folder.read("names/plot-2.svg").contains("energy"));
    for (keys, message) in [
        ("plot = [{ columns = [\"m4\"] }]", "unknown column `m4`"),
        ("plot = [\"m4\", { columns = [\"m1\"], against = \"m5\" }]", "unknown column `m4`"),
        ("plot = [\"m4\", { columns = [\"m1\"], against = \"m5\" }]", "unknown column `m5`"),
        ("plot = [{ columns = [] }]", "a figure of no columns"),
        (
            "plot = [{ columns = [\"m1\"], against = \"momentum_body\" }]",
            "unknown column `momentum_body`",
        ),
        ("plot = [{ columns = [\"m1\"], titel = \"x\" }]", "unknown key `titel`"),
        ("plot = [3]", "expected the name of a column"),
    ] {
        folder.write("scene.toml", &with_output(keys));
        let error = folder.lieflow(&["run", "scene.toml"]).refused();
        assert!(error.contains(message) && error.contains("scene.toml:"), "{error}");
    }
}

/// The parts of a quantity and the next figure have files of their own.
#[test]
fn parts_of_a_figure_and_the_next_figure_have_different_names() {
    let folder = Folder::new();
    let asked = "output.plot=[\"momentum_body\", \"energy\"]";
    folder.lieflow(&["run", "many-bodies", "--set", asked, "--out", "out"]).ok();
    let page = folder.read("out/index.html");
    for name in ["plot", "plot-part-2", "plot-part-3", "plot-part-4"] {
        assert_eq!(page.matches(&format!("id=\"{name}\"")).count(), 1, "{name}");
        assert!(folder.read(&format!("out/{name}.svg")).contains("momentum"), "{name}");
    }
    let ids = page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let mut ids: Vec<&str> = ids.collect();
    ids.sort_unstable();
    assert!(ids.windows(2).all(|pair| pair[0] != pair[1]), "{ids:?}");
}

/// Names of formulas are figures in their order: a vector is one, others are not joined by what their names share. The
/// words of a scene stay, also where a figure hardly changes or another formula is large.
#[test]
fn formulas_are_drawn_in_their_order_with_the_words_of_the_scene() {
    let folder = Folder::new();
    let keys = "plot = [\"pop2\", \"v3\", \"high\", \"pop1\", \"v1\", \
                { columns = [\"high\"], y_label = \"mine (V)\" }, { columns = [\"pop1\"], title = \"mine\" }]\n\
                [output.formulas]\nhigh = \"1e3 + m1\"\npop1 = \"m1\"\npop2 = \"m2\"\nv = \"[m3, m1, m2]\"";
    folder.write("scene.toml", &with_output(keys));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let figure = |number: usize| {
        folder.read(&format!(
            "out/plot{}.svg",
            match number {
                1 => String::new(),
                _ => format!("-{number}"),
            }
        ))
    };
    for (number, title, series) in [
        (1, "pop₂", &["pop₂"][..]),
        (2, "v", &["v₁", "v₃"]),
        (3, "high: how far it is from its start", &["high"]),
        (4, "pop₁", &["pop₁"]),
        (6, "high", &["high"]),
        (7, "mine", &["pop₁"]),
    ] {
        let figure = figure(number);
        assert!(figure.contains(&format!(">{title}<")), "{number}: {title}");
        assert_eq!(figure.matches("lf-dense\" tabindex=\"-1\" data-series=").count(), series.len());
        for series in series {
            assert!(figure.contains(&format!("data-series=\"{series}\"")), "{number}: {series}");
        }
    }
    assert!(figure(6).contains(">mine (V)<") && !figure(6).contains("from its start"));
}

#[test]
fn several_runs_are_drawn_in_one_figure() {
    let folder = Folder::new();
    folder.write("a.toml", &with_output(""));
    folder.write("b.toml", &with_output("").replace("[0.2, 0.0, 1.0]", "[0.4, 0.0, 1.0]"));
    folder.lieflow(&["run", "a.toml", "b.toml", "--no-page"]).ok();
    let runs = ["lieflow-out/a", "lieflow-out/b"];
    let told = folder.lieflow(&[&["plot"][..], &runs, &["--columns", "m"]].concat()).ok();
    assert!(told.starts_with("3 columns of 2 runs: lieflow-plot"), "{told}");
    let figure = folder.read("lieflow-plot/plot-1.svg");
    assert!(figure.contains(">m₁<"), "the title");
    for run in ["a", "b"] {
        assert_eq!(
            figure.matches(&format!("lf-dense\" tabindex=\"-1\" data-series=\"{run}\"")).count(),
            1
        );
    }
    assert_eq!(
        folder.names("lieflow-plot"),
        ["index.html", "plot-1.svg", "plot-2.svg", "plot-3.svg"]
    );
    // One run: columns of one name together, and a part of its time.
    let options = ["--columns", "m1,m2", "--from", "0.5", "--to", "1", "--out", "one"];
    folder.lieflow(&[&["plot", runs[0]][..], &options].concat()).ok();
    let figure = folder.read("one/plot-1.svg");
    assert!(figure.contains("data-series=\"m₁\"") && figure.contains("data-series=\"m₂\""));
    let ends = figure.split("data-x=\"linear ").nth(1).unwrap().split(' ').take(2);
    assert_eq!(ends.collect::<Vec<_>>(), ["5e-1", "1e0"]);
    for (args, message) in [
        (&["plot", "nowhere"][..], "there is no run in `nowhere`"),
        (&["plot", "lieflow-out/a", "--columns", "m7"], "no column `m7`"),
        (&["plot", "lieflow-out/a", "--from", "3"], "no rows at these times"),
        (&["plot", "lieflow-out/a", "--from", "1", "--to", "0.5"], "--from 1 is after --to 0.5"),
        (&["plot", "lieflow-out/a", "lieflow-out/../lieflow-out/a"], "is named twice"),
        (&["plot", "lieflow-out/a", "--out", "lieflow-out/b"], "is the folder of a run"),
    ] {
        assert!(folder.lieflow(args).refused().contains(message), "{args:?}");
    }
}

#[test]
fn a_run_that_is_not_complete_is_told() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let fails = [
        "method.name=rk",
        "method.tableau=euler",
        "method.map=",
        "time.dt=4",
        "time.t_span=[0,400]",
    ];
    let sets = fails.iter().flat_map(|set| ["--set", set]);
    let args = ["run", "scene.toml", "--no-page", "--out", "part"].into_iter().chain(sets);
    folder.lieflow(&args.collect::<Vec<_>>()).refused();
    let run = folder.lieflow(&["plot", "part"]);
    let expected = "note: `part` is a run that is not complete: its rows end at t = ";
    assert!(run.code == Some(0) && run.err.contains(expected), "{run:?}");
    // A run that was killed may have written a part of its last row, or a part of its last number.
    for rest in ["40,", "40,1,2,3.5"] {
        folder
            .write("killed/trajectory.partial.csv", &format!("t,a,b,c\n0,1,2,3\n20,1,2,4\n{rest}"));
        let run = folder.lieflow(&["plot", "killed"]);
        let expected = "note: `killed` is a run that is not complete: its rows end at t = 20";
        assert!(run.code == Some(0) && run.err.contains(expected), "{run:?}");
    }
    folder.write("killed/trajectory.partial.csv", "t,a\n0,1\n20\n40,2\n");
    let refused = folder.lieflow(&["plot", "killed"]).refused();
    assert!(refused.contains("trajectory.partial.csv:3: 1 numbers, expected 2"), "{refused}");
}

/// The rows of a run that did not end are drawn, not those of a complete run before it in the same folder.
#[test]
fn rows_of_a_run_before_are_not_drawn() {
    let folder = Folder::new();
    let rows = |from: f64| format!("t,a\n0,{from}\n1,{}\n", from + 1.0);
    folder.write("out/trajectory.csv", &rows(1.0));
    folder.write("out/trajectory.partial.csv", &rows(5.0));
    for summary in [
        None,
        Some(r#"{"completed": false, "trajectory": "trajectory.partial.csv"}"#),
        Some(r#"{"completed": true, "trajectory": "trajectory.csv"}"#),
    ] {
        summary.iter().for_each(|summary| folder.write("out/summary.json", summary));
        let run = folder.lieflow(&["plot", "out", "--out", "figures"]);
        let is_complete = summary.is_some_and(|summary| summary.contains("true"));
        let other = "; out/trajectory.csv is that of a run before";
        assert_eq!((run.code, run.err.contains(other)), (Some(0), !is_complete), "{run:?}");
        let least = if is_complete { "9.6e-1 2.04e0" } else { "4.96e0 6.04e0" };
        let figure = folder.read("figures/plot-1.svg");
        assert!(figure.contains(&format!("data-y=\"linear {least} ")), "{summary:?}: {figure}");
    }
}

/// A value that is not finite hides neither its own curve nor another one.
#[test]
fn a_row_that_is_not_finite_does_not_hide_the_others() {
    let folder = Folder::new();
    let rows = |t: f64| match t {
        0.0 => "0,inf,0.2,NaN\n".into(),
        t => format!("{t},{},{},{}\n", 1.0 / t, t.sin(), t.cos()),
    };
    let text: String = (0..100).map(|i| rows(0.1 * f64::from(i))).collect();
    folder.write("out/trajectory.csv", &format!("t,qa1,qa2,root\n{text}"));
    folder.lieflow(&["plot", "out", "--out", "figures"]).ok();
    assert!(!folder.read("figures/index.html").contains("stay as they are"));
    let [both, root] = ["1", "2"].map(|k| folder.read(&format!("figures/plot-{k}.svg")));
    assert!(both.contains("data-series=\"qa₁\"") && both.contains("data-series=\"qa₂\""), "{both}");
    assert!(root.contains("99 points") && !root.contains("no data"), "{root}");
    // In a run, a formula without a value at the start is drawn as it is.
    let formulas = "[output.formulas]\nroot = \"sqrt(m2 - 0.1)\"\ninverse = \"0.01/m2\"\n";
    folder.write("scene.toml", &(SCENE.to_owned() + formulas));
    folder.lieflow(&["run", "scene.toml", "--out", "run"]).ok();
    let page = folder.read("run/index.html");
    assert!(!page.contains("There is no data to draw") && !page.contains("∞"));
    assert!(page.contains("data-series=\"root\"") && page.contains("data-series=\"inverse\""));
}

/// What stays as it is has its own name, also where other columns of its quantity vary or are not drawn.
#[test]
fn constants_have_the_names_of_their_columns() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 1, 3]\nomega_body = [0.2, 0, 1]\n\
                [time]\nt_span = [0, 40]\n\
                [output]\nquantities = [\"momentum_body\"]\nplot = [\"m3\", \"b\", \"c\"]\n\
                [output.formulas]\nb = \"m3/3\"\nc = \"2*m3\"\nd = \"m1*m1\"\n";
    folder.write("scene.toml", text);
    folder.lieflow(&["run", "scene.toml", "--out", "run"]).ok();
    let page = folder.read("run/index.html");
    let constants = page.split("stay as they are at the start").nth(1).expect("constants");
    let constants = constants.split("</section>").next().unwrap_or_default();
    for name in [">Angular momentum in the body: m₃<", ">b<", ">c<"] {
        assert!(constants.contains(name), "{name}: {constants}");
    }
    assert!(!constants.contains("b, c, d"), "{constants}");
}

/// A name stands for all of its numbers, also where a matrix has more than nine rows; `l1` is its first row.
#[test]
fn entries_of_large_matrices_are_drawn_by_their_name() {
    let folder = Folder::new();
    let names: Vec<String> =
        (1..=11).flat_map(|i| (1..=i).map(move |j| format!("l{i}_{j}"))).collect();
    let row = |t: f64| (0..names.len()).map(|k| format!(",{}", t + k as f64)).collect::<String>();
    let text = format!("t,{},l1x\n0{},0\n1{},0\n", names.join(","), row(0.0), row(1.0));
    folder.write("toda/trajectory.csv", &text);
    for (name, count) in [("l", 66), ("l1", 1), ("l11", 11), ("l1_", 1), ("l11_1", 1), ("l1x", 1)] {
        let told = folder.lieflow(&["plot", "toda", "--columns", name, "--out", "out"]).ok();
        let many = if count == 1 { "" } else { "s" };
        assert!(told.starts_with(&format!("{count} column{many} of 1 run")), "{name}: {told}");
    }
}

/// Two thousand turns are a band, as high as they are from the start to the end; what is less than rounding is straight.
#[test]
fn fast_swings_are_a_band_and_noise_is_a_line() {
    let folder = Folder::new();
    let text = with_output("").replace("[0.2, 0.0, 1.0]", "[0.2, 0.0, 9.0]");
    let text = text.replace("t_span = [0, 2.0]", "t_span = [0, 2000.0]").replace("rkmk4", "exact");
    folder.write(
        "fast.toml",
        &text.replace("map = \"exp\"\n", "").replace("energy", "momentum_norm"),
    );
    folder.lieflow(&["run", "fast.toml", "--out", "out"]).ok();
    let names = folder.names("out");
    assert!(names.contains(&"time-momentum-body-beginning.svg".to_string()), "{names:?}");
    let whole = folder.read("out/time-momentum-body.svg");
    assert!(whole.contains("lf-filled") && whole.contains("the whole run"));
    // The length of the momentum moves by rounding alone: it is told, not drawn.
    assert!(!names.contains(&"time-momentum-norm.svg".to_string()), "{names:?}");
    let page = folder.read("out/index.html");
    assert!(page.contains("These quantities stay as they are at the start"));
}

/// A distance from the group is 0 to the rounding of its terms: it is told, not drawn.
#[test]
fn a_distance_that_is_rounding_is_no_figure() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"matrix-ode\"\ngroup = \"so\"\nfield = [[\"0\", \"-cos(t)\", \"sin(2*t)\"], \
                [\"cos(t)\", \"0\", \"-y11\"], [\"-sin(2*t)\", \"y11\", \"0\"]]\n[time]\nt_span = [0, 20]\n\
                [output]\nquantities = [\"point\", \"group_defect\"]\n";
    folder.write("own.toml", text);
    folder.lieflow(&["run", "own.toml", "--out", "out"]).ok();
    let names = folder.names("out");
    assert!(names.contains(&"time-point.svg".into()), "{names:?}");
    assert!(!names.iter().any(|name| name.contains("defect")), "{names:?}");
}

/// The attitude is drawn as its quaternion, and its nine entries are in a fold.
#[test]
fn the_attitude_is_drawn_as_a_quaternion() {
    let folder = Folder::new();
    folder.write("scene.toml", &SCENE.replace("\"energy\"", "\"attitude\", \"euler_zyx\""));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let figure = folder.read("out/time-quaternion.svg");
    assert!(figure.contains("data-series=\"qw\""));
    let page = folder.read("out/index.html");
    let fold = page.find("<summary>Rotation from body to space</summary>").unwrap();
    assert!(page.find("id=\"time-quaternion\"").unwrap() < fold);
    assert!(fold < page.find("id=\"time-attitude\"").unwrap());
    let header = folder.read("out/trajectory.csv");
    assert!(
        header.lines().next().unwrap().ends_with("g33,euler_zyx1,euler_zyx2,euler_zyx3"),
        "no further columns"
    );
    assert!(folder.read("out/time-euler-zyx.svg").contains("rad"));
}

/// A motion in space has its path as its figure, with the units of its lengths, beside its coordinates over time.
#[test]
fn a_position_is_a_path_in_space() {
    let folder = Folder::new();
    folder.lieflow(&["run", "rolling-turn", "--out", "out"]).ok();
    let figure = folder.read("out/figure.svg");
    for part in ["class=\"lf lf-space\"", ">x₁ (m)<", ">x₂ (m)<", ">x₃ (m)<", "class=\"lf-path\""]
    {
        assert!(figure.contains(part), "{part}");
    }
    // The shadow is a path, too, and the line has as many corners as a turn needs.
    let corners = |class: &str| {
        let line = figure.split(&format!("class=\"{class}\" d=\"")).nth(1).unwrap();
        line.split('"').next().unwrap().split(' ').count()
    };
    assert!(corners("lf-path") > 20 && corners("lf-shadow") > 20);
    assert!(folder.read("out/index.html").contains("From the ring to the dot"));
    assert!(folder.names("out").contains(&"time-position.svg".to_string()));
}
