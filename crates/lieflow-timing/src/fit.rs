//! The line of least squares.

/// The line of least squares through points that come one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    count: f64,
    /// Means of x and of y.
    mean: [f64; 2],
    /// Σ(x − mean)(y − mean) and Σ(x − mean)².
    squares: [f64; 2],
}

impl Fit {
    /// The next point.
    pub fn add(&mut self, (x, y): (f64, f64)) {
        self.count += 1.0;
        let before = [x - self.mean[0], y - self.mean[1]];
        for i in 0..2 {
            self.mean[i] += before[i] / self.count;
        }
        self.squares[0] += before[0] * (y - self.mean[1]);
        self.squares[1] += before[0] * (x - self.mean[0]);
    }

    /// The slope. `None` if all points have one x.
    pub fn slope(&self) -> Option<f64> {
        let [together, alone] = self.squares;
        (alone != 0.0).then_some(together / alone)
    }

    /// The value of the line at x. `None` if it has no slope.
    pub fn at(&self, x: f64) -> Option<f64> {
        Some(self.mean[1] + self.slope()? * (x - self.mean[0]))
    }
}

impl FromIterator<(f64, f64)> for Fit {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(points: I) -> Self {
        let mut fit = Fit::default();
        points.into_iter().for_each(|point| fit.add(point));
        fit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_three_points() {
        // Means 2 and 3; Σ(x − 2)(y − 3) = 13.5, Σ(x − 2)² = 14.
        let fit: Fit = [(0.0, 1.5), (1.0, 1.5), (5.0, 6.0)].into_iter().collect();
        let close = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-15);
        assert!(close(fit.slope(), 13.5 / 14.0) && close(fit.at(2.0), 3.0));
        assert_eq!(Fit::from_iter([(1.0, 2.0), (1.0, 3.0)]).slope(), None);
    }
}
