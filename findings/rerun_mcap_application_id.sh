#!/bin/sh
# rerun-sdk 0.41.0: the application id of an MCAP file is made from its path.
#
# Expected: `rerun run.mcap layout.rbl` shows the file with the blueprint, as it does for an .rrd file.
# Seen: a blueprint is applied to recordings with its application id. A file at another place has
# another id, with a part that looks like a checksum, so no blueprint can be saved for it beforehand.
# Effect here: recordings have to be converted with `--application-id` before the blueprint fits.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv tools
tools/bin/pip install --quiet --disable-pip-version-check rerun-sdk==0.41.0 mcap==1.6.0
export RERUN_ANALYTICS=0
tools/bin/rerun --version
tools/bin/python - <<'PYTHON'
from mcap.writer import Writer

with open("run.mcap", "wb") as file:
    writer = Writer(file)
    writer.start()
    schema = writer.register_schema("point", "jsonschema", b'{"type": "object"}')
    channel = writer.register_channel("/point", "json", schema)
    writer.add_message(channel, log_time=1, publish_time=1, data=b'{"x": 1}')
    writer.finish()
PYTHON
mkdir other
cp run.mcap other/run.mcap

# Prints the application id of a file that is converted with these options.
id_of() {
    tools/bin/rerun mcap convert "$@" --output run.rrd 2>log || { cat log; exit 1; }
    tools/bin/rerun rrd print run.rrd 2>/dev/null | grep -A 3 'StoreId(' | sed -n '3s/[ ",]//gp'
}

here=$(id_of run.mcap)
there=$(id_of other/run.mcap)
given=$(id_of run.mcap --application-id layout)
[ "$given" = layout ] || { echo "changed: with an application id $given"; exit 1; }
[ "$here" != "$there" ] || { echo "changed: at both places $here"; exit 1; }
echo "$here, at another place $there, given $given"
