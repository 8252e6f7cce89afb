//! Colours and the style sheet of the figures. All colours of figures and pages are named here.
//!
//! Each colour is a CSS variable `--lf-…`. The style sheet of a figure uses it with the light
//! colour as the fallback; a page sets the variables for both themes with [`variables`].

/// A colour by name, in the light and in the dark theme.
pub(crate) struct Colour {
    name: &'static str,
    light: &'static str,
    dark: &'static str,
}

const fn colour(name: &'static str, light: &'static str, dark: &'static str) -> Colour {
    Colour { name, light, dark }
}

/// The number of different line colours. After them they begin again.
pub const LINE_COLOURS: usize = 10;

/// The number of brightness levels of the ellipsoid.
pub(crate) const SHADES: usize = 16;

/// The first line colours follow Okabe and Ito (2008), made darker or lighter to stand out from the
/// background of each theme.
const COLOURS: [Colour; 16 + LINE_COLOURS] = [
    colour("paper", "#ffffff", "#14171c"),
    colour("ink", "#1c2128", "#e6e9ee"),
    colour("muted", "#5b6470", "#9ba5b2"),
    colour("rule", "#d5dae1", "#39414d"),
    colour("faint", "#edf0f3", "#232931"),
    colour("frame", "#9aa3ae", "#5a6472"),
    colour("accent", "#0067a6", "#6db6f2"),
    colour("mark", "#fdf6e3", "#2b2a20"),
    colour("ball-light", "#ffffff", "#46515f"),
    colour("ball", "#e3e9f0", "#2f3843"),
    colour("ball-edge", "#b3bfcc", "#1f262e"),
    colour("grid", "#a9b5c2", "#566374"),
    colour("wire", "#b98a35", "#c9a259"),
    colour("ellipsoid-dark", "#d9b56a", "#4b3d22"),
    colour("ellipsoid-light", "#fbeecb", "#8a7140"),
    colour("polhode", "#8a6a28", "#e2c078"),
    colour("c0", "#0072b2", "#5aa9f0"),
    colour("c1", "#cf4a10", "#ff8f57"),
    colour("c2", "#008a64", "#2fcf9f"),
    colour("c3", "#b4578f", "#ec9ccb"),
    colour("c4", "#c08a00", "#f0c040"),
    colour("c5", "#5b3fc4", "#8f74ff"),
    colour("c6", "#3b424c", "#d3d9e0"),
    colour("c7", "#00a3c4", "#57e6f7"),
    colour("c8", "#7a2e3a", "#d0606f"),
    colour("c9", "#6fa000", "#b6e04a"),
];

/// The CSS declarations that set all colour variables for the light or the dark theme.
pub(crate) fn variables(dark: bool) -> String {
    let value = |c: &Colour| if dark { c.dark } else { c.light };
    let named = COLOURS.iter().map(|c| format!("--lf-{}:{};", c.name, value(c)));
    let shades = (0..SHADES).map(|k| format!("--lf-e{k}:{};", shade(k, dark)));
    named.chain(shades).collect()
}

/// A figure as a file of its own, which is dark on a dark page. Inline it follows its page.
pub(crate) fn for_file(svg: &str) -> String {
    let dark = variables(true);
    let used = dark.split_inclusive(';').filter(|declaration| {
        declaration.split_once(':').is_some_and(|(name, _)| svg.contains(&format!("({name},")))
    });
    let used: String = used.collect();
    let style = format!("<style>@media screen and (prefers-color-scheme:dark){{:root{{{used}}}}}");
    svg.replacen("<style>", &style, 1)
}

/// The colour of the ellipsoid at brightness level `k`.
fn shade(k: usize, dark: bool) -> String {
    let hex = |name: &str| {
        let found = COLOURS.iter().find(|c| c.name == name);
        let text = found.map_or("#000000", |c| if dark { c.dark } else { c.light });
        u32::from_str_radix(&text[1..], 16).unwrap_or(0)
    };
    let (low, high) = (hex("ellipsoid-dark"), hex("ellipsoid-light"));
    let t = k as f64 / (SHADES - 1) as f64;
    let mix = |shift: u32| {
        let channel = |c: u32| f64::from((c >> shift) & 255);
        (channel(low) + t * (channel(high) - channel(low))).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(16), mix(8), mix(0))
}

/// A style sheet in one line, with each `property:@name` as that property in a named colour. It is
/// declared twice because some SVG converters do not know variables: they keep the first declaration.
fn style(template: &str) -> String {
    let declaration = |text: &str| match text.split_once(":@") {
        None => text.to_string(),
        Some((property, name)) => {
            let light = match name.strip_prefix('e').and_then(|k| k.parse().ok()) {
                Some(k) => shade(k, false),
                None => COLOURS.iter().find(|c| c.name == name).map_or("", |c| c.light).into(),
            };
            format!("{property}:{light};{property}:var(--lf-{name},{light})")
        }
    };
    let rule = |line: &str| {
        let (selector, body) = line.trim_end_matches('}').split_once('{').unwrap_or((line, ""));
        let body: Vec<String> = body.split(';').map(declaration).collect();
        format!("{selector}{{{}}}", body.join(";"))
    };
    template.lines().map(rule).collect()
}

/// The style sheet of a line chart.
pub(crate) fn chart_css() -> String {
    style(concat!(include_str!("common.css"), include_str!("chart.css")))
}

/// The style sheet of a body that turns.
pub(crate) fn body_css() -> String {
    style(concat!(include_str!("common.css"), include_str!("body.css")))
}

/// The style sheet of paths in space.
pub(crate) fn space_css() -> String {
    style(concat!(include_str!("common.css"), include_str!("space.css")))
}

/// The style sheet of a momentum sphere.
pub(crate) fn sphere_css() -> String {
    let shade = |k| {
        format!(".lf .lf-e{k}{{fill:@e{k};stroke:@e{k};stroke-width:.6;stroke-linejoin:round}}\n")
    };
    let shades: String = (0..SHADES).map(shade).collect();
    let template = concat!(include_str!("common.css"), include_str!("sphere.css"));
    style(&(template.to_string() + &shades))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_has_a_light_fallback() {
        for css in [chart_css(), body_css(), space_css(), sphere_css()] {
            assert!(css.contains("var(--lf-"));
            assert!(!css.contains(":;") && !css.contains(",)"));
        }
        for c in &COLOURS {
            assert!(c.light.len() == 7 && c.dark.len() == 7, "{}", c.name);
        }
    }

    #[test]
    fn a_file_follows_a_dark_page() {
        let svg = for_file("<svg><style>.a{fill:#fff;fill:var(--lf-paper,#fff)}</style></svg>");
        let dark = ":root{--lf-paper:#14171c;}}.a{";
        assert!(svg.starts_with("<svg><style>@media") && svg.contains(dark), "{svg}");
    }

    #[test]
    fn themes_differ() {
        assert!(variables(false).contains("--lf-paper:#ffffff;"));
        assert!(variables(true).contains("--lf-paper:#14171c;"));
        assert_eq!(shade(0, false), "#d9b56a");
        assert_eq!(shade(SHADES - 1, true), "#8a7140");
    }
}
