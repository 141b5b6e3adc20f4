// Each joint: where it is in its range, where it is to be, how much it has of the velocity that it may
// have there, a target for it, and two jog buttons.

export class Joints {
  #rows = [];
  #hello = null;

  constructor(hold, preview, speed) {
    const place = document.getElementById("joints");
    const motion = () => ({ kind: "joints", q: this.#rows.map(({ target }) => Number(target.value)) });
    const said = document.getElementById("joints-said");
    const question = {
      motion,
      speed,
      said: (text, possible) => {
        said.textContent = text;
        said.classList.toggle("refused", !possible);
      },
    };
    for (let joint = 0; joint < 7; joint += 1) {
      const row = document.createElement("div");
      row.className = "joint";
      row.innerHTML = `<span>J${joint + 1}</span><button type="button" aria-label="joint ${joint + 1} down">−</button>`
        + `<div class="track"><i></i><i class="reference"></i><i class="pace"></i><input type="range" step="0.001" data-needs="motion" aria-label="target of joint ${joint + 1}"></div>`
        + `<button type="button" aria-label="joint ${joint + 1} up">+</button><span class="value"></span>`;
      place.append(row);
      const [down, up] = row.querySelectorAll("button");
      hold.bind(down, () => ({ motion: { kind: "joint", joint: joint + 1, up: false }, speed: speed() }));
      hold.bind(up, () => ({ motion: { kind: "joint", joint: joint + 1, up: true }, speed: speed() }));
      const [measured, reference, pace] = row.querySelectorAll("i");
      this.#rows.push({
        measured, reference, pace, track: row.querySelector(".track"),
        target: row.querySelector("input"), value: row.querySelector(".value"), touched: false,
      });
      const last = this.#rows[joint];
      last.target.addEventListener("input", () => {
        last.touched = true;
        preview.want(question);
      });
    }
    const go = document.getElementById("go");
    hold.bind(go, () => ({ motion: motion(), speed: speed() }));
    document.getElementById("joints-reset").addEventListener("click", () => {
      for (const row of this.#rows) row.touched = false;
      preview.forget(question);
      said.textContent = "";
    });
  }

  describe(hello) {
    this.#hello = hello;
    this.#rows.forEach(({ target }, i) => {
      target.min = hello.target_lower[i];
      target.max = hello.target_upper[i];
    });
  }

  show(frame) {
    if (!this.#hello) return;
    const { joint_lower: lower, joint_upper: upper } = this.#hello;
    this.#rows.forEach((row, i) => {
      const share = (q) => `${Math.min(1, Math.max(0, (q - lower[i]) / (upper[i] - lower[i]))) * 100}%`;
      row.measured.style.left = share(frame.q[i]);
      row.reference.style.left = share(frame.reference[i]);
      const velocity = Math.max(-1, Math.min(1, frame.pace[i]));
      row.pace.style.left = `${50 + 50 * Math.min(0, velocity)}%`;
      row.pace.style.width = `${50 * Math.abs(velocity)}%`;
      row.pace.classList.toggle("fast", Math.abs(velocity) > 0.9);
      const distance = Math.min(frame.q[i] - lower[i], upper[i] - frame.q[i]);
      row.track.classList.toggle("near", distance < 0.1);
      row.value.textContent = `${((frame.q[i] * 180) / Math.PI).toFixed(1)}°`;
      row.track.classList.toggle("aimed", row.touched);
      if (!row.touched) row.target.value = frame.q[i];
    });
  }
}
