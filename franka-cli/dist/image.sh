#!/bin/sh
# Builds the container image of the static programs that `cargo xtask dist` leaves in target/image: an OCI layout in one file of
# target/artefacts. Needs buildah, but neither a daemon nor root.
set -eu
cd "$(dirname "$0")/../.."
target=${CARGO_TARGET_DIR:-target}
version=$(cargo pkgid --package franka-cli | sed 's/.*[#@]//')
# podman would take a version alone for the name of the image.
name=franka:$version
file=franka-$version.oci.tar
store=$(mktemp --directory)
trap 'rm -rf "$store"' EXIT
buildah() {
    command buildah --storage-driver vfs --root "$store" --runroot "$store/run" "$@"
}
platforms=$(cd "$target/image" && printf 'linux/%s,' *)
buildah build --quiet --isolation chroot --platform "${platforms%,}" --manifest "$name" \
    --timestamp "${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}" --build-arg "VERSION=$version" \
    --label "org.opencontainers.image.revision=$(git rev-parse HEAD)" --file franka-cli/dist/Dockerfile "$target/image"
buildah manifest push --quiet --all "$name" "oci-archive:$target/artefacts/$file:$name"
cd "$target/artefacts"
sha256sum -- "$file" >> SHA256SUMS
