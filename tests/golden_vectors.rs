//! Every golden suite on the project's own vectors. The suites are in `src/golden`, for example
//! `wire` for messages and datagrams.

use std::path::Path;

use franka_tests::golden::{self, SUITES};

#[test]
fn every_stored_vector_holds() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors");
    let outcomes = golden::run(&dir, SUITES);
    for outcome in &outcomes {
        println!("{outcome}");
        assert!(!outcome.absent(), "{} is not stored", outcome.file);
    }
    assert!(!golden::failed(&outcomes), "see the lines above");
}
