//! From a page to HTML text.

use super::glossary::{GLOSSARY, glossary};
use super::{Block, Page, Table};
use crate::plot::{escape, slug, theme};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(
    include_str!("turn.js"),
    include_str!("page.js"),
    include_str!("sphere.js"),
    include_str!("body.js")
);

impl Page {
    /// The page as one HTML file that needs nothing else.
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n\
             <style>\n{}{STYLE}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#content\">Skip to content</a>\n\
             <header class=\"top\">\n<div>\n<h1>{title}</h1>\n{}</div>\n\
             <button type=\"button\" id=\"theme\" hidden>Dark</button>\n</header>\n",
            theme_css(),
            optional("p", "subtitle", &self.subtitle)
        );
        let links = self
            .links
            .iter()
            .map(|(text, href)| format!("<a href=\"{}\">{}</a>\n", escape(href), escape(text)));
        let links: String = links.collect();
        out.push_str(&format!(
            "<nav class=\"links\" aria-label=\"Links\">\n{links}<a href=\"#words\">{GLOSSARY}</a>\n</nav>\n"
        ));
        let anchors = self.anchors();
        if anchors.len() > 1 {
            out.push_str(&self.contents(&anchors));
        }
        out.push_str("<main id=\"content\">\n");
        for (section, anchor) in self.sections.iter().zip(&anchors) {
            out.push_str(&format!(
                "<section aria-labelledby=\"{anchor}\">\n<h2 id=\"{anchor}\">{}</h2>\n",
                escape(&section.title)
            ));
            out.push_str(&blocks(&section.blocks));
            out.push_str("</section>\n");
        }
        out.push_str(&format!("<div id=\"words\">\n{}</div>\n", block(&glossary())));
        out.push_str("</main>\n");
        out.push_str(&optional("footer", "foot", &self.footer));
        out.push_str(&format!("<script>\n{SCRIPT}</script>\n</body>\n</html>\n"));
        out
    }

    /// A unique identifier for each section.
    fn anchors(&self) -> Vec<String> {
        let numbered = self.sections.iter().enumerate();
        numbered.map(|(i, s)| format!("s{}-{}", i + 1, slug(&s.title))).collect()
    }

    fn contents(&self, anchors: &[String]) -> String {
        let links = self.sections.iter().zip(anchors).map(|(section, anchor)| {
            format!("<li><a href=\"#{anchor}\">{}</a></li>", escape(&section.title))
        });
        let links: String = links.collect();
        format!("<nav class=\"toc\" aria-label=\"Contents\"><ol>{links}</ol></nav>\n")
    }
}

/// The colour variables: light, dark where the reader or the system asks for it, light on paper.
fn theme_css() -> String {
    let (light, dark) = (theme::variables(false), theme::variables(true));
    format!(
        ":root{{color-scheme:light;{light}}}\n\
         @media screen and (prefers-color-scheme:dark){{\
         :root:not([data-theme=light]){{color-scheme:dark;{dark}}}}}\n\
         @media screen{{:root[data-theme=dark]{{color-scheme:dark;{dark}}}}}\n"
    )
}

/// An element, or nothing if `text` is empty.
fn optional(element: &str, class: &str, text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("<{element} class=\"{class}\">{}</{element}>\n", prose(text))
}

/// Text that may break its lines, but not within a number such as 1e-9.
fn prose(text: &str) -> String {
    let mut parts = text.split("e-");
    let first = parts.next().unwrap_or_default().to_string();
    let joined = parts.fold(first, |before, after| {
        let number = before.ends_with(|c: char| c.is_ascii_digit())
            && after.starts_with(|c: char| c.is_ascii_digit());
        before + if number { "e-\u{2060}" } else { "e-" } + after
    });
    escape(&joined)
}

fn blocks(blocks: &[Block]) -> String {
    blocks.iter().map(block).collect()
}

