//! The paper's numbers, computed again, are regression values; and the maps are as accurate as promised.

mod maps;
mod tables;
