//! A body that turns: a box at the attitudes of a motion, and the way of one of its axes in space.

use super::camera::{CENTRE, Camera, HEIGHT, Vec3, WIDTH, dot, norm};
use super::svg::{Opening, arrow_head, polyline, px, slug, text};
use super::theme;
use super::thin::thin_path;

/// The pixels of half the diagonal of the box.
const SCALE: f64 = 158.0;

/// The length of the axes of space, and how far their names are, in halves of the diagonal.
const AXIS: f64 = 1.18;
const NAME: f64 = 1.32;

/// The attitude of a body at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The time.
    pub t: f64,
    /// The rotation from the body to space as a unit quaternion, w first.
    pub quaternion: [f64; 4],
}

/// A picture of a body that turns. On a page a reader plays it, moves to any time, and turns the view.
///
/// ```
/// use lieflow_figures::{Body, Pose};
/// let turned = |t: f64| Pose { t, quaternion: [(0.5 * t).cos(), 0.0, 0.0, (0.5 * t).sin()] };
/// let body = Body {
///     id: "body".into(),
///     title: "A box that turns about its third axis".into(),
///     sides: [3.0, 2.0, 1.0],
///     axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
///     poses: (0..60).map(|i| turned(0.1 * f64::from(i))).collect(),
///     caption: String::new(),
///     view: (35.0, 25.0),
/// };
/// assert!(body.svg().starts_with("<svg"));
/// ```
#[derive(Clone, Debug)]
pub struct Body {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the picture.
    pub title: String,
    /// The sides of the box, in any unit.
    pub sides: [f64; 3],
    /// The directions of the sides in the body.
    pub axes: [[f64; 3]; 3],
    /// The motion, in the order of time.
    pub poses: Vec<Pose>,
    /// The text below the picture.
    pub caption: String,
    /// The direction of the viewer in degrees: the azimuth from e1 toward e2 and the elevation.
    pub view: (f64, f64),
}

impl Body {
    /// The picture at the start as a complete `<svg>` element.
    pub fn svg(&self) -> String {
        let camera = Camera::new(self.view.0, self.view.1);
        let screen = |p: &Vec3| {
            let (x, y) = camera.project(p);
            (CENTRE.0 + SCALE * x, CENTRE.1 - SCALE * y)
        };
        let id = slug(&self.id);
        let opening = Opening {
            class: "lf-body",
            id: &id,
            size: (WIDTH, HEIGHT),
            title: &self.title,
            description: &format!("A box at the attitude of the start. {}", self.caption),
            css: theme::body_css(),
            attributes: String::new(),
            defs: String::new(),
        };
        let mut out = opening.svg();
        out += &text("lf-title", (16.0, 24.0), "start", &self.title);
        let tip = |i: usize, length: f64| -> Vec3 {
            core::array::from_fn(|j| if i == j { length } else { 0.0 })
        };
        let edges = self.edges();
        let first = self.seen().next().map_or([1.0, 0.0, 0.0, 0.0], |pose| pose.quaternion);
        let edges = edges.map(|edge| rotated(&first, &edge));
        let arrow = |i: usize, from: f64| {
            let (x, y) = screen(&tip(i, AXIS));
            let (dx, dy) = camera.project(&tip(i, 1.0));
            arrow_head((x, y), (dx, dy)) + &polyline(&[screen(&tip(i, from)), (x, y)])
        };
        for i in 0..3 {
            out += &format!("<path class=\"lf-axis\" data-axis=\"{i}\" d=\"{}\"/>", arrow(i, 0.0));
        }
        let way: Vec<Vec3> = self.seen().map(|pose| self.tip(pose)).collect();
        let way: Vec<_> = thin_path(&way, 2e-3).iter().map(screen).collect();
        out += &format!("<path class=\"lf-way lf-c1\" data-way=\"\" d=\"{}\"/>", polyline(&way));
        for face in 0..6 {
            let (axis, sign) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
            let (a, b, c) = (edges[axis], edges[(axis + 1) % 3], edges[(axis + 2) % 3]);
            let corner = |u: f64, v: f64| -> Vec3 {
                core::array::from_fn(|i| sign * a[i] + u * b[i] + v * c[i])
            };
            let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
            let seen = sign * dot(&a, &camera.toward) > 0.0;
            let d = match seen {
                true => polyline(&corners.map(|(u, v)| screen(&corner(u, v)))) + "z",
                false => String::new(),
            };
            out += &format!("<path class=\"lf-face lf-c{axis}\" data-face=\"{face}\" d=\"{d}\"/>");
        }
        // The part of an axis that leaves the box toward the viewer lies before the box.
        for i in 0..3 {
            let front = leaves(&edges, i, &camera.toward).map_or(String::new(), |at| arrow(i, at));
            for class in ["lf-halo", "lf-axis"] {
                out += &format!("<path class=\"{class}\" data-front=\"{i}\" d=\"{front}\"/>");
            }
        }
        for i in 0..3 {
            let (x, y) = screen(&tip(i, NAME));
            out += &format!(
                "<text class=\"lf-name\" data-name=\"{i}\" x=\"{}\" y=\"{}\">e<tspan \
                 font-size=\".7em\" font-style=\"normal\" dy=\"4\">{}</tspan></text>",
                px(x),
                px(y + 4.0),
                i + 1
            );
        }
        out.push_str("</svg>");
        out
    }

