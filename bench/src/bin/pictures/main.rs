//! Draws the pictures of the book that do not show a measured robot.
//!
//! `cargo run --release -p franka-bench --bin pictures [DIRECTORY]`
//!
//! | module | picture |
//! |---|---|
//! | [`datagram`] | the time between a state and the next |
//! | [`guards`] | the stages from a goal to torques |
//! | [`arm`] | the arm, and the frames of its links |
//! | [`step`] | a target that steps, and the resulting command |

mod arm;
mod canvas;
mod datagram;
mod guards;
mod step;
mod view;

use std::path::PathBuf;

use anyhow::Context as _;

fn main() -> anyhow::Result<()> {
    let directory = std::env::args()
        .nth(1)
        .map_or("docs/src".into(), PathBuf::from);
    for (name, draw) in PICTURES {
        let file = directory.join(name);
        let picture = draw();
        std::fs::write(&file, &picture).with_context(|| file.display().to_string())?;
        println!("{}: {} bytes", file.display(), picture.len());
    }
    Ok(())
}

/// A picture's file, and its drawing function.
type Picture = (&'static str, fn() -> String);

const PICTURES: [Picture; 4] = [
    ("datagram.svg", datagram::draw),
    ("guards.svg", guards::draw),
    ("arm.svg", arm::draw),
    ("step.svg", step::draw),
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Diagrams contain no numbers that depend on the machine.
    #[test]
    fn the_diagrams_of_the_book_are_those_of_this_program() {
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src");
        for (name, draw) in &PICTURES[..2] {
            let drawn = std::fs::read_to_string(book.join(name)).expect("a picture of the book");
            assert!(draw() == drawn, "{name}: run `cargo xtask pictures`");
        }
    }
}
