// The robots of a server, asked for until it answers.

import { ask } from "./connection.js";

const AGAIN_MS = 1000;

/** The answer to a question for the list. `unreachable` is called once if it takes several attempts. */
export async function listed(unreachable) {
  for (let attempt = 1; ; attempt += 1) {
    const answer = await ask("robots.json");
    if (answer) return answer;
    if (attempt === 1) unreachable();
    await new Promise((again) => setTimeout(again, AGAIN_MS));
  }
}
