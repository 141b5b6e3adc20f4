//! The container image, written without a container engine: an OCI layout in one tar file.
//!
//! ```text
//! index.json ──> index of the image ──> manifest of each architecture ──> config, layer
//!                                       all of them blobs, named by their hash
//! ```

use std::fs;
use std::path::Path;

use jiff::Timestamp;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use super::Release;
use super::archive::{Entry, gzip, tar};
use crate::cross::is_installed;
use xtask::workspace::Workspace;

/// User of the program in the container, without a counterpart on the host.
const USER: &str = "65532:65532";

/// Ports of the simulated robot, its hand and vacuum gripper, and of the page.
const PORTS: [u16; 4] = [1337, 1338, 1339, 8080];

const INDEX: &str = "application/vnd.oci.image.index.v1+json";
const MANIFEST: &str = "application/vnd.oci.image.manifest.v1+json";
const CONFIG: &str = "application/vnd.oci.image.config.v1+json";
const LAYER: &str = "application/vnd.oci.image.layer.v1.tar+gzip";

/// A static program and its papers, for one architecture by its name in Go: `amd64`, `arm64`.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) architecture: &'static str,
    pub(super) program: Vec<u8>,
    pub(super) papers: Vec<(String, Vec<u8>)>,
}

/// The image of all architectures as a tar file of an OCI layout.
pub(super) fn image(release: &Release, parts: &[Part]) -> anyhow::Result<Vec<u8>> {
    let mut blobs = Blobs::default();
    let mut manifests = Vec::new();
    for part in parts {
        manifests.push(manifest(release, part, &mut blobs)?);
    }
    let index = json!({"schemaVersion": 2, "mediaType": INDEX, "manifests": manifests});
    let mut image = blobs.add_json(INDEX, &index)?;
    // podman would interpret a version alone as the name of the image.
    let name = format!("franka:{}", release.version);
    image["annotations"] = json!({"org.opencontainers.image.ref.name": name});
    let top = json!({"schemaVersion": 2, "mediaType": INDEX, "manifests": [image]});
    blobs
        .entries
        .push(Entry::text("index.json", top.to_string()));
    blobs.entries.push(Entry::text(
        "oci-layout",
        json!({"imageLayoutVersion": "1.0.0"}).to_string(),
    ));
    tar(&blobs.entries, release.epoch)
}

/// The manifest of an architecture, with the description for an index.
fn manifest(release: &Release, part: &Part, blobs: &mut Blobs) -> anyhow::Result<Value> {
    let mut files = vec![Entry::program("usr/bin/franka", part.program.clone())];
    for (name, paper) in &part.papers {
        files.push(Entry::text(
            format!("usr/share/doc/franka/{name}"),
            paper.clone(),
        ));
    }
    let layer = tar(&files, release.epoch)?;
    let created = Timestamp::from_second(i64::try_from(release.epoch)?)?.to_string();
    let exposed: serde_json::Map<String, Value> = PORTS
        .iter()
        .map(|port| (format!("{port}/tcp"), json!({})))
        .collect();
    let mut labels = json!({
        "org.opencontainers.image.title": "franka",
        "org.opencontainers.image.description": "Command line, simulator and dashboard for Franka robots",
        "org.opencontainers.image.licenses": "Apache-2.0",
        "org.opencontainers.image.version": release.version,
        "org.opencontainers.image.revision": release.revision,
    });
    if !release.repository.is_empty() {
        labels["org.opencontainers.image.source"] = json!(release.repository);
    }
    let config = json!({
        "architecture": part.architecture,
        "os": "linux",
        "created": created,
        "config": {
            "User": USER,
            "Entrypoint": ["/usr/bin/franka"],
            "Cmd": ["--help"],
            "Env": ["PATH=/usr/bin"],
            "WorkingDir": "/",
            "ExposedPorts": exposed,
            "Labels": labels,
        },
        "rootfs": {"type": "layers", "diff_ids": [digest(&layer)]},
        "history": [{"created": created, "created_by": "cargo xtask dist"}],
    });
    let layer = blobs.add(LAYER, gzip(&layer)?);
    let config = blobs.add_json(CONFIG, &config)?;
    let manifest = json!({
        "schemaVersion": 2,
        "mediaType": MANIFEST,
        "config": config,
        "layers": [layer],
    });
    let mut manifest = blobs.add_json(MANIFEST, &manifest)?;
    manifest["platform"] = json!({"architecture": part.architecture, "os": "linux"});
    Ok(manifest)
}

