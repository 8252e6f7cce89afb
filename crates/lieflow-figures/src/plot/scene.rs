//! The objects around a momentum sphere, before they are projected. Lengths are in radii of the
//! sphere.

use super::camera::{Vec3, dot, norm, split};
use super::ellipsoid::{Ellipsoid, SPHERE};
use super::sphere::Sphere;
use super::thin::{distance_to_segment, thin_path};

/// What a line shows, which decides about its style and its hidden parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Meridians and parallels of the sphere.
    Graticule,
    /// Meridians and parallels of the ellipsoid.
    Wire,
    /// The curves of intersection of both.
    Polhode,
    /// A path of the momentum.
    Path,
    /// A coordinate axis.
    Axis,
}

impl Kind {
    /// The class of the style sheet.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Kind::Graticule => "lf-graticule",
            Kind::Wire => "lf-wire",
            Kind::Polhode => "lf-polhode",
            Kind::Path => "lf-path",
            Kind::Axis => "lf-axis",
        }
    }

    /// Whether hidden parts are drawn faintly instead of not at all.
    pub(crate) fn shows_hidden_parts(self) -> bool {
        !matches!(self, Kind::Graticule | Kind::Wire)
    }
}

/// A set of polylines of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) kind: Kind,
    pub(crate) pieces: Vec<Vec<Vec3>>,
}

/// Everything that is drawn.
pub(crate) struct Scene {
    pub(crate) ellipsoid: Option<Ellipsoid>,
    /// The lines; the paths are in the order of [`Sphere::paths`].
    pub(crate) lines: Vec<Line>,
    /// Where the arrows of the axes end.
    pub(crate) tips: [f64; 3],
    /// The half width of the part of space that is in view.
    pub(crate) extent: f64,
    /// Whether the ellipsoid continues outside of the view.
    pub(crate) cut: bool,
}

/// The largest part of the ellipsoid that is shown, so that the sphere does not become small.
const LARGEST: f64 = 1.75;

/// The length of the arrows outside of the surfaces.
const ARROW: f64 = 0.26;

impl Scene {
    pub(crate) fn new(sphere: &Sphere) -> Self {
        let ellipsoid = ellipsoid_of(sphere);
        let semi = ellipsoid.map_or([1.0; 3], |e| e.semi);
        let longest = semi.iter().copied().fold(1.0, f64::max);
        let reach = longest.min(LARGEST);
        let tips = semi.map(|a| a.max(1.0).min(reach) + ARROW);
        let mut lines = vec![];
        let outside = |pieces: Vec<Vec<Vec3>>, surface: &Ellipsoid| -> Vec<Vec<Vec3>> {
            pieces.iter().flat_map(|line| split(line, |p| surface.excludes(p)).0).collect()
        };
        let graticule = SPHERE.graticule(30);
        let graticule = ellipsoid.map_or(graticule.clone(), |e| outside(graticule, &e));
        lines.push(Line { kind: Kind::Graticule, pieces: graticule });
        if let Some(e) = ellipsoid {
            lines.push(Line { kind: Kind::Wire, pieces: outside(e.graticule(15), &SPHERE) });
            lines.push(Line { kind: Kind::Polhode, pieces: e.polhodes() });
        }
        for path in &sphere.paths {
            lines.push(Line { kind: Kind::Path, pieces: unit_path(sphere, &path.points) });
        }
        for (i, tip) in tips.iter().enumerate() {
            let at = |length: f64| std::array::from_fn(|j| if i == j { length } else { 0.0 });
            let shaft = vec![at(semi[i].max(1.0).min(reach)), at(*tip)];
            lines.push(Line { kind: Kind::Axis, pieces: vec![shaft] });
        }
        Scene { ellipsoid, lines, tips, extent: reach + ARROW, cut: longest > LARGEST }
    }

    /// Whether a surface is between `p` and the viewer.
    pub(crate) fn hides(&self, p: &Vec3, toward: &Vec3) -> bool {
        SPHERE.hides(p, toward) || self.ellipsoid.is_some_and(|e| e.hides(p, toward))
    }

