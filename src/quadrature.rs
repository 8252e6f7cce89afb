//! Quadrature.

/// Gauss–Legendre nodes and weights on \[0, 1\], exact to degree 13.
pub(crate) const GAUSS_LEGENDRE7: [(f64, f64); 7] = {
    let half: [(f64, f64); 3] = [
        (0.405_845_151_377_397_2, 0.381_830_050_505_118_94),
        (0.741_531_185_599_394_4, 0.279_705_391_489_276_7),
        (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    ];
    let mut nodes = [(0.5, 0.5 * 0.417_959_183_673_469_4); 7];
    let mut i = 0;
    while i < 3 {
        let (t, w) = half[i];
        nodes[2 * i] = (0.5 * (1.0 + t), 0.5 * w);
        nodes[2 * i + 1] = (0.5 * (1.0 - t), 0.5 * w);
        i += 1;
    }
    nodes
};