/// Files of the layout.
#[derive(Debug, Default)]
struct Blobs {
    entries: Vec<Entry>,
}

impl Blobs {
    /// Adds a blob, and returns its description.
    fn add(&mut self, media_type: &str, content: Vec<u8>) -> Value {
        let digest = digest(&content);
        let description = json!({"mediaType": media_type, "digest": digest, "size": content.len()});
        let path = format!("blobs/{}", digest.replace(':', "/"));
        if !self.entries.iter().any(|entry| entry.path == path) {
            self.entries.push(Entry::text(path, content));
        }
        description
    }

    fn add_json(&mut self, media_type: &str, content: &Value) -> anyhow::Result<Value> {
        Ok(self.add(media_type, serde_json::to_vec(content)?))
    }
}

/// The name of a blob.
fn digest(content: &[u8]) -> String {
    format!("sha256:{:x}", Sha256::digest(content))
}

/// Makes `skopeo` copy the image, which reads all of it, if it is installed; returns the result.
/// `work` is a directory that does not exist yet.
pub(super) fn check(workspace: &Workspace, image: &Path, work: &Path) -> anyhow::Result<String> {
    if !is_installed("skopeo") {
        return Ok("NOT CHECKED: skopeo is not installed".to_owned());
    }
    let mut copy = workspace.program("skopeo");
    copy.args(["copy", "--quiet", "--all", "--insecure-policy"]);
    copy.arg(format!("oci-archive:{}", image.display()));
    copy.arg(format!("dir:{}", work.display()));
    workspace.run(&mut copy)?;
    fs::remove_dir_all(work)?;
    Ok("copied by skopeo".to_owned())
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use flate2::read::GzDecoder;

    use super::*;

    fn example() -> Vec<u8> {
        let part = |architecture, program: &[u8]| Part {
            architecture,
            program: program.to_vec(),
            papers: vec![("LICENSE".to_owned(), b"text".to_vec())],
        };
        let parts = [part("amd64", b"one"), part("arm64", b"other")];
        image(&Release::example(), &parts).unwrap()
    }

    fn read(image: &[u8], path: &str) -> Vec<u8> {
        let mut archive = tar::Archive::new(image);
        let entries = archive.entries().unwrap().map(Result::unwrap);
        let mut found = entries.filter(|entry| entry.path().unwrap() == Path::new(path));
        let mut content = Vec::new();
        let mut entry = found.next().unwrap_or_else(|| panic!("{path} is there"));
        entry.read_to_end(&mut content).unwrap();
        content
    }

    /// The blob of a description, if hash and size are correct.
    fn blob(image: &[u8], description: &Value) -> Vec<u8> {
        let name = description["digest"].as_str().unwrap();
        let content = read(image, &format!("blobs/{}", name.replace(':', "/")));
        assert_eq!(digest(&content), name);
        assert_eq!(description["size"], content.len());
        content
    }

    #[test]
    fn every_description_leads_to_what_it_describes() {
        let image = example();
        assert_eq!(image, example(), "nothing but the content decides");
        let json = |bytes: Vec<u8>| serde_json::from_slice::<Value>(&bytes).unwrap();
        let top = json(read(&image, "index.json"));
        let index = json(blob(&image, &top["manifests"][0]));
        let manifests = index["manifests"].as_array().unwrap();
        assert_eq!(manifests.len(), 2);
        for (description, architecture) in manifests.iter().zip(["amd64", "arm64"]) {
            assert_eq!(description["platform"]["architecture"], architecture);
            let manifest = json(blob(&image, description));
            let config = json(blob(&image, &manifest["config"]));
            assert_eq!(config["architecture"], architecture);
            let mut layer = Vec::new();
            let packed = blob(&image, &manifest["layers"][0]);
            GzDecoder::new(packed.as_slice())
                .read_to_end(&mut layer)
                .unwrap();
            assert_eq!(config["rootfs"]["diff_ids"][0], digest(&layer));
            let program = read(&layer, "usr/bin/franka");
            assert!(program == b"one" || program == b"other");
        }
    }

    /// Skipped without skopeo: then only the test above reads the image.
    #[test]
    fn skopeo_copies_the_image() {
        let workspace = Workspace::find().unwrap();
        let name = format!("franka-xtask-{}-image", std::process::id());
        let work = std::env::temp_dir().join(name);
        fs::create_dir_all(&work).unwrap();
        let file = work.join("image.tar");
        fs::write(&file, example()).unwrap();
        println!("{}", check(&workspace, &file, &work.join("copy")).unwrap());
        fs::remove_dir_all(work).unwrap();
    }
}
