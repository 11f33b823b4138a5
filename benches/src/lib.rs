//! Validation of `lbm-ibm` against analytic solutions and published data, and its timings.
//!
//! `cargo run --release -p lbm-ibm-benches --bin validate -- --help`, and the same with `--bin speed`.

pub mod chart;
pub mod gap_study;
pub mod reference;
pub mod scenes;
pub mod speed;
pub mod stability;
pub mod validate;

/// Any error; it may cross threads.
pub type Fault = Box<dyn std::error::Error + Send + Sync>;
