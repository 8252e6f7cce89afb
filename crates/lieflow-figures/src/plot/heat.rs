//! A field on a surface: its values on a grid, on a sphere flat and as a globe.

use super::svg::{Opening, px, slug, text};
use super::theme;

/// Where the flat picture begins, and its height.
const LEFT: f64 = 16.0;
const TOP: f64 = 42.0;
const HEIGHT: f64 = 288.0;
/// The globe beside the flat picture of a sphere, which is twice as wide as high.
const RADIUS: f64 = 0.5 * HEIGHT;
const GLOBE: (f64, f64) = (LEFT + 2.0 * HEIGHT + 24.0 + RADIUS, TOP + RADIUS);

/// Cells along the diameter of the globe.
const CELLS: usize = 64;
/// Colours from the lowest to the highest value; odd, so that 0 has one.
const LEVELS: usize = 17;

/// What a field lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A sphere: rows from north to south, columns from west to east.
    Sphere,
    /// A square torus: rows from the largest y to the least, columns from the least x.
    Torus,
}

/// A field on a surface: of a sphere equirectangular and orthographic, of a torus one period.
#[derive(Clone, Debug)]
pub struct Heat {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the picture.
    pub title: String,
    /// The surface.
    pub ground: Ground,
    /// The values, in rows.
    pub values: Vec<Vec<f64>>,
    /// The text below the picture.
    pub caption: String,
}

impl Heat {
    /// The picture as a complete `<svg>` element.
    pub fn svg(&self) -> String {
        let (what, flat, width) = match self.ground {
            Ground::Sphere => {
                ("a sphere, flat and as a globe", 2.0 * HEIGHT, GLOBE.0 + RADIUS + 16.0)
            }
            Ground::Torus => ("a torus", HEIGHT, LEFT + HEIGHT + 16.0),
        };
        let height = TOP + HEIGHT + 30.0;
        let largest = self.largest();
        let id = slug(&self.id);
        let range = format!("from {:.3e} to {largest:.3e}", -largest);
        let opening = Opening {
            class: "lf-heat",
            id: &id,
            size: (width, height),
            title: &self.title,
            description: &format!("A field on {what}, {range}. {}", self.caption),
            css: theme::chart_css(),
            attributes: String::new(),
            defs: String::new(),
        };
        let mut out = opening.svg();
        out.push_str(&text("lf-title", (LEFT, 24.0), "start", &self.title));
        let (rows, cols) = (self.values.len(), self.values.first().map_or(0, Vec::len));
        let level = |i: usize, j: usize| self.level(largest, i, j);
        out.push_str(&fills((LEFT, TOP), (flat, HEIGHT), (rows, cols), level));
        let mut range = format!("blue {:.3} to red {largest:.3}; white is 0", -largest);
        if self.ground == Ground::Sphere {
            let east = self.strongest();
            out.push_str(&globe(rows, cols, east, level));
            let longitude = 360.0 * east - 180.0;
            let side = if longitude < 0.0 { 'W' } else { 'E' };
            range.push_str(&format!("; the globe is seen above {:.0}° {side}", longitude.abs()));
        }
        out.push_str(&text("lf-tick", (LEFT, TOP + HEIGHT + 20.0), "start", &range));
        out.push_str("</svg>");
        out
    }

    /// The largest magnitude.
    fn largest(&self) -> f64 {
        let values = self.values.iter().flatten().filter(|x| x.is_finite());
        values.fold(0.0, |a: f64, x| a.max(x.abs()))
    }

    /// The longitude, as a part of the width, where most of the field is: with its neighbours, so that the
    /// middle of a patch wins.
    fn strongest(&self) -> f64 {
        let cols = self.values.first().map_or(0, Vec::len);
        let sum = |j: usize| -> f64 {
            let column = self.values.iter().filter_map(|row| row.get(j % cols));
            column.filter(|x| x.is_finite()).map(|x| x * x).sum()
        };
        let around = |j: &usize| sum(j + cols - 1) + sum(*j) + sum(j + 1);
        let column = (0..cols).max_by(|a, b| around(a).total_cmp(&around(b)));
        column.map_or(0.5, |j| (j as f64 + 0.5) / cols as f64)
    }

    /// The colour of a cell; none for what is not a number.
    fn level(&self, largest: f64, i: usize, j: usize) -> Option<usize> {
        let x = *self.values.get(i)?.get(j)?;
        let part = if largest > 0.0 { x / largest } else { 0.0 };
        let top = (LEVELS - 1) as f64;
        part.is_finite().then(|| (0.5 * (part + 1.0) * top).round() as usize)
    }
}

