//! A field on a surface: its values on a grid, on a sphere flat and as a globe.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::scale::Axis;
use super::svg::{Opening, escape, px, slug, text};
use super::theme;

/// Where the flat picture begins, and its height.
const LEFT: f64 = 16.0;
const TOP: f64 = 42.0;
const HEIGHT: f64 = 384.0;
/// The globe beside the flat picture of a sphere, which is twice as wide as high.
const RADIUS: f64 = 0.5 * HEIGHT;
const GLOBE: (f64, f64) = (LEFT + 2.0 * HEIGHT + 24.0 + RADIUS, TOP + RADIUS);
/// The bar of colours below the picture.
const BAR: f64 = TOP + HEIGHT + 14.0;
const THICK: f64 = 10.0;

/// Pixels along the height of a picture, whatever the grid is.
const PIXELS: usize = 256;
/// Colours from the lowest to the highest value; odd, so that 0 has one.
const LEVELS: usize = 129;

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
        let height = BAR + THICK + if self.ground == Ground::Sphere { 44.0 } else { 26.0 };
        let largest = self.largest();
        let id = slug(&self.id);
        let range = format!("from {:.3e} to {largest:.3e}", -largest);
        let stops = (0..LEVELS).step_by(LEVELS / 8).map(|level| {
            let [r, g, b] = colour(level);
            let at = level as f64 / (LEVELS - 1) as f64;
            format!("<stop offset=\"{at:.3}\" stop-color=\"#{r:02x}{g:02x}{b:02x}\"/>")
        });
        let stops: String = stops.collect();
        let opening = Opening {
            class: "lf-heat",
            id: &id,
            size: (width, height),
            title: &self.title,
            description: &format!("A field on {what}, {range}. {}", self.caption),
            css: theme::chart_css(),
            attributes: String::new(),
            defs: format!("<defs><linearGradient id=\"{id}-c\">{stops}</linearGradient></defs>"),
        };
        let mut out = opening.svg();
        out.push_str(&text("lf-title", (LEFT, 24.0), "start", &self.title));
        let wide = if self.ground == Ground::Sphere { 2 * PIXELS } else { PIXELS };
        let flat_level = |i: usize, j: usize| {
            let at = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
            self.level(largest, at(i, PIXELS), at(j, wide))
        };
        out.push_str(&image((LEFT, TOP), (flat, HEIGHT), (PIXELS, wide), flat_level));
        if self.ground == Ground::Sphere {
            let east = self.strongest();
            out.push_str(&self.globe(largest, east));
            let longitude = 360.0 * east - 180.0;
            let side = if longitude < 0.0 { 'W' } else { 'E' };
            let seen = format!("The globe is seen from above {:.0}° {side}.", longitude.abs());
            out.push_str(&below(LEFT, 2.6, "start", &seen));
        }
        out.push_str(&format!(
            "<rect class=\"lf-frame\" x=\"{LEFT}\" y=\"{BAR}\" width=\"{flat}\" height=\"{THICK}\" \
             style=\"fill:url(#{id}-c)\"/>"
        ));
        let bar = Axis::linear("").map([-largest, largest].into_iter(), (LEFT, LEFT + flat), 0.0);
        for tick in bar.ticks(0.2 * flat) {
            let at = tick.at.clamp(LEFT + 8.0, LEFT + flat - 8.0);
            out.push_str(&below(at, 1.2, "middle", &tick.label.unwrap_or_default()));
        }
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

    /// The colour at a part of the height and of the width; none for what is not a number.
    fn level(&self, largest: f64, down: f64, across: f64) -> Option<u8> {
        let rows = self.values.len() as i64;
        let cols = self.values.first().map_or(0, Vec::len) as i64;
        if rows == 0 || cols == 0 {
            return None;
        }
        let (i, wi) = around(down, rows);
        let (j, wj) = around(across, cols);
        let mut x = 0.0;
        for (k, a) in wi.iter().enumerate() {
            let row = i + k as i64;
            // A sphere ends at its poles, a torus begins again.
            let row = match self.ground {
                Ground::Sphere => row.clamp(0, rows - 1),
                Ground::Torus => row.rem_euclid(rows),
            };
            for (l, b) in wj.iter().enumerate() {
                let column = (j + l as i64).rem_euclid(cols);
                x += a * b * self.values[row as usize].get(column as usize).unwrap_or(&f64::NAN);
            }
        }
        let part = if largest > 0.0 { (x / largest).clamp(-1.0, 1.0) } else { x };
        let top = (LEVELS - 1) as f64;
        part.is_finite().then(|| (0.5 * (part + 1.0) * top).round() as u8)
    }

    /// The sphere as it is seen from far above the equator at a longitude, a part of the width.
    fn globe(&self, largest: f64, east: f64) -> String {
        let seen = |i: usize, j: usize| {
            let at = |k: usize| (k as f64 + 0.5) / (0.5 * PIXELS as f64) - 1.0;
            let (x, z) = (at(j), -at(i));
            let y2 = 1.0 - x * x - z * z;
            if y2 < 0.0 {
                return None;
            }
            let longitude = (x.atan2(y2.sqrt()) / core::f64::consts::TAU + east).rem_euclid(1.0);
            self.level(largest, 0.5 - z.asin() / core::f64::consts::PI, longitude)
        };
        let corner = (GLOBE.0 - RADIUS, GLOBE.1 - RADIUS);
        let globe = image(corner, (2.0 * RADIUS, 2.0 * RADIUS), (PIXELS, PIXELS), seen);
        let (x, y) = GLOBE;
        format!(
            "{globe}<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" fill=\"none\" class=\"lf-frame\"/>"
        )
    }
}

