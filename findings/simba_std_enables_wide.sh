#!/bin/sh
# simba 0.10.2 (nalgebra 0.35.0): the feature `std` enables the optional dependency `wide`.
#
# Expected: `std` only forwards to `wide` where a program has asked for SIMD, as `wide?/std` does.
# Seen: `std = ["wide/std"]` turns the dependency on. A program that takes nalgebra with `std` and no
# SIMD compiles wide, safe_arch and bytemuck; without `std` it does not.
# Effect here: about 4 s of processor time in each build from nothing on the machine where this was
# found. Without `std`, elementary functions come from the portable libm instead.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cargo init --quiet --name finding --vcs none .

# Prints the packages of a program that takes nalgebra with these features.
packages() {
    printf '[package]\nname = "finding"\nversion = "0.1.0"\nedition = "2021"\n[dependencies]\n%s\n%s\n' \
        "nalgebra = { version = \"=0.35.0\", default-features = false, features = [\"$1\"] }" \
        'simba = { version = "=0.10.2", default-features = false }' >Cargo.toml
    cargo tree --quiet --prefix none --edges normal | cut -d ' ' -f 1 | sort -u
}

packages std >std
packages libm >libm
for name in wide safe_arch bytemuck; do
    grep -qx "$name" std || { echo "changed: std does not enable $name"; exit 1; }
    if grep -qx "$name" libm; then echo "changed: $name is there without std"; exit 1; fi
done
echo "nalgebra 0.35.0, simba 0.10.2: std enables wide, safe_arch and bytemuck; libm alone does not"
