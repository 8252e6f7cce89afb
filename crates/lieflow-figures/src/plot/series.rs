//! The lines of a chart and their markers.

use super::svg::px;
use super::theme::LINE_COLOURS;

/// A value with a remark for the reader who points at it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// The horizontal value.
    pub x: f64,
    /// The vertical value.
    pub y: f64,
    /// A remark such as `"h = 1/64"`; may be empty.
    pub note: String,
}

impl Point {
    /// A point without a remark.
    pub fn new(x: f64, y: f64) -> Self {
        Point { x, y, note: String::new() }
    }

    /// The point with a remark.
    pub fn with_note(self, note: impl Into<String>) -> Self {
        Point { note: note.into(), ..self }
    }
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Point::new(x, y)
    }
}

/// The shape drawn at the points of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marker {
    /// No marker: a dense line, drawn at the resolution of the picture.
    #[default]
    None,
    /// A disc.
    Circle,
    /// A small disc, without a line from one to the next: for points between which nothing lies.
    Dot,
    /// A square.
    Square,
    /// A triangle standing on its base.
    Triangle,
    /// A square standing on its corner.
    Diamond,
    /// A triangle standing on its tip.
    Wedge,
    /// An upright cross.
    Plus,
    /// A diagonal cross.
    Cross,
    /// A hexagon.
    Hexagon,
}

/// Give each of several lines with one colour and one dash another marker.
pub fn tell_apart(series: &mut [Series]) {
    for i in 1..series.len() {
        let look = |a: &Series| (a.colour % LINE_COLOURS, a.dash);
        let alike = series[..i].iter().filter(|a| look(a) == look(&series[i])).count();
        if alike > 0 {
            series[i].marker = Marker::cycle(series[i].colour + alike);
        }
    }
}

impl Marker {
    /// A different shape for each `index`, in turn.
    pub fn cycle(index: usize) -> Self {
        const SHAPES: [Marker; 8] = [
            Marker::Circle,
            Marker::Square,
            Marker::Triangle,
            Marker::Diamond,
            Marker::Wedge,
            Marker::Plus,
            Marker::Cross,
            Marker::Hexagon,
        ];
        SHAPES[index % SHAPES.len()]
    }

    /// The outline around the origin; all shapes have about the area of a disc of radius `r`.
    pub(crate) fn outline(self, r: f64) -> String {
        let closed = |corners: &[(f64, f64)]| {
            let pairs = corners.iter().map(|c| format!("{} {}", px(r * c.0), px(r * c.1)));
            format!("M{}z", pairs.collect::<Vec<_>>().join("L"))
        };
        match self {
            Marker::None => String::new(),
            Marker::Circle | Marker::Dot => {
                let r = if self == Marker::Dot { 0.5 * r } else { r };
                let (r, d) = (px(r), px(2.0 * r));
                format!("M-{r} 0a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0-{d} 0z")
            }
            Marker::Square => closed(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Marker::Triangle => closed(&[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)]),
            Marker::Diamond => closed(&[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)]),
            Marker::Wedge => closed(&[(0.0, 1.25), (1.15, -0.85), (-1.15, -0.85)]),
            Marker::Plus => {
                let (r, d) = (px(1.2 * r), px(2.4 * r));
                format!("M-{r} 0h{d}M0-{r}v{d}")
            }
            Marker::Cross => {
                let (r, d) = (px(0.9 * r), px(1.8 * r));
                format!("M-{r}-{r}l{d} {d}M-{r} {r}l{d}-{d}")
            }
            Marker::Hexagon => closed(&[
                (-1.1, 0.0),
                (-0.55, -0.95),
                (0.55, -0.95),
                (1.1, 0.0),
                (0.55, 0.95),
                (-0.55, 0.95),
            ]),
        }
    }

    /// Whether the shape has strokes only and no area to fill.
    fn is_open(self) -> bool {
        matches!(self, Marker::Plus | Marker::Cross)
    }
}

/// A line of a chart.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// The index of the colour; lines that belong together may share it. After [`LINE_COLOURS`] they begin
    /// again.
    pub colour: usize,
    /// In the colour of text instead, as a line that is none of the data.
    pub in_ink: bool,
    /// The shape at the points. [`Marker::None`] is for dense lines.
    pub marker: Marker,
    /// A dashed line with hollow markers.
    pub dash: bool,
    /// The points in their order along the line.
    pub points: Vec<Point>,
    /// Filled, as the band between two lines: the points go around it.
    pub filled: bool,
    /// A heavier line, drawn above the others.
    pub emphasised: bool,
}

impl Series {
    /// A solid line without markers.
    pub fn line<P: Into<Point>>(
        name: impl Into<String>,
        colour: usize,
        points: impl IntoIterator<Item = P>,
    ) -> Self {
        let points = points.into_iter().map(Into::into).collect();
        Series { name: name.into(), colour, points, ..Series::default() }
    }

    /// The line with a marker at each point.
    pub fn with_marker(self, marker: Marker) -> Self {
        Series { marker, ..self }
    }

    /// The line dashed, or not.
    pub fn with_dash(self, dash: bool) -> Self {
        Series { dash, ..self }
    }

    /// The line in the colour of text.
    pub fn in_ink(self) -> Self {
        Series { in_ink: true, ..self }
    }

    /// The points as the edge of a filled band.
    pub fn with_fill(self) -> Self {
        Series { filled: true, ..self }
    }

    /// The CSS classes of this line and of its legend entry.
    pub(crate) fn classes(&self) -> String {
        let mut classes = match self.in_ink {
            true => "lf-ink".to_string(),
            false => format!("lf-c{}", self.colour % LINE_COLOURS),
        };
        if self.dash {
            classes.push_str(" lf-dash");
        }
        if self.filled {
            classes.push_str(" lf-filled");
        }
        if self.emphasised {
            classes.push_str(" lf-strong");
        }
        classes
    }

    /// The CSS classes of a marker of this line.
    pub(crate) fn marker_classes(&self) -> &'static str {
        if self.marker.is_open() { "lf-p lf-open" } else { "lf-p" }
    }

    /// The outline of a marker of this line.
    pub(crate) fn outline(&self) -> String {
        self.marker.outline(if self.emphasised { 4.6 } else { 4.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_lines_look_alike() {
        let look = |i: usize| Series {
            colour: i % 11,
            marker: Marker::cycle(i % 11),
            dash: i.is_multiple_of(2),
            ..Series::default()
        };
        let mut series: Vec<Series> = (0..40).map(look).collect();
        tell_apart(&mut series);
        let mut seen = Vec::new();
        for line in &series {
            let look = (line.colour % LINE_COLOURS, line.dash, line.marker);
            assert!(!seen.contains(&look), "{look:?}");
            seen.push(look);
        }
    }

    #[test]
    fn neighbouring_markers_differ() {
        for i in 0..8 {
            assert_ne!(Marker::cycle(i), Marker::cycle(i + 1));
            assert!(Marker::cycle(i).outline(4.0).starts_with('M'));
        }
        assert_eq!(Marker::cycle(8), Marker::Circle);
    }

    #[test]
    fn classes_state_the_style() {
        let series = Series { colour: 11, dash: true, emphasised: true, ..Series::default() };
        assert_eq!(series.classes(), "lf-c1 lf-dash lf-strong");
        assert_eq!(series.in_ink().classes(), "lf-ink lf-dash lf-strong");
    }
}
