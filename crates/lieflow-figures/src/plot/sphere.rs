//! Paths on a sphere, with an ellipsoid that they lie on, too.

use super::camera::{CENTRE, Camera, HEIGHT, Vec3, WIDTH, clip, dot, norm, split};
use super::labels::{self, ROW};
use super::scene::{Kind, Line, Scene};
use super::series::{Marker, Series};
use super::svg::{Opening, arrow_head, polyline, px, slug, text};
use super::theme::{self, SHADES};

/// The pixels from the centre to the edge of the view.
const HALF: f64 = 196.0;

/// A path of the momentum.
#[derive(Clone, Debug, Default)]
pub struct Path {
    /// The name below the picture.
    pub name: String,
    /// The index of the colour, as in [`Series::colour`].
    pub colour: usize,
    /// The momenta in the body frame, in the order of time. Where a picture has several paths, the end of each is a dot.
    pub points: Vec<[f64; 3]>,
}

/// A picture of the sphere |m| = `radius` in orthographic projection, with the parts of an ellipsoid outside of it and with
/// paths of m. A momentum of a free body keeps its length and its energy, and both are such surfaces.
///
/// A point is hidden if the ray from it to the viewer passes through the sphere or through the
/// ellipsoid. Hidden parts of paths and of axes are faint and dashed.
#[derive(Clone, Debug, Default)]
pub struct Sphere {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the picture.
    pub title: String,
    /// The radius.
    pub radius: f64,
    /// The semi-axes of the ellipsoid, if there is one.
    pub ellipsoid: Option<[f64; 3]>,
    /// The paths.
    pub paths: Vec<Path>,
    /// The text below the picture.
    pub caption: String,
    /// The direction of the viewer in degrees: the azimuth from e1 toward e2 and the elevation.
    pub view: (f64, f64),
}

