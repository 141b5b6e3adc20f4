// The page of one robot, or the one that shows several.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { dashboard } from "./dashboard.js";
import { overview } from "./overview.js";

if (document.body.id === "overview") overview();
else dashboard();
