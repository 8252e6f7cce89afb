//! Formulas: what they mean, their derivatives against differences, and texts that are none.

use lieflow::scalar::{Counted, Ops};

use toml::de::DeTable;

use super::{Formula, Lets, Names, Parameters, SamplesFile, Text, Texts, Which};
use crate::reader::{Is, Mistake, Read, ReadError, Refusal, Value, keys_of};

fn names() -> Names {
    Parameters::default().names("variables", ["x", "y", "w_1"]).expect("three names")
}
fn read(text: &str) -> Result<Formula, Refusal> {
    Formula::read("f", text, &names()).map_err(refusal)
}
/// The only mistake of an error.
fn refusal(error: ReadError) -> Refusal {
    match &error.mistakes[..] {
        [Mistake::Refused(refusal)] => refusal.clone(),
        _ => panic!("{error:?}"),
    }
}
fn value(text: &str, at: [f64; 3]) -> f64 {
    read(text).unwrap_or_else(|refusal| panic!("{text}: {refusal:?}")).value(&at)
}

/// The value of a table with these lines.
fn table<T: Read>(lines: &str) -> Result<T, ReadError> {
    let table = DeTable::parse(lines).expect("TOML");
    let place = table.span();
    T::read(&Value { place, is: Is::Table(keys_of(table.into_inner())) })
}

#[test]
fn formulas_mean_what_they_mean_on_paper() {
    let (x, y, w) = (0.75, -1.25, 3.5);
    for (text, expected) in [
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("2^-2^2", 0.0625),
        ("-x^2", -x * x),
        ("2--3", 5.0),
        ("- -3 + +1", 4.0),
        ("8/4/2", 1.0),
        ("8 - 4 - 2", 2.0),
        ("2*3 + 4*5", 26.0),
        ("1e-3 + 1.5E+2 + .5 + 2.", 152.501),
        ("2*e", 2.0 * core::f64::consts::E),
        ("cos(pi)", -1.0),
        ("x*y - w_1/(x + 1)", x * y - w / (x + 1.0)),
        ("x^0.5", x.powf(0.5)),
        ("x^y", x.powf(y)),
        ("w_1^3", w * w * w),
        ("1/w_1^2", 1.0 / (w * w)),
        ("w_1^-2", 1.0 / (w * w)),
        ("min(x, max(y, 0.5))", 0.5),
        ("atan2(x, y)", x.atan2(y)),
        ("sign(y)*abs(y) + sign(0)", y),
        ("sinh(x) + cosh(x) - exp(x)", 0.0),
        ("asin(sin(x)) + acos(cos(x)) + atan(tan(x))", 3.0 * x),
        ("tanh(x) - sinh(x)/cosh(x)", 0.0),
        ("ln(x) - log10(x)/log10(e)", 0.0),
        ("\n x\n\t+ 1", x + 1.0),
    ] {
        let got = value(text, [x, y, w]);
        assert!(
            (got - expected).abs() <= 4.0 * f64::EPSILON * (1.0 + expected.abs()),
            "{text}: {got}"
        );
    }
}

#[test]
fn a_formula_has_no_value_where_it_has_none() {
    for text in ["ln(y)", "sqrt(y)", "0*ln(y)", "min(x, ln(y))", "y^0.5", "asin(2)"] {
        assert!(value(text, [0.75, -1.25, 3.5]).is_nan(), "{text}");
    }
    let pole = read("1/(x - 1)").unwrap();
    let refusal = pole.check(&[1.0, 0.0, 0.0]).unwrap();
    assert_eq!(refusal.message, "f is inf at the start (x = 1), expected a number");
    assert_eq!(pole.check(&[2.0, 0.0, 0.0]), None);
    assert!(pole.value::<f64>(&[]).is_nan(), "a value that is missing is none");
    // What only follows from a variable is no loss; of others the first and the last are kept.
    pole.forget();
    assert!(!pole.value::<f64>(&[f64::NAN, 0.0, 0.0]).is_finite());
    assert_eq!(pole.lost(Which::First), None);
    assert!(pole.value::<f64>(&[1.0, f64::NAN, 3.5]).is_infinite());
    assert!(pole.value::<f64>(&[1.0, 2.0, 3.5]).is_infinite());
    assert_eq!(pole.lost(Which::First), pole.lost(Which::Last));
    let lost = pole.lost(Which::Last).map(|lost| lost.to_string());
    assert_eq!(lost.as_deref(), Some("f = 1/(x - 1) is inf at x = 1"));
}

