#![no_main]

lieflow_fuzz::target!("pade22");