    /// For each path: does it share its curve with another one? Then most of its points lie on the other one, and of two
    /// colours one is not seen there.
    pub(crate) fn share_a_curve(&self) -> Vec<bool> {
        let paths = self.lines.iter().filter(|line| line.kind == Kind::Path);
        let paths: Vec<&[Vec<Vec3>]> = paths.map(|line| &line.pieces[..]).collect();
        let is_on = |p: &Vec3, path: &[Vec<Vec3>]| {
            let mut segments = path.iter().flat_map(|piece| piece.windows(2));
            segments.any(|ab| distance_to_segment(p, &ab[0], &ab[1]) < SAME_CURVE)
        };
        let shares = |i: usize, j: usize| {
            let all = sampled(paths[i]);
            2 * all.iter().filter(|p| is_on(p, paths[j])).count() > all.len()
        };
        let mut shared = vec![false; paths.len()];
        for (i, j) in (0..paths.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
            if !(shared[i] && shared[j]) && (shares(i, j) || shares(j, i)) {
                (shared[i], shared[j]) = (true, true);
            }
        }
        shared
    }

    /// The brightness, 0 to 1, of the ellipsoid at `p` in light from `lamp`.
    pub(crate) fn brightness(&self, p: &Vec3, lamp: &Vec3) -> f64 {
        let normal = self.ellipsoid.unwrap_or(SPHERE).normal(p);
        (0.5 + 0.5 * dot(&normal, lamp) / norm(&normal)).clamp(0.0, 1.0)
    }
}

/// The ellipsoid, unless the numbers do not describe one.
fn ellipsoid_of(sphere: &Sphere) -> Option<Ellipsoid> {
    let semi = sphere.ellipsoid?.map(|a| a / sphere.radius);
    semi.iter().all(|a| a.is_finite() && *a > 1e-6).then_some(Ellipsoid { semi })
}

/// Two points are not joined if they are farther apart than this, in radians from the centre. The path between them is
/// unknown.
const FAR: f64 = 0.25;
/// Two points that are farther apart than this are joined only if the path is smooth at both.
const NEAR: f64 = 0.1;
/// The cosine of the largest turn of a smooth path from one chord to the next. A chord is not drawn if the path turns more
/// at both of its ends: the points are too few to show the path.
const TURN: f64 = 0.5;
/// A path of fewer chords is not drawn as a line: a motion may turn many times between so few rows.
const FEW: usize = 8;

/// Paths that are nearer to each other are one curve to the eye: two pixels.
const SAME_CURVE: f64 = 0.01;
/// Points of a path that are compared with another one.
const COMPARED: usize = 64;

/// About [`COMPARED`] points of a path, at equal distances along each of its pieces.
fn sampled(path: &[Vec<Vec3>]) -> Vec<Vec3> {
    let every = path.len().div_ceil(COMPARED).max(1);
    let count = COMPARED.div_ceil(path.len().max(1));
    path.iter().step_by(every).flat_map(|piece| along(piece, count)).collect()
}

/// So many points at equal distances along a piece; the piece itself where it has no length.
fn along(piece: &[Vec3], count: usize) -> Vec<Vec3> {
    let ends = piece.windows(2).scan(0.0, |length, ab| {
        *length += distance_to_segment(&ab[0], &ab[1], &ab[1]);
        Some(*length)
    });
    let ends: Vec<f64> = ends.collect();
    let whole = ends.last().copied().unwrap_or(0.0);
    let at = |k: usize| {
        let along = whole * (k as f64 + 0.5) / count as f64;
        let i = ends.partition_point(|end| *end < along).min(ends.len() - 1);
        let from = if i == 0 { 0.0 } else { ends[i - 1] };
        let part = (along - from) / (ends[i] - from).max(f64::MIN_POSITIVE);
        std::array::from_fn(|axis| piece[i][axis] + part * (piece[i + 1][axis] - piece[i][axis]))
    };
    if ends.is_empty() { piece.to_vec() } else { (0..count).map(at).collect() }
}

