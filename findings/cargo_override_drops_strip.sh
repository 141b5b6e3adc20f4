#!/bin/sh
# cargo 1.95.0: a profile's `strip = true` does not reach a package that has an override of its own.
#
# Expected: `[profile.release.package.NAME] opt-level = "s"` changes the optimisation of that package
# and leaves the rest of the profile as it is.
# Seen: rustc is called with `strip=debuginfo` instead of `strip=symbols`, and the program keeps its
# symbol table. `strip` cannot be set in an override.
# Effect here: an override of the command line's package made the packed program a quarter larger.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cargo init --quiet --name finding --vcs none .
cargo --version

# Prints the strip options of a release build with these further lines of the manifest.
options() {
    printf '[package]\nname = "finding"\nversion = "0.1.0"\nedition = "2021"\n%b' \
        "[profile.release]\nstrip = true\n$1" >Cargo.toml
    touch src/main.rs
    cargo build --release --verbose 2>&1 | grep -o 'strip=[a-z]*'
}

plain=$(options '')
override=$(options '[profile.release.package.finding]\nopt-level = "s"\n')
[ "$plain" = strip=symbols ] || { echo "changed: without an override $plain"; exit 1; }
[ "$override" = strip=debuginfo ] || { echo "changed: with an override $override"; exit 1; }
echo "without an override $plain, with one $override"
