//! Paths in space, in a box with one scale for its three axes.

use super::camera::{Camera, HEIGHT, Vec3, WIDTH, norm};
use super::labels::{self, ROW};
use super::scale::{Axis, Map, nice_step};
use super::sphere::Path;
use super::svg::{Opening, polyline, px, slug, text, text_width};
use super::theme;
use super::thin::thin_path;
use crate::number::{short, time_or};

/// The frame that the box fills.
const FRAME: [(f64, f64); 2] = [(78.0, 52.0), (452.0, 396.0)];

/// A side of the box is at least this part of the longest one: a path in a plane has a box, too.
const THIN: f64 = 0.25;
/// The free part of each side, before and behind the paths.
const ROOM: f64 = 0.05;
/// Ticks of the longest side.
const TICKS: f64 = 5.0;
/// The distance of numbers and of the names of axes from the box, in pixels.
const NUMBER: f64 = 16.0;
const NAME: f64 = 40.0;
/// Half of a name up to which that distance is enough, in pixels.
const SHORT: f64 = 20.0;

/// A picture of paths in space in orthographic projection, with their shadows on the floor of a box. A length has the same
/// size along all three axes. The start of a path is a ring, and its end a dot.
///
/// ```
/// use lieflow_figures::{Axis, Path, Space};
/// let point = |t: f64| [t.cos(), t.sin(), 0.1 * t];
/// let helix = Space {
///     id: "path".into(),
///     title: "A helix".into(),
///     axes: ["x", "y", "z"].map(|name| Axis::linear(name).with_unit("m")),
///     paths: vec![Path { points: (0..200).map(|i| point(0.1 * f64::from(i))).collect(), ..Path::default() }],
///     caption: String::new(),
///     view: (35.0, 25.0),
/// };
/// assert!(helix.svg().starts_with("<svg"));
/// ```
#[derive(Clone, Debug)]
pub struct Space {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the picture.
    pub title: String,
    /// The names and the units of the axes.
    pub axes: [Axis; 3],
    /// The paths. Names are below the picture where there are several.
    pub paths: Vec<Path>,
    /// The text below the picture.
    pub caption: String,
    /// The direction of the viewer in degrees: the azimuth from the first axis toward the second, from 0 to 90, and the
    /// elevation, from 0 to 90.
    pub view: (f64, f64),
}

/// The box around the paths, as it is seen.
struct Frame {
    lo: Vec3,
    hi: Vec3,
    camera: Camera,
    scale: f64,
    /// The pixel of the origin.
    origin: (f64, f64),
}

