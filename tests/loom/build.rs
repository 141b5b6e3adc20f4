//! Sets `cfg(loom)` for this package alone, so that it shares all other builds with the workspace.

fn main() {
    println!("cargo::rustc-cfg=loom");
    println!("cargo::rerun-if-changed=build.rs");
}
