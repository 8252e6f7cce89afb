//! All zeros of a smooth function on an interval, by polynomials whose convergence is checked. It knows numbers only.
//!
//! The polynomial interpolates 5, 9 or 17 values at Chebyshev–Lobatto points. It is trusted if its Chebyshev coefficients
//! fall: then the last of them bound its distance from the function. In Bernstein's form its coefficients bound it, and
//! their differences bound its slope. So each part of the interval has no zero, or the function is monotone there, or it is
//! halved (de Casteljau). Source: J. P. Boyd, SIAM J. Numer. Anal. 40 (2002); F. Biscani & D. Izzo, MNRAS 513 (2022).

use core::f64::consts::FRAC_1_SQRT_2;

/// The numbers of values less one. The points of each are among those of the next.
const DEGREES: [usize; 3] = [4, 8, 16];
/// How often coefficients must fall, each two from the two before, and to which part of them at least. Values of a
/// function that is much faster than their distance do so by chance: at 1e-3, 1e-5, 3e-7 of all places.
const FALLS: [(usize, f64); 3] = [(1, 1.0 / 32.0), (3, 1.0 / 8.0), (4, 1.0 / 8.0)];
/// The most values.
pub(super) const MOST: usize = 17;
/// The finest level.
pub(super) const FINEST: usize = DEGREES.len() - 1;
/// Rounding of a value, in roundings of the numbers of the problem, and in parts of the sizes of the terms of its series.
const ROUNDING: f64 = 16.0;
/// The shortest part of an interval that is looked at.
const SHORTEST: f64 = 1.0 / (1u64 << 48) as f64;
/// The most points that separate zeros.
const SEPARATORS: usize = 64;

/// cos(πj/16) up to j = 8.
const COSINES: [f64; 9] = [
    1.0,
    0.980_785_280_403_230_4,
    0.923_879_532_511_286_7,
    0.831_469_612_302_545_2,
    FRAC_1_SQRT_2,
    0.555_570_233_019_602_2,
    0.382_683_432_365_089_8,
    0.195_090_322_016_128_27,
    0.0,
];

/// cos(πj/16).
const fn cosine(j: usize) -> f64 {
    match j % 32 {
        j @ ..=8 => COSINES[j],
        j @ ..=16 => -COSINES[16 - j],
        j @ ..=24 => -COSINES[j - 16],
        j => COSINES[32 - j],
    }
}

/// The place in \[0, 1\] of the point with this number, from 0 to 16.
pub(super) fn place(j: usize) -> f64 {
    0.5 - 0.5 * cosine(j)
}

/// The distance of the numbers of two points of a level.
pub(super) const fn stride(level: usize) -> usize {
    (MOST - 1) / DEGREES[level]
}

/// True if the values show all zeros, though no polynomial describes them, as at a jump, at a kink and at a zero of high
/// multiplicity: they only rise, they only fall, or they are farther from zero than from each other. Values of a function
/// that is much faster than their distance hardly ever do so.
pub(super) fn shows_all(values: &[f64; MOST]) -> bool {
    let (least, largest) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let is_far = least.max(-largest) > largest - least;
    values.is_sorted() || values.iter().rev().is_sorted() || is_far
}

