//! Writes the golden messages as seeds of all targets: `seeds DIRECTORY` makes
//! `DIRECTORY/<target>/<message>`.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let mut arguments = env::args_os().skip(1);
    let (Some(directory), None) = (arguments.next(), arguments.next()) else {
        return Err(io::Error::other("one argument is needed: the directory"));
    };
    let directory = PathBuf::from(directory);
    let vectors = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/vectors");
    let seeds = franka_fuzz::seeds::read(&vectors.join("wire_golden.json"));
    for seed in &seeds {
        let target = directory.join(seed.target);
        fs::create_dir_all(&target)?;
        fs::write(target.join(&seed.name), &seed.bytes)?;
    }
    println!("{} seeds in {}", seeds.len(), directory.display());
    Ok(())
}
