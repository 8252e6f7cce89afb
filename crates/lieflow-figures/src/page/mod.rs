//! Self-contained HTML pages: headings, text, tables, facts and figures in one file, without
//! anything from the network.

mod render;

use crate::plot::{Chart, Heat, Sphere};

/// A page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The title of the page.
    pub title: String,
    /// A sentence below the title; may be empty.
    pub subtitle: String,
    /// The sections in their order.
    pub sections: Vec<Section>,
    /// A line at the foot of the page, for instance the version of the program; may be empty.
    pub footer: String,
}

/// A part of a page under a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// The content.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section of `blocks`.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Section { title: title.into(), blocks }
    }
}

/// A piece of content.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph of plain text.
    Paragraph(String),
    /// A link to another page on a line of its own.
    Link {
        /// What it says.
        text: String,
        /// Where it leads, relative to this page.
        href: String,
    },
    /// Preformatted text such as a command.
    Code(String),
    /// Names with their values.
    Facts(Vec<(String, String)>),
    /// A table.
    Table(Table),
    /// A line chart.
    Chart(Chart),
    /// A momentum sphere, which a reader can turn.
    Sphere(Sphere),
    /// A field on a sphere.
    Heat(Heat),
    /// Blocks next to each other where there is room.
    Row(Vec<Block>),
    /// Content that is folded away under a summary.
    Details {
        /// The visible line.
        summary: String,
        /// The folded content.
        blocks: Vec<Block>,
    },
}

impl Block {
    /// A paragraph of plain text.
    pub fn text(text: impl Into<String>) -> Self {
        Block::Paragraph(text.into())
    }
}

/// A column of a table.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// The heading of the column.
    pub title: String,
    /// Whether the cells are numbers, which are aligned at the right.
    pub numeric: bool,
}

impl Column {
    /// A column of text.
    pub fn text(title: impl Into<String>) -> Self {
        Column { title: title.into(), numeric: false }
    }

    /// A column of numbers.
    pub fn number(title: impl Into<String>) -> Self {
        Column { title: title.into(), numeric: true }
    }
}

/// A row of a table; its first cell is the heading of the row.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The cells in the order of the columns.
    pub cells: Vec<String>,
    /// Whether the row stands out.
    pub emphasised: bool,
}

impl Row {
    /// A row of `cells`.
    pub fn new(cells: Vec<String>) -> Self {
        Row { cells, emphasised: false }
    }
}

/// A table.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The text above the table.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Row>,
}
