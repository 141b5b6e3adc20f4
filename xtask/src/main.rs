//! One-command tasks of this workspace
fn main() {}