impl Frame {
    /// The box around these points.
    fn around<'a>(points: impl Iterator<Item = &'a Vec3> + Clone, view: (f64, f64)) -> Self {
        let end = |i: usize, sign: f64| {
            let values = points.clone().map(move |p| sign * p[i]);
            sign * values.fold(f64::NEG_INFINITY, f64::max)
        };
        let ends: [[f64; 2]; 3] = std::array::from_fn(|i| [end(i, -1.0), end(i, 1.0)]);
        let ends = ends.map(|[lo, hi]| if lo <= hi { [lo, hi] } else { [0.0, 0.0] });
        let longest = ends.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
        // A path that stays where it is, to the digits of a number, has a box all the same.
        let size = ends.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
        let longest = match longest > 1e-12 * size {
            true => longest,
            false if size > 0.0 => size,
            false => 1.0,
        };
        let half = ends.map(|[lo, hi]| (0.5 + ROOM) * (hi - lo).max(THIN * longest));
        let middle = ends.map(|[lo, hi]| lo + 0.5 * (hi - lo));
        let lo: Vec3 = std::array::from_fn(|i| middle[i] - half[i]);
        let hi: Vec3 = std::array::from_fn(|i| middle[i] + half[i]);
        let camera = Camera::new(view.0, view.1);
        let corners = (0..8).map(|k| {
            let corner: Vec3 = std::array::from_fn(|i| if k >> i & 1 == 0 { lo[i] } else { hi[i] });
            camera.project(&corner)
        });
        let least = (f64::INFINITY, f64::INFINITY);
        let [first, last] = corners.fold([least, (-least.0, -least.1)], |[a, b], (x, y)| {
            [(a.0.min(x), a.1.min(y)), (b.0.max(x), b.1.max(y))]
        });
        let [from, to] = FRAME;
        let (wide, high) = (last.0 - first.0, last.1 - first.1);
        let scale = ((to.0 - from.0) / wide).min((to.1 - from.1) / high);
        let centre = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
        let origin = (
            centre.0 - scale * (first.0 + last.0) / 2.0,
            centre.1 + scale * (first.1 + last.1) / 2.0,
        );
        Frame { lo, hi, camera, scale, origin }
    }

    fn screen(&self, p: &Vec3) -> (f64, f64) {
        let (x, y) = self.camera.project(p);
        (self.origin.0 + self.scale * x, self.origin.1 - self.scale * y)
    }

    /// The ticks of an axis: where they are, and their numbers in the units of its map.
    fn ticks(&self, axis: usize, map: &Map) -> Vec<(f64, f64)> {
        let sides: Vec3 = std::array::from_fn(|i| self.hi[i] - self.lo[i]);
        // One step for all axes, so that the lines are squares, but for an axis that is short.
        let step = nice_step(sides.iter().copied().fold(0.0, f64::max) / TICKS);
        let step = if sides[axis] < 2.0 * step { nice_step(sides[axis] / 4.0) } else { step };
        let first = (self.lo[axis] / step).ceil();
        let count = (self.hi[axis] / step).floor() - first;
        let tick = |k: i64| {
            let value = (first + k as f64) * step;
            (value, ((value - map.offset) / step).round() * step / 10f64.powi(map.power))
        };
        (0..=count.clamp(-1.0, 50.0) as i64).map(tick).collect()
    }

    /// What the numbers of an axis leave out, as in a chart in the plane.
    fn map(&self, axis: usize, of: &Axis) -> Map {
        of.map([self.lo[axis], self.hi[axis]].into_iter(), (0.0, 1.0), 0.0)
    }

    /// The point of the box with one coordinate, and the others at the lower (`false`) or the upper end.
    fn at(&self, axis: usize, value: f64, upper: [bool; 3]) -> Vec3 {
        std::array::from_fn(|i| match i == axis {
            true => value,
            false if upper[i] => self.hi[i],
            false => self.lo[i],
        })
    }
}

/// The edge along which the numbers of each axis are: where its other coordinates are at their upper ends. The first two
/// are on the front edges of the floor. The third is on the left edge of the picture, with its name above it.
const EDGES: [[bool; 3]; 3] = [[false, true, false], [true, false, false], [true, false, false]];

impl Space {
    /// The picture as a complete `<svg>` element.
    pub fn svg(&self) -> String {
        let paths: Vec<Vec<Vec3>> = self.paths.iter().map(|path| finite(&path.points)).collect();
        let frame = Frame::around(paths.iter().flatten(), self.view);
        let named = if self.paths.len() > 1 { self.paths.len() } else { 0 };
        let id = slug(&self.id);
        let opening = Opening {
            class: "lf-space",
            id: &id,
            size: (WIDTH, HEIGHT + ROW * named as f64 + if named > 0 { 8.0 } else { 0.0 }),
            title: &self.title,
            description: &self.description(&frame),
            css: theme::space_css(),
            attributes: String::new(),
            defs: String::new(),
        };
        let mut out = opening.svg();
        out += &text("lf-title", (16.0, 24.0), "start", &self.title);
        self.draw_box(&mut out, &frame);
        let line = |points: &[Vec3]| {
            let points: Vec<_> = points.iter().map(|p| frame.screen(p)).collect();
            polyline(&points)
        };
        // Thinned to less than a pixel.
        let paths: Vec<_> = paths.iter().map(|path| thin_path(path, 0.3 / frame.scale)).collect();
        for path in &paths {
            let floor: Vec<Vec3> = path.iter().map(|p| [p[0], p[1], frame.lo[2]]).collect();
            out += &format!("<path class=\"lf-shadow\" d=\"{}\"/>", line(&floor));
        }
        for (k, (path, points)) in self.paths.iter().zip(&paths).enumerate() {
            let (Some(begin), Some(end)) = (points.first(), points.last()) else { continue };
            out += &format!(
                "<g class=\"lf-s {}\" data-line=\"{k}\"><path class=\"lf-path\" d=\"{}\"/>",
                path.as_series().classes(),
                line(points)
            );
            for (class, point) in [("lf-begin", begin), ("lf-end", end)] {
                let (x, y) = frame.screen(point);
                out += &format!(
                    "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"4\"/>",
                    px(x),
                    px(y)
                );
            }
            out += "</g>";
        }
        for (k, path) in self.paths.iter().enumerate().take(named) {
            let at = (24.0, HEIGHT + ROW * (k as f64 + 0.5));
            out += &labels::entry(&path.as_series(), k, at, None, WIDTH - 48.0);
        }
        out + "</svg>"
    }

