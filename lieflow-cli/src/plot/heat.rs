//! A field on a sphere: its values on a grid of latitudes and longitudes, flat and as a globe.

use super::svg::{escape, px, slug, text};
use super::theme;

/// The size of the flat picture, and the place of the globe.
const WIDTH: f64 = 576.0;
const HEIGHT: f64 = 288.0;
const LEFT: f64 = 16.0;
const TOP: f64 = 42.0;
const RADIUS: f64 = 0.5 * HEIGHT;
const GLOBE: (f64, f64) = (LEFT + WIDTH + 24.0 + RADIUS, TOP + RADIUS);

/// Cells along the diameter of the globe.
const CELLS: usize = 80;
/// Colours from the lowest to the highest value; odd, so that 0 has one.
const LEVELS: usize = 17;

/// A field on a sphere, equirectangular and orthographic.
#[derive(Clone, Debug)]
pub struct Heat {
    /// An identifier that is unique within the page.
    pub id: String,
    /// The title above the picture.
    pub title: String,
    /// The values: rows from north to south, columns from west to east.
    pub values: Vec<Vec<f64>>,
    /// The text below the picture.
    pub caption: String,
}

impl Heat {
    /// The picture as a complete `<svg>` element.
    pub fn svg(&self) -> String {
        let (width, height) = (GLOBE.0 + RADIUS + 16.0, TOP + HEIGHT + 30.0);
        let largest = self.largest();
        let id = slug(&self.id);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lf lf-heat\" id=\"{id}\" \
             viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
             aria-labelledby=\"{id}-t {id}-d\"><title id=\"{id}-t\">{}</title>\
             <desc id=\"{id}-d\">A field on a sphere from {:.3e} to {largest:.3e}, flat and as a \
             globe. {}</desc><style>{}</style>\
             <rect class=\"lf-paper\" width=\"{width}\" height=\"{height}\"/>",
            escape(&self.title),
            -largest,
            escape(&self.caption),
            theme::chart_css()
        );
        out.push_str(&text("lf-title", (LEFT, 24.0), "start", &self.title));
        let (rows, cols) = (self.values.len(), self.values.first().map_or(0, Vec::len));
        let cell = (WIDTH / cols.max(1) as f64, HEIGHT / rows.max(1) as f64);
        let level = |i: usize, j: usize| self.level(largest, i, j);
        out.push_str(&fills((LEFT, TOP), cell, rows, cols, level));
        let side = 2.0 * RADIUS / CELLS as f64;
        let corner = (GLOBE.0 - RADIUS, GLOBE.1 - RADIUS);
        let seen = |i: usize, j: usize| {
            let at = |k: usize| (k as f64 + 0.5) / (0.5 * CELLS as f64) - 1.0;
            let (x, z) = (at(j), -at(i));
            let y2 = 1.0 - x * x - z * z;
            if y2 < 0.0 || rows == 0 || cols == 0 {
                return None;
            }
            let longitude = x.atan2(y2.sqrt()) / core::f64::consts::TAU + 0.5;
            let latitude = 0.5 - z.asin() / core::f64::consts::PI;
            let row = ((latitude * rows as f64) as usize).min(rows - 1);
            level(row, ((longitude * cols as f64) as usize).min(cols - 1))
        };
        out.push_str(&fills(corner, (side, side), CELLS, CELLS, seen));
        out.push_str(&format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{RADIUS}\" fill=\"none\" class=\"lf-frame\"/>",
            GLOBE.0, GLOBE.1
        ));
        let range = format!("blue {:.3} to red {largest:.3}; white is 0", -largest);
        out.push_str(&text("lf-tick", (LEFT, TOP + HEIGHT + 20.0), "start", &range));
        out.push_str("</svg>");
        out
    }

    /// The largest magnitude.
    fn largest(&self) -> f64 {
        let values = self.values.iter().flatten().filter(|x| x.is_finite());
        values.fold(0.0, |a: f64, x| a.max(x.abs()))
    }

    /// The colour of a cell; none for what is not a number.
    fn level(&self, largest: f64, i: usize, j: usize) -> Option<usize> {
        let x = *self.values.get(i)?.get(j)?;
        let part = if largest > 0.0 { x / largest } else { 0.0 };
        let top = (LEVELS - 1) as f64;
        part.is_finite().then(|| (0.5 * (part + 1.0) * top).round() as usize)
    }
}

/// Runs of cells of one colour along each row, a path for each colour.
fn fills(
    (left, top): (f64, f64),
    (width, height): (f64, f64),
    rows: usize,
    cols: usize,
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
                // A little over the edge, so that no seam shows.
                path.push_str(&format!(
                    "M{} {}h{}v{}h-{}z",
                    px(left + start as f64 * width),
                    px(top + i as f64 * height),
                    px((j - start) as f64 * width + 0.2),
                    px(height + 0.2),
                    px((j - start) as f64 * width + 0.2),
                ));
            }
        }
    }
    let drawn = paths.iter().enumerate().filter(|(_, path)| !path.is_empty());
    drawn.map(|(k, d)| format!("<path fill=\"{}\" d=\"{d}\"/>", colour(k))).collect()
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

    fn heat(values: Vec<Vec<f64>>) -> String {
        Heat { id: "h".into(), title: "a & b".into(), values, caption: String::new() }.svg()
    }

    #[test]
    fn values_have_their_colours() {
        let svg = heat(vec![vec![-1.0, 0.0, 1.0]; 2]);
        for level in [0, LEVELS / 2, LEVELS - 1] {
            assert!(svg.contains(&colour(level)), "{svg}");
        }
        assert_eq!(colour(LEVELS / 2), "#f7f7f7");
        assert!(svg.contains("a &amp; b") && svg.ends_with("</svg>"));
    }

    #[test]
    fn fields_of_nothing_are_pictures_too() {
        for values in [vec![], vec![vec![]], vec![vec![f64::NAN; 4]; 2], vec![vec![0.0; 4]; 2]] {
            let svg = heat(values);
            assert!(!svg.contains("NaN") && svg.ends_with("</svg>"));
        }
    }
}
