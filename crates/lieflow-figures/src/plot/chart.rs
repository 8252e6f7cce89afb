//! Line charts.

use super::labels::{self, ROW};
use super::scale::{Axis, Map, Scale, Tick};
use super::series::{Marker, Point, Series};
use super::svg::{Opening, escape, polyline, px, ring, slug, text, text_width};
use super::theme;
use super::trace::{Trace, omission};

/// The size of the picture. The names of the lines may need more height.
const WIDTH: f64 = 760.0;
const TOP: f64 = 42.0;
const BOTTOM: f64 = 412.0;
/// The least width of the data.
const LEAST: f64 = 320.0;

/// The size of the labels of ticks, as in common.css.
const TICK_SIZE: f64 = 12.0;

/// The room of the title of the upward axis, and the room between an axis and its labels.
const UPWARD: f64 = 24.0;
const BESIDE: f64 = 8.0;

/// The room below the data, between the data and the names of the lines, and at the right edge.
const FOOT: f64 = 52.0;
const GAP: f64 = 24.0;
const EDGE: f64 = 12.0;

/// Places on the horizontal axis that have a name: each is a thin vertical line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// What they are.
    pub name: String,
    /// Where they are.
    pub at: Vec<f64>,
}

impl Marks {
    /// How the lines of the first marks of a chart look, of the second, and so on.
    pub const LOOKS: [&str; 3] = ["dotted", "dashed", "dash-dotted"];
}

/// A chart of lines over two axes.
#[derive(Clone, Debug)]
pub struct Chart {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the chart.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The lines.
    pub series: Vec<Series>,
    /// The text below the chart.
    pub caption: String,
    /// Thin vertical lines, below the others.
    pub marks: Vec<Marks>,
}

impl Chart {
    /// A chart of these lines over a horizontal and a vertical axis, without a caption.
    pub fn new(
        id: impl Into<String>,
        title: impl Into<String>,
        [x, y]: [Axis; 2],
        series: impl IntoIterator<Item = Series>,
    ) -> Self {
        let series = series.into_iter().collect();
        let (caption, marks) = (String::new(), Vec::new());
        Chart { id: id.into(), title: title.into(), x, y, series, caption, marks }
    }

    /// The chart with a text below it.
    pub fn with_caption(self, caption: impl Into<String>) -> Self {
        Chart { caption: caption.into(), ..self }
    }

    /// The chart with these marks.
    pub fn with_marks(self, marks: impl Into<Vec<Marks>>) -> Self {
        Chart { marks: marks.into(), ..self }
    }

    /// The chart as a complete `<svg>` element.
    ///
    /// A line goes through those of its points that have a place within the axes and has a gap at
    /// the others; [`Chart::notes`] counts the others. Each point of a line with markers is an
    /// element of its own. A line without markers is thinned to the resolution of the picture.
    pub fn svg(&self) -> String {
        let layout = Layout::new(self);
        let traces: Vec<Trace> =
            self.series.iter().map(|s| Trace::new(s, &layout.x, &layout.y)).collect();
        let rows = self.named().count() as f64 * ROW;
        let note = if self.notes().is_empty() { 0.0 } else { 16.0 };
        let height = (BOTTOM + FOOT + note).max(TOP + rows + 10.0).ceil();
        let id = slug(&self.id);
        let place = format!(" data-plot=\"{} {} {BOTTOM}\"", layout.x.from, layout.x.to);
        let attributes =
            [map_attribute("x", &layout.x, &self.x), map_attribute("y", &layout.y, &self.y), place];
        let opening = Opening {
            class: "lf-chart",
            id: &id,
            size: (layout.width, height),
            title: &self.title,
            description: &self.description(),
            css: theme::chart_css(),
            attributes: attributes.concat(),
            defs: String::new(),
        };
        let mut out = opening.svg();
        self.draw_axes(&mut out, &layout, height);
        self.draw_marks(&mut out, &layout.x);
        for index in self.drawing_order() {
            self.draw_line(&mut out, index, &traces[index], &layout.x, &layout.y);
        }
        if traces.iter().all(|t| t.points.is_empty()) {
            let middle = (0.5 * (layout.x.from + layout.x.to), 0.5 * (TOP + BOTTOM));
            out.push_str(&text("lf-note", middle, "middle", "There is no data to draw."));
        }
        self.draw_names(&mut out, &traces, &layout);
        out.push_str("</svg>");
        out
    }

