//! Writes the golden messages as seeds of all targets: `cargo run --bin seeds`, in this directory.
//!
//! They go to `corpus/<target>/`, where `cargo fuzz run <target>` looks for them.

use std::path::Path;
use std::{fs, io};

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let seeds = franka_fuzz::seeds::read(&root.join("../tests/vectors/wire_golden.json"));
    for seed in &seeds {
        let directory = root.join("corpus").join(seed.target);
        fs::create_dir_all(&directory)?;
        fs::write(directory.join(&seed.name), &seed.bytes)?;
    }
    println!(
        "{} seeds written to {}",
        seeds.len(),
        root.join("corpus").display()
    );
    Ok(())
}
