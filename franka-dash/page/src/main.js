// The page of one robot, or the one that shows several.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { dashboard } from "./dashboard.js";
import { overview, tell } from "./overview.js";

if (document.body.id === "overview") {
  overview().catch((error) => tell(`The robots cannot be shown: ${error.message}. Reload the page.`));
} else {
  dashboard();
}
