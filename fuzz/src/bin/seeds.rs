//! Writes the golden messages, the cassettes of the tests, short sessions and recordings, and
//! sessions of the dashboard as seeds of the targets: `seeds DIRECTORY` makes
//! `DIRECTORY/<target>/<seed>`.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let mut arguments = env::args_os().skip(1);
    let (Some(directory), None) = (arguments.next(), arguments.next()) else {
        return Err(io::Error::other("one argument is needed: the directory"));
    };
    let directory = PathBuf::from(directory);
    let mut count = 0;
    let mut put = |target: &str, name: &str, bytes: &[u8]| {
        count += 1;
        let target = directory.join(target);
        fs::create_dir_all(&target)?;
        fs::write(target.join(name), bytes)
    };
    let vectors = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/vectors");
    for seed in franka_fuzz::seeds::read(&vectors.join("wire_golden.json")) {
        put(seed.target, &seed.name, &seed.bytes)?;
    }
    for entry in fs::read_dir(vectors.join("../cassettes"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|it| it == "mcap") {
            let name = path.file_name().expect("an entry has a name");
            put("cassette", &name.to_string_lossy(), &fs::read(&path)?)?;
        }
    }
    for (name, bytes) in franka_fuzz::cassettes::seeds() {
        put("cassette", name, &bytes)?;
    }
    for (name, bytes) in franka_fuzz::recordings::seeds() {
        put("recording", name, &bytes)?;
    }
    for (number, bytes) in franka_fuzz::dashboard_sessions().iter().enumerate() {
        put("dashboard", &number.to_string(), bytes)?;
    }
    println!("{count} seeds in {}", directory.display());
    Ok(())
}