    /// Sentences that count the points which are not drawn, for each cause; empty if all are.
    pub fn notes(&self) -> String {
        let Layout { x, y, .. } = Layout::new(self);
        let mut counts: Vec<(String, usize)> = Vec::new();
        for point in self.series.iter().flat_map(|s| &s.points) {
            let horizontal = omission(&self.x, &x, point.x);
            let Some(cause) = horizontal.or_else(|| omission(&self.y, &y, point.y)) else {
                continue;
            };
            match counts.iter_mut().find(|c| c.0 == cause) {
                Some(count) => count.1 += 1,
                None => counts.push((cause, 1)),
            }
        }
        let sentences = counts.iter().map(|(cause, count)| match count {
            1 => format!("1 point {cause} is not drawn."),
            _ => format!("{count} points {cause} are not drawn."),
        });
        sentences.collect::<Vec<_>>().join(" ")
    }

    /// The caption followed by the [`notes`](Chart::notes).
    pub fn full_caption(&self) -> String {
        [self.caption.trim(), &self.notes()].join(" ").trim().to_string()
    }

    fn description(&self) -> String {
        let names: Vec<&str> = self.series.iter().map(|s| s.name.as_str()).collect();
        format!(
            "{} against {}; {} lines: {}. {}",
            self.y.title,
            self.x.title,
            names.len(),
            names.join(", "),
            self.full_caption()
        )
    }

    /// The lines that are named beside the data: not a single one whose name is on the axis.
    fn named(&self) -> impl Iterator<Item = &Series> {
        let told = |s: &Series| self.y.title.contains(s.name.as_str());
        let all = self.series.len() > 1 || !self.series.iter().any(told);
        self.series.iter().filter(move |_| all)
    }

