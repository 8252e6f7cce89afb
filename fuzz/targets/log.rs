#![no_main]

lieflow_fuzz::target!("log");
