//! The names of the lines, to the right of the data.

use super::series::{Marker, Series};
use super::svg::{escape, px, text_width};

/// The distance of two lines of text.
pub(crate) const ROW: f64 = 20.0;

/// The length of the sample of a line.
const SAMPLE: f64 = 30.0;

/// The width of the column of names.
pub(crate) fn column_width(series: &[Series]) -> f64 {
    let widths = series.iter().map(|s| {
        let weight = if s.emphasised { 1.06 } else { 1.0 };
        weight * text_width(&s.name, 12.5)
    });
    SAMPLE + 10.0 + widths.fold(0.0, f64::max)
}

/// Heights near the `wanted` ones that are at least `gap` apart and within `lo..=hi` if there is
/// room. Neighbours that collide are moved by equal amounts (pool adjacent violators).
pub(crate) fn spread(wanted: &[f64], gap: f64, (lo, hi): (f64, f64)) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|a, b| wanted[*a].total_cmp(&wanted[*b]));
    // Subtracting `rank · gap` turns "at least a gap apart" into "not decreasing".
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, i) in order.iter().enumerate() {
        let mut pool = (wanted[*i] - rank as f64 * gap, 1);
        while let Some(last) = pools.last().copied().filter(|last| last.0 > pool.0) {
            let count = last.1 + pool.1;
            let mean = (last.0 * last.1 as f64 + pool.0 * pool.1 as f64) / count as f64;
            pool = (mean, count);
            pools.pop();
        }
        pools.push(pool);
    }
    let room = hi - gap * wanted.len().saturating_sub(1) as f64;
    let levels = pools.iter().flat_map(|(level, count)| std::iter::repeat_n(*level, *count));
    let mut heights = vec![0.0; wanted.len()];
    for (rank, (i, level)) in order.iter().zip(levels).enumerate() {
        heights[*i] = level.min(room).max(lo) + rank as f64 * gap;
    }
    heights
}

/// The legend entry of line `index` at (`x`, `y`), with a leader line from the line's end at
/// `from` if that is given.
pub(crate) fn entry(
    series: &Series,
    index: usize,
    (x, y): (f64, f64),
    from: Option<(f64, f64)>,
    width: f64,
) -> String {
    let mut out = format!(
        "<g class=\"lf-key {}\" data-line=\"{index}\" data-series=\"{}\">",
        series.classes(),
        escape(&series.name)
    );
    // A transparent area makes the whole entry sensitive to the pointer.
    out.push_str(&format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{ROW}\" rx=\"3\" fill=\"none\" \
         pointer-events=\"all\"/>",
        px(x - 5.0),
        px(y - ROW / 2.0),
        px(width + 8.0)
    ));
    if let Some((x0, y0)) = from {
        let knee = (x0 + x) / 2.0;
        out.push_str(&format!(
            "<path class=\"lf-leader\" d=\"M{} {}C{} {} {} {} {} {}\"/>",
            px(x0 + 3.0),
            px(y0),
            px(knee),
            px(y0),
            px(knee),
            px(y),
            px(x - 2.0),
            px(y)
        ));
    }
    // Points without a line are small: in the legend each is large enough to see its colour.
    let outline = match series.marker {
        Marker::Dot => Marker::Circle.outline(4.0),
        _ => {
            let line = format!("<path class=\"lf-key-line\" d=\"M{} {}h{SAMPLE}\"/>", px(x), px(y));
            out.push_str(&line);
            series.outline()
        }
    };
    if !outline.is_empty() {
        // The class of a drawn point would make the sample count as data.
        let class = series.marker_classes().replace("lf-p", "lf-m");
        let middle = (px(x + SAMPLE / 2.0), px(y));
        out.push_str(&format!(
            "<path class=\"{class}\" d=\"{outline}\" transform=\"translate({} {})\"/>",
            middle.0, middle.1
        ));
    }
    out.push_str(&format!(
        "<text x=\"{}\" y=\"{}\">{}</text></g>",
        px(x + SAMPLE + 8.0),
        px(y + 4.3),
        escape(&series.name)
    ));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_labels_do_not_collide() {
        let wanted = [50.0, 52.0, 10.0, 51.0, 95.0];
        let heights = spread(&wanted, 12.0, (0.0, 100.0));
        let mut sorted = heights.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|w| w[1] - w[0] >= 12.0 - 1e-9));
        assert!(sorted[0] >= 0.0 && sorted[4] <= 100.0);
        assert_eq!((heights[2], heights[4]), (10.0, 95.0));
        assert!((heights[3] - 51.0).abs() < 1e-9);
    }

    #[test]
    fn points_without_a_line_have_none_in_the_legend() {
        let entry = |marker| {
            let series = Series::line("a", 0, [(0.0, 0.0)]).with_marker(marker);
            entry(&series, 0, (0.0, 0.0), None, 50.0)
        };
        assert!(!entry(Marker::Dot).contains("lf-key-line"));
        assert!(entry(Marker::Circle).contains("lf-key-line"));
    }

    #[test]
    fn spread_keeps_the_bounds() {
        assert_eq!(spread(&[99.0, 99.0, 99.0], 10.0, (0.0, 100.0)), [80.0, 90.0, 100.0]);
        assert_eq!(spread(&[0.0, 0.0], 10.0, (0.0, 100.0)), [0.0, 10.0]);
        assert!(spread(&[], 10.0, (0.0, 100.0)).is_empty());
    }
}