/// The rounding of values of a function that has these values.
///
/// A part of a step may have small values with the rounding of the whole step: those of g(y) have that of y, whose size does
/// not depend on the part. `epsilon` is the rounding of the numbers of the problem.
pub(super) fn noise_of(values: &[f64; MOST], epsilon: f64) -> f64 {
    ROUNDING * epsilon * values.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Numbers for polynomials of degree 16 at most.
type Numbers = [f64; MOST];

/// For each degree the Chebyshev coefficients of the polynomials that are 1 at one point and 0 at the others.
static CHEBYSHEV: [[Numbers; MOST]; 3] = {
    let mut all = [[[0.0; MOST]; MOST]; 3];
    let mut level = 0;
    while level < 3 {
        let n = DEGREES[level];
        let mut j = 0;
        while j <= n {
            let mut k = 0;
            while k <= n {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                let halves = if j == 0 || j == n { 0.5 } else { 1.0 }
                    * if k == 0 || k == n { 0.5 } else { 1.0 };
                all[level][j][k] = sign * halves * 2.0 * cosine(k * j * stride(level)) / n as f64;
                k += 1;
            }
            j += 1;
        }
        level += 1;
    }
    all
};

/// Σ x_j row_j over the first N rows.
fn sum_of_rows<const N: usize>(rows: &[Numbers; MOST], x: &Numbers) -> Numbers {
    let mut sum = [0.0; MOST];
    for (x, row) in x[..N].iter().zip(rows) {
        for (sum, number) in sum[..N].iter_mut().zip(row) {
            *sum += x * number;
        }
    }
    sum
}

/// For each degree the Chebyshev polynomials in Bernstein's form, and the largest of those numbers.
static BERNSTEIN: [([Numbers; MOST], Numbers); 3] = {
    // Pascal's triangle.
    let mut choose = [[0i64; 33]; 33];
    let mut n = 0;
    while n < 33 {
        choose[n][0] = 1;
        let mut k = 1;
        while k <= n {
            choose[n][k] = choose[n - 1][k - 1] + choose[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    let mut all = [([[0.0; MOST]; MOST], [0.0; MOST]); 3];
    let mut level = 0;
    while level < 3 {
        let n = DEGREES[level];
        let mut k = 0;
        while k <= n {
            let mut j = 0;
            while j <= n {
                // Σ (−1)^(k−i) C(2k, 2i) C(n−k, j−i) / C(n, j)
                let (mut sum, mut i) = (0, 0);
                while i <= k && i <= j {
                    let sign = if (k - i) % 2 == 0 { 1 } else { -1 };
                    sum += sign * choose[2 * k][2 * i] * choose[n - k][j - i];
                    i += 1;
                }
                let value = sum as f64 / choose[n][j] as f64;
                all[level].0[k][j] = value;
                if value.abs() > all[level].1[k] {
                    all[level].1[k] = value.abs();
                }
                j += 1;
            }
            k += 1;
        }
        level += 1;
    }
    all
};

/// The coarsest level that describes a function, from its Chebyshev coefficients by those of one level. `None` if that
/// level does not.
fn level_of(c: &[f64], own: usize, rounding: f64) -> Option<usize> {
    // In pairs, because one of two is zero where a function is even or odd.
    let pair = |i: usize| c[2 * i - 1].abs() + c[2 * i].abs();
    let falls = |level: &usize| {
        let ((times, part), last) = (FALLS[*level], DEGREES[*level] / 2);
        let is_small = |i: usize, bound: f64| pair(i) <= bound.max(rounding);
        (last + 1 - times..=last).all(|i| is_small(i, part * pair(i - 1)))
            && (last + 1..=DEGREES[own] / 2).all(|i| is_small(i, part * pair(last)))
    };
    if falls(&own) { (0..=own).find(falls) } else { None }
}

/// The rounding of values of a function on an interval.
pub(super) struct Rounding {
    /// The least rounding of a value.
    pub(super) noise: f64,
    /// The rounding of the places, in parts of the interval.
    pub(super) blur: f64,
    /// The relative rounding of the numbers of the problem.
    pub(super) epsilon: f64,
}

/// A function on an interval as a polynomial.
pub(super) struct Proxy {
    degree: usize,
    /// In Bernstein's form.
    b: Numbers,
    /// The polynomial is this far from the function at most.
    far: f64,
    /// The same of the differences of `b`.
    steep: f64,
    /// The coarsest level that describes the function.
    pub(super) level: Option<usize>,
    /// True if more values would tell no more.
    is_exact: bool,
}

impl Proxy {
    /// The polynomial through the values of this level, which are at their places among 17.
    pub(super) fn new(
        values: &Numbers,
        level: usize,
        Rounding { noise, blur, epsilon }: Rounding,
    ) -> Self {
        let (degree, stride) = (DEGREES[level], stride(level));
        let mut at = [0.0; MOST];
        at.iter_mut().zip(values.iter().step_by(stride)).for_each(|(at, value)| *at = *value);
        let (to_bernstein, largest) = &BERNSTEIN[level];
        let apply = match level {
            0 => sum_of_rows::<5>,
            1 => sum_of_rows::<9>,
            _ => sum_of_rows::<MOST>,
        };
        let c = apply(&CHEBYSHEV[level], &at);
        let b = apply(to_bernstein, &c);
        let terms = c.iter().zip(largest).map(|(c, largest)| c.abs() * largest);
        // The slope of the polynomial T_k is at most k², and 2k² on [0, 1].
        let slopes = c.iter().enumerate().map(|(k, c)| c.abs() * (2 * k * k) as f64);
        let rounding = noise + ROUNDING * epsilon * terms.sum::<f64>() + blur * slopes.sum::<f64>();
        let last = c[degree - 1].abs() + c[degree].abs();
        let far = last + rounding;
        let level = level_of(&c, level, rounding);
        // |p′| on [−1, 1] is at most degree²·|p|, and a slope of 1 is a difference of 2/degree.
        let steep = 2.0 * degree as f64 * far;
        Proxy { degree, b, far, steep, level, is_exact: last <= 16.0 * rounding }
    }

    /// The places between which the function is monotone where it has zeros. `None` if the polynomial is too far from the
    /// function to tell.
    pub(super) fn separators(&self) -> Option<Separators> {
        self.level?;
        let mut found = Separators { places: [0.0; SEPARATORS], count: 0 };
        self.search(&self.b, [0.0, 1.0], &mut found)?;
        Some(found)
    }

    /// Adds the ends of the parts with a zero, of the part from `start` to `end` with the coefficients `b`.
    fn search(&self, b: &Numbers, [start, end]: [f64; 2], found: &mut Separators) -> Option<()> {
        let Proxy { degree, far, .. } = *self;
        let (b, steep) = (&b[..=degree], self.steep * (end - start));
        let all = |test: &dyn Fn(f64) -> bool| b.iter().all(|&b| test(b));
        if all(&|b| b > far) || all(&|b| b < -far) {
            return Some(());
        }
        let slopes = |test: &dyn Fn(f64) -> bool| b.windows(2).all(|b| test(b[1] - b[0]));
        let is_monotone = slopes(&|d| d > steep) || slopes(&|d| d < -steep);
        let is_unknown = all(&|b| b.abs() <= far) && slopes(&|d| d.abs() <= steep);
        let is_short = end - start <= SHORTEST;
        if is_monotone || (is_unknown || is_short) && self.is_exact {
            found.add(start)?;
            return found.add(end);
        }
        if is_unknown || is_short {
            return None;
        }
        // De Casteljau's halves.
        let (mut left, mut right) = ([0.0; MOST], [0.0; MOST]);
        right[..=degree].copy_from_slice(b);
        for i in 0..=degree {
            left[i] = right[0];
            for j in 0..degree - i {
                right[j] = 0.5 * (right[j] + right[j + 1]);
            }
        }
        let middle = 0.5 * (start + end);
        self.search(&left, [start, middle], found)?;
        self.search(&right, [middle, end], found)
    }
}

/// Places in order. Between two neighbours a function has no zero or is monotone.
pub(super) struct Separators {
    places: [f64; SEPARATORS],
    count: usize,
}

impl Separators {
    /// The places.
    pub(super) fn places(&self) -> &[f64] {
        &self.places[..self.count]
    }
    fn add(&mut self, place: f64) -> Option<()> {
        if self.places().last() != Some(&place) {
            *self.places.get_mut(self.count)? = place;
            self.count += 1;
        }
        Some(())
    }
}

/// True if a function that [`Proxy::level`] 0 describes has no zero between `start` and `end`, from its values there, in the
/// middle, and at a point before.
///
/// The parabola through the three points is as far from the function as the third divided difference tells. `before` is
/// the distance of the point before, in parts of the distance of `start` and `end`, and the value there. `epsilon` is the
/// rounding of the numbers of the problem.
pub(super) fn has_none([start, middle, end]: [f64; 3], before: (f64, f64), epsilon: f64) -> bool {
    // Places −1, 0, 1 and −1 − x.
    let x = 2.0 * before.0;
    let slope = middle - start;
    let bend = 0.5 * (start - 2.0 * middle + end);
    let bend_before = (slope - (start - before.1) / x) / (1.0 + x);
    let third = ((bend - bend_before) / (2.0 + x)).abs();
    let moves = 0.5 * (end - start).abs() + 0.5 * bend.abs();
    let inner = 2.0 * middle - 0.5 * (start + end);
    let least = start.abs().min(inner.abs()).min(end.abs());
    let sign = start > 0.0;
    // The parabola and the function differ by 0.4 of the third difference where it is constant.
    let is_far = least > 2.0 * third && third <= (moves / 8.0).max(ROUNDING * epsilon * least);
    // By chance a faster function has such values, but seldom where they are near each other and smooth.
    let is_slow = least > moves || least > 0.5 * moves && third <= moves / 32.0;
    (inner > 0.0) == sign && (end > 0.0) == sign && is_far && is_slow
}