    fn drawing_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.series.len()).collect();
        order.sort_by_key(|i| self.series[*i].emphasised);
        order
    }

    fn draw_axes(&self, out: &mut String, Layout { x, y, .. }: &Layout, height: f64) {
        let (columns, rows) = (x.ticks(46.0), y.ticks(34.0));
        // Labels that are wide need more room.
        let columns = match widest(&columns) + 14.0 {
            room if room > 46.0 => x.ticks(room),
            _ => columns,
        };
        let (left, right) = (px(x.from), px(x.to));
        for major in [false, true] {
            let vertical = columns.iter().filter(|t| t.major == major);
            let horizontal = rows.iter().filter(|t| t.major == major);
            let vertical = vertical.map(|t| format!("M{} {TOP}V{BOTTOM}", px(t.at)));
            let horizontal = horizontal.map(|t| format!("M{left} {}H{right}", px(t.at)));
            let class = if major { "lf-grid" } else { "lf-minor" };
            let d: String = vertical.chain(horizontal).collect();
            out.push_str(&format!("<path class=\"{class}\" d=\"{d}\"/>"));
        }
        out.push_str(&format!("<path class=\"lf-frame\" d=\"M{left} {TOP}V{BOTTOM}H{right}\"/>"));
        for (tick, label) in columns.iter().filter_map(|t| Some((t, t.label.as_ref()?))) {
            let number = tick.number.map_or_else(String::new, |n| format!(" data-n=\"{n}\""));
            out.push_str(&format!(
                "<text class=\"lf-tick\" x=\"{}\" y=\"{}\" text-anchor=\"middle\"{number}>{}</text>",
                px(tick.at),
                px(BOTTOM + 18.0),
                escape(label)
            ));
        }
        for (at, label) in rows.iter().filter_map(|t| Some((t.at, t.label.as_ref()?))) {
            out.push_str(&text("lf-tick", (x.from - BESIDE, at + 4.2), "end", label));
        }
        let middle = 0.5 * (x.from + x.to);
        out.push_str(&text("lf-title", (16.0, 24.0), "start", &self.title));
        out.push_str(&text("lf-label", (middle, BOTTOM + 41.0), "middle", &self.x.title_beside(x)));
        out.push_str(&format!(
            "<g class=\"lf-upward\"><text class=\"lf-label\" \
             transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text></g>",
            px(0.5 * (TOP + BOTTOM)),
            escape(&self.y.title_beside(y))
        ));
        let notes = self.notes();
        if !notes.is_empty() {
            out.push_str(&text("lf-note", (x.from, height - 5.0), "start", &notes));
        }
    }

    fn draw_marks(&self, out: &mut String, x: &Map) {
        for (i, marks) in self.marks.iter().enumerate() {
            let look = Marks::LOOKS[i % Marks::LOOKS.len()];
            for at in &marks.at {
                let within = |at: &f64| x.contains(*at);
                let Some(pixel) = x.pixel(*at).filter(within) else { continue };
                let title = format!("{}\n{}: {}", marks.name, self.x.title, self.x.value_text(*at));
                out.push_str(&format!(
                    "<path class=\"lf-mark lf-{look}\" d=\"M{} {TOP}V{BOTTOM}\"><title>{}</title></path>",
                    px(pixel),
                    escape(&title)
                ));
            }
        }
    }

    fn draw_line(&self, out: &mut String, index: usize, trace: &Trace, x: &Map, y: &Map) {
        let series = &self.series[index];
        out.push_str(&format!("<g class=\"lf-s {}\" data-line=\"{index}\">", series.classes()));
        let path = |run: &Vec<(f64, f64)>| match &run[..] {
            [only] if series.marker == Marker::None => ring(*only),
            run => polyline(run),
        };
        let d: String = trace.runs.iter().map(path).collect();
        if series.marker == Marker::None {
            out.push_str(&format!(
                "<path class=\"lf-line lf-dense\" tabindex=\"-1\" data-series=\"{}\" \
                 d=\"{d}\"><title>{}</title></path>",
                escape(&series.name),
                escape(&self.line_text(series, trace))
            ));
        } else {
            if series.marker != Marker::Dot {
                out.push_str(&format!("<path class=\"lf-line\" d=\"{d}\"/>"));
            }
            let (class, outline) = (series.marker_classes(), series.outline());
            for point in trace.points.iter().map(|i| &series.points[*i]) {
                let (Some(px_x), Some(px_y)) = (x.pixel(point.x), y.pixel(point.y)) else {
                    continue;
                };
                out.push_str(&format!(
                    "<path class=\"{class}\" d=\"{outline}\" transform=\"translate({} {})\" \
                     tabindex=\"-1\" data-series=\"{}\" data-x=\"{:e}\" data-y=\"{:e}\" \
                     data-note=\"{}\"><title>{}</title></path>",
                    px(px_x),
                    px(px_y),
                    escape(&series.name),
                    point.x,
                    point.y,
                    escape(&point.note),
                    escape(&self.point_text(series, point))
                ));
            }
        }
        out.push_str("</g>");
    }

    /// What a reader sees who points at `point`, line by line.
    fn point_text(&self, series: &Series, point: &Point) -> String {
        let mut lines = vec![
            series.name.clone(),
            format!("{}: {}", self.x.title, self.x.value_text(point.x)),
            format!("{}: {}", self.y.title, self.y.value_text(point.y)),
        ];
        if !point.note.is_empty() {
            lines.push(point.note.clone());
        }
        lines.join("\n")
    }

    /// The summary of a line without markers.
    fn line_text(&self, series: &Series, trace: &Trace) -> String {
        let values = || trace.points.iter().map(|i| series.points[*i].y);
        let lowest = values().fold(f64::INFINITY, f64::min);
        let highest = values().fold(f64::NEG_INFINITY, f64::max);
        let Some(last) = values().next_back() else {
            return format!("{}\nno points", series.name);
        };
        format!(
            "{}\n{} points\n{}: {} to {}, at the end {}",
            series.name,
            trace.points.len(),
            self.y.title,
            self.y.value_text(lowest),
            self.y.value_text(highest),
            self.y.value_text(last)
        )
    }

    /// The names of the lines: next to their ends if all lines end at the right edge, in their
    /// given order from the top otherwise.
    fn draw_names(&self, out: &mut String, traces: &[Trace], layout: &Layout) {
        let right = layout.x.to;
        let at_edge = |end: &(f64, f64)| end.0 > right - 4.0;
        let end = |t: &Trace| t.runs.last().and_then(|run| run.last()).copied().filter(at_edge);
        let ends: Option<Vec<(f64, f64)>> = traces.iter().map(end).collect();
        let heights = match &ends {
            Some(ends) => {
                let wanted: Vec<f64> = ends.iter().map(|e| e.1).collect();
                labels::spread(&wanted, ROW, (TOP + ROW / 2.0, BOTTOM - ROW / 2.0))
            }
            None => (0..traces.len()).map(|i| TOP + ROW * (i as f64 + 0.5)).collect(),
        };
        let mut order: Vec<usize> = (0..traces.len()).collect();
        order.sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
        out.push_str("<g class=\"lf-legend\">");
        for i in order.into_iter().take(self.named().count()) {
            let from = ends.as_ref().map(|ends| ends[i]);
            let at = (right + GAP, heights[i]);
            out.push_str(&labels::entry(&self.series[i], i, at, from, layout.names));
        }
        out.push_str("</g>");
    }
}

