//! The device of the example `gap_study`, from its own files, for what is measured on it.

#[path = "../../examples/gap_study/device.rs"]
pub mod device;
#[path = "../../examples/gap_study/options.rs"]
pub mod options;