#[test]
fn each_thread_has_its_own_losses() {
    let pole = read("1/(x - 1)").unwrap();
    assert!(pole.value::<f64>(&[1.0, 2.0, 3.5]).is_infinite());
    let other = std::thread::scope(|scope| {
        let run = || {
            pole.forget();
            pole.lost(Which::Last)
        };
        scope.spawn(run).join().unwrap()
    });
    assert_eq!(other, None);
    assert!(pole.lost(Which::Last).is_some());
    pole.forget();
    assert_eq!(pole.lost(Which::Last), None);
}

/// f′ against (8(f(h) − f(−h)) − (f(2h) − f(−2h)))/12h, whose error is h⁴f⁽⁵⁾/30 and ε|f|/h: with
/// h = 2⁻¹⁰ that is 1e-12 for the derivatives of these.
#[test]
fn derivatives_agree_with_differences() {
    let at = [0.6, 0.35, 1.4];
    for text in [
        "x + y - w_1",
        "x*y*w_1",
        "x/(y + w_1)",
        "(x + 1)/2",
        "2/x",
        "-x^3 + y^-2",
        "x^y",
        "2^x",
        "x^w_1",
        "x^0.5",
        "sin(x*y)",
        "cos(x + y)",
        "tan(x*w_1)",
        "asin(x*y)",
        "acos(x*y)",
        "atan(x/y)",
        "atan2(x, y)",
        "atan2(x*y, w_1)",
        "sinh(x)*cosh(y)",
        "tanh(x*y)",
        "exp(-x^2/y)",
        "ln(x*w_1)",
        "log10(x + y^2)",
        "sqrt(x^2 + y^2 + w_1^2)",
        "abs(y - x)",
        "sign(x - y)*x",
        "min(x*y, w_1*x)",
        "max(x*y, w_1*x)",
        "max(2, x) - min(x, 2)",
        "sin(cos(tan(x)*y)^2 + w_1)^3",
        "x - x",
        "3",
    ] {
        let f = read(text).unwrap();
        for i in 0..3 {
            let slope = f.derivative(i).unwrap().value(&at);
            let h = 1.0 / 1024.0;
            let shifted = |by: f64| {
                let mut at = at;
                at[i] += by * h;
                f.value(&at)
            };
            let near = shifted(1.0) - shifted(-1.0);
            let far = shifted(2.0) - shifted(-2.0);
            let expected = (8.0 * near - far) / (12.0 * h);
            assert!(
                (slope - expected).abs() < 2e-9 * (1.0 + expected.abs()),
                "{text} by {i}: {slope} {expected}"
            );
            assert!(f.uses(i) || slope == 0.0, "{text} by {i}");
        }
    }
    let second = read("x^3*y").unwrap().derivative(0).unwrap().derivative(1).unwrap();
    assert_eq!(second.value(&[2.0, 5.0, 0.0]), 12.0);
}

/// A product of many factors has derivatives that are a few times as long.
#[test]
fn derivatives_stay_short() {
    let factors: Vec<String> = (1..=600).map(|i| format!("(x + {i}/600)")).collect();
    let product = read(&factors.join("*")).unwrap();
    let slope = product.derivative(0).unwrap();
    let logarithmic = (1..=600).map(|i| 1.0 / (0.5 + f64::from(i) / 600.0)).sum::<f64>();
    let (f, df) = (product.value(&[0.5, 0.0, 0.0]), slope.value(&[0.5, 0.0, 0.0]));
    // 600 factors, each with two roundings.
    assert!((df / f - logarithmic).abs() < 2000.0 * f64::EPSILON * logarithmic, "{df} {f}");
}