    /// The floor and the two walls behind the paths, with lines at the ticks, and the numbers and names of the axes.
    fn draw_box(&self, out: &mut String, frame: &Frame) {
        let mut lines = String::new();
        let mut words = String::new();
        let centre = ((FRAME[0].0 + FRAME[1].0) / 2.0, (FRAME[0].1 + FRAME[1].1) / 2.0);
        for axis in 0..3 {
            let edge = |value: f64| frame.screen(&frame.at(axis, value, EDGES[axis]));
            let (from, to) = (edge(frame.lo[axis]), edge(frame.hi[axis]));
            // Away from the box, at a right angle to the edge.
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let length = dx.hypot(dy).max(1e-9);
            let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
            let outward = (middle.0 - centre.0) * -dy + (middle.1 - centre.1) * dx;
            let sign = if outward < 0.0 { -1.0 } else { 1.0 };
            let (ux, uy) = (-sign * dy / length, sign * dx / length);
            let anchor = match ux {
                ..-0.3 => "end",
                0.3.. => "start",
                _ => "middle",
            };
            let map = frame.map(axis, &self.axes[axis]);
            let mut widest: f64 = 0.0;
            for (value, number) in frame.ticks(axis, &map) {
                for other in (0..3).filter(|other| *other != axis) {
                    // On the wall or on the floor that this axis and the other one span.
                    let ends = [frame.lo[other], frame.hi[other]].map(|end| {
                        let mut point = frame.at(axis, value, [false; 3]);
                        point[other] = end;
                        frame.screen(&point)
                    });
                    lines += &polyline(&ends);
                }
                let number = short(number, 6);
                widest = widest.max(text_width(&number, 12.0));
                let (x, y) = edge(value);
                let at = (x + 0.55 * NUMBER * ux, y + NUMBER * uy.max(0.0) + 4.0);
                words += &text("lf-tick", at, anchor, &number);
            }
            let title = self.axes[axis].title_beside(&map);
            if axis == 2 {
                words += &text("lf-name", (to.0, to.1 - 14.0), "middle", &title);
                continue;
            }
            let away = match anchor {
                // Below the numbers, which are lower at one end of a long name.
                "middle" => {
                    let more = (text_width(&title, 12.0) / 2.0 - SHORT).max(0.0);
                    NAME + more * (ux / uy).abs()
                }
                _ => NAME.max(widest * ux.abs() + 14.0),
            };
            let at = (middle.0 + away * ux, middle.1 + away * uy + 4.0);
            words += &text("lf-name", at, anchor, &title);
        }
        let corner = |i: usize, j: usize| {
            let at = |upper: [bool; 2]| {
                let mut point = frame.lo;
                for (axis, is_upper) in [i, j].into_iter().zip(upper) {
                    point[axis] = if is_upper { frame.hi[axis] } else { frame.lo[axis] };
                }
                frame.screen(&point)
            };
            polyline(&[[false, false], [true, false], [true, true], [false, true]].map(at)) + "z"
        };
        let walls = corner(0, 1) + &corner(0, 2) + &corner(1, 2);
        *out += &format!(
            "<path class=\"lf-lines\" d=\"{lines}\"/><path class=\"lf-wall\" d=\"{walls}\"/>"
        );
        *out += &words;
    }

    fn description(&self, frame: &Frame) -> String {
        let ranges = self.axes.iter().enumerate().map(|(i, axis)| {
            let ends = [frame.lo[i], frame.hi[i]];
            let [lo, hi] = ends.map(|end| time_or(end, ends, |end| short(end, 4)));
            format!("{} from {lo} to {hi}", axis.title_with_unit())
        });
        format!(
            "Paths in space, seen from azimuth {}° and elevation {}°: {}. {}",
            self.view.0,
            self.view.1,
            ranges.collect::<Vec<_>>().join(", "),
            self.caption
        )
    }
}

