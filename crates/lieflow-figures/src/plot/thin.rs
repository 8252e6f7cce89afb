//! Reduction of long lines to what a picture can show.

/// At most four points for each run of points in one of `columns` equal columns of the range of
/// x: the first, the lowest, the highest and the last. A line through them covers the same pixels
/// as the full line when there is a column for each pixel. Points that are not finite are dropped.
pub(crate) fn thin_time_series(points: &[(f64, f64)], columns: usize) -> Vec<(f64, f64)> {
    let finite = points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite());
    let finite: Vec<(f64, f64)> = finite.collect();
    let lo = finite.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let hi = finite.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let width = (hi - lo) / columns.max(1) as f64;
    let column = |p: &(f64, f64)| if width > 0.0 { ((p.0 - lo) / width).floor() } else { 0.0 };
    finite.chunk_by(|a, b| column(a) == column(b)).flat_map(extremes).collect()
}

/// The first, lowest, highest and last point of `run`, in their order and each once.
fn extremes(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let by_height = |a: &usize, b: &usize| run[*a].1.total_cmp(&run[*b].1);
    let lowest = (0..run.len()).min_by(by_height).unwrap_or(0);
    let highest = (0..run.len()).max_by(by_height).unwrap_or(0);
    let mut kept = vec![0, lowest, highest, run.len().saturating_sub(1)];
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().filter_map(|i| run.get(i).copied()).collect()
}

/// The points of a path that are needed to stay within `tolerance` of it (Douglas–Peucker).
pub(crate) fn thin_path<const N: usize>(points: &[[f64; N]], tolerance: f64) -> Vec<[f64; N]> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut open = vec![(0, points.len() - 1)];
    while let Some((a, b)) = open.pop() {
        let farthest = (a + 1..b)
            .map(|i| (i, distance_to_segment(&points[i], &points[a], &points[b])))
            .max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, distance)) = farthest
            && distance > tolerance
        {
            keep[i] = true;
            open.extend([(a, i), (i, b)]);
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

/// The distance of p from the segment from a to b.
pub(crate) fn distance_to_segment<const N: usize>(p: &[f64; N], a: &[f64; N], b: &[f64; N]) -> f64 {
    let (mut along, mut length) = (0.0, 0.0);
    for i in 0..N {
        along += (p[i] - a[i]) * (b[i] - a[i]);
        length += (b[i] - a[i]).powi(2);
    }
    let t = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    (0..N).map(|i| (p[i] - a[i] - t * (b[i] - a[i])).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_series_keeps_extremes() {
        let mut points: Vec<(f64, f64)> =
            (0..10_000).map(|i| (f64::from(i), (f64::from(i) * 0.7).sin())).collect();
        points[1234].1 = 9.0;
        points[8765].1 = -7.0;
        let thin = thin_time_series(&points, 100);
        assert!(thin.len() <= 4 * 101);
        assert!(thin.contains(&(1234.0, 9.0)) && thin.contains(&(8765.0, -7.0)));
        assert_eq!(thin.first(), points.first());
        assert_eq!(thin.last(), points.last());
        assert!(thin.windows(2).all(|w| w[0].0 < w[1].0));
    }

    #[test]
    fn time_series_without_extent_or_numbers() {
        assert!(thin_time_series(&[], 10).is_empty());
        assert!(thin_time_series(&[(f64::NAN, 1.0), (0.0, f64::INFINITY)], 10).is_empty());
        assert_eq!(thin_time_series(&[(1.0, 2.0)], 10), vec![(1.0, 2.0)]);
    }

    #[test]
    fn path_stays_within_the_tolerance() {
        let circle: Vec<[f64; 2]> = (0..=1000)
            .map(|i| (f64::from(i) * std::f64::consts::TAU / 1000.0).sin_cos())
            .map(|(s, c)| [c, s])
            .collect();
        let thin = thin_path(&circle, 1e-3);
        assert!(thin.len() < 140 && thin.len() > 20);
        for p in &circle {
            let near = thin.windows(2).map(|w| distance_to_segment(p, &w[0], &w[1]));
            assert!(near.fold(f64::INFINITY, f64::min) <= 1e-3 + 1e-12);
        }
    }
}
