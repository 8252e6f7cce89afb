//! What the paper prints, and what is wrong in it.

use crate::methods::PaperMethod;

/// A row of Table 3: energy error at t = 400, and its mean.
pub const TABLE3: [(PaperMethod, &str, &str); 8] = [
    (PaperMethod::Mr, "1.0330e-05", "8.5929e-04"),
    (PaperMethod::Exp, "0.0300", "0.0150"),
    (PaperMethod::Ccsk, "0.2064", "0.1026"),
    (PaperMethod::Ccsk321, "0.0089", "0.0046"),
    (PaperMethod::Ccsk123, "0.4204", "0.2094"),
    (PaperMethod::Cay, "0.3339", "0.1671"),
    (PaperMethod::B4, "0.1450", "0.0726"),
    (PaperMethod::Rk4, "0.5863", "0.2958"),
];

/// A row of Table 4: log₁₀ of the operations to 1e-3 and 1e-6 in the two tests, and the operations of
/// a step that these numbers belong to.
#[derive(Clone, Copy, Debug)]
pub struct Table4 {
    /// The method.
    pub method: PaperMethod,
    /// To 1e-3 and 1e-6, for each test.
    pub printed: [[f64; 2]; 2],
    /// Operations of a step, for each test. `None` if no constant fits the two numbers.
    pub per_step: [Option<f64>; 2],
}

const fn line(method: PaperMethod, p: [f64; 4], per_step: [Option<f64>; 2]) -> Table4 {
    Table4 { method, printed: [[p[0], p[1]], [p[2], p[3]]], per_step }
}

/// Table 4. The operations of a step are not in the paper: they are the integers that its numbers
/// imply, one for two numbers.
pub const TABLE4: [Table4; 9] = [
    line(PaperMethod::Mr, [3.7350, 4.5078, 5.3546, 6.0545], [Some(1767.0), Some(1684.0)]),
    line(PaperMethod::S, [3.0821, 4.5864, 6.3032, 7.4649], [Some(667.0), None]),
    line(PaperMethod::Exp, [3.0635, 3.8140, 4.9248, 5.6144], [Some(749.0), Some(713.0)]),
    line(PaperMethod::Ccsk, [3.0764, 3.8278, 5.1211, 5.8551], [Some(651.0), Some(615.0)]),
    line(PaperMethod::Ccsk321, [2.8129, 3.5740, 5.0725, 5.8319], [Some(651.0), Some(615.0)]),
    line(PaperMethod::Ccsk123, [3.1603, 3.9074, 5.2132, 5.9964], [Some(651.0), Some(615.0)]),
    line(PaperMethod::Cay, [3.0539, 3.8052, 5.0890, 5.7877], [Some(713.0), Some(677.0)]),
    line(PaperMethod::B4, [2.7731, 3.5237, 4.7440, 5.4732], [Some(417.0), Some(408.0)]),
    line(PaperMethod::Rk4, [3.0773, 3.8207, 5.2167, 5.9541], [Some(657.0), Some(621.0)]),
];

/// The energy error that Table 3 prints for a method, and its mean.
pub fn table3(method: PaperMethod) -> Option<[&'static str; 2]> {
    TABLE3.iter().find(|(printed, ..)| *printed == method).map(|(_, last, mean)| [*last, *mean])
}

/// What Table 4 prints for a method.
pub fn table4(method: PaperMethod) -> Option<&'static Table4> {
    TABLE4.iter().find(|printed| printed.method == method)
}

/// The operations that Table 2 prints for a part of a map, and the fewest known.
pub fn table2(map: &str, part: &str) -> ([u64; 4], u64) {
    let printed = TABLE2.iter().find(|(m, p, _)| (*m, *p) == (map, part));
    let fewest = OPTIMUM.iter().find(|(m, p, _)| (*m, *p) == (map, part));
    (printed.map_or([0; 4], |printed| printed.2), fewest.map_or(0, |fewest| fewest.2))
}

