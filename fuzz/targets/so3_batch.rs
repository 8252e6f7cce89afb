#![no_main]

lieflow_fuzz::target!("so3_batch");
