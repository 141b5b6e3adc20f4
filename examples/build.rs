//! Compiles `proto/arm.proto` to Rust, for the gRPC service and its client. Uses Rust only:
//! `protoc` need not be installed.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=proto/arm.proto");
    #[cfg(feature = "grpc")]
    {
        let definitions = protox::compile(["arm.proto"], ["proto"])?;
        let mut messages = tonic_prost_build::Config::new();
        messages.enable_type_names(); // for packing into the details of a status
        tonic_prost_build::configure().compile_fds_with_config(definitions, messages)?;
    }
    Ok(())
}
