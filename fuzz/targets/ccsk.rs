#![no_main]

lieflow_fuzz::target!("ccsk");