/// A path in radii of the sphere, thinned to less than a pixel, without chords between points that do not show the path. A
/// point alone is there twice, and so is a dot.
fn unit_path(sphere: &Sphere, points: &[Vec3]) -> Vec<Vec<Vec3>> {
    let scaled = points.iter().map(|p| p.map(|x| x / sphere.radius));
    let finite: Vec<Vec3> = scaled.filter(|p| norm(p).is_finite()).collect();
    let is_within = |a: &Vec3, b: &Vec3, far: f64| dot(a, b) >= far.cos() * norm(a) * norm(b);
    let chords: Vec<Vec3> =
        finite.windows(2).map(|ab| std::array::from_fn(|i| ab[1][i] - ab[0][i])).collect();
    let goes_on = |a: &Vec3, b: &Vec3| dot(a, b) >= TURN * norm(a) * norm(b);
    let is_shown = |i: usize| {
        let before = i.checked_sub(1).map(|before| goes_on(&chords[before], &chords[i]));
        let after = chords.get(i + 1).map(|after| goes_on(&chords[i], after));
        let [a, b] = [&finite[i], &finite[i + 1]];
        match chords.len() {
            ..FEW => false,
            _ if is_within(a, b, NEAR) => before == Some(true) || after == Some(true),
            _ => is_within(a, b, FAR) && before != Some(false) && after != Some(false),
        }
    };
    let is_joined: Vec<bool> = (0..chords.len()).map(is_shown).collect();
    let piece = |piece: &[Vec3]| match piece {
        [only] => vec![*only; 2],
        several => thin_path(several, 2e-3),
    };
    let mut places = 0..finite.len();
    let joined = |_: &Vec3, _: &Vec3| places.next().is_some_and(|i| is_joined[i]);
    finite.chunk_by(joined).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sphere::Path;
    use super::*;

    /// Arcs of one circle share it where most of the one lies on the other; circles that cross do not.
    #[test]
    fn paths_on_one_curve_are_known() {
        let arc = |height: f64, from: f64, to: f64| {
            let radius = (1.0 - height * height).sqrt();
            let point = |i: usize| {
                let angle = from + (to - from) * i as f64 / 200.0;
                [radius * angle.cos(), radius * angle.sin(), height]
            };
            Path { points: (0..=200).map(point).collect(), ..Path::default() }
        };
        let upright = Path {
            points: arc(0.0, 0.0, 6.0).points.iter().map(|p| [p[1], p[2], p[0]]).collect(),
            ..Path::default()
        };
        let shared = |paths: Vec<Path>| {
            Scene::new(&Sphere { radius: 1.0, paths, ..Sphere::default() }).share_a_curve()
        };
        let arcs =
            vec![arc(0.3, 0.0, 5.0), upright.clone(), arc(0.3, 0.8, 5.8), arc(0.35, 0.0, 5.0)];
        assert_eq!(shared(arcs), [true, false, true, false]);
        // A short one on a long one is not seen, whichever is first.
        assert_eq!(shared(vec![arc(0.3, 1.0, 1.5), arc(0.3, 0.0, 6.0)]), [true, true]);
        assert_eq!(shared(vec![arc(0.3, 0.0, 6.0), arc(0.3, 1.0, 1.5)]), [true, true]);
        assert_eq!(shared(vec![arc(0.3, 0.0, 3.0), arc(0.3, 2.5, 5.5)]), [false, false]);
        assert_eq!(shared(vec![upright, Path::default()]), [false, false]);
    }

    #[test]
    fn points_that_are_far_apart_are_not_joined() {
        let sphere = Sphere { radius: 2.0, ..Sphere::default() };
        let at = |angle: f64| [2.0 * angle.cos(), 2.0 * angle.sin(), 0.0];
        let path = |angles: &[f64]| -> Vec<usize> {
            let points: Vec<Vec3> = angles.iter().map(|angle| at(*angle)).collect();
            unit_path(&sphere, &points).iter().map(Vec::len).collect()
        };
        let steps = |first: f64, count: usize| (0..count).map(move |i| first + 0.2 * i as f64);
        assert_eq!(path(&steps(0.0, 12).collect::<Vec<_>>()), [12]);
        assert_eq!(path(&steps(0.0, 5).chain(steps(1.1, 6)).collect::<Vec<_>>()), [5, 6]);
        // So few tell nothing of the way between them.
        assert_eq!(path(&[0.0, 0.2, 0.4]), [2, 2, 2]);
        assert_eq!(path(&[0.0, 0.2]), [2, 2]);
        assert_eq!(path(&[]), [0; 0]);
        // A small circle about a pole, passed in steps of 2.5 radians.
        let about_pole = |radius: f64, step: f64| -> Vec<usize> {
            let point = |i: usize| {
                let (s, c) = (step * i as f64).sin_cos();
                [radius * c, radius * s, 1.99]
            };
            let points: Vec<Vec3> = (0..40).map(point).collect();
            unit_path(&sphere, &points).iter().map(Vec::len).collect()
        };
        for radius in [0.2, 0.06] {
            assert_eq!(about_pole(radius, 2.5), [2; 40]);
            assert_eq!(about_pole(radius, 0.3).len(), 1);
        }
    }
}
