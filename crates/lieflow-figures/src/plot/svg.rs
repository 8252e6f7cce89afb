//! Small pieces of SVG text: escaping, coordinates, path data.

/// `text` with the five special characters of HTML and XML replaced by entities. Control
/// characters, which XML forbids, become spaces.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            '\u{fffe}' | '\u{ffff}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// The start of a picture: its size, its title and description for readers who do not see it, and its
/// paper. What follows is the drawing and `</svg>`.
pub(crate) struct Opening<'a> {
    /// The class of its kind, after `lf `.
    pub(crate) class: &'a str,
    pub(crate) id: &'a str,
    pub(crate) size: (f64, f64),
    pub(crate) title: &'a str,
    pub(crate) description: &'a str,
    pub(crate) css: String,
    /// Further attributes, with a space before each.
    pub(crate) attributes: String,
    /// Further elements, behind the paper.
    pub(crate) defs: String,
}

impl Opening<'_> {
    pub(crate) fn svg(&self) -> String {
        let Opening { class, id, size: (width, height), css, attributes, defs, .. } = self;
        let (title, description) = (escape(self.title), escape(self.description));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lf {class}\" id=\"{id}\" \
             viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
             aria-labelledby=\"{id}-t {id}-d\"{attributes}><title id=\"{id}-t\">{title}</title>\
             <desc id=\"{id}-d\">{description}</desc><style>{css}</style>{defs}\
             <rect class=\"lf-paper\" width=\"{width}\" height=\"{height}\"/>"
        )
    }
}

/// `text` reduced to an identifier: letters, digits and hyphens, beginning with a letter.
pub(crate) fn slug(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if !out.ends_with('-') && !out.is_empty() {
            out.push('-');
        }
    }
    let out = out.trim_end_matches('-');
    if out.starts_with(|c: char| c.is_ascii_alphabetic()) {
        out.to_string()
    } else {
        format!("f-{out}")
    }
}

/// A coordinate with one decimal, which is finer than a pixel, in as few characters as possible.
pub(crate) fn px(x: f64) -> String {
    let tenths = (x * 10.0).round();
    if tenths % 10.0 == 0.0 {
        format!("{}", (tenths / 10.0) as i64)
    } else {
        format!("{:.1}", tenths / 10.0)
    }
}

/// Path data through `points`. A single point becomes a segment of length zero, which round line
/// caps show as a dot.
pub(crate) fn polyline(points: &[(f64, f64)]) -> String {
    let pairs: Vec<String> = points.iter().map(|p| format!("{} {}", px(p.0), px(p.1))).collect();
    match pairs.as_slice() {
        [] => String::new(),
        [only] => format!("M{only}h0"),
        [first, rest @ ..] => format!("M{first}L{}", rest.join(" ")),
    }
}

/// A small ring around a place: the path of a dense line of one point.
pub(crate) fn ring((x, y): (f64, f64)) -> String {
    format!("M{} {}a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0", px(x - 1.5), px(y))
}

/// The head of an arrow with its tip at these pixels, which points to the direction (right, up) of the view: a unit vector
/// of space as it is seen.
pub(crate) fn arrow_head((x, y): (f64, f64), (dx, dy): (f64, f64)) -> String {
    // Along the direction it is foreshortened like an axis, across it has its full width.
    let size = dx.hypot(dy).max(0.2);
    let (across, down) = (3.6 * -dy / size, 3.6 * dx / size);
    let (left, top) = (x - 9.0 * dx, y + 9.0 * dy);
    polyline(&[(left + across, top - down), (x, y), (left - across, top + down)])
}

/// The estimated width of `text` set in a sans-serif font of `size` pixels; a wide font of digits fits.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

/// A line of text at a point, which `anchor` relates to its start, middle or end.
pub(crate) fn text(class: &str, (x, y): (f64, f64), anchor: &str, content: &str) -> String {
    format!(
        "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\">{}</text>",
        px(x),
        px(y),
        escape(content)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(escape(r#"<a href="x">&'"#), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
        assert_eq!(escape("a\u{0}b"), "a b");
    }

    #[test]
    fn identifiers() {
        assert_eq!(slug("Speed & error (1)"), "speed-error-1");
        assert_eq!(slug("3D"), "f-3d");
        assert_eq!(slug("\"><script>"), "script");
    }

    #[test]
    fn coordinates() {
        assert_eq!(px(12.0), "12");
        assert_eq!(px(-0.04), "0");
        assert_eq!(px(3.1449), "3.1");
        assert_eq!(polyline(&[(1.0, 2.0), (3.0, 4.5)]), "M1 2L3 4.5");
        assert_eq!(polyline(&[(1.0, 2.0)]), "M1 2h0");
    }
}