/// Where the data are in the picture.
struct Layout {
    x: Map,
    y: Map,
    /// The width of the names of the lines.
    names: f64,
    width: f64,
}

impl Layout {
    /// The upward axis first: its labels decide where the data begin.
    fn new(chart: &Chart) -> Self {
        let points = || chart.series.iter().flat_map(|s| &s.points);
        let y = chart.y.map(points().map(|p| p.y), (BOTTOM, TOP), 0.04);
        let left = (UPWARD + widest(&y.ticks(34.0)) + BESIDE).ceil();
        let (names, beside) = match chart.named().count() {
            0 => (0.0, 0.0),
            _ => (labels::column_width(&chart.series), GAP),
        };
        let right = (WIDTH - EDGE - names - beside).max(left + LEAST).floor();
        // Dense lines begin and end at the frame, markers stay clear of it.
        let marked = chart.series.iter().any(|s| s.marker != Marker::None);
        let padding = if marked { 0.04 } else { 0.0 };
        let x = chart.x.map(points().map(|p| p.x), (left, right), padding);
        Layout { x, y, names, width: (right + beside + names + EDGE).ceil() }
    }
}

/// The width of the widest label.
fn widest(ticks: &[Tick]) -> f64 {
    let labels = ticks.iter().filter_map(|tick| tick.label.as_ref());
    labels.map(|label| text_width(label, TICK_SIZE)).fold(0.0, f64::max)
}

