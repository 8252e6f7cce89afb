//! Ellipsoids about the origin with their axes along e1, e2, e3.

use super::camera::{Vec3, clip};

/// The depth, as a fraction of the sphere's radius, that a line may lie below a surface and still
/// count as on it. Drawn lines are chords and lie slightly below the surface.
const TOLERANCE: f64 = 0.02;

/// The ellipsoid of all x with Σ (xᵢ/aᵢ)² = 1 for the semi-axes a, measured in radii of the sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipsoid {
    pub(crate) semi: Vec3,
}

/// The unit sphere.
pub(crate) const SPHERE: Ellipsoid = Ellipsoid { semi: [1.0; 3] };

impl Ellipsoid {
    /// The outward normal (with a length other than one) of the level surface through `p`.
    pub(crate) fn normal(&self, p: &Vec3) -> Vec3 {
        std::array::from_fn(|i| p[i] / self.semi[i].powi(2))
    }

    /// Σ aᵢ⁻² pᵢ qᵢ: one for p = q on the surface, less inside, more outside.
    fn form(&self, p: &Vec3, q: &Vec3) -> f64 {
        (0..3).map(|i| p[i] * q[i] / self.semi[i].powi(2)).sum()
    }

    /// Whether `p` is outside.
    pub(crate) fn excludes(&self, p: &Vec3) -> bool {
        self.form(p, p) > 1.0
    }

    /// Whether the ray from `p` to a viewer in the direction `toward` passes through the inside.
    pub(crate) fn hides(&self, p: &Vec3, toward: &Vec3) -> bool {
        // The ray p + s·toward leaves the ellipsoid at the larger root of a s² + 2 b s + c = 0.
        let a = self.form(toward, toward);
        let b = self.form(p, toward);
        let c = self.form(p, p) - 1.0;
        let discriminant = b * b - a * c;
        discriminant > 0.0 && discriminant.sqrt() - b > TOLERANCE * a
    }

    /// The point at an angle `latitude` from the plane of e1 and e2, both in radians.
    pub(crate) fn point(&self, latitude: f64, longitude: f64) -> Vec3 {
        let (s, c) = latitude.sin_cos();
        let (sl, cl) = longitude.sin_cos();
        [self.semi[0] * c * cl, self.semi[1] * c * sl, self.semi[2] * s]
    }

    /// Meridians and parallels every `step` degrees.
    pub(crate) fn graticule(&self, step: usize) -> Vec<Vec<Vec3>> {
        let angle = |degrees: usize| (degrees as f64).to_radians();
        let meridian = |longitude: usize| {
            let point = |d| self.point(angle(d) - angle(90), angle(longitude));
            (0..=180).step_by(5).map(point).collect()
        };
        let parallel = |colatitude: usize| {
            let point = |d| self.point(angle(colatitude) - angle(90), angle(d));
            (0..=360).step_by(5).map(point).collect()
        };
        let meridians = (0..360).step_by(step).map(meridian);
        meridians.chain((step..180).step_by(step).map(parallel)).collect()
    }

    /// The curves of intersection with the unit sphere.
    pub(crate) fn polhodes(&self) -> Vec<Vec<Vec3>> {
        let w = self.semi.map(|a| a.powi(-2));
        let mut curves = Vec::new();
        for k in 0..3 {
            // Without x_k the two equations leave an ellipse x_i²/p + x_j²/q = 1.
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let p = (1.0 - w[k]) / (w[i] - w[k]);
            let q = (1.0 - w[k]) / (w[j] - w[k]);
            if !(p > 0.0 && q > 0.0 && p <= 1.0 && q <= 1.0) {
                continue;
            }
            for side in [1.0, -1.0] {
                let point = |degrees: usize| {
                    let (s, c) = (degrees as f64).to_radians().sin_cos();
                    let mut x = [0.0; 3];
                    x[i] = p.sqrt() * c;
                    x[j] = q.sqrt() * s;
                    x[k] = side * (1.0 - x[i] * x[i] - x[j] * x[j]).max(0.0).sqrt();
                    x
                };
                curves.push((0..=360).step_by(4).map(point).collect());
            }
        }
        curves
    }

    /// Small polygons that cover the part of the surface outside of the unit sphere.
    pub(crate) fn mesh_outside(&self) -> Vec<Vec<Vec3>> {
        // Cut in the plane of the angles, so that all corners are on the surface.
        let place = |angles: &Vec3| self.point(angles[0], angles[1]);
        let step = 5f64.to_radians();
        let mut polygons = Vec::new();
        for i in -18..18 {
            for j in 0..72 {
                let corner = |di, dj| [f64::from(i + di) * step, f64::from(j + dj) * step, 0.0];
                let quad = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)];
                let outside = clip(&quad, |angles| SPHERE.excludes(&place(angles)));
                if outside.len() > 2 {
                    polygons.push(outside.iter().map(place).collect());
                }
            }
        }
        polygons
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera::norm;
    use super::*;

    #[test]
    fn a_sphere_hides_what_is_behind_and_inside() {
        let viewer = [1.0, 0.0, 0.0];
        assert!(!SPHERE.hides(&[1.0, 0.0, 0.0], &viewer));
        assert!(SPHERE.hides(&[-1.0, 0.0, 0.0], &viewer));
        assert!(SPHERE.hides(&[0.0, 0.0, 0.0], &viewer));
        assert!(SPHERE.hides(&[-5.0, 0.0, 0.5], &viewer));
        assert!(!SPHERE.hides(&[-5.0, 0.0, 1.5], &viewer));
        assert!(!SPHERE.hides(&[0.8, 0.6, 0.0], &viewer));
        assert!(SPHERE.hides(&[-0.8, 0.6, 0.0], &viewer));
    }

    #[test]
    fn an_ellipsoid_hides_a_front_point_of_the_sphere_inside() {
        let long = Ellipsoid { semi: [2.0, 0.9, 0.9] };
        let viewer = [1.0, 0.0, 0.0];
        assert!(long.hides(&[1.0, 0.0, 0.0], &viewer));
        assert!(!long.hides(&[0.0, 1.0, 0.0], &viewer));
        assert!(!long.hides(&[0.0, 0.0, 1.0], &[0.0, 0.0, 1.0]));
    }

    #[test]
    fn polhodes_lie_on_both_surfaces() {
        for semi in [[0.58, 0.82, 1.004], [3.3, 1.66, 0.78], [1.2, 1.0 + 1e-3, 0.9]] {
            let e = Ellipsoid { semi };
            let curves = e.polhodes();
            assert_eq!(curves.len(), 2);
            for p in curves.iter().flatten() {
                assert!((norm(p) - 1.0).abs() < 1e-12 && (e.form(p, p) - 1.0).abs() < 1e-12);
            }
        }
        assert!(Ellipsoid { semi: [2.0; 3] }.polhodes().is_empty());
        assert!(Ellipsoid { semi: [0.5, 0.6, 0.7] }.polhodes().is_empty());
    }

    #[test]
    fn the_mesh_is_outside_of_the_sphere() {
        let e = Ellipsoid { semi: [3.3, 1.66, 0.78] };
        assert!(e.mesh_outside().iter().flatten().all(|p| norm(p) > 0.9999));
        assert!(Ellipsoid { semi: [0.5; 3] }.mesh_outside().is_empty());
    }
}
