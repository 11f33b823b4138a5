//! Magnetic sources and beads. Empty in this version.