fn block(block: &Block) -> String {
    match block {
        Block::Paragraph(text) => format!("<p>{}</p>\n", prose(text)),
        Block::Notice(text) => {
            format!("<p class=\"notice\" role=\"note\">{}</p>\n", prose(text))
        }
        Block::Code(text) => {
            format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escape(text))
        }
        Block::Facts(facts) => {
            let facts = facts.iter().map(|(name, value)| {
                let class = if is_long(value) { " class=\"long\"" } else { "" };
                format!("<div><dt>{}</dt><dd{class}>{}</dd></div>\n", escape(name), escape(value))
            });
            format!("<dl class=\"facts\">\n{}</dl>\n", facts.collect::<String>())
        }
        Block::Glossary(words) => {
            let words = words.iter().map(|(word, meaning)| {
                format!("<dt>{}</dt><dd>{}</dd>\n", escape(word), escape(meaning))
            });
            format!("<dl class=\"words\">\n{}</dl>\n", words.collect::<String>())
        }
        Block::Table(table) => html_table(table),
        Block::Chart(chart) => figure(&chart.title, &chart.svg(), &chart.full_caption()),
        Block::Sphere(sphere) => {
            let drawing = with_data(&sphere.svg(), "scene", &sphere.json());
            figure(&sphere.title, &drawing, &sphere.full_caption())
        }
        Block::Body(body) => {
            let drawing = with_data(&body.svg(), "motion", &body.json());
            figure(&body.title, &drawing, &body.caption)
        }
        Block::Space(space) => figure(&space.title, &space.svg(), &space.caption),
        Block::Heat(heat) => figure(&heat.title, &heat.svg(), &heat.caption),
        Block::Row(row) => format!("<div class=\"row\">\n{}</div>\n", blocks(row)),
        Block::Fold { title, blocks: inner } => format!(
            "<details>\n<summary>{}</summary>\n{}</details>\n",
            escape(title),
            blocks(inner)
        ),
    }
}

/// A drawing under its title, which breaks its lines as the drawing could not.
fn figure(title: &str, drawing: &str, caption: &str) -> String {
    let (title, caption) =
        (optional("p", "title", title), optional("figcaption", "caption", caption));
    format!("<figure>\n{title}{drawing}\n{caption}</figure>\n")
}

/// A drawing with the data of a script, which `class` finds.
fn with_data(drawing: &str, class: &str, json: &str) -> String {
    format!("{drawing}\n<script type=\"application/json\" class=\"{class}\">{json}</script>")
}

/// A column with a longer cell than this breaks its lines, and a longer fact is no number to stand out.
const LONG: usize = 44;

fn is_long(text: &str) -> bool {
    text.chars().count() > LONG
}

