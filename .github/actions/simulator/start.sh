# Starts a simulated robot in the background and waits until it listens. Its environment has
# FRANKA, the program; ROBOT, fr3 or fer; OPTIONS of `franka sim`; WAIT, whole seconds.
set -euo pipefail

if ! [[ "$WAIT" =~ ^[1-9][0-9]{0,4}$ ]]; then
  echo "wait is '$WAIT', expected whole seconds from 1 on"
  exit 1
fi
# Of each simulator its own: a job may start several.
log=$(mktemp "$RUNNER_TEMP/franka-sim.XXXXXX.log")
# xargs takes any number of lines, and quotes; a quote without its end ends this script.
words=$(xargs --no-run-if-empty printf '%s\n' <<< "$OPTIONS")
options=()
if [[ -n "$words" ]]; then
  mapfile -t options <<< "$words"
fi
"$FRANKA" sim --robot "$ROBOT" "${options[@]}" > "$log" 2>&1 &
simulator=$!
{
  echo "log=$log"
  echo "pid=$simulator"
} >> "$GITHUB_OUTPUT"

for ((tenth = 0; tenth < 10 * WAIT; tenth++)); do
  if grep --quiet "^listening on" "$log"; then
    cat "$log"
    exit 0
  fi
  if ! kill -0 "$simulator" 2> /dev/null; then
    echo "the simulator has ended:"
    cat "$log"
    exit 1
  fi
  sleep 0.1
done
echo "the simulator does not listen after $WAIT s:"
cat "$log"
kill "$simulator"
exit 1
