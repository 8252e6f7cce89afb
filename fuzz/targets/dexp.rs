#![no_main]

lieflow_fuzz::target!("dexp");