/// The sphere as it is seen from far above the equator at a longitude, a part of the width.
fn globe(
    rows: usize,
    cols: usize,
    east: f64,
    level: impl Fn(usize, usize) -> Option<usize>,
) -> String {
    let seen = |i: usize, j: usize| {
        let at = |k: usize| (k as f64 + 0.5) / (0.5 * CELLS as f64) - 1.0;
        let (x, z) = (at(j), -at(i));
        let y2 = 1.0 - x * x - z * z;
        if y2 < 0.0 || rows == 0 || cols == 0 {
            return None;
        }
        let longitude = (x.atan2(y2.sqrt()) / core::f64::consts::TAU + east).rem_euclid(1.0);
        let latitude = 0.5 - z.asin() / core::f64::consts::PI;
        let row = ((latitude * rows as f64) as usize).min(rows - 1);
        level(row, ((longitude * cols as f64) as usize).min(cols - 1))
    };
    let corner = (GLOBE.0 - RADIUS, GLOBE.1 - RADIUS);
    let cells = fills(corner, (2.0 * RADIUS, 2.0 * RADIUS), (CELLS, CELLS), seen);
    let (x, y) = GLOBE;
    format!(
        "{cells}<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" fill=\"none\" class=\"lf-frame\"/>"
    )
}

/// Runs of cells of one colour along each row, a path for each colour: in cells, so that every number is
/// a small one.
fn fills(
    (left, top): (f64, f64),
    (width, height): (f64, f64),
    (rows, cols): (usize, usize),
    level: impl Fn(usize, usize) -> Option<usize>,
) -> String {
    let mut paths = vec![String::new(); LEVELS];
    for i in 0..rows {
        let mut j = 0;
        while j < cols {
            let (start, here) = (j, level(i, j));
            while j < cols && level(i, j) == here {
                j += 1;
            }
            if let Some(path) = here.and_then(|k| paths.get_mut(k)) {
                path.push_str(&format!("M{start} {i}h{}v1h-{}z", j - start, j - start));
            }
        }
    }
    let drawn = paths.iter().enumerate().filter(|(_, path)| !path.is_empty());
    let drawn: String =
        drawn.map(|(k, d)| format!("<path fill=\"{}\" d=\"{d}\"/>", colour(k))).collect();
    let cell = [width / cols.max(1) as f64, height / rows.max(1) as f64];
    format!(
        "<g shape-rendering=\"crispEdges\" transform=\"translate({} {}) scale({} {})\">{drawn}</g>",
        px(left),
        px(top),
        cell[0],
        cell[1]
    )
}

/// From blue over white to red.
fn colour(level: usize) -> String {
    let x = 2.0 * level as f64 / (LEVELS - 1) as f64 - 1.0;
    let end = if x < 0.0 { [33.0, 102.0, 172.0] } else { [178.0, 24.0, 43.0] };
    let [r, g, b] = end.map(|c: f64| (247.0 + (c - 247.0) * x.abs()).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heat(ground: Ground, values: Vec<Vec<f64>>) -> String {
        let (id, title, caption) = ("h".into(), "a & b".into(), String::new());
        Heat { id, title, ground, values, caption }.svg()
    }

    #[test]
    fn values_have_their_colours() {
        for ground in [Ground::Sphere, Ground::Torus] {
            let svg = heat(ground, vec![vec![-1.0, 0.0, 1.0]; 2]);
            for level in [0, LEVELS / 2, LEVELS - 1] {
                assert!(svg.contains(&colour(level)), "{svg}");
            }
            assert_eq!(svg.contains("<circle"), ground == Ground::Sphere);
        }
        assert_eq!(colour(LEVELS / 2), "#f7f7f7");
    }

    /// A field that is positive in the east alone is seen from there: the globe is red.
    #[test]
    fn the_globe_shows_where_the_field_is() {
        let east = vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0];
        let svg = heat(Ground::Sphere, vec![east; 4]);
        assert!(svg.contains("above 105° E"), "{svg}");
        let globe = svg.rsplit("<g ").next().unwrap_or_default();
        let middle = format!("fill=\"{}\" d=\"", colour(LEVELS - 1));
        assert!(globe.contains(&middle), "{globe}");
    }

    #[test]
    fn fields_of_nothing_are_pictures_too() {
        for values in [vec![], vec![vec![]], vec![vec![f64::NAN; 4]; 2], vec![vec![0.0; 4]; 2]] {
            let svg = heat(Ground::Sphere, values);
            assert!(!svg.contains("NaN") && svg.ends_with("</svg>"));
            assert!(svg.contains("a &amp; b"));
        }
    }
}
