// How punctual control is.

export function statistics(connection) {
  const body = document.querySelector("#statistics tbody");
  const cell = (value) => value.toFixed(0);
  connection.addEventListener("statistics", ({ detail: { thread } }) => {
    if (!thread) {
      body.innerHTML = "<tr><td>Another program controls the robot</td></tr>";
      return;
    }
    const rows = ["turnaround", "slack", "interval"].filter((name) => thread[name]).map((name) => {
      const { p50, p99, max } = thread[name];
      return `<tr><td>${name}, µs</td><td>${cell(p50)}</td><td>${cell(p99)}</td><td>${cell(max)}</td></tr>`;
    });
    body.innerHTML = `<tr><th></th><th>median</th><th>99 %</th><th>max</th></tr>${rows.join("")}`
      + `<tr><td>states</td><td>${thread.states}</td><td>lost ${thread.lost}</td><td>skipped ${thread.skipped}</td></tr>`;
  });
}