/// The points that can be drawn.
fn finite(points: &[Vec3]) -> Vec<Vec3> {
    points.iter().copied().filter(|p| norm(p).is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(points: Vec<Vec3>) -> Space {
        Space {
            id: "s".into(),
            title: "Space".into(),
            axes: ["x & y", "y", "z"].map(Axis::linear),
            paths: vec![Path { name: "p".into(), colour: 0, points }],
            caption: String::new(),
            view: (35.0, 25.0),
        }
    }

    /// The circle of the end of the path, in pixels.
    fn end(svg: &str) -> (f64, f64) {
        let circle = svg.split("lf-end\" ").nth(1).unwrap();
        let number = |name: &str| {
            let rest = circle.split(&format!("{name}=\"")).nth(1).unwrap();
            rest.split('"').next().unwrap().parse::<f64>().unwrap()
        };
        (number("cx"), number("cy"))
    }

    /// The corners of the box are in the picture, one length is the same along each axis, and each has ticks.
    #[test]
    fn the_box_is_in_view_and_has_one_scale() {
        for far in [1e-3, 1.0, 1e6] {
            let points = [[0.0; 3], [far, 0.2 * far, 3.0 * far]];
            let frame = Frame::around(points.iter(), (35.0, 25.0));
            for corner in [frame.lo, frame.hi] {
                let (x, y) = frame.screen(&corner);
                assert!((0.0..WIDTH).contains(&x) && (0.0..HEIGHT).contains(&y), "{x} {y}");
            }
            assert!((frame.hi[1] - frame.lo[1]) >= THIN * 3.0 * far);
            // Unit lengths along the axes are those of the projection, times one scale.
            let lengths = [0, 1, 2].map(|axis| {
                let [from, to] = [0.0, 1e-3 * far].map(|x| {
                    frame.screen(&std::array::from_fn(|i| if i == axis { x } else { 0.0 }))
                });
                (to.0 - from.0).hypot(to.1 - from.1)
            });
            let squares: f64 = lengths.iter().map(|x| x * x).sum();
            assert!((squares / (2.0 * (1e-3 * far * frame.scale).powi(2)) - 1.0).abs() < 1e-6);
            for axis in 0..3 {
                let map = frame.map(axis, &Axis::linear("x"));
                let ticks: Vec<f64> = frame.ticks(axis, &map).into_iter().map(|t| t.0).collect();
                assert!((2..12).contains(&ticks.len()), "{axis}: {ticks:?}");
                let inside = |x: &f64| (frame.lo[axis]..=frame.hi[axis]).contains(x);
                assert!(ticks.iter().all(inside), "{axis}: {ticks:?}");
            }
        }
    }

    /// The third axis points up, and the second one to the right of the first.
    #[test]
    fn what_is_higher_is_drawn_higher() {
        let to = |p: Vec3| {
            // The same box for all.
            let box_of = [[-1.0; 3], [1.0; 3], [0.0; 3]];
            end(&space([&box_of[..], &[p]].concat()).svg())
        };
        let start = to([0.0; 3]);
        let up = to([0.0, 0.0, 1.0]);
        assert!(up.1 < start.1 - 20.0 && (up.0 - start.0).abs() < 0.2, "{start:?} {up:?}");
        let [first, second] = [to([1.0, 0.0, 0.0]), to([0.0, 1.0, 0.0])];
        assert!(first.0 < start.0 && second.0 > start.0 && first.1 > start.1 && second.1 > start.1);
    }

    /// Two numbers of an axis are never the same: what they share is beside its name.
    #[test]
    fn numbers_far_from_the_origin_leave_out_what_they_share() {
        let far = [[4_206_980.0, -3.0, 2e-9], [4_207_020.0, 17.0, 2e-9]];
        let svg = space(far.into()).svg();
        let of_tick = |rest: &str| rest.split(['>', '<']).nth(1).map(str::to_string);
        let mut axes = svg.split("class=\"lf-name\"");
        for _ in 0..3 {
            let ticks = axes.next().unwrap().split("class=\"lf-tick\"").skip(1);
            let numbers: Vec<String> = ticks.filter_map(of_tick).collect();
            assert!(numbers.len() > 1, "{numbers:?}");
            assert!(numbers.windows(2).all(|pair| pair[0] != pair[1]), "{numbers:?}");
        }
        assert!(svg.contains("x &amp; y − 4.207×10⁶<") && svg.contains(">y<"), "{svg}");
        assert!(svg.contains("x &amp; y from 4206978 to 4207022"), "{svg}");
    }

    #[test]
    fn pictures_are_numbers_only() {
        for points in [
            vec![],
            vec![[0.0; 3]],
            vec![[1e3, 2.0, 5.0]; 3],
            vec![[f64::NAN; 3], [0.0, f64::INFINITY, 1.0], [1.0, 2.0, 3.0]],
        ] {
            let svg = space(points).svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert!(svg.contains("x &amp; y"));
        }
    }
}
