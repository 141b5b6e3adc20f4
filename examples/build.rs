//! Turns `proto/arm.proto` into Rust, for the gRPC service and its client. In Rust alone: no
//! `protoc` has to be installed.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=proto/arm.proto");
    #[cfg(feature = "grpc")]
    {
        let definitions = protox::compile(["arm.proto"], ["proto"])?;
        let mut messages = tonic_prost_build::Config::new();
        messages.enable_type_names(); // to be packed into the details of a status
        tonic_prost_build::configure().compile_fds_with_config(definitions, messages)?;
    }
    Ok(())
}
