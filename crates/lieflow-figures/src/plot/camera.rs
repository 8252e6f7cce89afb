//! Vectors, the orthographic projection and the cutting of lines and polygons.

/// The size of a picture of space in pixels, without the names of its paths.
pub(super) const WIDTH: f64 = 520.0;
pub(super) const HEIGHT: f64 = 458.0;
/// The pixel of a body, or of a sphere, in its middle.
pub(super) const CENTRE: (f64, f64) = (260.0, 248.0);

/// A vector in space.
pub(crate) type Vec3 = [f64; 3];

pub(crate) fn dot(a: &Vec3, b: &Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: &Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The point at the fraction `t` of the way from `a` to `b`.
fn between(a: &Vec3, b: &Vec3, t: f64) -> Vec3 {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

/// An orthographic view of the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    /// The unit vector from the origin to the viewer.
    pub(crate) toward: Vec3,
}

impl Camera {
    /// The view from the direction at `azimuth` degrees from e1 toward e2 and `elevation` degrees
    /// above the plane of both.
    pub(crate) fn new(azimuth: f64, elevation: f64) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (se, ce) = elevation.to_radians().sin_cos();
        Camera {
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            toward: [ce * ca, ce * sa, se],
        }
    }

    /// The coordinates to the right and upward.
    pub(crate) fn project(&self, p: &Vec3) -> (f64, f64) {
        (dot(p, &self.right), dot(p, &self.up))
    }
}

/// The pieces of `line` where `inside` holds and those where it does not.
pub(crate) fn split(
    line: &[Vec3],
    inside: impl Fn(&Vec3) -> bool,
) -> (Vec<Vec<Vec3>>, Vec<Vec<Vec3>>) {
    let mut pieces: [Vec<Vec<Vec3>>; 2] = [Vec::new(), Vec::new()];
    let mut piece: Vec<Vec3> = Vec::new();
    let mut state = line.first().is_some_and(&inside);
    for p in line {
        let next = inside(p);
        if let Some(last) = piece.last().filter(|_| next != state) {
            let cut = crossing(last, p, &inside);
            piece.push(cut);
            pieces[usize::from(!state)].push(std::mem::replace(&mut piece, vec![cut]));
        }
        state = next;
        piece.push(*p);
    }
    if piece.len() > 1 {
        pieces[usize::from(!state)].push(piece);
    }
    let [within, without] = pieces;
    (within, without)
}

/// Where `inside` changes between `a` and `b`, by bisection.
fn crossing(a: &Vec3, b: &Vec3, inside: impl Fn(&Vec3) -> bool) -> Vec3 {
    let start = inside(a);
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..12 {
        let middle = 0.5 * (lo + hi);
        if inside(&between(a, b, middle)) == start { lo = middle } else { hi = middle }
    }
    between(a, b, hi)
}

/// The part of a convex polygon where `inside` holds, if every edge is cut at most once.
pub(crate) fn clip(polygon: &[Vec3], inside: impl Fn(&Vec3) -> bool) -> Vec<Vec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, b) in polygon.iter().enumerate() {
        let a = &polygon[(i + polygon.len() - 1) % polygon.len()];
        if inside(a) != inside(b) {
            kept.push(crossing(a, b, &inside));
        }
        if inside(b) {
            kept.push(*b);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_a_right_handed_frame() {
        let c = Camera::new(30.0, 20.0);
        for v in [c.right, c.up, c.toward] {
            assert!((norm(&v) - 1.0).abs() < 1e-12);
        }
        assert!(dot(&c.right, &c.up).abs() < 1e-12 && dot(&c.up, &c.toward).abs() < 1e-12);
        let above = Camera::new(-90.0, 90.0);
        let (x, y) = above.project(&[1.0, 2.0, 3.0]);
        assert!((x - 1.0).abs() < 1e-12 && (y - 2.0).abs() < 1e-12);
    }

    #[test]
    fn lines_are_cut_where_the_condition_changes() {
        let line = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let (within, without) = split(&line, |p| p[0] > 0.5);
        assert_eq!((within.len(), without.len()), (1, 1));
        assert!((within[0][0][0] - 0.5).abs() < 1e-3 && within[0].len() == 3);
        assert!(split(&[], |_| true).0.is_empty());
    }

    #[test]
    fn polygons_are_clipped() {
        let square = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let half = clip(&square, |p| p[0] >= 1.0);
        assert_eq!(half.len(), 4);
        assert!(half.iter().all(|p| p[0] > 1.0 - 1e-3));
        assert!(clip(&square, |_| false).is_empty());
    }
}