fn html_table(table: &Table) -> String {
    // The caption stands outside of what scrolls, so that all of it is read. A region that scrolls has to
    // be reachable by the keyboard, and so needs a name.
    let name = escape(if table.caption.is_empty() { "Table" } else { &table.caption });
    let mut out = format!(
        "<div class=\"table\">\n{}<div class=\"scroll\" role=\"region\" tabindex=\"0\" \
         aria-label=\"{name}\">\n<table aria-label=\"{name}\">\n",
        optional("p", "caption", &table.caption)
    );
    let long = |column: usize| {
        let mut cells = table.rows.iter().filter_map(|row| row.cells.get(column));
        cells.any(|cell| is_long(&cell.text))
    };
    let classes: Vec<&str> = (0..table.columns.len())
        .map(|column| match table.columns[column].numeric {
            true => " class=\"number\"",
            false if long(column) => " class=\"long\"",
            false => "",
        })
        .collect();
    let class = |column: usize| classes.get(column).copied().unwrap_or_default();
    // The script makes a heading a button. One row, or numbers without values, have no order.
    let sorts = |column: usize| {
        let mut cells = table.rows.iter().filter_map(|row| row.cells.get(column));
        table.rows.len() > 1
            && (!table.columns[column].numeric || cells.any(|cell| cell.value.is_some()))
    };
    out.push_str("<thead><tr>");
    for (i, column) in table.columns.iter().enumerate() {
        let sorts = if sorts(i) { " data-sorts" } else { "" };
        let title = escape(&column.title);
        out.push_str(&format!("<th scope=\"col\"{}{sorts}>{title}</th>", class(i)));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str(if row.emphasised { "<tr class=\"strong\">" } else { "<tr>" });
        for (i, cell) in row.cells.iter().enumerate() {
            let (open, close) = if i == 0 { ("th scope=\"row\"", "th") } else { ("td", "td") };
            let value = cell.value.map_or_else(String::new, |x| format!(" data-value=\"{x:e}\""));
            out.push_str(&format!("<{open}{}{value}>{}</{close}>", class(i), escape(&cell.text)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n</div>\n</div>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::super::{Cell, Column, Row, Section};
    use super::*;
    use crate::{Axis, Chart};

    fn page(content: Vec<Block>) -> Page {
        let section = Section::new("Results & <more>", content);
        Page {
            title: "A <page>".into(),
            subtitle: "\"quoted\"".into(),
            links: vec![("data <1>".into(), "a&b.csv".into())],
            sections: vec![section.clone(), section],
            footer: "lieflow".into(),
        }
    }

    #[test]
    fn all_text_is_escaped() {
        let evil = "<script>alert(1)</script>";
        let table = Table::new(evil, vec![Column::text(evil)], [[evil.to_string()]]);
        let html = page(vec![
            Block::text(evil),
            Block::Code(evil.into()),
            Block::Notice(evil.into()),
            Block::Facts(vec![(evil.into(), evil.into())]),
            Block::Table(table),
        ])
        .html();
        assert!(!html.contains(evil));
        assert!(html.contains("<a href=\"a&amp;b.csv\">data &lt;1&gt;</a>"));
        assert!(html.contains("A &lt;page&gt;") && html.contains("&quot;quoted&quot;"));
    }

    #[test]
    fn the_page_is_self_contained() {
        let html = page(vec![Block::text("x")]).html();
        assert!(html.starts_with("<!DOCTYPE html>\n<html lang=\"en\">"));
        for outside in ["http://", "https://", " src=", "@import", "url("] {
            let allowed = html.matches("http://www.w3.org/2000/svg").count();
            let found = html.matches(outside).count();
            assert!(found == 0 || (outside == "http://" && found == allowed), "{outside}");
        }
    }

    #[test]
    fn a_number_is_on_one_line() {
        let html = block(&Block::text("about 2.5e-9 of a one-2-one"));
        assert_eq!(html, "<p>about 2.5e-\u{2060}9 of a one-2-one</p>\n");
    }

    #[test]
    fn every_page_leads_to_the_words() {
        let html = Page::default().html();
        assert_eq!(html.matches("<a href=\"#words\">").count(), 1);
        assert_eq!(html.matches("<div id=\"words\">").count(), 1);
    }

    #[test]
    fn a_fact_that_is_a_sentence_does_not_stand_out() {
        let facts = [("Steps", "20".to_string()), ("Times", "medians of rounds ".repeat(3))];
        let html = block(&Block::facts(facts));
        assert!(html.contains("<dd>20</dd>") && html.contains("<dd class=\"long\">medians"));
    }

    #[test]
    fn sections_have_unique_anchors() {
        let html = page(vec![]).html();
        assert_eq!(html.matches("id=\"s1-results-more\"").count(), 1);
        assert_eq!(html.matches("id=\"s2-results-more\"").count(), 1);
        assert!(html.contains("href=\"#s2-results-more\""));
    }

    #[test]
    fn tables_have_headings_and_alignment() {
        let row = Row::new(["RKMK4", "1.0"]).with_emphasis(true);
        let columns = Column::all(["method"], ["error"]);
        let html = html_table(&Table::new("", columns, [row]));
        assert!(html.contains("<th scope=\"col\" class=\"number\">error</th>"));
        assert!(html.contains("<tr class=\"strong\"><th scope=\"row\">RKMK4</th>"));
        assert!(html.contains("<td class=\"number\">1.0</td>"));
        assert!(!html.contains("class=\"caption\""));
    }

    #[test]
    fn columns_of_text_and_of_values_sort() {
        let rows =
            [2e-9, 10.0].map(|x| ["a".into(), Cell::number(x, |x| format!("{x} ns")), "1".into()]);
        let columns = Column::all(["name"], ["time", "without a value"]);
        let html = html_table(&Table::new("", columns, rows.clone()));
        assert!(html.contains("<td class=\"number\" data-value=\"2e-9\">0.000000002 ns</td>"));
        assert!(html.contains("<th scope=\"col\" data-sorts>name</th>"));
        assert!(html.contains("<th scope=\"col\" class=\"number\" data-sorts>time</th>"));
        assert_eq!(html.matches("data-sorts").count(), 2);
        assert_eq!(Cell::number(f64::NAN, |_| "–").value, None);
        let one = Table::new("", Column::all(["name"], []), rows.into_iter().take(1));
        assert!(!html_table(&one).contains("data-sorts"));
    }

    #[test]
    fn folds_hold_their_blocks_and_figures() {
        let chart = Chart::new("inner", "A chart", [Axis::linear("x"), Axis::linear("y")], []);
        let fold = Block::fold("More & more", vec![Block::text("inside"), chart.into()]);
        let page = page(vec![fold]);
        assert!(
            page.html().contains("<details>\n<summary>More &amp; more</summary>\n<p>inside</p>")
        );
        assert_eq!(page.figures()[0].0, "inner.svg");
    }

    #[test]
    fn the_caption_of_a_table_does_not_scroll_away() {
        let columns = vec![Column::text("method")];
        let html = html_table(&Table::new("All of it", columns, [Row::default()]));
        let caption = html.find("<p class=\"caption\">All of it</p>");
        assert!(caption < html.find("class=\"scroll\"") && caption.is_some(), "{html}");
    }
}