#[test]
fn operations_are_counted() {
    let f = read("2*sin(x)*sin(x) + y/w_1 - sqrt(x)^5").unwrap();
    let at = [0.5, 1.0, 2.0];
    let expected = Ops { add: 2, mul: 5, div: 1, sqrt: 1, trig: 1 };
    let (plain, ops) = Counted::count(|| f.value(&at));
    assert_eq!(ops, expected);
    let (counted, ops) = Counted::count(|| f.value(&at.map(Counted)));
    assert_eq!((ops, counted.0), (expected, plain));
}

#[test]
fn parameters_are_numbers_with_names() {
    let parameters: Parameters = table("k = 3\nc = 0.5").unwrap();
    let names = parameters.names("variables", ["x"]).unwrap();
    let f = Formula::read("f", "k*x^k + c", &names).unwrap();
    assert_eq!(f.value(&[2.0]), 24.5);
    assert_eq!(f.derivative(0).unwrap().value(&[2.0]), 36.0);
    for (text, variable, why) in [
        ("x = 1", "x", "`x` is the name of a variable already"),
        ("sin = 1", "x", "`sin` is the name of a function"),
        ("pi = 3", "x", "`pi` is a constant already; choose another name"),
        ("\"a b\" = 3", "x", "`a b` is not a valid name"),
        ("k = 3", "2x", "`2x` is not a valid name"),
        ("k = 3", "", "the name is empty"),
    ] {
        let parameters = table::<Parameters>(text);
        let names = parameters.and_then(|parameters| parameters.names("variables", [variable]));
        let error = names.unwrap_err();
        assert!(error.message().is_some_and(|told| told.starts_with(why)), "{error:?}");
    }
    assert!(table::<Parameters>("k = inf").is_err());
    // Parameters of parameters, in any order.
    let of_others: Parameters = table("a = \"2*b\"\nb = \"c + 1\"\nc = 3\nd = \"90*deg\"").unwrap();
    let values: Vec<_> = of_others.iter().collect();
    assert_eq!(values, [("a", 8.0), ("b", 4.0), ("c", 3.0), ("d", core::f64::consts::FRAC_PI_2)]);
}

/// Vectors and matrices by their names and written out, against the same by components.
#[test]
fn vectors_and_matrices_are_their_components() {
    let variables = ["t", "a1", "a2", "a3", "g11", "g12", "g21", "g22", "b1", "b2", "norm"];
    let names = Parameters::default().names("variables", variables).expect("names");
    let lets: Lets = table("c = \"2*g*b\"\nup = [0, \"t\", 1]").expect("formulas");
    let names = names.with_lets("let", &lets).checked().expect("formulas");
    let of =
        |text: &str| Formula::read("f", text, &names).unwrap_or_else(|e| panic!("{text}: {e:?}"));
    let at: [f64; 11] = [0.3, 1.1, -0.7, 0.4, 2.0, -1.5, 0.25, 3.0, 0.9, -0.2, 7.0];
    for (text, plain) in [
        ("dot(a, a)", "a1^2 + a2^2 + a3^2"),
        ("norm(a)*norm", "sqrt(a1^2 + a2^2 + a3^2)*norm"),
        ("dot(g*b, [1, 10])", "g11*b1 + g12*b2 + 10*(g21*b1 + g22*b2)"),
        ("dot(transpose(g)*b, [1, 10])", "g11*b1 + g21*b2 + 10*(g12*b1 + g22*b2)"),
        ("dot(g*g*b, b)", "dot(g*(g*b), b)"),
        ("dot(b, 3*b/2 - [b2, -b1])", "3*(b1^2 + b2^2)/2 - b1*b2 + b2*b1"),
        ("dot(cross(a, up), [1, 2, 3])", "a2 - a3*t - 2*a1 + 3*a1*t"),
        ("c1 + 10*c2", "2*(g11*b1 + g12*b2) + 20*(g21*b1 + g22*b2)"),
        ("dot(g1, g2)", "g11*g21 + g12*g22"),
        ("-dot(-c, b)", "c1*b1 + c2*b2"),
        ("dot([1, 2], (g + g)*b)", "2*(g11*b1 + g12*b2) + 4*(g21*b1 + g22*b2)"),
    ] {
        let (got, expected) = (of(text).value(&at), of(plain).value(&at));
        assert!(
            (got - expected).abs() < 1e-14 * (1.0 + expected.abs()),
            "{text}: {got} {expected}"
        );
        for i in 0..at.len() {
            let slopes = [text, plain].map(|f| of(f).derivative(i).unwrap().value(&at));
            assert!((slopes[0] - slopes[1]).abs() < 1e-13, "{text} by {i}: {slopes:?}");
        }
    }
}