/// The attribute from which the page script finds the value of a pixel.
fn map_attribute(name: &str, map: &Map, axis: &Axis) -> String {
    let (kind, linear) = match map.scale {
        Scale::Linear => ("linear", 0.0),
        Scale::Log10 => ("log10", 0.0),
        Scale::SymLog { linear } => ("symlog", linear),
    };
    let title = escape(&axis.title);
    // The script of a page gives durations their own units.
    let unit = escape(if axis.is_of_durations() { "durations" } else { &axis.unit });
    format!(
        " data-{name}=\"{kind} {:e} {:e} {} {} {linear:e}\" data-{name}-title=\"{title}\" \
         data-{name}-unit=\"{unit}\"",
        map.lo, map.hi, map.from, map.to
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<Point>, marker: Marker) -> Chart {
        let axes = [Axis::log("CPU time").of_durations(), Axis::log("global error")];
        let series = [Series::line("a <b>", 0, points).with_marker(marker)];
        Chart::new("demo", "Speed & error", axes, series).with_caption("A chart.")
    }

    #[test]
    fn every_point_is_drawn_once() {
        let points: Vec<Point> =
            (1..20).map(|i| Point::new(f64::from(i), f64::from(i).powi(-4))).collect();
        let svg = chart(points.clone(), Marker::Circle).svg();
        assert_eq!(svg.matches("class=\"lf-p\"").count(), points.len());
        for p in &points {
            let data = format!("data-x=\"{:e}\" data-y=\"{:e}\"", p.x, p.y);
            assert_eq!(svg.matches(&data).count(), 1);
        }
    }

    #[test]
    fn a_single_line_is_named_once() {
        let points = vec![Point::new(1.0, 1.0)];
        assert_eq!(chart(points.clone(), Marker::Circle).svg().matches("lf-key ").count(), 1);
        let axes = [Axis::linear("t"), Axis::linear("energy − 2").with_unit("J")];
        let energy = Chart::new("e", "Energy", axes, [Series::line("energy", 0, points)]);
        assert_eq!(energy.svg().matches("lf-key ").count(), 0);
    }

    #[test]
    fn marks_within_the_axes_are_drawn_with_their_names() {
        let points = vec![Point::new(1.0, 1.0), Point::new(10.0, 2.0)];
        let marks = Marks { name: "a < b".into(), at: vec![2.0, 5.0, 100.0] };
        let svg = chart(points, Marker::None).with_marks([marks]).svg();
        assert_eq!(svg.matches("class=\"lf-mark lf-dotted\"").count(), 2);
        assert_eq!(svg.matches("<title>a &lt; b\nCPU time: ").count(), 2);
    }

    #[test]
    fn points_without_a_place_are_counted() {
        let mut points = vec![Point::new(1.0, 1.0), Point::new(2.0, 0.0), Point::new(3.0, 0.0)];
        points.extend([Point::new(4.0, f64::NAN), Point::new(-1.0, 1.0), Point::new(5.0, 0.5)]);
        let chart = chart(points, Marker::Square);
        assert_eq!(
            chart.full_caption(),
            "A chart. 2 points with global error 0 are not drawn. \
             1 point with global error not finite is not drawn. \
             1 point with negative CPU time is not drawn."
        );
        let svg = chart.svg();
        assert_eq!(svg.matches("class=\"lf-p\"").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn text_is_escaped() {
        let svg = chart(vec![Point::new(1.0, 1.0).with_note("\"<i>")], Marker::Plus).svg();
        assert!(svg.contains("Speed &amp; error") && svg.contains("a &lt;b&gt;"));
        assert!(svg.contains("data-note=\"&quot;&lt;i&gt;\""));
        assert!(!svg.contains("<i>") && !svg.contains("<b>"));
    }

    #[test]
    fn charts_without_data_are_valid() {
        for points in [vec![], vec![Point::new(f64::NAN, f64::INFINITY)]] {
            let svg = chart(points, Marker::None).svg();
            assert!(svg.contains("no data") && svg.ends_with("</svg>"));
            assert!(!svg.contains("NaN") && !svg.contains("=\"inf"));
        }
        let empty = Chart { series: vec![], ..chart(vec![], Marker::None) };
        assert!(empty.svg().ends_with("</svg>"));
    }

    #[test]
    fn dense_lines_are_thinned_and_have_gaps() {
        let wave = |i: i32| if i == 40_000 { 0.0 } else { 2.0 + (f64::from(i) * 0.1).sin() };
        let points = (1..80_000).map(|i| Point::new(f64::from(i), wave(i))).collect();
        let chart = chart(points, Marker::None);
        let svg = chart.svg();
        assert!(svg.len() < 60_000, "{}", svg.len());
        let line = svg.split("lf-dense").nth(1).and_then(|s| s.split("</g>").next());
        assert_eq!(line.map(|s| s.matches('M').count()), Some(2));
        assert!(chart.notes().starts_with("1 point with global error 0"));
    }
}
