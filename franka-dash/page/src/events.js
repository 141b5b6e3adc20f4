// The log, and the notice of the newest refusal.

const KEPT = 200;
const NOTICE_MS = 6000;

export function events(connection) {
  const list = document.getElementById("events");
  const notice = document.getElementById("notice");
  let hide = null;
  const add = (level, text, detail) => {
    const item = document.createElement("li");
    item.className = level;
    const time = document.createElement("time");
    time.textContent = new Date().toLocaleTimeString();
    item.append(time, text);
    if (detail) {
      const more = document.createElement("details");
      const summary = document.createElement("summary");
      summary.textContent = "Cause and remedy";
      const pre = document.createElement("pre");
      pre.textContent = detail;
      more.append(summary, pre);
      more.open = level === "error";
      item.append(more);
    }
    list.prepend(item);
    while (list.childElementCount > KEPT) list.lastElementChild.remove();
  };
  connection.addEventListener("event", ({ detail }) => add(detail.level, detail.text, detail.detail));
  connection.addEventListener("missed", ({ detail }) => add("warning", `${detail.events} events missed`, null));
  connection.addEventListener("closed", () => add("error", "Connection to the server lost", null));
  connection.addEventListener("denied", ({ detail }) => add("error", `No access: ${detail.why}`, null));
  connection.addEventListener("refused", ({ detail }) => {
    notice.textContent = `Refused: ${detail.why}`;
    notice.hidden = false;
    clearTimeout(hide);
    hide = setTimeout(() => { notice.hidden = true; }, NOTICE_MS);
  });
}