/// The numbers of a vector are stated together: a name that continues theirs is no part of it.
#[test]
fn a_vector_has_the_numbers_that_are_stated_with_it() {
    let variables = ["t", "w1", "w2", "w3"];
    let parameters: Parameters = table("w4 = 10\nb4 = 7\nj31 = 1\nj32 = 1").expect("numbers");
    let names = parameters.names("variables", variables).expect("names");
    let rows = (1..=12).map(|i| format!("[{i}, {}]", i * i)).collect::<Vec<_>>().join(", ");
    let lets = format!(
        "b = \"[1, 2, 3]\"\nj = [[1, 2], [3, 4]]\nm = \"[{rows}]\"\nn = \"2*m\"\ns1 = \"3\"\ns2 = \"4\""
    );
    let lets: Lets = table(&lets).expect("formulas");
    let names = names.with_lets("let", &lets).checked().expect("formulas");
    let at = [0.5, 3.0, 0.0, 4.0];
    for (text, expected) in [
        ("norm(w)", 5.0),
        ("dot(b, b)", 14.0),
        ("dot(transpose(j)*[1, 1], [1, 10])", 64.0),
        ("dot(m*[1, 1], m*[0, 1])", (1..=12).map(|i| f64::from((i + i * i) * i * i)).sum()),
        ("m12_2 + m1_2 + n11_1 + dot(n2, [1, 1])", 144.0 + 1.0 + 22.0 + 12.0),
        ("norm(s)", 5.0),
    ] {
        let f = Formula::read("f", text, &names).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        assert_eq!(f.value(&at), expected, "{text}");
    }
    // Also where the names come one after the other.
    let more: Lets =
        table("c = \"[1, 2]\"\nc3 = \"5\"\nd = \"norm(c)\"\ne1 = \"c\"").expect("formulas");
    let names = names.with_lets("more", &more).checked().expect("formulas");
    for text in ["dot(c, c)", "d^2", "dot(e1, e1)"] {
        let f = Formula::read("f", text, &names).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        assert!((f.value(&at) - 5.0).abs() < 1e-15, "{text}");
    }
}

