//! Writes the golden messages, the cassettes of the tests, short recordings and sessions of the
//! dashboard as seeds of the targets: `seeds DIRECTORY` makes `DIRECTORY/<target>/<seed>`.

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
    let target = directory.join("cassette");
    fs::create_dir_all(&target)?;
    let mut cassettes = 0;
    for entry in fs::read_dir(vectors.join("../cassettes"))? {
        let path = entry?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "mcap")
        {
            let name = path.file_name().expect("an entry has a name");
            fs::copy(&path, target.join(name))?;
            cassettes += 1;
        }
    }
    let recordings = franka_fuzz::recordings::seeds();
    for (name, bytes) in &recordings {
        let target = directory.join("recording");
        fs::create_dir_all(&target)?;
        fs::write(target.join(name), bytes)?;
    }
    let sessions = franka_fuzz::dashboard_sessions();
    let target = directory.join("dashboard");
    fs::create_dir_all(&target)?;
    for (number, session) in sessions.iter().enumerate() {
        fs::write(target.join(number.to_string()), session)?;
    }
    let count = seeds.len() + cassettes + recordings.len() + sessions.len();
    println!("{count} seeds in {}", directory.display());
    Ok(())
}