    /// The motion as JSON, from which a script plays it. Times count from the start, also for a run backward in time.
    /// Quaternions are in ten thousandths.
    pub fn json(&self) -> String {
        let list = |items: &mut dyn Iterator<Item = String>| {
            format!("[{}]", items.collect::<Vec<_>>().join(","))
        };
        let edges = self.edges();
        let edges =
            list(&mut edges.iter().map(|edge| list(&mut edge.iter().map(|x| format!("{:.4}", x)))));
        let (start, end) = (self.seen().next(), self.seen().last());
        let [start, end] = [start, end].map(|pose| pose.map_or(0.0, |pose| pose.t));
        let since = |pose: &Pose| format!("{:.6e}", (pose.t - start).abs());
        let times = list(&mut self.seen().map(since));
        let turns = self.seen().flat_map(|pose| pose.quaternion);
        let turns = list(&mut turns.map(|x| format!("{:.0}", 1e4 * x)));
        format!(
            "{{\"view\":[{:e},{:e}],\"centre\":[{},{}],\"scale\":{SCALE},\"axis\":{AXIS},\
             \"name\":{NAME},\"edges\":{edges},\"way\":{},\"span\":[{start:e},{end:e}],\"t\":{times},\"q\":{turns}}}",
            self.view.0,
            self.view.1,
            CENTRE.0,
            CENTRE.1,
            self.longest()
        )
    }

    /// The poses that can be drawn.
    fn seen(&self) -> impl Iterator<Item = &Pose> {
        let finite =
            |pose: &&Pose| pose.t.is_finite() && pose.quaternion.iter().all(|x| x.is_finite());
        self.poses.iter().filter(finite)
    }

    /// Half of each edge as a vector in the body; half the diagonal is 1.
    fn edges(&self) -> [Vec3; 3] {
        let diagonal = norm(&self.sides);
        let half = |i: usize| if diagonal > 0.0 { self.sides[i] / diagonal } else { 0.0 };
        core::array::from_fn(|i| self.axes[i].map(|x| half(i) * x))
    }

    /// The longest side, whose axis leaves a way.
    fn longest(&self) -> usize {
        (0..3).max_by(|a, b| self.sides[*a].total_cmp(&self.sides[*b])).unwrap_or(0)
    }

    /// Where the axis of the longest side is.
    fn tip(&self, pose: &Pose) -> Vec3 {
        rotated(&pose.quaternion, &self.axes[self.longest()])
    }
}

/// Where the axis of space `i` leaves a box with these halves of edges, if that is on a face toward the viewer.
fn leaves(edges: &[Vec3; 3], i: usize, toward: &Vec3) -> Option<f64> {
    let at = |edge: &Vec3| dot(edge, edge) / edge[i].abs();
    let face = edges.iter().min_by(|a, b| at(a).total_cmp(&at(b)))?;
    (face[i] * dot(face, toward) > 0.0).then(|| at(face))
}

/// q v q*.
fn rotated([w, x, y, z]: &[f64; 4], v: &Vec3) -> Vec3 {
    let cross = |a: &Vec3, b: &Vec3| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [*x, *y, *z];
    let once = cross(&u, v);
    let twice = cross(&u, &once);
    core::array::from_fn(|i| v[i] + 2.0 * (w * once[i] + twice[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(poses: Vec<Pose>) -> Body {
        Body {
            id: "b".into(),
            title: "a & b".into(),
            sides: [3.0, 2.0, 1.0],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            poses,
            caption: String::new(),
            view: (35.0, 25.0),
        }
    }

    #[test]
    fn a_turn_moves_the_axis() {
        let quarter = core::f64::consts::FRAC_1_SQRT_2;
        let turned = rotated(&[quarter, 0.0, 0.0, quarter], &[1.0, 0.0, 0.0]);
        assert!((turned[1] - 1.0).abs() < 1e-12 && turned[0].abs() < 1e-12);
    }

    /// From outside three faces of a box are seen.
    #[test]
    fn three_faces_are_seen() {
        let svg = body(vec![Pose { t: 0.0, quaternion: [1.0, 0.0, 0.0, 0.0] }]).svg();
        assert_eq!(svg.matches("z\"/>").count(), 3, "{svg}");
        assert_eq!(svg.matches("data-face").count(), 6);
        assert!(svg.contains("a &amp; b"));
    }

    /// Seen from e₁, that axis lies before the box, and the other two do not leave it toward the viewer.
    #[test]
    fn an_axis_toward_the_viewer_lies_before_the_box() {
        let edges = [[0.2, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.8]];
        let at = |i, toward| leaves(&edges, i, &toward).map(|at| (10.0 * at).round());
        let from_e1 = |i| at(i, [1.0, 0.0, 0.0]);
        assert_eq!([0, 1, 2].map(from_e1), [Some(2.0), None, None]);
        let aside = |i| at(i, [0.6, -0.6, 0.5]);
        assert_eq!([0, 1, 2].map(aside), [Some(2.0), None, Some(8.0)]);
    }

    #[test]
    fn motions_of_nothing_are_pictures_too() {
        let odd = Pose { t: 0.0, quaternion: [f64::NAN; 4] };
        for poses in [vec![], vec![odd]] {
            let body = Body { sides: [f64::NAN; 3], ..body(poses) };
            assert!(!body.json().contains("NaN") && body.svg().ends_with("</svg>"));
        }
    }
}