impl Sphere {
    /// The picture as a complete `<svg>` element.
    pub fn svg(&self) -> String {
        let scene = Scene::new(self);
        let shared = self.shared(&scene);
        let camera = Camera::new(self.view.0, self.view.1);
        let scale = HALF / scene.extent;
        let height = HEIGHT + ROW * self.paths.len() as f64 + 8.0;
        let id = slug(&self.id);
        let opening = Opening {
            class: "lf-sphere",
            id: &id,
            size: (WIDTH, height),
            title: &self.title,
            description: &self.description(),
            css: theme::sphere_css(),
            attributes: String::new(),
            defs: format!("<defs>{}</defs>", definitions(&id)),
        };
        let mut out = opening.svg();
        out += &text("lf-title", (16.0, 24.0), "start", &self.title);
        let mask = if scene.cut { format!(" mask=\"url(#{id}-m)\"") } else { String::new() };
        out.push_str(&format!("<g{mask}>"));
        let fills = fills(&scene, &camera, scale);
        let (behind, before) = fills.split_at(SHADES);
        draw_fills(&mut out, behind, 0);
        out.push_str(&format!(
            "<circle class=\"lf-ball\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"url(#{id}-b)\"/>",
            CENTRE.0,
            CENTRE.1,
            px(scale)
        ));
        draw_fills(&mut out, before, SHADES);
        self.draw_lines(&mut out, (&scene, &shared), &camera, |kind| {
            kind != Kind::Path && kind != Kind::Axis
        });
        out.push_str("</g>");
        self.draw_lines(&mut out, (&scene, &shared), &camera, |kind| {
            kind == Kind::Path || kind == Kind::Axis
        });
        draw_arrows(&mut out, &scene, &camera, scale);
        for (i, end) in self.ends().iter().enumerate() {
            let (x, y) = screen(&camera, scale, end);
            let far = if scene.hides(end, &camera.toward) { " lf-far" } else { "" };
            out.push_str(&format!(
                "<g class=\"lf-s {}\" data-line=\"{i}\"><circle class=\"lf-end{far}\" data-end=\"{i}\" \
                 cx=\"{}\" cy=\"{}\" r=\"4\"/></g>",
                self.paths[i].as_series().classes(),
                px(x),
                px(y)
            ));
        }
        for (k, path) in self.paths.iter().enumerate() {
            let at = (24.0, HEIGHT + ROW * (k as f64 + 0.5));
            // Of a path on the curve of another one the dot alone has its colour.
            let marker = if shared[k] { Marker::Dot } else { Marker::None };
            let series = path.as_series().with_marker(marker);
            out.push_str(&labels::entry(&series, k, at, None, WIDTH - 48.0));
        }
        out.push_str("</svg>");
        out
    }

    /// The scene as JSON, from which a script can draw other views. Coordinates are in thousandths
    /// of the radius; the lines are in the order of the attributes `data-line-front` of the
    /// picture.
    pub fn json(&self) -> String {
        let scene = Scene::new(self);
        let point = |p: &Vec3| {
            let [x, y, z] = p.map(|x| (x * 1000.0).round() as i64);
            format!("[{x},{y},{z}]")
        };
        let list = |items: Vec<String>| format!("[{}]", items.join(","));
        let piece = |p: &Vec<Vec3>| list(p.iter().map(point).collect());
        let line = |l: &Line| list(l.pieces.iter().map(piece).collect());
        let semi = match scene.ellipsoid {
            Some(e) => list(e.semi.iter().map(|a| format!("{a:e}")).collect()),
            None => "null".to_string(),
        };
        format!(
            "{{\"view\":[{:e},{:e}],\"centre\":[{},{}],\"scale\":{:e},\"shades\":{SHADES},\
             \"semi\":{semi},\"tips\":{},\"ends\":{},\"lines\":{}}}",
            self.view.0,
            self.view.1,
            CENTRE.0,
            CENTRE.1,
            HALF / scene.extent,
            list(scene.tips.iter().map(|t| format!("{t:e}")).collect()),
            list(self.ends().iter().map(point).collect()),
            list(scene.lines.iter().map(line).collect())
        )
    }

    /// Where several paths end, in radii of the sphere: they may lie on one curve, and their ends tell them apart.
    fn ends(&self) -> Vec<Vec3> {
        let end = |path: &Path| {
            let mut points = path.points.iter().rev().map(|p| p.map(|x| x / self.radius));
            points.find(|p| norm(p).is_finite())
        };
        let ends: Option<Vec<Vec3>> = self.paths.iter().map(end).collect();
        ends.filter(|ends| ends.len() > 1).unwrap_or_default()
    }

    /// The paths that share a curve, where the dots at their ends tell them apart.
    fn shared(&self, scene: &Scene) -> Vec<bool> {
        match self.ends().is_empty() {
            true => vec![false; self.paths.len()],
            false => scene.share_a_curve(),
        }
    }

    /// The caption, and what is drawn of paths that share a curve.
    pub fn full_caption(&self) -> String {
        let is_shared = self.shared(&Scene::new(self)).contains(&true);
        let told = if is_shared {
            "Paths on one curve are drawn in one colour; the dot of each is where it ends."
        } else {
            ""
        };
        [self.caption.trim(), told].join(" ").trim().to_string()
    }

    fn description(&self) -> String {
        let names: Vec<&str> = self.paths.iter().map(|p| p.name.as_str()).collect();
        format!(
            "The sphere of momentum with its energy ellipsoid, seen from azimuth {}° and \
             elevation {}°. Paths: {}. {}",
            self.view.0,
            self.view.1,
            names.join(", "),
            self.full_caption()
        )
    }

    fn draw_lines(
        &self,
        out: &mut String,
        (scene, shared): (&Scene, &[bool]),
        camera: &Camera,
        which: fn(Kind) -> bool,
    ) {
        let mut paths = 0..self.paths.len();
        for (k, line) in scene.lines.iter().enumerate().filter(|(_, line)| which(line.kind)) {
            let (front, back) = visible_parts(line, scene, camera);
            let path = paths.next().filter(|_| line.kind == Kind::Path);
            if let Some(i) = path {
                let classes = match shared[i] {
                    true => "lf-ink".into(),
                    false => self.paths[i].as_series().classes(),
                };
                out.push_str(&format!("<g class=\"lf-s {classes}\" data-line=\"{i}\">"));
            }
            let class = line.kind.class();
            if line.kind.shows_hidden_parts() {
                out.push_str(&format!(
                    "<path class=\"{class} lf-back\" data-line-back=\"{k}\" d=\"{back}\"/>"
                ));
            }
            out.push_str(&format!(
                "<path class=\"{class}\" data-line-front=\"{k}\" d=\"{front}\"/>"
            ));
            if path.is_some() {
                out.push_str("</g>");
            }
        }
    }
}

impl Path {
    pub(crate) fn as_series(&self) -> Series {
        Series { name: self.name.clone(), colour: self.colour, ..Series::default() }
    }
}

/// The pixels of a point in radii of the sphere.
fn screen(camera: &Camera, scale: f64, p: &Vec3) -> (f64, f64) {
    let (x, y) = camera.project(p);
    (CENTRE.0 + scale * x, CENTRE.1 - scale * y)
}

/// The path data of the visible and of the hidden parts of `line`.
fn visible_parts(line: &Line, scene: &Scene, camera: &Camera) -> (String, String) {
    let (mut front, mut back) = (String::new(), String::new());
    let scale = HALF / scene.extent;
    let draw = |pieces: Vec<Vec<Vec3>>| -> String {
        let pixels = |piece: &Vec<Vec3>| -> Vec<(f64, f64)> {
            piece.iter().map(|p| screen(camera, scale, p)).collect()
        };
        pieces.iter().map(|piece| polyline(&pixels(piece))).collect()
    };
    for piece in &line.pieces {
        let (visible, hidden) = split(piece, |p| !scene.hides(p, &camera.toward));
        front.push_str(&draw(visible));
        back.push_str(&draw(hidden));
    }
    (front, back)
}

/// The path data of the ellipsoid: for each brightness the parts behind the plane of the sphere's
/// outline, then for each brightness those before it. The sphere is drawn between the two; a front
/// side of the ellipsoid outside of the sphere has no other surface before it.
fn fills(scene: &Scene, camera: &Camera, scale: f64) -> Vec<String> {
    let mut fills = vec![String::new(); 2 * SHADES];
    let Some(ellipsoid) = scene.ellipsoid else {
        return fills;
    };
    let lamp: Vec3 = std::array::from_fn(|i| {
        0.7 * camera.toward[i] - 0.4 * camera.right[i] + 0.59 * camera.up[i]
    });
    for polygon in ellipsoid.mesh_outside() {
        let facing = clip(&polygon, |p| dot(&ellipsoid.normal(p), &camera.toward) >= 0.0);
        let count = facing.len() as f64;
        if facing.len() < 3 {
            continue;
        }
        let sum = |i: usize| facing.iter().map(|p| p[i]).sum::<f64>();
        let middle: Vec3 = std::array::from_fn(|i| sum(i) / count);
        let shade = (scene.brightness(&middle, &lamp) * SHADES as f64) as usize;
        let layer = if dot(&middle, &camera.toward) < 0.0 { 0 } else { SHADES };
        let corners: Vec<(f64, f64)> = facing.iter().map(|p| screen(camera, scale, p)).collect();
        let fill = &mut fills[layer + shade.min(SHADES - 1)];
        fill.push_str(&polyline(&corners));
        fill.push('z');
    }
    fills
}

fn draw_fills(out: &mut String, fills: &[String], first: usize) {
    for (shade, d) in fills.iter().enumerate() {
        let index = first + shade;
        out.push_str(&format!("<path class=\"lf-e{shade}\" data-fill=\"{index}\" d=\"{d}\"/>"));
    }
}

/// The arrow heads and the names of the axes.
fn draw_arrows(out: &mut String, scene: &Scene, camera: &Camera, scale: f64) {
    for (i, length) in scene.tips.iter().enumerate() {
        let tip: Vec3 = std::array::from_fn(|j| if i == j { *length } else { 0.0 });
        let (x, y) = screen(camera, scale, &tip);
        let (dx, dy) = camera.project(&tip.map(|t| t / norm(&tip)));
        let far = if scene.hides(&tip, &camera.toward) { " lf-far" } else { "" };
        let size = dx.hypot(dy).max(0.2);
        let (ux, uy) = (dx / size, -dy / size);
        let tip = (x + 9.0 * dx, y - 9.0 * dy);
        out.push_str(&format!(
            "<path class=\"lf-head{far}\" data-head=\"{i}\" d=\"{}z\"/>\
             <text class=\"lf-name{far}\" data-name=\"{i}\" x=\"{}\" y=\"{}\">e<tspan \
             font-size=\".7em\" font-style=\"normal\" dy=\"4\">{}</tspan></text>",
            arrow_head(tip, (dx, dy)),
            px(tip.0 + 13.0 * ux),
            px(tip.1 + 13.0 * uy + 4.0),
            i + 1
        ));
    }
}

/// The shading of the sphere, and the mask under which a large ellipsoid fades at the edge.
fn definitions(id: &str) -> String {
    let edge = HALF + 14.0;
    let (x, y) = CENTRE;
    format!(
        "<radialGradient id=\"{id}-b\" cx=\".5\" cy=\".5\" r=\".5\" fx=\".34\" fy=\".28\">\
         <stop offset=\"0\" class=\"lf-b0\"/><stop offset=\".72\" class=\"lf-b1\"/>\
         <stop offset=\"1\" class=\"lf-b2\"/></radialGradient>\
         <radialGradient id=\"{id}-f\" gradientUnits=\"userSpaceOnUse\" cx=\"{x}\" cy=\"{y}\" \
         r=\"{edge}\"><stop offset=\".84\" stop-color=\"#fff\"/>\
         <stop offset=\"1\" stop-color=\"#000\"/></radialGradient>\
         <mask id=\"{id}-m\" maskUnits=\"userSpaceOnUse\" x=\"0\" y=\"0\" width=\"{WIDTH}\" \
         height=\"{HEIGHT}\"><rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"url(#{id}-f)\"/>\
         </mask>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The semi-axes of Σ mᵢ²/(2Jᵢ) = E with J = (1, 2, 3).
    fn energy(e: f64) -> Option<[f64; 3]> {
        Some([1.0, 2.0, 3.0].map(|j: f64| (2.0 * j * e).sqrt()))
    }

    fn sphere(points: Vec<Vec3>) -> Sphere {
        Sphere {
            id: "s".into(),
            title: "Sphere".into(),
            radius: 2.0,
            ellipsoid: energy(1.0),
            paths: vec![Path { name: "p & q".into(), colour: 0, points }],
            caption: String::new(),
            view: (0.0, 0.0),
        }
    }

    /// The number of lines drawn by the visible and by the hidden part of the path.
    fn parts(sphere: &Sphere) -> (usize, usize) {
        let scene = Scene::new(sphere);
        let camera = Camera::new(sphere.view.0, sphere.view.1);
        let path = scene.lines.iter().find(|l| l.kind == Kind::Path);
        let (front, back) = path.map(|l| visible_parts(l, &scene, &camera)).unwrap_or_default();
        (front.matches('M').count(), back.matches('M').count())
    }

    fn equator() -> Vec<Vec3> {
        (0..=360)
            .map(|d| f64::from(d).to_radians())
            .map(|t| [2.0 * t.cos(), 2.0 * t.sin(), 0.0])
            .collect()
    }

    #[test]
    fn half_of_the_equator_is_hidden() {
        // Begins on the front side: front, back, front.
        let round = Sphere { ellipsoid: energy(1e-3), ..sphere(equator()) };
        assert_eq!(parts(&round), (2, 1));
        assert_eq!(parts(&Sphere { view: (0.0, 90.0), ..round }), (1, 0));
    }

    /// Of two paths on one circle neither has its colour on it; the legend shows the dots.
    #[test]
    fn paths_on_one_curve_are_told_by_their_ends() {
        let later: Vec<Vec3> = equator().into_iter().skip(90).collect();
        let path = |name: &str, colour, points| Path { name: name.into(), colour, points };
        let two = |second: Vec<Vec3>| Sphere {
            paths: vec![path("a", 0, equator()), path("b", 1, second)],
            ..sphere(Vec::new())
        };
        let one_curve = two(later.clone());
        let svg = one_curve.svg();
        assert_eq!(svg.matches("<g class=\"lf-s lf-ink\"").count(), 2);
        assert_eq!(svg.matches("lf-end").count() - svg.matches(".lf-end").count(), 2);
        assert!(!svg.contains("class=\"lf-key-line\"") && svg.contains("class=\"lf-m\""));
        // A file has no style of other figures.
        assert!(svg.contains(".lf-m{fill:currentColor"));
        assert!(one_curve.full_caption().contains("one colour"));
        let apart = two(later.iter().map(|p| [p[2], p[0], p[1]]).collect());
        let svg = apart.svg();
        assert!(!svg.contains("\"lf-s lf-ink\"") && apart.full_caption().is_empty());
        assert_eq!(svg.matches("class=\"lf-key-line\"").count(), 2);
    }

    #[test]
    fn a_large_ellipsoid_hides_all() {
        assert_eq!(parts(&Sphere { ellipsoid: energy(1e3), ..sphere(equator()) }), (0, 1));
    }

    #[test]
    fn pictures_are_numbers_only() {
        let nan = vec![[f64::NAN; 3], [0.0, 0.0, 2.0]];
        let good = sphere(nan);
        let flat = Sphere { radius: 0.0, ..good.clone() };
        let odd = Sphere { ellipsoid: Some([f64::NAN, 0.0, 1.0]), ..good.clone() };
        for s in [good, flat, odd] {
            for text in [s.svg(), s.json()] {
                assert!(!text.contains("NaN") && !text.contains("inf"));
            }
            assert!(s.svg().contains("p &amp; q"));
        }
    }
}
