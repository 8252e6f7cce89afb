#![no_main]

lieflow_fuzz::target!("unitary");