/// Where the argument of a function is constant, so is the function, also if its slope there is infinite.
#[test]
fn slopes_of_clamped_formulas_are_zero() {
    for (text, at, slope) in [
        ("1 - sqrt(max(x, 0))", -0.5, 0.0),
        ("max(x, 0)^0.5", -0.5, 0.0),
        ("sqrt(max(x, 0))", 0.25, 1.0),
        ("asin(min(x, 1))", 2.0, 0.0),
        ("acos(max(-1, min(1, x)))", -3.0, 0.0),
        ("sqrt(1 - min(x, 1)^2)", 1.5, 0.0),
        ("(x^2)^0.75", 0.0, 0.0),
        ("0^x", 2.0, 0.0),
        ("max(1, sqrt(x))", 0.0, 0.0),
        ("min(sqrt(x), 1)", 4.0, 0.0),
        ("min(sqrt(x), 1)", 0.25, 1.0),
        ("max(x, y)", 0.5, 0.5),
    ] {
        let slope_of = read(text).unwrap().derivative(0).unwrap();
        assert_eq!(slope_of.value(&[at, 0.5, 0.0]), slope, "{text} at {at}");
    }
    // Where the argument moves, the slope is infinite.
    let root = read("sqrt(x)").unwrap().derivative(0).unwrap();
    assert_eq!(root.value(&[0.0; 3]), f64::INFINITY);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    for (text, message, help) in [
        (
            "",
            "the formula ends here; expected a number, a name or a parenthesis at character 1",
            None,
        ),
        (
            "x + ",
            "the formula ends here; expected a number, a name or a parenthesis at character 5",
            None,
        ),
        ("2x", "found `x`, expected an operator or the end at character 2", Some("2*x")),
        (
            "2 kg",
            "found `k`, expected an operator or the end at character 3",
            Some("write 2; units"),
        ),
        ("2xx", "found `x`, expected an operator or the end at character 2", Some("written 2*xx")),
        ("1_000", "found `_`, expected an operator or the end at character 2", Some("without `_`")),
        (
            "x**2",
            "found `*`, expected a number, a name or a parenthesis at character 3",
            Some("x^2"),
        ),
        ("(x + 1", "the formula ends here; expected an operator or `)` at character 7", None),
        ("x)", "found `)`, expected an operator or the end at character 2", None),
        ("3*w1", "unknown name `w1` at character 3", Some("did you mean `w_1`?")),
        ("sine(x)", "unknown function `sine` at character 1", Some("did you mean `sin`?")),
        ("log(x)", "unknown function `log` at character 1", Some("did you mean `ln`?")),
        ("x(2)", "found `(`, expected an operator or the end at character 2", Some("2*x")),
        ("sin x", "found `x`, expected `(` after sin at character 5", None),
        ("min(x)", "found `)`, expected `,`: min takes two numbers at character 6", None),
        (
            "sin(x, y)",
            "found `,`, expected an operator or `)` at character 6",
            Some("sin takes a number"),
        ),
        ("1e999", "the number 1e999 is out of range at character 1", None),
        ("x + 1.5e-400", "the number 1.5e-400 is out of range at character 5", None),
        ("1.2.3", "`1.2.3` is not a number at character 1", None),
        (
            "-0,1*x",
            "found `,`, expected an operator or the end at character 3",
            Some("a decimal point, not a comma: 0.5"),
        ),
        (
            "sin(0,5)",
            "found `,`, expected an operator or `)` at character 6",
            Some("decimal point"),
        ),
        ("x $ y", "found `$`, expected an operator or the end at character 3", None),
    ] {
        let refusal = read(text).unwrap_err();
        assert_eq!(refusal.message, format!("f: {message} of the formula"), "{text}");
        match help {
            None => assert_eq!(refusal.help, None, "{text}"),
            Some(help) => assert!(refusal.help.is_some_and(|said| said.contains(help)), "{text}"),
        }
    }
    let texts = Texts::List(["x", "y +"].map(|text| Text(text.into())).into());
    let refusal = refusal(texts.read("torque", 2, &names()).unwrap_err());
    assert_eq!(refusal.key.as_deref(), Some("torque[2]"));
}

#[test]
fn absurd_formulas_are_refused() {
    let nested = |levels: usize| format!("{}x{}", "(".repeat(levels), ")".repeat(levels));
    assert!(read(&nested(60)).is_ok());
    for text in
        [nested(100_000 / 2), nested(200), "-".repeat(60_000), format!("{}2", "2^".repeat(9_000))]
    {
        let refusal = read(&text).unwrap_err();
        assert!(
            refusal.message.contains("levels") || refusal.message.contains("bytes"),
            "{refusal:?}"
        );
    }
    assert!(read(&"x + ".repeat(20_000)).unwrap_err().message.contains("bytes"));
    let long: Vec<String> = (0..5000).map(|i| format!("x*{i}")).collect();
    assert!(read(&long.join("+")).unwrap_err().message.contains("more than 4096 operations"));
    // As a text, each level of the derivative would be as long as all below it.
    let folded = (0..30).fold("x".to_owned(), |text, _| format!("sin({text})"));
    assert!(read(&folded).unwrap().derivative(0).unwrap().value(&[0.5_f64, 0.0, 0.0]).is_finite());
}

