//! Validation of `lbm-ibm` against analytic solutions and published data, and its timings.
//!
//! `cargo run --release -p lbm-ibm-benches --bin validate -- --help`

pub mod reference;
pub mod validate;
