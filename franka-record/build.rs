//! Turns the definitions in `schemas/` into Rust, and keeps their descriptors for the files that
//! are written. In Rust alone: no `protoc` has to be installed.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use prost::Message as _;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=schemas");
    let definitions = protox::compile(["franka.proto", "foxglove.proto"], ["schemas"])?;
    let output = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    fs::write(output.join("descriptors.bin"), definitions.encode_to_vec())?;
    let mut messages = prost_build::Config::new();
    messages.enable_type_names(); // a schema is found by the name of its message
    messages.compile_fds(definitions)?;
    Ok(())
}
