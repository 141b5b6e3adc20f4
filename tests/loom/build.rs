//! Sets `cfg(loom)` for this package alone, so that it shares all other builds with the workspace.

fn main() {
    println!("cargo::rustc-cfg=loom");
    // A feature of franka-rt, never enabled here.
    println!("cargo::rustc-check-cfg=cfg(feature, values(\"serde\"))");
    println!("cargo::rerun-if-changed=build.rs");
}