/// A column of Table 2: additions, multiplications, square roots, trigonometric functions.
pub const TABLE2: [(&str, &str, [u64; 4]); 9] = [
    ("exp", "Ψ", [15, 17, 1, 2]),
    ("ccsk", "Ψ", [4, 14, 0, 6]),
    ("cay", "Ψ", [15, 20, 0, 0]),
    ("exp", "dΨ⁻¹", [15, 18, 1, 1]),
    ("ccsk", "dΨ⁻¹", [0, 6, 0, 4]),
    ("cay", "dΨ⁻¹", [9, 9, 0, 0]),
    ("exp", "both", [25, 29, 1, 3]),
    ("ccsk", "both", [4, 20, 0, 6]),
    ("cay", "both", [24, 23, 0, 0]),
];

/// The fewest operations known for a column of Table 2.
pub const OPTIMUM: [(&str, &str, u64); 9] = [
    ("exp", "Ψ", 32),
    ("ccsk", "Ψ", 24),
    ("cay", "Ψ", 33),
    ("exp", "dΨ⁻¹", 32),
    ("ccsk", "dΨ⁻¹", 10),
    ("cay", "dΨ⁻¹", 18),
    ("exp", "both", 57),
    ("ccsk", "both", 30),
    ("cay", "both", 34),
];

/// What is printed, and what is right: the formulas that a user might take from the paper, then the
/// parameters of its experiments.
pub const ERRATA: [[&str; 3]; 18] = [
    ["§2, energy in space", "E = w_sᵀ gᵀ J g w_sᵀ", "E = ½ w_sᵀ g J gᵀ w_s"],
    ["§2, before (3)", "½ m_s(Ad_g w_c) = (Ad*_g m_s)(w_c)", "½ on both sides, or on neither"],
    [
        "§2, g → Ad*_g",
        "called a representation",
        "an anti-representation, Ad*_a Ad*_b = Ad*_{ba}; the left action on 𝔤* is Ad*_{g⁻¹}",
    ],
    ["§3, text of Figure 2", "Λ_p : 𝔤 → M", "Λ_p : G → M"],
    [
        "§4.2, (18)",
        "given for the ordering 123 alone",
        "321: rows (cos u₃ sec u₂, sin u₃ sec u₂, 0), (−sin u₃, cos u₃, 0), \
         (cos u₃ tan u₂, sin u₃ tan u₂, 1); both singular at u₂ = ±π/2",
    ],
    [
        "§4.3, dcay⁻¹",
        "(𝟙 − u/2)v(𝟙 + u/2) = 𝟙 − ½[u, v] − ¼uvu",
        "(𝟙 − u/2)v(𝟙 + u/2) = v − ½[u, v] − ¼uvu",
    ],
    ["§4.3", "G_J, 𝔤_J", "G_M, 𝔤_M"],
    [
        "§5.1, MR",
        "10 flows, 20 trigonometric functions (6 at order 2)",
        "13 flows, 26 trigonometric functions (10 at order 2)",
    ],
    ["§5.1, S", "k = tan(½ζ̄)/(½‖ζ̄‖)", "k = tan(½‖ζ̄‖)/(½‖ζ̄‖)"],
    ["§5.1, S", "cay: 18 operations", "35, by Table 2"],
    ["§5.1, B4", "g⁺ = exp(ω̄) g", "g⁺ = exp(h ω̄) g"],
    ["§5.1, B4", "192 operations", "408 in Table 4: 192 and four products with gJ⁻¹gᵀ"],
    ["§5.2, example 3", "J = diag(1, 4, 18)", "J⁻¹ = diag(1, 4, 18)"],
    ["§5.2, example 3", "Δt = 0.0004", "Δt = 0.004"],
    ["§5.2, ccsk", "one step ccskf, one ccskb", "ccskb (321) first"],
    ["§5.3", "diag(1, 4, 18) is symmetric", "asymmetric"],
    ["§5.3", "N = 2^p, p = 1 … 6", "p = 5 … 10 in the second test"],
    ["§5.3", "“the ccsk presents a better behaviour (figure 4)”", "ccskb, the ordering 321, does"],
];
