//! Self-contained HTML pages: headings, text, tables, facts and figures in one file, without
//! anything from the network.

mod glossary;
mod render;

use crate::plot::{Body, Chart, Heat, Space, Sphere, for_file, slug};

/// A page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The title of the page.
    pub title: String,
    /// A sentence below the title; may be empty.
    pub subtitle: String,
    /// Other pages and files: what they are called, and where they are, relative to this page.
    pub links: Vec<(String, String)>,
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

impl Page {
    /// A page with the version of lieflow at its foot.
    pub fn new(
        title: impl Into<String>,
        subtitle: impl Into<String>,
        sections: Vec<Section>,
    ) -> Self {
        let footer = format!("lieflow {}", env!("CARGO_PKG_VERSION"));
        Page { title: title.into(), subtitle: subtitle.into(), links: Vec::new(), sections, footer }
    }

    /// The page with links to these pages and files, relative to this page.
    pub fn with_links<'a>(self, links: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let links = links.into_iter().map(|(text, href)| (text.into(), href.into())).collect();
        Page { links, ..self }
    }

    /// Every figure of the page: the name of a file beside it, and what that holds.
    pub fn figures(&self) -> Vec<(String, String)> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        blocks.flat_map(Block::figures).collect()
    }
}

/// A piece of content.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph of plain text.
    Paragraph(String),
    /// A sentence that a reader must not miss.
    Notice(String),
    /// Preformatted text such as a command.
    Code(String),
    /// Names with their values.
    Facts(Vec<(String, String)>),
    /// Words with what they mean.
    Glossary(Vec<(&'static str, &'static str)>),
    /// A table.
    Table(Table),
    /// A line chart.
    Chart(Chart),
    /// A momentum sphere, which a reader can turn.
    Sphere(Sphere),
    /// Paths in space.
    Space(Space),
    /// A body that turns, which a reader plays.
    Body(Body),
    /// A field on a sphere.
    Heat(Heat),
    /// Blocks next to each other where there is room.
    Row(Vec<Block>),
    /// Blocks that a reader opens.
    Fold {
        /// What is inside.
        title: String,
        /// The blocks.
        blocks: Vec<Block>,
    },
}

impl Block {
    /// A paragraph of plain text.
    pub fn text(text: impl Into<String>) -> Self {
        Block::Paragraph(text.into())
    }

    /// Blocks that stay closed until a reader opens them.
    pub fn fold(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Block::Fold { title: title.into(), blocks }
    }

    /// Names with their values.
    pub fn facts<N: Into<String>, V: Into<String>>(
        facts: impl IntoIterator<Item = (N, V)>,
    ) -> Self {
        Block::Facts(facts.into_iter().map(|(name, value)| (name.into(), value.into())).collect())
    }

    /// The figures of this block: the name of a file, and what it holds.
    fn figures(&self) -> Vec<(String, String)> {
        let file = |id: &str, svg: String| vec![(format!("{}.svg", slug(id)), for_file(&svg))];
        match self {
            Block::Chart(chart) => file(&chart.id, chart.svg()),
            Block::Sphere(sphere) => file(&sphere.id, sphere.svg()),
            Block::Space(space) => file(&space.id, space.svg()),
            Block::Body(body) => file(&body.id, body.svg()),
            Block::Heat(heat) => file(&heat.id, heat.svg()),
            Block::Row(blocks) | Block::Fold { blocks, .. } => {
                blocks.iter().flat_map(Block::figures).collect()
            }
            _ => Vec::new(),
        }
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Block::Table(table)
    }
}
impl From<Chart> for Block {
    fn from(chart: Chart) -> Self {
        Block::Chart(chart)
    }
}
impl From<Body> for Block {
    fn from(body: Body) -> Self {
        Block::Body(body)
    }
}
impl From<Space> for Block {
    fn from(space: Space) -> Self {
        Block::Space(space)
    }
}
impl From<Sphere> for Block {
    fn from(sphere: Sphere) -> Self {
        Block::Sphere(sphere)
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

    /// Columns of text, then columns of numbers.
    pub fn all<const T: usize, const N: usize>(texts: [&str; T], numbers: [&str; N]) -> Vec<Self> {
        texts.into_iter().map(Column::text).chain(numbers.map(Column::number)).collect()
    }
}

/// A cell of a table.
#[derive(Clone, Debug, Default)]
pub struct Cell {
    /// What it shows.
    pub text: String,
    /// The number that the text stands for. A reader sorts by it.
    pub value: Option<f64>,
}

impl Cell {
    /// A number, shown in this format. One that is not finite has no place in an order.
    pub fn number<T: Into<String>>(value: f64, format: impl FnOnce(f64) -> T) -> Self {
        Cell { text: format(value).into(), value: Some(value).filter(|x| x.is_finite()) }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Cell { text: text.into(), value: None }
    }
}

/// A row of a table; its first cell is the heading of the row.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The cells in the order of the columns.
    pub cells: Vec<Cell>,
    /// Whether the row stands out.
    pub emphasised: bool,
}

impl Row {
    /// A row of these cells.
    pub fn new<C: Into<Cell>>(cells: impl IntoIterator<Item = C>) -> Self {
        Row { cells: cells.into_iter().map(Into::into).collect(), emphasised: false }
    }

    /// The row, standing out from the others if `emphasised`.
    pub fn with_emphasis(self, emphasised: bool) -> Self {
        Row { emphasised, ..self }
    }
}

impl<C: Into<Cell>> From<Vec<C>> for Row {
    fn from(cells: Vec<C>) -> Self {
        Row::new(cells)
    }
}

impl<C: Into<Cell>, const N: usize> From<[C; N]> for Row {
    fn from(cells: [C; N]) -> Self {
        Row::new(cells)
    }
}

/// A table. A reader sorts it by a click on the heading of a column: by text in a column of text, by
/// [`Cell::value`] in a column of numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The text above the table.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Row>,
}

impl Table {
    /// A table of these rows.
    pub fn new<R: Into<Row>>(
        caption: impl Into<String>,
        columns: Vec<Column>,
        rows: impl IntoIterator<Item = R>,
    ) -> Self {
        let rows = rows.into_iter().map(Into::into).collect();
        Table { caption: caption.into(), columns, rows }
    }
}
