// The examples of the page: the program makes them.
import type { Task } from "./history";

export const patient: Task = {
  subject: "ventricle",
  files: [],
  make: [["phantom", "patient", "--seed", "1", "--out", "/made"]],
  inputs: ["/made/study.dcm"],
};
export const vase: Task = {
  subject: "cloud",
  files: [],
  make: [["phantom", "cloud", "--set", "shape=vase", "--set", "points=30000", "--set", "noise_percent=0.1", "--out", "/made"]],
  inputs: ["/made/cloud.ply"],
};
