//! The Rust code and the descriptors of a recording's messages, from the definitions in
//! `franka-record/schemas`. Both are committed: a build of the recorder then needs no compiler of
//! definitions.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, ensure};
use prost::Message as _;

use xtask::workspace::Workspace;

/// Writes the generated files.
pub(crate) fn write(workspace: &Workspace) -> anyhow::Result<()> {
    for (path, content) in generate(workspace)? {
        fs::write(&path, content).with_context(|| path.display().to_string())?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Fails if a generated file differs from the output of [`write()`].
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    for (path, content) in generate(workspace)? {
        ensure!(
            fs::read(&path).is_ok_and(|found| found == content),
            "{} does not match franka-record/schemas: run cargo xtask schemas",
            path.display()
        );
    }
    Ok(())
}

/// Path and content of each generated file.
fn generate(workspace: &Workspace) -> anyhow::Result<BTreeMap<PathBuf, Vec<u8>>> {
    let crate_folder = workspace.root().join("franka-record");
    let folder = crate_folder.join("src/schema/generated");
    let names = ["franka.proto", "foxglove.proto"];
    let definitions = protox::compile(names, [crate_folder.join("schemas")])?;
    let mut files = BTreeMap::from([(folder.join("descriptors.bin"), definitions.encode_to_vec())]);
    let mut messages = prost_build::Config::new();
    messages.enable_type_names(); // a schema is found by the name of its message
    let modules = definitions.file.into_iter().map(|file| {
        let module = prost_build::Module::from_protobuf_package_name(file.package());
        (module, file)
    });
    for (module, code) in messages.generate(modules.collect())? {
        let path = folder.join(module.to_file_name_or("schema"));
        files.insert(path, code.into_bytes());
    }
    Ok(files)
}
