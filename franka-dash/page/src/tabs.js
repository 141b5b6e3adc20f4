// Links between the pages of several robots on one server.

/** Shows links to `names` and to all of them; `root` leads from this page to the first one. */
export function tabs(names, root, current) {
  const nav = document.getElementById("robots");
  nav.hidden = names.length < 2;
  nav.replaceChildren(...["", ...names].map((name) => {
    const link = document.createElement("a");
    // The token stays.
    link.href = `${root}${name ? `${name}/` : ""}${location.hash}`;
    link.textContent = name || "All";
    if (name === current) link.setAttribute("aria-current", "page");
    return link;
  }));
}

/** The name of the robot of this page: the last part of its path. */
export const here = () => decodeURIComponent(location.pathname.split("/").at(-2) ?? "");
