//! The numerical section of Celledoni & Owren (2003), computed again.
//!
//! [`compute()`] gives the tables and figures beside what is printed ([`Paper`]), what is wrong in the print, and what it
//! does not have. [`experiments`] and [`energy`] are its three experiments, and [`maps`] is a study of the maps: their
//! errors against values of 30 digits, and their times. Pages and tables are values; who asks for them writes the files.
//!
//! | room | what is in it |
//! |---|---|
//! | `methods` | the methods of the paper's tables, each on its equation |
//! | `printed` | the numbers that the paper prints, and its errata |
//! | `energy` | the energy along a run |
//! | `experiments` | the three experiments |
//! | `accuracy` | Table 4 and Figure 5 |
//! | `counts` | Table 2 |
//! | `trace` | Table 1 as one step |
//! | `findings` | what the paper does not have: frames, orders of the drift, the separatrix |
//! | `maps` | the study of the maps |
//! | `results` | all of the paper, computed |
//! | `verdicts` | what the paper says about speed and error, judged |
//! | `news` | the figures of the findings |
//! | `files` | the data as CSV |
//! | `page` | the page |
//!
//! A room uses those above it in this table only.
#![forbid(unsafe_code)]

pub mod accuracy;
pub mod counts;
pub mod energy;
pub mod experiments;
mod files;
pub mod findings;
pub mod maps;
pub mod methods;
mod news;
mod page;
pub mod printed;
mod results;
pub mod trace;
mod verdicts;

pub use results::{Paper, PaperExtent, compute};
pub use verdicts::Verdict;

use lieflow_figures::{Page, csv};

/// The page.
pub const PAPER_PAGE: &str = "paper.html";

impl Paper {
    /// The data: the name of each file, and its text as CSV.
    pub fn files(&self) -> Vec<(&'static str, String)> {
        let all = files::all(self).into_iter();
        all.map(|(name, header, rows)| (name, csv::table(header.split(','), rows))).collect()
    }

    /// The page, with links to the data.
    pub fn page(&self) -> Page {
        let names = files::all(self).into_iter().map(|(name, ..)| (name, name));
        page::page(self).with_links(names)
    }

    /// Table 3: the name of each method, its energy error and its mean error, each as printed and as computed here.
    pub fn table3(&self) -> Vec<[String; 5]> {
        let rows = self.energy[2].iter().filter_map(|run| {
            let [last, mean] = printed::table3(run.method)?.map(String::from);
            let ours = |x: f64| format!("{:.6e}", x.abs());
            Some([run.method.name().into(), last, ours(run.last()), mean, ours(run.mean())])
        });
        rows.collect()
    }

    /// What the paper says about speed and error, each sentence with what came out here.
    pub fn verdicts(&self) -> Vec<Verdict> {
        verdicts::all(self)
    }
}