/// The derivative of x²/(2c) is one division, with the bits of 2x/(2c); so in whichever order it is written.
#[test]
fn the_derivative_of_a_square_over_a_number_is_one_division() {
    for (text, operations) in
        [("x^2/(2*0.3)", 3), ("x^2/0.3", 3), ("x^2/2", 1), ("3*x^2/0.7", 7), ("x^2/(2*y)", 6)]
    {
        let slope = read(text).unwrap().derivative(0).unwrap();
        assert!(slope.operations() <= operations, "{text}: {}", slope.operations());
    }
    let slope = read("x^2/(2*0.3)").unwrap().derivative(0).unwrap();
    for x in [0.1_f64, -7.3, 1e300, 3e-310, 0.0, f64::INFINITY] {
        assert_eq!(slope.value(&[x, 0.0, 0.0]).to_bits(), (x / 0.3).to_bits(), "{x}");
    }
    assert_eq!(slope.quotient(), Some((0, 0.3)));
    assert_eq!(read("y").unwrap().quotient(), Some((1, 1.0)));
    assert_eq!(read("0.3/x").unwrap().quotient(), None);
    assert_eq!(read("x/y").unwrap().quotient(), None);
    assert_eq!(read("2*x/6").unwrap().value(&[0.7_f64, 0.0, 0.0]), 2.0 * 0.7 / 6.0);
    assert_eq!(read("6/x").unwrap().value(&[0.7_f64, 0.0, 0.0]), 6.0 / 0.7);
}

/// Random texts from the pieces of formulas: read or refused, evaluated, derived, and never a panic.
#[test]
fn random_texts_are_read_or_refused() {
    let pieces = [
        "x",
        "y",
        "w_1",
        "2",
        "1e",
        "e-3",
        ".",
        "+",
        "-",
        "*",
        "/",
        "^",
        "(",
        ")",
        ",",
        " ",
        "sin(",
        "min(",
        "atan2",
        "pi",
        "µ",
        "\u{301}",
        "\0",
        "{",
        "\"",
        "9e99",
        "(x)",
        "^2",
        "sqrt(x",
        "😀",
        "[",
        "]",
        "dot(",
        "transpose(",
        "[x,",
    ];
    let mut seed = 1_u64;
    let mut draw = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    let mut read_ones = 0;
    for _ in 0..40_000 {
        let length = draw(12);
        let text: String = (0..=length).map(|_| pieces[draw(pieces.len())]).collect();
        if let Ok(formula) = read(&text) {
            read_ones += 1;
            let _ = formula.value(&[0.3, -0.2, 1e300]);
            assert!(formula.derivative(draw(3)).is_ok(), "{text}");
        }
    }
    assert!(read_ones > 500, "{read_ones}");
}

/// The derivative of samples by t is that of their spline, here x³ of a cubic; by another variable there is none of
/// them. The operations are those of a cubic.
#[test]
fn samples_have_derivatives_by_the_time() {
    let rows = ["t,u", "0,0", "1,1", "2,8", "4,64"].join("\n");
    let file = SamplesFile("u.csv".into(), rows);
    let names = Parameters::default().names("variables", ["t", "x"]).expect("two names");
    let names = names
        .with_samples(Some(file), Some(lieflow::samples::Interpolation::Cubic))
        .expect("a table");
    let of = |text: &str| Formula::read("f", text, &names).expect("a formula");
    let (t, x) = (1.7f64, 0.3);
    for (text, by_t, by_x) in [
        ("u", 3.0 * t * t, 0.0),
        ("x*u + t", x * 3.0 * t * t + 1.0, t * t * t),
        ("u^2", 6.0 * t.powi(5), 0.0),
        ("x", 0.0, 1.0),
    ] {
        let slopes = [0, 1].map(|variable| of(text).derivative(variable).expect("a formula"));
        let [found_t, found_x] = slopes.map(|slope| slope.value(&[t, x]));
        assert!((found_t - by_t).abs() < 1e-12 && (found_x - by_x).abs() < 1e-12, "{text}");
    }
    let second = of("u").derivative(0).and_then(|slope| slope.derivative(0));
    assert!((second.expect("a formula").value(&[t, x]) - 6.0 * t).abs() < 1e-12);
    assert!(of("u").value(&[4.1, x]).is_nan());
    let u = of("u");
    let (_, counted) = Counted::count(|| u.value(&[t, x].map(Counted)));
    assert_eq!(counted, Ops::adds(1) + Ops::muladds(3));
    assert!(of("x*u").uses(0) && of("u").uses(0) && !of("u").uses(1) && !of("x").uses(0));
}