/// A text below the bar, `lines` of its own lines down: on a narrow page it is larger than the picture.
fn below(x: f64, lines: f64, anchor: &str, content: &str) -> String {
    let (x, y, content) = (px(x), BAR + THICK, escape(content));
    format!(
        "<text class=\"lf-tick\" x=\"{x}\" y=\"{y}\" dy=\"{lines}em\" text-anchor=\"{anchor}\">{content}</text>"
    )
}

/// The first of the four cells around a part of `count` cells, and their weights (Catmull and Rom).
fn around(part: f64, count: i64) -> (i64, [f64; 4]) {
    let at = part * count as f64 - 0.5;
    let (first, t) = (at.floor() as i64 - 1, at - at.floor());
    let weights = [
        -0.5 * t * (1.0 - t).powi(2),
        1.0 + t * t * (1.5 * t - 2.5),
        0.5 * t + t * t * (2.0 - 1.5 * t),
        -0.5 * t * t * (1.0 - t),
    ];
    (first, weights)
}

/// An image of colours; where there is none it is transparent.
fn image(
    (left, top): (f64, f64),
    (width, height): (f64, f64),
    (rows, cols): (usize, usize),
    level: impl Fn(usize, usize) -> Option<u8>,
) -> String {
    // The colour after the last is that of nothing.
    const NOTHING: u8 = LEVELS as u8;
    let pixels = (0..rows * cols).map(|k| level(k / cols, k % cols).unwrap_or(NOTHING));
    let pixels: Vec<u8> = pixels.collect();
    let mut palette: Vec<u8> = (0..LEVELS).flat_map(colour).collect();
    palette.extend([255; 3]);
    let mut opacity = vec![255; LEVELS];
    opacity.push(0);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, cols as u32, rows as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette);
    encoder.set_trns(opacity);
    encoder.set_compression(png::Compression::High);
    // Writing into memory does not fail; a picture that could not be made is left out.
    let written = encoder.write_header().and_then(|mut image| image.write_image_data(&pixels));
    if written.is_err() {
        return String::new();
    }
    format!(
        "<image x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\" \
         preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>",
        px(left),
        px(top),
        STANDARD.encode(&file)
    )
}

/// From blue over white to red.
fn colour(level: usize) -> [u8; 3] {
    let x = 2.0 * level as f64 / (LEVELS - 1) as f64 - 1.0;
    let end = if x < 0.0 { [33.0, 102.0, 172.0] } else { [178.0, 24.0, 43.0] };
    end.map(|c: f64| (247.0 + (c - 247.0) * x.abs()).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heat(ground: Ground, values: Vec<Vec<f64>>) -> Heat {
        let (id, title, caption) = ("h".into(), "a & b".into(), String::new());
        Heat { id, title, ground, values, caption }
    }

    #[test]
    fn values_have_their_colours() {
        assert_eq!(colour(LEVELS / 2), [247; 3]);
        let values = vec![vec![-1.0, 0.0, 1.0]; 2];
        for ground in [Ground::Sphere, Ground::Torus] {
            let heat = heat(ground, values.clone());
            let middle = |cell: f64| heat.level(1.0, 0.5, (cell + 0.5) / 3.0).map(usize::from);
            assert_eq!([0.0, 1.0, 2.0].map(middle), [0, LEVELS / 2, LEVELS - 1].map(Some));
            // Between two cells, and across the edge.
            let edge = heat.level(1.0, 0.5, 0.0);
            assert_eq!(edge, heat.level(1.0, 0.5, 1.0));
            let svg = heat.svg();
            let images = if ground == Ground::Sphere { 2 } else { 1 };
            assert_eq!(svg.matches("data:image/png;base64,iVBORw0KGgo").count(), images);
            assert!(svg.contains(">−1.0</text>") && svg.contains(">0</text>"), "{svg}");
        }
    }

    /// The file can be read, and has the colours of its pixels.
    #[test]
    fn an_image_reads_back() {
        let svg = image((0.0, 0.0), (2.0, 1.0), (1, 2), |_, j| (j == 1).then_some(7));
        let data = svg.split("base64,").nth(1).and_then(|s| s.split('"').next()).unwrap();
        let file = STANDARD.decode(data).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; 2];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, [LEVELS as u8, 7]);
    }

    /// A field that is positive in the east alone is seen from there: the middle of the globe is red.
    #[test]
    fn the_globe_shows_where_the_field_is() {
        let east = vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0];
        let heat = heat(Ground::Sphere, vec![east; 4]);
        assert!(heat.svg().contains("above 105° E"));
        assert_eq!(heat.level(1.0, 0.5, heat.strongest()).map(usize::from), Some(LEVELS - 1));
    }

    #[test]
    fn fields_of_nothing_are_pictures_too() {
        for values in [vec![], vec![vec![]], vec![vec![f64::NAN; 4]; 2], vec![vec![0.0; 4]; 2]] {
            let svg = heat(Ground::Sphere, values).svg();
            assert!(!svg.contains("NaN") && svg.ends_with("</svg>"));
            assert!(svg.contains("a &amp; b"));
        }
    }
}
